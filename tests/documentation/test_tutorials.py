"""The tutorials run as they are printed, and print what they show."""

import pytest

from simcore.paths import ROOT
from tests.helpers.page_blocks import PageRun, blocks_of

PAGES = sorted((ROOT / "docs/tutorials").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_runs_and_prints_what_it_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    PageRun(tmp_path).run(page.read_text(encoding="utf-8"))


def test_there_are_four_tutorials_of_some_length():
    assert len(PAGES) == 4
    assert all(len(blocks_of(page.read_text(encoding="utf-8"))) >= 6 for page in PAGES)

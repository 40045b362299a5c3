"""The how-to pages run as they are printed, and print what they show."""

import re

import pytest

from simcore.paths import ROOT
from tests.helpers.page_blocks import PageRun, blocks_of

RUN = sorted(
    page
    for page in (ROOT / "docs/how_to").glob("*.md")
    if any(block.language in ("bash", "python") for block in blocks_of(page.read_text(encoding="utf-8")))
)


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_a_page_runs_and_prints_what_it_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    PageRun(tmp_path).run(page.read_text(encoding="utf-8"))


def test_each_section_on_an_error_has_a_command_that_fails():
    _, *sections = re.split(r"^## ", (ROOT / "docs/how_to/errors.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert len(sections) >= 10
    for section in sections:
        assert any(block.mark == "fails" for block in blocks_of(section)), section.splitlines()[0]

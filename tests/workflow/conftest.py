"""Fixtures that run Snakemake on this project in a folder of their own."""

from pathlib import Path

import pytest

from tests.helpers.workplace import Workplace


@pytest.fixture
def workplace(tmp_path):
    """Return an empty workplace."""
    return Workplace(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """Return a workplace in which a small campaign of three studies has run, and the arguments of the run.

    The output of Snakemake, with its own log, is in the workplace's said.txt.
    """
    workplace = Workplace(tmp_path_factory.mktemp("campaign"))
    arguments = ["--configfile", "config/smoke.yaml", str(Path(__file__).with_name("three_studies.yaml"))]
    status, said = workplace.run(*arguments, "--verbose")
    assert status == 0, said
    (workplace.folder / "said.txt").write_text(said)
    return workplace, arguments

"""The version is stated in one place, is the same in all files, and has no effect on the digests of results."""

import json
import re
import subprocess
import tomllib

import pytest
import yaml

from simcore.packing.checkpoints.key import checkpoint_code
from simcore.paths import ROOT
from simcore.provenance.digest import read_source
from simcore.provenance.version import VERSION


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_package_takes_its_version_from_the_file_of_the_code():
    settings = tomllib.loads(read("pyproject.toml"))
    assert settings["project"]["dynamic"] == ["version"] and "version" not in settings["project"]
    assert read(settings["tool"]["setuptools"]["dynamic"]["version"]["file"]).strip() == VERSION


def test_the_files_for_citation_and_the_changelog_have_the_version():
    citation = yaml.safe_load(read("CITATION.cff"))
    assert citation["version"] == json.loads(read(".zenodo.json"))["version"] == VERSION
    newest = re.search(r"^## \[(\d.*?)\] - (\d{4}-\d{2}-\d{2})$", read("CHANGELOG.md"), re.MULTILINE)
    assert newest.groups() == (VERSION, str(citation["date-released"]))


def test_a_tag_of_this_commit_is_the_version():
    try:
        tags = subprocess.run(
            ["git", "tag", "--points-at", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.split()
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("this is no git repository")
    versions = [tag.removeprefix("v") for tag in tags if re.fullmatch(r"v?\d+\.\d+.*", tag)]
    assert versions in ([], [VERSION])


def test_a_new_version_changes_no_digest_and_refuses_no_checkpoint():
    module = ROOT / "simcore" / "provenance" / "version.py"
    assert VERSION not in read(module) and not read_source(module).imports
    assert checkpoint_code().split("+")[0] == "0.1.0" and VERSION not in checkpoint_code()

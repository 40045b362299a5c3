"""Names of code in files: what they are made of, and that they follow the sources."""

import subprocess

from simcore.paths import ROOT
from simcore.provenance import code_name
from simcore.provenance.digest import digest
from simcore.provenance.version import VERSION


def test_a_name_has_version_digest_and_the_commit_of_a_clone(monkeypatch, tmp_path):
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False).stdout
    name = code_name.code_name("abc")
    version, _, commit = name.partition(" ")
    assert version == f"{VERSION}+abc"
    assert head.startswith(commit.strip("()+")) and bool(commit) == bool(head)
    monkeypatch.setattr(code_name, "ROOT", tmp_path)
    code_name._commit.cache_clear()
    assert code_name.code_name("abc") == f"{VERSION}+abc"
    code_name._commit.cache_clear()


def test_evaluations_of_other_code_have_another_name():
    names = [code_name.name_of_sources(f"simcore/evaluation/{file}.py") for file in ("evaluate", "deposit")]
    assert names[0] != names[1]
    assert names[0].startswith(f"{VERSION}+{digest('simcore/evaluation/evaluate.py')[:12]}")

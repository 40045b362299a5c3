"""MkDocs builds the site without a warning."""

import subprocess
import sys

import pytest

from simcore.paths import ROOT


def test_the_site_is_built_without_a_warning(tmp_path):
    pytest.importorskip("material", reason="make environment installs MkDocs")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for page in ("index", "reference/packing_settings", "reference/python", "explanation/time_step"):
        assert (tmp_path / f"{page}.html").is_file()
    assert "simcore.pack" in (tmp_path / "reference" / "python.html").read_text(encoding="utf-8")

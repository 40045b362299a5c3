"""Commands start without the modules that only campaigns, ranks or other systems have."""

import json
import subprocess
import sys

from simcore.commands import COMMANDS
from simcore.paths import ROOT

# fcntl is absent on Windows; the others belong to extras of the package, or to `launch`.
WITHOUT = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {"fcntl", "mpi4py", "snakemake", "psutil", "openpyxl"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
sys.modules.pop("fcntl", None)
from simcore.__main__ import main
sys.exit(main(sys.argv[1:]))
"""
SPECIFICATION = """
domain: {width: 25 mm, height: 0.2 m}
shapes: {kind: sphere}
sizes: {bounds: [5.6 mm, 8 mm], mass_fractions: [1]}
amount: {grains: 40}
shaking: {duration: 0.05 s}
numerics: {contact_time: 1 ms}
"""


def without(folder, *words):
    """Run a command without these modules and return its exit status, output and errors."""
    command = [sys.executable, "-c", WITHOUT, *map(str, words)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def test_the_modules_are_absent(tmp_path):
    code = WITHOUT.replace("from simcore.__main__ import main\nsys.exit(main(sys.argv[1:]))", "import fcntl")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert "No module named 'fcntl'" in done.stderr


def test_every_command_shows_its_options(tmp_path):
    status, said, _ = without(tmp_path, "--help")
    assert status == 0
    assert all(name in said for name in COMMANDS)


def test_grains_are_predicted(tmp_path):
    status, said, errors = without(tmp_path, "predict", ROOT / "examples/table2.csv", "--case", "U1")
    assert status == 0, errors
    assert "Rhine" in said


def test_measured_porosities_are_fitted(tmp_path):
    words = ("fit", ROOT / "examples/measured.csv", "--case", "one-class", "--out", "model.json")
    status, said, errors = without(tmp_path, *words)
    assert status == 0, errors
    assert "The chosen model is the offset" in said and (tmp_path / "model.json").exists()


def test_a_bed_is_packed_on_one_rank_and_evaluated(tmp_path):
    (tmp_path / "tiny.yaml").write_text(SPECIFICATION)
    status, said, errors = without(tmp_path, "explain", "tiny.yaml")
    assert status == 0, errors
    assert "40" in said
    words = ("pack", "tiny.yaml", "tiny.nc", "--force", "--checkpoints", "kept")
    status, _, errors = without(tmp_path, *words)
    assert status == 0, errors
    assert "cannot be locked" in errors  # without fcntl there is no lock, and the log reports it
    status, said, errors = without(tmp_path, "porosity", "tiny.nc", "--cut", "2 mm", "--json")
    assert status == 0, errors
    assert 0.3 < json.loads(said)["n"] < 0.6
    status, _, errors = without(tmp_path, "fabric", "tiny.nc", "--cut", "2 mm")
    assert status == 0, errors


def test_a_rank_of_mpi_without_mpi4py_names_the_extra(tmp_path, monkeypatch):
    (tmp_path / "tiny.yaml").write_text(SPECIFICATION)
    monkeypatch.setenv("PMI_RANK", "0")  # as under mpiexec
    status, _, errors = without(tmp_path, "pack", "tiny.yaml", "x.nc")
    assert status == 2
    assert errors == (
        "scree pack: this needs the package mpi4py, which is not installed; install it with: pip install '.[mpi]' in "
        "the folder of Scree\n"
    )

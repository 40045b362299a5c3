"""The built package works without the clone, in an environment that contains only its wheel."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile

import pytest
import xarray as xr

from simcore.compilation import source_digest
from simcore.export.export import SUFFIXES
from simcore.packing.checkpoints.key import checkpoint_code
from simcore.paths import DATA, ROOT
from simcore.provenance.version import VERSION

SPECIFICATION = """
name: tiny
domain: {width: 25 mm, height: 0.2 m}
shapes: {kind: sphere}
sizes: {bounds: [5.6 mm, 8 mm], mass_fractions: [1]}
amount: {grains: 40}
shaking: {duration: 0.05 s}
numerics: {contact_time: 1 ms}
"""
SOURCES = ("setup.py", "pyproject.toml", "MANIFEST.in", "README.md", "LICENSE", "CHANGELOG.md", "environment.txt")
DIGESTS = (
    "from simcore.packing.checkpoints.key import checkpoint_code; from simcore.compilation import source_digest; "
    "print(source_digest(), checkpoint_code())"
)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Return the path of the wheel, built from a copy of the sources, so that the clone stays clean."""
    folder = tmp_path_factory.mktemp("sources")
    for name in SOURCES:
        shutil.copy(ROOT / name, folder)
    for name in ("config", "results/reference", "simcore"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    # The setuptools of this environment builds, so that no network is needed.
    options = ["--no-deps", "--no-index", "--no-build-isolation", "--quiet", "--wheel-dir", str(folder / "dist")]
    run([sys.executable, "-m", "pip", "wheel", ".", *options], folder)
    (path,) = (folder / "dist").glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """Return a function that runs words in an empty folder, with the programs of an environment that has the wheel.

    The environment takes the libraries, but not this project, from the one of the tests.
    """
    environment, empty = tmp_path_factory.mktemp("environment"), tmp_path_factory.mktemp("empty")
    run([sys.executable, "-m", "venv", "--without-pip", str(environment)], empty)
    paths = {"base": str(environment), "platbase": str(environment)}
    # A path file in a folder that a path file adds is not read, so an editable install of this project has no effect.
    libraries = dict.fromkeys(sysconfig.get_path(name) for name in ("purelib", "platlib"))
    site = sysconfig.get_path("purelib", "venv", vars=paths)
    with open(os.path.join(site, "libraries.pth"), "w", encoding="utf-8") as file:
        file.write("\n".join(libraries) + "\n")
    python = os.path.join(sysconfig.get_path("scripts", "venv", vars=paths), "python")
    options = ["--python", python, "install", "--no-deps", "--no-index", "--quiet", "--force-reinstall"]
    run([sys.executable, "-m", "pip", *options, str(wheel)], empty)

    def run_installed(program, *words):
        return run([os.path.join(os.path.dirname(python), program), *words], empty)

    run_installed.folder = empty
    run_installed.site = site
    return run_installed


def run(words, folder):
    """Run a program without the clone in Python's path and return its output; fail the test if it fails."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    if "--no-build-isolation" in words:
        environment["PYTHONPATH"] = os.environ.get("PYTHONPATH", "")
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def test_the_package_is_the_installed_one_and_has_the_digests_of_the_clone(installed):
    assert installed("python", "-c", "import simcore.paths as p; print(p.ROOT)").strip() == installed.site
    assert installed("python", "-c", DIGESTS).split() == [source_digest(), checkpoint_code()]
    assert installed("scree", "--version") == f"scree {VERSION}+{source_digest()}\n"


def test_all_data_are_in_the_wheel_and_nothing_but_the_package(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {name.split("/")[0] for name in names} == {"simcore", wheel.name.rsplit("-", 3)[0] + ".dist-info"}
    rows = [path.relative_to(DATA).as_posix() for path in (DATA / "results/reference").rglob("*.csv")]
    assert len(rows) > 50
    for name in (*rows, "config/packing.schema.yaml", "config/accuracy.yaml", "config/cases.tsv"):
        assert f"simcore/data/{name}" in names
    assert {"simcore/grains/scan_ranges.csv", "simcore/provenance/version.txt"} <= names
    assert {"simcore/page/static/page.html", "simcore/page/static/prediction.js"} <= names
    static = "simcore/report/static"
    assert {f"{static}/page.html", f"{static}/vendor/sortable.js", f"{static}/vendor/LICENSE"} <= names


def test_porosities_of_table_2_are_those_of_the_clone(installed):
    shutil.copy(ROOT / "examples/table2.csv", installed.folder)
    words = ["predict", "--case", "U1", "table2.csv"]
    predicted = installed("scree", *words, "--json")
    in_clone = subprocess.run(
        [sys.executable, "-m", "simcore", *words, "--json"],
        cwd=installed.folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert predicted == in_clone.stdout
    assert len(json.loads(predicted)["samples"]) == 9


def test_a_model_is_fitted_to_measured_porosities_and_predict_takes_it(installed):
    for name in ("measured.csv", "table2.csv"):
        shutil.copy(ROOT / "examples" / name, installed.folder)
    said = installed("scree", "fit", "measured.csv", "--case", "one-class", "--out", "model.json")
    assert "The chosen model is the offset of our model unified" in said
    predicted = json.loads(
        installed("scree", "predict", "--case", "U1", "table2.csv", "--models", "model.json", "--json")
    )
    assert [model["model"] for model in predicted["models"]] == ["measured"]


def test_a_packing_is_explained_packed_and_evaluated(installed):
    (installed.folder / "tiny.yaml").write_text(SPECIFICATION)
    assert "40" in installed("scree", "explain", "tiny.yaml")
    installed("scree", "pack", "tiny.yaml", "tiny.nc", "--force")
    with xr.open_dataset(installed.folder / "tiny.nc", engine="netcdf4") as bed:
        assert bed.sizes["grain"] == 40
    bulk = json.loads(installed("scree", "porosity", "tiny.nc", "--cut", "2 mm", "--json"))
    assert 0.3 < bulk["n"] < 0.6
    code = "import simcore; print(simcore.read_packing('tiny.nc').sizes['grain'])"
    assert installed("python", "-c", code) == "40\n"


def test_a_sieve_curve_is_described_and_written_as_a_packing(installed):
    shutil.copy(ROOT / "examples/sieve_curve.csv", installed.folder)
    words = ["sieve", "sieve_curve.csv", "--finest", "2 mm", "--specification", "bed.yaml", "--plot", "curve.png"]
    assert "Folk and Ward: medium gravel" in installed("scree", *words)
    assert (installed.folder / "curve.png").is_file()
    assert "Warning" not in installed("scree", "explain", "bed.yaml")


def test_a_packing_is_exported_to_each_format_and_drawn(installed):
    (installed.folder / "tiny.yaml").write_text(SPECIFICATION)
    installed("scree", "pack", "tiny.yaml", "exported.nc", "--force")
    installed("scree", "export", "exported.nc", "bed.stl")
    # One process writes the other formats, because each start takes seconds.
    code = f"from simcore.__main__ import main; [main(['export', 'exported.nc', 'bed' + end]) for end in {SUFFIXES}]"
    installed("python", "-c", code)
    for suffix in SUFFIXES:
        assert (installed.folder / f"bed{suffix}").stat().st_size > 0
    installed("scree", "plot", "exported.nc", "--cut", "2 mm")
    assert (installed.folder / "exported.png").is_file()

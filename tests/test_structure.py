"""The layout that simcore/__init__.py describes: packages whose imports run one way, short files, short signatures."""

import ast
import subprocess
import sys

import pytest

from benchmarks.correctness import structure
from simcore.paths import ROOT

# A package imports only what is listed before it.
ORDER = (
    "paths",
    "writing",
    "provenance",
    "compilation",
    "grains",
    "scene",
    "dem",
    "evaluation",
    "packing",
    "reference",
    "models",
    "export",
    "pores",
    "campaign",
    "verification",
    "report",
    "page",
    "commands",
    "__main__",
)
# Functions that may have more positional arguments than structure.MOST_ARGUMENTS, with the reason.
LONG_SIGNATURES = {}

# These packages contain the data of a scene, and Snakemake imports them again for each job.
WITHOUT_NUMBA = """
import importlib, pkgutil, sys
import simcore.campaign.plan, simcore.grains, simcore.scene
for package in (simcore.grains, simcore.scene):
    for module in pkgutil.iter_modules(package.__path__, package.__name__ + "."):
        importlib.import_module(module.name)
sys.exit("numba" in sys.modules)
"""
# A plan reads no grains, and a prediction for a case evaluates no model of sieve curves.
LOADED_LATER = {
    "simcore.campaign.plan": {"numba", "simcore.grains.readers", "simcore.grains.voxels", "statsmodels", "sklearn"},
    "simcore.models.size_and_form.bed_forms": {"numba", "simcore.models.size_and_form.bed_prediction", "statsmodels"},
}


@pytest.mark.parametrize("module", LOADED_LATER)
def test_what_a_command_does_not_need_is_not_imported(module):
    code = f"import sys, {module}; print(sorted({LOADED_LATER[module]!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "[]", done.stderr


def test_imports_run_one_way():
    pairs = structure.package_imports(ROOT)
    assert {package for pair in pairs for package in pair} == set(ORDER)
    assert [pair for pair in pairs if ORDER.index(pair[0]) <= ORDER.index(pair[1])] == []
    assert structure.cycles(pairs) == []


def test_the_root_has_only_what_all_packages_use_and_the_command_line():
    assert set(structure.root_modules(ROOT)) <= {"__init__", "__main__", "compilation", "paths", "writing"}


def test_files_and_signatures_are_short():
    assert structure.long_files(ROOT) == {}
    assert structure.long_signatures(ROOT).keys() == LONG_SIGNATURES.keys()


def test_grains_scenes_and_plans_need_no_numba():
    assert subprocess.run([sys.executable, "-c", WITHOUT_NUMBA], cwd=ROOT).returncode == 0


@pytest.fixture
def checkout(tmp_path):
    """Return a checkout with two packages that import each other, one from inside a function, and a third."""
    sources = {
        "__init__": "",
        "top": "from simcore.a import one\n",
        "a/__init__": "",
        "a/one": "from ..b import two\n\n\ndef f(a, b, c, d, e, /, f, g, h, i, *, k):\n    pass\n",
        "b/__init__": "",
        "b/two": "class C:\n    def g(self, a, b, c, d, e, f, g, h):\n        import simcore.a.one\n",
        "c/__init__": "\n" * (structure.MOST_LINES + 1),
    }
    for name, text in sources.items():
        path = tmp_path / "simcore" / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def test_circles_long_files_and_long_signatures_are_found(checkout):
    pairs = structure.package_imports(checkout)
    assert pairs == {("top", "a"): 1, ("a", "b"): 1, ("b", "a"): 1}
    assert structure.cycles(pairs) == [["a", "b"]]
    assert structure.root_modules(checkout) == ["__init__", "top"]
    assert structure.long_files(checkout) == {"simcore.c": structure.MOST_LINES + 1}
    assert structure.long_signatures(checkout) == {"simcore.a.one.f": 9}  # neither self nor the keyword counts


def test_relative_imports_of_a_package_are_those_of_its_folder():
    tree = ast.parse("from .deep import f\nfrom . import g\n")
    known = {"simcore.a", "simcore.a.deep", "simcore.a.g", "simcore.deep", "simcore.g"}
    assert structure.imported_modules("simcore.a.one", tree, known) == {"simcore.a.deep", "simcore.a.g"}


def test_a_folder_without_the_code_is_refused(tmp_path, capsys):
    with pytest.raises(SystemExit) as stopped:
        structure.main([str(tmp_path)])
    assert stopped.value.code == 2
    assert "Name the root of a checkout" in capsys.readouterr().err

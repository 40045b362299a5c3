"""The public names of simcore, and the ten lines of the README that use them."""

import re
import subprocess
import sys

import pytest

import simcore
from simcore.paths import ROOT
from tests.helpers.packings import make_packing, sphere_lattice


def test_every_public_name_is_there_and_documented():
    for name in simcore.__all__:
        value = getattr(simcore, name)
        assert name in dir(simcore)
        assert name == "__version__" or len(value.__doc__) > 40, name


def test_an_unknown_name_is_refused_with_those_that_exist():
    with pytest.raises(AttributeError, match="no attribute 'packing_of'; it has pack, read_packing, "):
        simcore.packing_of  # noqa: B018


def test_the_package_alone_imports_nothing_large():
    code = "import sys, simcore; print({'numba', 'numpy', 'xarray', 'scipy'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "set()\n"


def test_ten_lines_of_the_readme_pack_spheres_and_print_their_coordination_number(tmp_path):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(import simcore\n.*?)```", text, re.DOTALL)
    assert len([line for line in code.splitlines() if line.strip()]) <= 10
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    *rows, last = done.stdout.splitlines()
    assert len(rows) == 100 and all(len(row.strip("[] ").split()) == 3 for row in rows)
    # With friction, spheres need at least four contacts on average where they carry load; the top of the bed has fewer.
    assert 3.0 < float(last) < 6.0


def test_a_specification_of_another_type_is_refused():
    with pytest.raises(ValueError, match="the specification is of type list; give a nested dict, or the path"):
        simcore.pack([])


@pytest.mark.parametrize("function", ["porosity", "porosity_profile", "fabric", "coordination_number"])
def test_what_evaluates_a_packing_takes_its_path_too(tmp_path, function):
    centres, width = sphere_lattice("bcc", 4, 12)
    bed = make_packing(1e-2 * centres, 5e-3, width=1e-2 * width)
    simcore.write_packing(tmp_path / "bed.nc", bed)
    assert getattr(simcore, function)(tmp_path / "bed.nc").identical(getattr(simcore, function)(bed))
    with pytest.raises(ValueError, match="absent.nc: there is no such file"):
        getattr(simcore, function)("absent.nc")

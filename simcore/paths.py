"""Paths of the files that are part of the project, in a clone and in an installed package.

In a clone, and in an editable install from it, the data files are in config/ and results/reference/ beside the package.
A built package has the same files under the same names in its folder data/, where `setup.py` puts them.
"""

import os
import sys
from importlib.resources import files
from pathlib import Path

PACKAGE = Path(str(files("simcore"))).resolve()
ROOT = PACKAGE.parent  # folder from which the package is imported: the clone, or site-packages
DATA = PACKAGE / "data" if (PACKAGE / "data").is_dir() else ROOT
CONFIG = DATA / "config"  # schemas, presets, sieve curves
REFERENCE = DATA / "results" / "reference"  # committed rows
R22_TABLES = REFERENCE / "r22"  # the tables of Rettinger et al. (2022)


def project_file(name: str | Path) -> Path:
    """Return the path of a file of the project, given by its path in the clone, such as "config/cases.tsv"."""
    beside_code, in_data = ROOT / name, DATA / name
    return in_data if in_data.is_file() else beside_code


def project_name(path: Path) -> str:
    """Return the path of a file of the project in the clone, wherever it is installed, or all of any other path."""
    for folder in (DATA, ROOT):
        if path.is_relative_to(folder):
            return path.relative_to(folder).as_posix()
    return str(path)


def cache_folder() -> Path:
    """Return the folder of compiled code and of what is read of source files: SCREE_CACHE, or ~/.cache/scree.

    RuntimeError if the variable is not set and there is no home folder.
    """
    given = os.environ.get("SCREE_CACHE")
    return Path(given) if given else Path.home() / ".cache" / "scree"


def find_this_python_first() -> None:
    """Put this process's Python first in PATH for the programs that it starts, also without an active environment."""
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])

"""Paths of the files that are part of the project."""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "config"  # schemas, presets, sieve curves
REFERENCE = ROOT / "results" / "reference"  # committed rows
R22_TABLES = REFERENCE / "r22"  # the tables of Rettinger et al. (2022)


def find_this_python_first() -> None:
    """Put this process's Python first in PATH for the programs that it starts, also without an active environment."""
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])

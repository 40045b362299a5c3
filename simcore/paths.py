"""Where the files lie that come with the project."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "config"  # schemas, presets, sieve curves
REFERENCE = ROOT / "results" / "reference"  # committed rows
R22_TABLES = REFERENCE / "study"  # the tables of Rettinger et al. (2022)

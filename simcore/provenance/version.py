"""The version of Scree. Its one place is version.txt, which pyproject.toml reads too.

The number is not in Python code, so that a new version changes no digest of the code: it makes no packing anew and
refuses no checkpoint.
"""

from pathlib import Path

VERSION = Path(__file__).with_name("version.txt").read_text(encoding="utf-8").strip()

"""Puts the project's data files into a built package; everything else is in pyproject.toml.

The files have one place in the clone, config/ and results/reference/, and are copied when a package is built. An
editable install reads them in the clone. See simcore/paths.py.
"""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

DATA = (
    "config/*.schema.yaml",
    "config/accuracy.yaml",
    "config/config.yaml",
    "config/cases.tsv",
    "config/curves.tsv",
    "results/reference/**/*.csv",
)


class BuildWithData(build_py):
    """Copies the data files to simcore/data, under their paths in the clone."""

    def run(self):
        super().run()
        if not self.editable_mode:
            for source in data_files():
                target = Path(self.build_lib, "simcore", "data", source)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)


def data_files():
    """Return the paths of the data files, sorted; RuntimeError if a pattern matches none."""
    found = {pattern: sorted(Path().glob(pattern)) for pattern in DATA}
    if empty := [pattern for pattern, paths in found.items() if not paths]:
        raise RuntimeError(f"There is no file {', '.join(empty)}. Build from the folder of setup.py in a whole clone.")
    return sorted(path for paths in found.values() for path in paths)


setup(cmdclass={"build_py": BuildWithData})

"""Columns of written tables that simcore.reference.columns does not describe."""

import csv
from pathlib import Path

from simcore.reference.columns import find_column


def undescribed_columns(folder, tables="**/*.csv"):
    """Return the undescribed columns of the tables in `folder`, a dict from path to names, of such tables only.

    The heading of a column of row names may be empty. If there is no table, an AssertionError is raised.
    """
    found = {}
    paths = sorted(Path(folder).glob(tables))
    assert paths, f"{folder}: no table fits {tables}"
    for path in paths:
        table = path.relative_to(folder)
        with open(path, newline="", encoding="utf-8") as file:
            header = next(csv.reader(file))
        missing = [name for name in header if name and find_column(table, name) is None]
        if missing:
            found[str(table)] = missing
    return found

"""Errors in rows of a table: the first one in full, and which other rows have errors too."""

from simcore.grains.form_notices import SHOWN
from simcore.grains.text_lists import join_first


def read_each(rows, read) -> dict:
    """Return {row: read(row)}; ValueError with the first error of `read` and the other rows that have one."""
    values, errors = {}, {}
    for row in rows:
        try:
            values[row] = read(row)
        except ValueError as error:
            errors[row] = error
    if errors:
        raise ValueError(_describe(errors))
    return values


def _describe(errors):
    (_, first), *others = errors.items()
    if not others:
        return str(first)
    rows, verb = ("rows", "have errors") if len(others) > 1 else ("row", "has an error")
    return f"{first}; {rows} {join_first([str(row) for row, _ in others], SHOWN)} {verb} too"

"""Errors in rows of a table: the first one in full, and which other rows have errors too."""

from simcore.grains.form_notices import SHOWN
from simcore.grains.text_lists import join_first


def read_each(items, read) -> list:
    """Return [read(row, item)] of the pairs `items` of a row and what it contains.

    ValueError with the first error of `read` and the other rows that have one.
    """
    values, errors = [], []
    for row, item in items:
        try:
            values.append(read(row, item))
        except ValueError as error:
            errors.append((row, error))
    if errors:
        raise ValueError(_describe(errors))
    return values


def _describe(errors):
    (_, first), *others = errors
    if not others:
        return str(first)
    rows, verb = ("rows", "have errors") if len(others) > 1 else ("row", "has an error")
    return f"{first}; {rows} {join_first([str(row) for row, _ in others], SHOWN)} {verb} too"

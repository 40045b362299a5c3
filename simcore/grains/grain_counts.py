"""Reads how many grains each row of a table of grain forms represents."""

import re
from dataclasses import dataclass

from simcore.grains.cell_numbers import read_number
from simcore.grains.class_labels import group_noun
from simcore.grains.form_columns import may_number_rows

MAX_GRAINS = 1e12  # maximum of a count in one row
FEWEST_IDS = 6  # so many whole numbers may number the rows with gaps, such as 101, 102, 104, ..., or in another order
ROWS_BY_SAMPLE = 3  # least mean number of rows of a sample whose rows are numbered from 1
# 1,234 may mean 1234 or 1.234.
_AMBIGUOUS = re.compile(r"[1-9]\d{0,2}[.,]\d{3}")
_PERCENT = re.compile("%|percent", re.IGNORECASE)
_WHOLE = re.compile(r"[1-9]\d{0,11}")  # a number of grains, at most about MAX_GRAINS


@dataclass(frozen=True)
class Counts:
    """Weights of the rows.

    weights: dict from row to its weight; whole: whether the weights are numbers of grains instead of shares.
    """

    weights: dict
    whole: bool


def read_counts(path, header, cells, columns):
    """Return the Counts of the rows (None if each row is one grain), and notices."""
    if columns.counts is None:
        return None, []
    name, texts = header[columns.counts], cells[columns.counts]
    used = cells[[*columns.forms.values(), columns.counts]].to_numpy().ravel()
    marks = {mark for text in used for mark in ".," if mark in text and not _AMBIGUOUS.fullmatch(text)}
    weights = {}
    for row, text in texts.items():
        where = f"{path}, row {row}"
        if _AMBIGUOUS.fullmatch(text) and not marks == {mark for mark in ".," if mark in text}:
            raise ValueError(f"{where}: {name} is {text}; write it without a separator of thousands")
        weights[row] = read_number(where, name, text)
        if not 0 <= weights[row] <= MAX_GRAINS:
            raise ValueError(f"{where}: {name} = {weights[row]:g}; a number of grains must be between 0 and 1e12")
    values = list(weights.values())
    if _are_row_numbers(name, values):
        return None, [_row_numbers_notice(name)]
    whole = all(value.is_integer() for value in values) and not _PERCENT.search(name)
    if whole:
        _refuse_rising(path, name, values, "grains")
        return Counts(weights, True), [
            f"the column {name} is the number of grains of each row, {sum(values):.0f} in all"
        ]
    return Counts(weights, False), [f"the column {name} is the weight of each row; the number of grains is unknown"]


def read_numbers(path, header, cells, columns):
    """Return the Counts of the grains of each sample of means, None if they are unknown, and notices."""
    if columns.counts is None:
        return None, []
    name, texts = header[columns.counts], cells[columns.counts]
    if _PERCENT.search(name):
        return None, [f"the column {name} is not used, because it is in percent"]
    for row, text in texts.items():
        if _AMBIGUOUS.fullmatch(text) and not may_number_rows(name):
            raise ValueError(f"{path}, row {row}: {name} is {text}; write it without a separator of thousands")
        if not _WHOLE.fullmatch(text):
            given = f"{text} in row {row} is no" if text else f"row {row} has no"
            return None, [f"the column {name} is not used, because {given} number of grains"]
    numbers = [int(text) for text in texts]
    if _are_row_numbers(name, numbers):
        return None, [_row_numbers_notice(name)]
    noun = group_noun(header, columns.sample)
    _refuse_rising(path, name, numbers, f"{noun}es" if noun.endswith("s") else f"{noun}s")
    notice = f"the column {name} is the number of grains of each {noun}; FL and EL are assumed to be independent"
    return Counts(dict(zip(texts.index, numbers, strict=True)), True), [notice]


def _are_row_numbers(name, values):
    """Return whether values number the rows: they rise by 1, are 1 to N in any order, or begin anew for each sample.

    The last two need at least FEWEST_IDS rows, because few counts of grains may be so by chance. If the name of the
    column can only be that of a number of grains, such as `count`, the first needs as many rows too, and the smallest
    value must be 1.
    """
    if not may_number_rows(name) and min(values) != 1:
        return False
    rises = [b - a == 1 for a, b in zip(values, values[1:], strict=False)]
    if rises and all(rises) and (may_number_rows(name) or len(values) >= FEWEST_IDS):
        return True
    if len(values) < FEWEST_IDS:
        return False
    starts = [value for value, rises_to in zip(values, [False, *rises], strict=True) if not rises_to]
    anew = set(starts) == {1} and len(starts) * ROWS_BY_SAMPLE <= len(values)
    return anew or sorted(values) == list(range(1, len(values) + 1))


def _refuse_rising(path, name, values, rows):
    """Raise ValueError if whole numbers rise from row to row in a column that may number them; rows: what they are."""
    rise = all(b > a for a, b in zip(values, values[1:], strict=False))
    if rise and len(values) >= FEWEST_IDS and may_number_rows(name):
        raise ValueError(
            f"{path}: the numbers in the column {name} rise from row to row; rename the column to `id` if they number "
            f"the {rows}, or to `count` if they are numbers of grains"
        )


def _row_numbers_notice(name):
    return f"the column {name} numbers the rows, so it is not used as a number of grains"

"""Recognises a column of sieve classes by its name, and reads its cells, such as "8-11.2 mm"."""

import re

from simcore.grains.cell_numbers import read_number
from simcore.grains.sieve_columns import LENGTHS, known_unit

CLASS_NAME = re.compile(
    r"(?:(?:(?:size|sieve)[ _-]*)?class|(?:sieb|korn)?klasse)(?:\s*[\[(]([a-zµμ]+)[\])])?", re.IGNORECASE
)
CLASS_LABEL = re.compile(r"([\d.,]+)\s*([a-zµ]*)\s*(-|–|/|to|bis|\.\.)\s*([\d.,]+)\s*([a-zµ]*)", re.IGNORECASE)


def class_patterns():
    """Return the regular expressions of the name of the column and of its cells; whole texts match, in any case."""
    return CLASS_NAME.pattern, CLASS_LABEL.pattern


def look_like_classes(texts):
    """Return whether there are texts, and each of them is a range of sizes; 3/2021, without a unit, is a date."""
    matches = [CLASS_LABEL.fullmatch(text) for text in texts]
    if not matches or not all(matches) or any(match[3] == "/" and not match[5] for match in matches):
        return False
    try:
        return all(_number(match[1]) < _number(match[4]) for match in matches)
    except ValueError:
        return False


def class_bounds(where, column, label, unit):
    """Return the bounds [m] of a class; the lower one may be 0.

    where: file and row, for messages. unit: text of the unit in the name of the column, or None. ValueError if the
    label is no class, or has no unit or an unknown one.
    """
    match = CLASS_LABEL.fullmatch(label)
    in_header = "" if unit else f", or put the unit in the header, `{column} [mm]`"
    if not match:
        example = "8-11.2" if unit else "8-11.2 mm"
        raise ValueError(f"{where}: {column} is '{label}'; give both sieves, such as '{example}'{in_header}")
    low, low_unit, mark, high, high_unit = match.groups()
    high_unit = high_unit or unit
    if not high_unit:
        raise ValueError(f"{where}: {column} is '{label}' without a unit; write it as '{label} mm'{in_header}")
    if mark == "/" and known_unit(high_unit) == "in":
        raise ValueError(
            f"{where}: {column} is '{label}', which may be a fraction of an inch; write a class as '{low}-{high}'"
        )
    lower, upper = (
        read_number(f"{where}, {column} '{label}'", "size", text) * _factor(where, column, label, of_text)
        for text, of_text in ((low, low_unit or high_unit), (high, high_unit))
    )
    if not lower < upper:
        raise ValueError(f"{where}: {column} is '{label}'; give the smaller size first")
    return lower, upper


def _factor(where, column, label, text):
    unit = known_unit(text)
    if unit not in LENGTHS:
        raise ValueError(f"{where}: {column} is '{label}'; its unit '{text}' is unknown, use {', '.join(LENGTHS)}")
    return LENGTHS[unit]


def _number(text):
    return float(text.replace(",", "."))

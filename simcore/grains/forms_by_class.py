"""Reads the forms of the grains of each sieve class from a table with a column of classes.

The column is named `class`, `size class` or `sieve class`; its cells are such as "8-11.2 mm".
"""

import re

from simcore.grains.cell_numbers import read_number
from simcore.grains.measured_forms import read_measured
from simcore.grains.sieve_columns import LENGTHS, known_unit
from simcore.grains.table_file import read_table

_NAME = re.compile(r"(?:(?:size|sieve)[ _-]*)?class(?:\s*[\[(](\w+)[\])])?", re.IGNORECASE)
_LABEL = re.compile(r"([\d.,]+)\s*([a-zµ]*)\s*(?:-|–|to|\.\.)\s*([\d.,]+)\s*([a-zµ]*)", re.IGNORECASE)


def class_patterns():
    """Return the regular expressions of the name of the column and of its cells; whole texts match, in any case."""
    return _NAME.pattern, _LABEL.pattern


def class_column(path):
    """Return the name of the column of sieve classes of the table at `path`, or None if it has none."""
    if path is None:
        return None
    return next((name for name in read_table(path).header if _NAME.fullmatch(name)), None)


def read_classes(path, column):
    """Return ({(lower, upper) [m]: Sample}, notices) of a table with a column of sieve classes.

    ValueError if a label is no class, or if two classes overlap.
    """
    samples, notices = read_measured(path, column)
    unit = _NAME.fullmatch(column).group(1)
    classes = dict(sorted((_bounds(path, column, sample.name, unit), sample) for sample in samples))
    ends = list(classes)
    for (low, high), (lower, upper) in zip(ends, ends[1:], strict=False):
        if lower < high * (1 - 1e-9):
            raise ValueError(
                f"{path}: the classes {low * 1e3:g} to {high * 1e3:g} mm and {lower * 1e3:g} to {upper * 1e3:g} mm "
                f"overlap; correct the column {column}"
            )
    return classes, notices


def sample_of_class(curve, index, classes):
    """Return the Sample of the class `index` of a SieveCurve, from the classes of read_classes.

    ValueError if the class of the curve lies in none of them.
    """
    low, high = curve.bounds[index : index + 2]
    for (lower, upper), sample in classes.items():
        if lower <= low * (1 + 1e-6) and high <= upper * (1 + 1e-6):
            return sample
    raise ValueError(
        f"{curve.name}: the class {low * 1e3:g} to {high * 1e3:g} mm has mass, but lies in none of the classes of the "
        "table of forms; add its forms, or remove the column of classes"
    )


def _bounds(path, column, label, unit):
    match = _LABEL.fullmatch(label.strip())
    if not match:
        raise ValueError(f"{path}: {column} is {label!r}, which is no sieve class; write it as '8-11.2 mm'")
    low, low_unit, high, high_unit = match.groups()
    high_unit = high_unit or unit
    if not high_unit:
        raise ValueError(f"{path}: {column} is {label!r} without a unit; write it as '{label} mm'")
    lower, upper = (
        read_number(f"{path}, {column} {label!r}", "size", text) * _factor(path, column, label, of_text)
        for text, of_text in ((low, low_unit or high_unit), (high, high_unit))
    )
    if not 0.0 < lower < upper:
        raise ValueError(f"{path}: {column} is {label!r}; give the smaller size first, and sizes above 0")
    return lower, upper


def _factor(path, column, label, text):
    unit = known_unit(text)
    if unit not in LENGTHS:
        raise ValueError(f"{path}: {column} is {label!r}; its unit {text!r} is unknown, use {', '.join(LENGTHS)}")
    return LENGTHS[unit]

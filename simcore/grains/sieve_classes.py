"""Reads a table of sieve classes, such as "8-11.2 mm" with its mass, as a table of sieves."""

import math
import re
from dataclasses import replace

from simcore.grains.cell_numbers import read_number
from simcore.grains.class_labels import CLASS_LABEL, CLASS_NAME, class_bounds
from simcore.grains.sieve_columns import LENGTHS, OPENING, PAN, RETAINED, column_meaning, known_unit
from simcore.grains.summary_rows import find_summary_rows

LOWER_SIEVE = "lower sieve"  # name of the column of openings that replaces the classes
OPEN_END = re.compile(r"(<=?|>=?|≤|≥|unter|über|below|above|under|over)\s*([\d.,]+)\s*([a-zµμ]*)", re.IGNORECASE)
BELOW = ("<", "<=", "≤", "unter", "below", "under")
SAME_SIEVE = 1e-6  # relative deviation


def with_lower_sieves(path, table):
    """Return (TextTable, whether it has classes), with each class replaced by the sieve on which it is retained.

    The rows are in the order of the sieves, finest first, and the upper sieve of the coarsest class is added, on which
    nothing is retained. Ends such as "< 2 mm", "> 63 mm" and `pan` may stand beside the classes. A table without
    classes is returned as it is. ValueError names a label that is no class, and classes that overlap or leave a gap.
    """
    position, unit = _column_of_classes(path, table)
    if position is None:
        return table, False
    name = table.header[position]
    totals = find_summary_rows(table.cells[[position]])
    classes, others = [], []
    for row, label in table.cells[position].items():
        if row in totals or PAN.fullmatch(label) and not OPEN_END.fullmatch(label):
            others.append(row)
        else:
            classes.append((*_bounds(f"{path}, row {row}", name, label, unit), row))
    classes.sort()
    _check_neighbours(path, name, classes)
    header = [LOWER_SIEVE if k == position else text for k, text in enumerate(table.header)]
    cells = table.cells.loc[[*others, *(row for *_, row in classes)]].copy()
    for lower, _, row in classes:
        cells.loc[row, position] = f"{1e3 * lower:.12g} mm"
    if math.isfinite(classes[-1][1]):
        cells.loc[table.cells.index.max() + 1] = "0"
        cells.loc[cells.index[-1], position] = f"{1e3 * classes[-1][1]:.12g} mm"
    return replace(table, header=header, cells=cells), True


def retained_only(path, columns):
    """Return the SieveColumns with the amounts of the classes only; ValueError if there are none."""
    amounts = [column for column in columns.amounts if column.meaning == RETAINED]
    if not amounts:
        raise ValueError(
            f"{path}: sieve classes need the mass or the percent of each class, such as `mass [g]` or `retained [%]`; "
            "if you have what passes, give the openings of the sieves instead of classes"
        )
    return replace(columns, amounts=amounts)


def _column_of_classes(path, table):
    """Return the position of the column of classes and the text of its unit; (None, None) if there are openings."""
    found = []
    for position, name in enumerate(table.header):
        named = CLASS_NAME.fullmatch(name)
        meaning, unit = (None, named[1]) if named else column_meaning(path, name)
        if any(_is_class(label, unit) for label in table.cells[position]):
            if named or meaning == OPENING:
                found.append((position, unit))
        elif meaning == OPENING:
            return None, None
    return found[0] if found else (None, None)


def _is_class(label, unit):
    """Return whether a cell is a class; 3/8 is one only with a unit other than inches, of which it is a fraction."""
    match = CLASS_LABEL.fullmatch(label)
    return bool(match) and (match[3] != "/" or known_unit(match[5] or unit or "") not in (None, "in"))


def _bounds(where, name, label, unit):
    """Return the bounds [m] of a class, or of an end, which reaches from 0 or to infinity."""
    end = OPEN_END.fullmatch(label)
    if not end:
        return class_bounds(where, name, label, unit)
    mark, size, of_size = end.groups()
    length = known_unit(of_size or unit or "")
    if length not in LENGTHS:
        raise ValueError(f"{where}: {name} is '{label}' without a unit of length; use {', '.join(LENGTHS)}")
    value = read_number(f"{where}, {name} '{label}'", "size", size) * LENGTHS[length]
    return (0.0, value) if mark.lower() in BELOW else (value, math.inf)


def _check_neighbours(path, name, classes):
    """Raise ValueError unless each class of the sorted (lower, upper, row) begins where the one before it ends."""
    for (low, high, row), (lower, upper, next_row) in zip(classes, classes[1:], strict=False):
        if lower < high * (1 - SAME_SIEVE):
            raise ValueError(
                f"{path}: the classes {_text(low, high)} (row {row}) and {_text(lower, upper)} (row {next_row}) "
                f"overlap; correct the column {name}"
            )
        if lower > high * (1 + SAME_SIEVE):
            raise ValueError(
                f"{path}: no row has the class {_text(high, lower)}, between rows {row} and {next_row}; add it, with 0 "
                "if it is empty"
            )


def _text(low, high):
    if low == 0.0:
        return f"below {1e3 * high:g} mm"
    return f"{1e3 * low:g} to {1e3 * high:g} mm" if math.isfinite(high) else f"above {1e3 * low:g} mm"

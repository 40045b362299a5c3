"""Reads a table of sieve classes, such as "8-11.2 mm" with its mass, as a table of sieves."""

import math
import re
from dataclasses import replace

from simcore.grains.cell_numbers import check_decimal_marks
from simcore.grains.class_labels import (
    CLASS_LABEL,
    CLASS_NAME,
    IN_PHI,
    LOWER_NAME,
    LOWER_SIEVE,
    NO_PHI,
    NO_SIZE,
    OPEN_END,
    SIZE,
    UPPER_NAME,
    UPPER_SIEVE,
    class_bounds,
    class_text,
)
from simcore.grains.sieve_columns import (
    LENGTHS,
    OPENING,
    PAN,
    PHI,
    RETAINED,
    column_meaning,
    known_unit,
    split_unit,
    unit_in_name,
)
from simcore.grains.summary_rows import find_summary_rows

_SIGN = re.compile(r"(?<!\d)[-+−](?=\d)")
SAME_SIEVE = 1e-6  # relative deviation
NEARLY = 0.01  # relative deviation of two sizes that may be meant as the same sieve, such as 3.99 and 4


def with_joined_bounds(path, table):
    """Return the TextTable with a column of the lower and one of the upper sieves as one column of classes.

    The names are those of LOWER_NAME and UPPER_NAME with the same unit of length, such as `von [mm]` and `bis [mm]`, or
    those of LOWER_SIEVE and UPPER_SIEVE, such as `retained on [mm]` and `passing [mm]`. A class without a lower sieve
    is "< 2", one without an upper sieve "> 63". Other tables are returned as they are, also if a third column has the
    classes or the openings. ValueError if the units are missing, differ or are phi, or if a size has a separator of
    thousands.
    """
    parts = [_as_bound(*split_unit(name)) for name in table.header]
    lower, upper = (_position_of_bounds(parts, pattern) for pattern in (LOWER_NAME, UPPER_NAME))
    if lower is None or upper is None:
        return table
    used = {i: table.header[i] for i in (lower, upper)}
    if any(_has_sizes(path, table, i) for i in table.cells if i not in used):
        return table
    (low_name, unit), (high_name, other) = parts[lower], parts[upper]
    _check_units(path, used.values(), (low_name, high_name), (unit, other))
    check_decimal_marks(path, used, table.cells)
    header = [name for i, name in enumerate(table.header) if i != upper]
    cells = table.cells.copy()
    cells[lower] = [_joined(*texts) for texts in zip(cells[lower], cells[upper], strict=True)]
    cells = cells.drop(columns=upper).rename(columns=lambda i: i - (i > upper))
    header[lower - (lower > upper)] = f"{low_name} and {high_name} [{unit}]"
    return replace(table, header=header, cells=cells)


def _as_bound(name, unit):
    """Return the name and unit of a column; the name is that of a bound if the column has the lower or upper sieves."""
    if known_unit(unit or "") in LENGTHS:
        for pattern, bound in ((LOWER_SIEVE, "from"), (UPPER_SIEVE, "to")):
            if pattern.fullmatch(name):
                return bound, unit
    return name, unit


def _position_of_bounds(parts, pattern):
    """Return the position of the only column with such a name, of those with a unit if there are any, or None."""
    named = [i for i, (name, _) in enumerate(parts) if pattern.fullmatch(name)]
    positions = [i for i in named if parts[i][1]] or named
    return positions[0] if len(positions) == 1 else None


def _check_units(path, columns, names, texts):
    """Raise ValueError unless the texts of the two units are the same unit of length; names: columns without units."""
    units = {known_unit(text or "") for text in texts}
    the_columns = f"{path}: the columns {' and '.join(columns)}"
    if PHI in units:
        raise ValueError(f"{the_columns} are the bounds of classes; {NO_PHI}")
    if len(units) > 1 or not units <= set(LENGTHS):
        raise ValueError(
            f"{the_columns} need the same unit of length; write it in both names, such as "
            f"{' and '.join(f'`{name} [mm]`' for name in names)}"
        )


def _has_sizes(path, table, position):
    """Return whether a column has the openings of the sieves, or classes."""
    name = table.header[position]
    named, unit = _named_class(name)
    is_class = any(_is_class(label, unit, named) for label in table.cells[position])
    return bool(named) or is_class or column_meaning(path, name)[0] == OPENING


def _joined(low, high):
    """Return the class of two cells; a text that is no size, such as `pan` or a total, is returned as it is."""
    low, high = ("" if NO_SIZE.fullmatch(text) else text for text in (low, high))
    for text in (low, high):
        if text and not SIZE.fullmatch(text):
            return text
    if low and high:
        return f"{low}-{high}"
    return f"> {low}" if low else f"< {high}" if high else ""


def with_lower_sieves(path, table):
    """Return (TextTable, position of the column of classes), with each class replaced by the sieve that retains it.

    The rows are in the order of the sieves, finest first, and the upper sieve of the coarsest class is added, on which
    nothing is retained; its row number is one above all others. Ends such as "< 2 mm", "> 63 mm" and `pan` may stand
    beside the classes. Without classes the result is (table, None). ValueError names a label that is no class, and
    classes that overlap or leave a gap.
    """
    position, unit = _column_of_classes(path, table)
    if position is None:
        return table, None
    name = table.header[position]
    totals = find_summary_rows(table.cells[[position]])
    classes, others = [], []
    for row, label in table.cells[position].items():
        if row in totals or PAN.fullmatch(label) and not OPEN_END.fullmatch(label):
            others.append(row)
        else:
            classes.append((*class_bounds(f"{path}, row {row}", name, label, unit), row))
    classes.sort()
    _check_neighbours(path, name, classes)
    cells = table.cells.loc[[*others, *(row for *_, row in classes)]].copy()
    for lower, _, row in classes:
        cells.loc[row, position] = f"{1e3 * lower:.12g} mm"
    if math.isfinite(classes[-1][1]):
        cells.loc[table.cells.index.max() + 1] = "0"
        cells.loc[cells.index[-1], position] = f"{1e3 * classes[-1][1]:.12g} mm"
    return replace(table, cells=cells), position


def retained_only(path, columns):
    """Return the SieveColumns with the amounts of the classes only; ValueError if there are none."""
    amounts = [column for column in columns.amounts if column.meaning == RETAINED]
    if not amounts:
        raise ValueError(
            f"{path}: sieve classes need the mass or the percent of each class, such as `mass [g]` or `retained [%]`; "
            "if you have sums, give the openings of the sieves instead: what passes belongs to the upper sieve of a "
            "class, and what is retained in sum to its lower one"
        )
    return replace(columns, amounts=amounts)


def _column_of_classes(path, table):
    """Return the position of the column of classes and the text of its unit; (None, None) if there are openings."""
    of_classes, named_only = [], []
    for position, name in enumerate(table.header):
        named, unit = _named_class(name)
        is_class = any(_is_class(label, unit, named) for label in table.cells[position])
        if is_class:
            of_classes.append((position, unit))
        elif named:
            named_only.append((position, unit))
        elif column_meaning(path, name)[0] == OPENING:
            return None, None
    return [*of_classes, *named_only, (None, None)][0]


def _named_class(name):
    """Return the match of the name of a column with CLASS_NAME or None, and the text of its unit or None."""
    named = CLASS_NAME.fullmatch(name)
    unit = named[1] if named else unit_in_name(name)
    return named, PHI if unit is None and IN_PHI.search(name) else unit


def _is_class(label, unit, named):
    """Return whether a cell is a class, in phi too, which is refused later.

    3/8 inches are a fraction. In a column that is not named for classes, a class has a unit of length, since 2021-03 is
    a date.
    """
    if known_unit(unit or "") == PHI and CLASS_LABEL.fullmatch(_SIGN.sub("", label)):
        return True
    match = CLASS_LABEL.fullmatch(label)
    length = known_unit(match[5] or unit or "") if match else None
    return bool(match) and (
        length in LENGTHS and (match[3] != "/" or length != "in") or bool(named) and match[3] != "/"
    )


def _check_neighbours(path, name, classes):
    """Raise ValueError unless each class of the sorted (lower, upper, row) begins where the one before it ends."""
    for (low, high, row), (lower, upper, next_row) in zip(classes, classes[1:], strict=False):
        if lower < high * (1 - SAME_SIEVE):
            raise ValueError(
                f"{path}: the classes {class_text(low, high)} (row {row}) and {class_text(lower, upper)} (row "
                f"{next_row}) overlap; correct the column {name}"
            )
        if lower > high * (1 + NEARLY):
            raise ValueError(
                f"{path}: no row has the class {class_text(high, lower)}, between rows {row} and {next_row}; add it, "
                "with 0 if it is empty"
            )
        if lower > high * (1 + SAME_SIEVE):
            raise ValueError(
                f"{path}: the classes of rows {row} and {next_row} end and begin at {1e3 * high:g} and "
                f"{1e3 * lower:g} mm; write the same sieve in both"
            )

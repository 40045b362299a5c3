"""Reads the forms of the grains of each sieve class from a table with a column of classes.

The column is named `class`, `size class`, `sieve class`, `Klasse` or `Siebklasse`; its cells are such as "8-11.2 mm".
"""

from simcore.grains.cell_numbers import read_number
from simcore.grains.class_labels import CLASS_LABEL, CLASS_NAME
from simcore.grains.measured_forms import samples_of_table
from simcore.grains.sieve_columns import LENGTHS, known_unit
from simcore.grains.table_file import read_table


def class_column(path):
    """Return the name of the column of sieve classes of the table at `path`, or None if it has none."""
    if path is None:
        return None
    return next((name for name in read_table(path).header if CLASS_NAME.fullmatch(name)), None)


def read_classes(path, column):
    """Return ({(lower, upper) [m]: Sample}, notices) of a table with a column of sieve classes.

    ValueError if a label is no class, or if two classes overlap.
    """
    table = read_table(path)
    samples, notices = samples_of_table(table, column)
    labels = table.cells[table.header.index(column)]
    rows = {label: row for row, label in reversed(list(labels.items()))}  # the first row of each class
    unit = CLASS_NAME.fullmatch(column).group(1)
    classes = [(_bounds(f"{path}, row {rows[sample.name]}", column, sample.name, unit), sample) for sample in samples]
    classes.sort(key=lambda entry: entry[0])
    ends = [bounds for bounds, _ in classes]
    for (low, high), (lower, upper) in zip(ends, ends[1:], strict=False):
        if lower < high * (1 - 1e-9):
            raise ValueError(
                f"{path}: the classes {low * 1e3:g} to {high * 1e3:g} mm and {lower * 1e3:g} to {upper * 1e3:g} mm "
                f"overlap; correct the column {column}"
            )
    return dict(classes), notices


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


def _bounds(where, column, label, unit):
    """Return the bounds [m] of a class. where: file and row, for messages. unit: in the name of the column, or None."""
    match = CLASS_LABEL.fullmatch(label)
    in_header = "" if unit else f", or put the unit in the header, `{column} [mm]`"
    if not match:
        example = "8-11.2" if unit else "8-11.2 mm"
        raise ValueError(f"{where}: {column} is '{label}'; give both sieves, such as '{example}'{in_header}")
    low, low_unit, high, high_unit = match.groups()
    high_unit = high_unit or unit
    if not high_unit:
        raise ValueError(f"{where}: {column} is '{label}' without a unit; write it as '{label} mm'{in_header}")
    lower, upper = (
        read_number(f"{where}, {column} '{label}'", "size", text) * _factor(where, column, label, of_text)
        for text, of_text in ((low, low_unit or high_unit), (high, high_unit))
    )
    if not 0.0 < lower < upper:
        raise ValueError(f"{where}: {column} is '{label}'; give the smaller size first, and sizes above 0")
    return lower, upper


def _factor(where, column, label, text):
    unit = known_unit(text)
    if unit not in LENGTHS:
        raise ValueError(f"{where}: {column} is '{label}'; its unit '{text}' is unknown, use {', '.join(LENGTHS)}")
    return LENGTHS[unit]

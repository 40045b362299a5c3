"""Reads the forms of the grains of each sieve class from a table with a column of classes.

The column has a name such as `class` or `Siebklasse` (simcore.grains.class_labels); its cells are such as "8-11.2 mm".
"""

from simcore.grains.class_labels import CLASS_NAME, class_bounds, class_text
from simcore.grains.measured_forms import samples_of_table

BY_CLASS = "forms by sieve class"  # name of a sample without a name


def class_name(header):
    """Return the name of the column of sieve classes of a table with this header, or None if it has none."""
    return next((name for name in header if CLASS_NAME.fullmatch(name)), None)


def classes_of_table(table, column, name=None):
    """Return ({(lower, upper) [m]: Sample}, notices) of a TextTable with a column of sieve classes.

    column: its name. name: of the sample, for messages, or None. ValueError if a label is no class, or if two classes
    overlap.
    """
    path = table.path
    of = "" if name is None else f" of the sample {name}"
    samples, notices = samples_of_table(table, column, of=of)
    labels = table.cells[table.header.index(column)]
    rows = {label: row for row, label in reversed(list(labels.items()))}  # the first row of each class
    unit = CLASS_NAME.fullmatch(column).group(1)
    classes = [
        (class_bounds(f"{path}, row {rows[sample.name]}", column, sample.name, unit), sample) for sample in samples
    ]
    classes.sort(key=lambda entry: entry[0])
    ends = [bounds for bounds, _ in classes]
    for (low, high), (lower, upper) in zip(ends, ends[1:], strict=False):
        if (low, high) == (lower, upper):
            names = " and ".join(sample.name for bounds, sample in classes if bounds == (low, high))
            raise ValueError(f"{path}: {names}{of} are the same class; write it in one way in the column {column}")
        if lower < high * (1 - 1e-9):
            raise ValueError(
                f"{path}: the classes {class_text(low, high)} and {class_text(lower, upper)}{of} overlap; correct "
                f"the column {column}"
            )
    return dict(classes), notices


def describe_unused_classes(path, curve, classes, name=BY_CLASS):
    """Return notices on the classes of classes_of_table in which the SieveCurve has no mass.

    path: of their table. name: of the sample.
    """
    of = "" if name == BY_CLASS else f" of the sample {name}"
    with_mass = curve.mass_fractions > 0.0
    filled = list(zip(curve.bounds[:-1][with_mass], curve.bounds[1:][with_mass], strict=True))
    return [
        f"{path}: the class {class_text(lower, upper)}{of} is not used, because the sieve curve has no mass there"
        for lower, upper in classes
        if not any(low < upper * (1 - 1e-6) and lower * (1 + 1e-6) < high for low, high in filled)
    ]


def sample_of_class(curve, index, classes):
    """Return the Sample of the class `index` of a SieveCurve, from the classes of classes_of_table.

    ValueError if the class of the curve lies in none of them.
    """
    low, high = curve.bounds[index : index + 2]
    for bounds, sample in classes.items():
        if _contains(bounds, low, high):
            return sample
    parts = [bounds for bounds in classes if bounds[0] < high * (1 - 1e-6) and low * (1 + 1e-6) < bounds[1]]
    lies, remedy = "no class of the table of forms contains it", "add its forms"
    if index == 0:
        remedy += (
            f", or begin the finest class of forms at 0, such as '< {min(upper for _, upper in classes) * 1e3:g} mm'"
        )
    if parts:
        lies = f"it is only partly within {' and '.join(class_text(*bounds) for bounds in parts)} of the table of forms"
        remedy = "let the classes of forms end at sieves of the curve"
    raise ValueError(
        f"sieve curve {curve.name}: the class {low * 1e3:g} to {high * 1e3:g} mm has mass, but {lies}; "
        f"{remedy}, or remove the column of classes"
    )


def has_class(curve, index, classes) -> bool:
    """Return whether the class `index` of a SieveCurve lies in one of the classes of classes_of_table."""
    return any(_contains(bounds, *curve.bounds[index : index + 2]) for bounds in classes)


def _contains(bounds, low, high):
    return bounds[0] <= low * (1 + 1e-6) and high <= bounds[1] * (1 + 1e-6)

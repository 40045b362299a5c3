"""Reads point clouds from text: a table with columns x, y, z in its header, or of three columns without a header."""

import csv
import re

import numpy as np

from simcore.grains.measured_forms import read_measured

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?(nan|inf|infinity)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?")
# "x", "X", "x_mm", "X [mm]", "x (Länge)", "coord_x", "Points:0".
_AXIS_NAME = re.compile(
    r"(?:(?:coord(?:inate)?s?|pos(?:ition)?|points?)[\s_.:-]*)?([xyz012])(?:[\s_-]*coord(?:inate)?s?)?"
    r"(?:\s*[\[(]([^/]*)[\])]|[\s_]+(m|mm|cm|dm|[µμu]m|km|in|inch|ft))?",  # not of velocities
    re.IGNORECASE,
)
_LENGTHS = ("m", "mm", "cm", "dm", "µm", "μm", "um", "km", "in", "inch", "ft")
# Header names of axes or forms of grains, in lower case and without unit.
_FORM_NAMES = (
    {"l", "i", "s"},
    {"a", "b", "c"},
    {"fl", "el"},
    {"mean_fl", "mean_el"},
    {"mu_fl", "mu_el"},
    {"length", "width", "thickness"},
    {"flatness", "elongation"},
)
_LEAST_MEAN = 0.1  # minimum of mean flatness and elongation in a specification (config/packing.schema.yaml)
_LONGEST = 100.0  # maximum of the longest over the shortest axis of gravel


def read_points(path, unit):
    """Read the points (n, 3) of a text table, in its unit, and the names of the columns that were not used.

    unit: "m" or "mm"; a unit in the header must not contradict it. Commas, semicolons, tabs or blanks separate the
    fields; decimals may have commas unless commas separate the fields. The first row may be the number of points.
    ValueError names row and column, counted from 1, but not the path. A table of axes is refused with advice on its
    use.
    """
    header, rows = _read_rows(path)
    if header is None:
        if len(rows[0][1]) != 3:
            raise ValueError(
                f"it has {len(rows[0][1])} columns and no header that names x, y and z; write a first line of names, "
                "such as x,y,z, or keep only these three columns"
            )
        columns, unused = [0, 1, 2], []
    else:
        columns = _find_columns(path, header, unit)
        unused = [name for i, name in enumerate(header) if i not in columns]
    width = len(header) if header is not None else 3
    for number, fields in rows:
        if len(fields) != width:
            raise ValueError(
                f"row {number} has {len(fields)} fields, not {width} as {'the header' if header else 'the first row'}; "
                "add or remove fields, and write decimals with a point if commas separate the fields"
            )
    points = _numbers(rows, columns, header)
    if header is None and _looks_like_axes(points):
        raise ValueError(
            "each row has three positive numbers, the largest first, like a table of axes L, I, S; "
            + how_to_use_forms(path)
            + "; if they are points, write x,y,z as its first line"
        )
    return points, unused


def refuse_forms(path):
    """Raise ValueError if the header of a text file is that of a table of axes or forms."""
    lines = [line for line in _decode(path).splitlines()[:20] if line.strip() and not line.startswith("sep=")]
    header = _split(lines[0], _delimiter(lines)) if lines else []
    if _is_form_table(path, header):
        raise ValueError(_form_error(path, header))


def how_to_use_forms(path):
    """Return advice on the use of a table of axes, with the statistics of its forms if they can be read."""
    advice = (
        "pack grains of such forms without `grains`, with `shapes: {choice: form_distribution, flatness: "
        "{mean: …, std: …}, elongation: {mean: …, std: …}}`, the mean and standard deviation of FL = S/I and EL = I/L"
    )
    try:
        samples, _ = read_measured(path)
    except ValueError:
        return advice
    distributions = [
        f"flatness: {{mean: {sample.mu_FL:.3f}, std: {sample.sigma_FL:.3f}}}, elongation: {{mean: {sample.mu_EL:.3f}, "
        f"std: {sample.sigma_EL:.3f}}}"
        for sample in samples
    ]
    if min(min(sample.mu_FL, sample.mu_EL) for sample in samples) < _LEAST_MEAN:
        return f"{advice}; these are {distributions[0]}, but means below {_LEAST_MEAN} are not packed"
    if len(distributions) == 1:
        return (
            "pack grains of these forms without `grains`, with `shapes: {choice: form_distribution, "
            f"{distributions[0]}}}`"
        )
    listed = "; ".join(
        f"sample {sample.name}: {form}" for sample, form in zip(samples[:3], distributions, strict=False)
    )
    return f"{advice}; these are {listed}{' …' if len(distributions) > 3 else ''}"


def _form_error(path, header):
    return f"it is a table of axes or forms ({', '.join(header)}), not of points on a grain; {how_to_use_forms(path)}"


def _is_form_table(path, header):
    """Return whether the file is a table of axes or forms, by its header or content, and its header lacks x, y, z."""
    if len(_axis_columns(header)) == 3 or all(_number(name) is not None for name in header):
        return False
    if _names_forms(header):
        return True
    try:
        return bool(read_measured(path)[0])
    except ValueError:
        return False


def _names_forms(header):
    names = {re.split(r"[\s_]*[\[(]", name.strip().lower())[0] for name in header}
    names |= {re.sub(r"_(mm|m|cm|µm|um|px)$", "", name) for name in names}
    return any(form_names <= names for form_names in _FORM_NAMES)


def _decode(path):
    data = path.read_bytes()
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _read_rows(path):
    """Return the header (list of names, or None) and [(row number, fields)] of the rows with points."""
    comment, lines = None, []
    for number, line in enumerate(_decode(path).splitlines(), start=1):
        if line.startswith(("#", "//")):
            comment = line.lstrip("#/ ") if not lines else comment
        elif line.strip(" \t,;") and not line.lower().startswith("sep="):
            lines.append((number, line))
    if not lines:
        raise ValueError("the file contains no points; correct the path, or write the file again")
    mark = _delimiter([line for _, line in lines[:50]])
    rows = [(number, _split(line, mark)) for number, line in lines]
    header, rows = _without_count(*_without_header(rows))
    if not rows:
        raise ValueError("the file contains no points; correct the path, or write the file again")
    if header is None and comment is not None:
        names = _split(comment, _delimiter([comment]))
        header = names if len(names) == len(rows[0][1]) and len(_axis_columns(names)) == 3 else None
    # A separator at the end of the rows makes a column without name and values; it is dropped.
    width = max(i + 1 for fields in [header or [], *(fields for _, fields in rows)] for i, f in enumerate(fields) if f)
    return header and header[:width], [(number, fields[:width]) for number, fields in rows]


def _without_header(rows):
    fields = rows[0][1]
    if all(_number(field) is not None for field in fields if field):
        return None, rows
    return fields, rows[1:]


def _without_count(header, rows):
    """Drop a first row that is the number of the others; ValueError if that number is wrong."""
    if len(rows) < 2 or len(rows[0][1]) != 1 or len(rows[1][1]) == 1:
        return header, rows
    count = _number(rows[0][1][0])
    if header is not None or count is None:
        return header, rows
    header, rows = _without_header(rows[1:])
    if count != len(rows):
        raise ValueError(
            f"its first row counts {count:g} points, but {len(rows)} follow; the file is cut short, or the row is wrong"
        )
    return header, rows


def _delimiter(lines):
    """Return the separator of the fields: semicolon, tab, comma, or None for blanks."""
    for mark in ";\t":
        if any(mark in line for line in lines):
            return mark
    with_comma = [line for line in lines if "," in line]
    words = [line.split() for line in with_comma]
    if not with_comma or all(
        len(fields) > 2 and all(_DECIMAL_COMMA.fullmatch(f) or _NUMBER.fullmatch(f) for f in fields) for fields in words
    ):
        return None
    return ","


def _split(line, mark):
    if mark is None:
        return line.split()
    if '"' in line:
        return [field.strip() for field in next(csv.reader([line], delimiter=mark, skipinitialspace=True))]
    return [field.strip() for field in line.split(mark)]


def _number(field):
    """Return the number in a field, with a decimal point or comma, or None if it is not a number."""
    if _DECIMAL_COMMA.fullmatch(field):
        field = field.replace(",", ".")
    return float(field) if _NUMBER.fullmatch(field) else None


def _axis_columns(header):
    """Return the columns of x, y, z that the header names, {axis: [(position, unit or None)]}."""
    positions = {}
    for position, name in enumerate(header):
        match = _AXIS_NAME.fullmatch(name.strip())
        if match is None or (match[1] in "012" and len(name.strip()) == 1):
            continue
        axis = {"0": "x", "1": "y", "2": "z"}.get(match[1], match[1].lower())
        positions.setdefault(axis, []).append((position, match[2] or match[3]))
    return positions


def _find_columns(path, header, unit):
    positions = _axis_columns(header)
    listed = ", ".join(header)
    if len(positions) < 3:
        if _is_form_table(path, header):
            raise ValueError(_form_error(path, header))
        missing = ", ".join(axis for axis in "xyz" if axis not in positions)
        raise ValueError(
            f"its header ({listed}) names no column {missing}; name the three columns of coordinates x, y and z; use a "
            "table of axes with `shapes.choice: form_distribution` instead"
        )
    for axis in "xyz":
        if len(positions[axis]) > 1:
            raise ValueError(f"its header ({listed}) names {axis} twice; rename or remove one of the columns")
        header_unit = positions[axis][0][1]
        if header_unit in _LENGTHS and header_unit != unit:
            raise ValueError(
                f"its header gives {header[positions[axis][0][0]]}, but `grains.unit` is {unit}; correct one of them, "
                "or convert the coordinates: units of grains are mm or m"
            )
    return [positions[axis][0][0] for axis in "xyz"]


def _numbers(rows, columns, header):
    names = [header[i] if header else f"{i + 1}" for i in columns]
    table = [[fields[i] for i in columns] for _, fields in rows]
    try:
        points = np.array(table, float)
    except ValueError:
        points = np.array([[_number(field) for field in fields] for fields in table], float)
    if np.isfinite(points).all():
        return points
    row, column = np.argwhere(~np.isfinite(points))[0]
    field = table[row][column]
    reason = "NaN or infinite" if _number(field) is not None else "not a number"
    raise ValueError(f"row {rows[row][0]}, column {names[column]}: '{field}' is {reason}; correct or remove the row")


def _looks_like_axes(points):
    """Return whether all rows could be axes L, I, S of grains.

    The points of a grain's surface, on all sides of its middle, do not look like that.
    """
    return bool(
        len(points) >= 4
        and (points > 0).all()
        and (np.diff(points, axis=1) <= 0).all()
        and (points[:, 0] <= _LONGEST * points[:, 2]).all()
    )

"""Reads the openings of the sieves in a table, and finds the row of the pan."""

import re
from fractions import Fraction

import numpy as np

from simcore.grains.cell_numbers import check_sheet_error, read_number
from simcore.grains.row_errors import read_each
from simcore.grains.sieve_columns import LENGTHS, LOGARITHMS, PAN, PHI, PSI, known_unit

LEAST_COARSEST = 63e-6  # [m]; if the coarsest sieve is finer, its unit or decimal mark is probably wrong
MAX_COARSEST = 1.0  # [m]; larger sizes of grains may be in µm
COMMON_FRACTION = re.compile(r"(?:([1-9]\d*)[ -])?([1-9]\d*) ?/ ?([1-9]\d*)")
SINGLE_SIGNS = {"½": "1/2", "¼": "1/4", "¾": "3/4", "⅛": "1/8", "⅜": "3/8", "⅝": "5/8", "⅞": "7/8"}
WITH_UNIT = re.compile(r'(.*?)\s*([a-zA-Zµμφϕ]+|["″”])\.?')
SAME_SIZE = 0.05  # relative deviation of the size in a row such as "< 2"; standard sieves are farther apart
BELOW = re.compile(r"<=? ?([\d.,]+) ?([a-zA-Zµμ]*)")  # a row of what passes a size
ABOVE = re.compile(r"[>≥]=? ?(.*)")


def read_openings(path, header, cells, columns):
    """Return the rows of sieves from fine to coarse, their openings [m], ascending, and the row of the pan or None."""
    name, texts = header[columns.opening], cells[columns.opening]
    sieves = [row for row, text in texts.items() if not PAN.fullmatch(text)]
    if columns.unit is None and sieves and not any(map(WITH_UNIT.fullmatch, texts[sieves])):
        raise ValueError(
            f"{path}: the unit of the column {name} is missing, and units are never guessed; write it in the header, "
            f"such as `{name} [mm]` or `{name} [phi]`"
        )
    read = read_each(texts[sieves].items(), lambda row, text: _opening(f"{path}, row {row}", name, text, columns.unit))
    openings = {row: opening for row, opening in zip(sieves, read, strict=True) if opening > 0.0}
    pans = [row for row in texts.index if row not in openings]
    if len(pans) > 1:
        raise ValueError(f"{path}, row {pans[1]}: this is a second pan, after row {pans[0]}; remove one")
    if len(openings) < 2:
        raise ValueError(
            f"{path}: the table has {len(openings) or 'no'} sieve{'s' * (not openings)}; at least two are needed"
        )
    rows, values = list(openings), np.array(list(openings.values()))
    if pans:
        _check_pan(f"{path}, row {pans[0]}", name, texts[pans[0]], columns.unit, values.min())
    if values.max() < LEAST_COARSEST:
        raise ValueError(
            f"{path}: the coarsest sieve is {values.max() * 1e3:g} mm, finer than sand; correct the unit of {name}, "
            "and write sizes without separators of thousands"
        )
    if not _in_order(values):
        raise ValueError(_fault_of_order(path, rows, values, columns.unit))
    order = slice(None) if values[0] < values[-1] else slice(None, None, -1)
    return rows[order], values[order], pans[0] if pans else None


def notices_of_size(name, unit, openings, passing):
    """Return a notice if the sizes of the grains look like those of another unit or sign.

    name, unit: of the column of openings. There is one if grains are larger than MAX_COARSEST, and one if phi or psi
    has the sign of sand throughout.
    """
    if unit in LOGARITHMS and openings[-1] < 1e-3:
        sign, of_gravel, other = ("positive", "negative", PSI) if unit == PHI else ("negative", "positive", PHI)
        return [
            f"all sieves are finer than 1 mm, because {name} is {sign}; for gravel {unit} is {of_gravel}: if its sign "
            f"was left out, name the column `{other}`"
        ]
    largest = openings[min(np.count_nonzero(passing < 1.0), len(openings) - 1)]
    if largest <= MAX_COARSEST:
        return []
    return [
        f"there are grains of about {largest * 1e3:g} mm, which are too large for a sieve; the unit of {name} may be µm"
    ]


def opening_rules():
    """Return what a reader of openings in another language needs, as plain values."""
    patterns = {"with_unit": WITH_UNIT, "fraction": COMMON_FRACTION, "below": BELOW, "above": ABOVE}
    return {
        "patterns": {key: pattern.pattern for key, pattern in patterns.items()},
        "single_signs": SINGLE_SIGNS,
        "same_size": SAME_SIZE,
        "least_coarsest": LEAST_COARSEST,
        "most_coarsest": MAX_COARSEST,
    }


def _check_pan(where, name, text, unit, finest):
    """Raise ValueError if the row of the pan states another size, such as "< 2", than the finest sieve [m]."""
    below = BELOW.fullmatch(text)
    own = known_unit(below[2]) if below and below[2] else unit  # another word, such as `< 2 pan`, is no unit
    if below is None or own not in LENGTHS:
        return
    size = _opening(where, name, below[1], own)
    if abs(size / finest - 1.0) > SAME_SIZE:
        raise ValueError(
            f"{where}: {name} is '{text}', but the finest sieve is {finest * 1e3:g} mm; add the sieve of "
            f"{size * 1e3:g} mm, or write `pan` if the row has all that passes the finest sieve"
        )


def _in_order(values):
    steps = np.diff(values)
    return bool(np.all(steps > 0) or np.all(steps < 0))


def _fault_of_order(path, rows, values, unit):
    """Return what is wrong with openings [m] that neither rise nor fall.

    A single opening without which the others are in order is the wrong one. Otherwise it is the first that differs from
    most steps or, if as many rise as fall, from the step between the ends.
    """
    advice = "order the sieves from coarse to fine or from fine to coarse, each once"
    _, repeats = np.unique(values, return_counts=True)
    if len(repeats) > 1 and repeats.min() > 1:
        advice = "a table has one sieve curve, so that each sample needs its own file"
    alone = [i for i in range(len(values)) if _in_order(np.delete(values, i))]
    if len(alone) == 1:
        (i,) = alone
        divided = np.where(np.arange(len(values)) == i, values * 1e-3, values)
        hint = f"it may be in µm, which is {values[i]:g} mm; if not, " if unit == "mm" and _in_order(divided) else ""
        return (
            f"{path}, row {rows[i]}: the opening {values[i] * 1e3:g} mm is out of the order of the other sieves; "
            f"{hint}{advice}"
        )
    signs = np.sign(np.diff(values))
    direction = np.sign(signs.sum()) or np.sign(values[-1] - values[0])
    wrong = int(np.argmax((signs != direction) | (signs == 0.0))) + 1
    return (
        f"{path}, row {rows[wrong]}: the opening {values[wrong] * 1e3:g} mm follows {values[wrong - 1] * 1e3:g} mm; "
        f"{advice}"
    )


def _opening(where, name, text, unit):
    """Return the opening in a cell [m]; 0 only for a length of 0, which is the pan."""
    check_sheet_error(where, name, text)
    if not re.search(r"\d", text):
        is_text = f"{name} is '{text}', which is no size" if text else f"{name} is empty"
        raise ValueError(
            f"{where}: {is_text}; if the row has what passes the finest sieve, name it `pan`; if it is no sieve, "
            "remove the row"
        )
    if above := ABOVE.fullmatch(text):
        what = (
            "a larger phi is a finer size: name the row `pan` if it has what passes the finest sieve"
            if unit == PHI
            else f"write {above[1]}: the row of a sieve has what stays on it"
        )
        raise ValueError(f"{where}: {name} is '{text}'; {what}")
    match = WITH_UNIT.fullmatch(text)
    own = known_unit(match[2]) if match else None
    if unit is None and match and own is None:
        raise ValueError(f"{where}: {name} is '{text}'; its unit is unknown; use {', '.join([*LENGTHS, *LOGARITHMS])}")
    if unit is None and own is None:
        raise ValueError(
            f"{where}: {name} is '{text}', without a unit; write it as in the other rows, or for all rows in the "
            f"header, such as `{name} [mm]`"
        )
    if match and (unit is None or own in (*LENGTHS, *LOGARITHMS)):
        unit, text = own, match[1]
    if re.match(r"(?:no|nr|#)", text, re.IGNORECASE):
        raise ValueError(f"{where}: {name} is '{text}', a number of a sieve; give its opening instead, in mm")
    plain = "".join(f" {SINGLE_SIGNS[sign]}" if sign in SINGLE_SIGNS else sign for sign in text).strip()
    if fraction := COMMON_FRACTION.fullmatch(plain):
        whole, above, below = (int(part or 0) for part in fraction.groups())
        value = whole + Fraction(above, below)
        raise ValueError(f"{where}: {name} is '{text}'; write a fraction as a decimal number, {float(value):g}")
    value = read_number(where, name, text)
    if unit in LOGARITHMS:
        if abs(value) > 20:
            sign = "-" if unit == PHI else ""
            raise ValueError(
                f"{where}: {name} = {value:g} {unit} is no sieve; {unit} is {sign}log2 of the opening in mm"
            )
        return 2.0 ** (-value if unit == PHI else value) * 1e-3
    if unit not in LENGTHS:
        raise ValueError(
            f"{where}: {name} is in {unit}, which is not a length; use {', '.join([*LENGTHS, *LOGARITHMS])}"
        )
    if value < 0:
        raise ValueError(
            f"{where}: the opening {name} = {value:g} {unit} is negative; write [phi] if it is in phi, or `pan` if the "
            f"row has what passes {-value:g} {unit}"
        )
    return value * LENGTHS[unit]

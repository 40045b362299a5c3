"""Recognises a column of sieve classes by its name, and reads its cells, such as "8-11.2 mm" and "> 63 mm"."""

import math
import re

from simcore.grains.cell_numbers import DATE, read_number
from simcore.grains.sieve_columns import LENGTHS, PAN, PHI, known_unit

CLASS_NAME = re.compile(
    r"(?:(?:(?:size|sieve)[ _-]*)?class|(?:sieb|korn|korngrößen)?klasse|classe)(?:\s*[\[(]([a-zµμφ]+)[\])])?",
    re.IGNORECASE,
)
CLASS_LABEL = re.compile(
    r"([\d.,]+)\s*([a-zµμ]*)\s*(-|–|—|−|/|to|bis|à|…|\.\.+)\s*([\d.,]+)\s*([a-zµμ]*)", re.IGNORECASE
)
OPEN_END = re.compile(
    r"(<=?|>=?|≤|≥|\+|-|−|unter|über|kleiner|größer|below|above|under|over|finer than|coarser than|smaller than"
    r"|larger than|less than|more than)\s*([\d.,]+)\s*([a-zµμ]*)|([\d.,]+)\s*([a-zµμ]*)\s*\+",
    re.IGNORECASE,
)
BELOW = ("<", "<=", "≤", "-", "−", "unter", "kleiner", "below", "under", "finer than", "smaller than", "less than")
# Names, without a unit, of a column of the lower and of one of the upper sieves of classes.
_OF_BOUNDS = r"(?:(?:grain[ _-]?)?size|diameter|sieve|bound|limit|opening|d)"
LOWER_NAME = re.compile(
    rf"from|von|lower(?:[ _-]{_OF_BOUNDS})?|low|{_OF_BOUNDS}[ _-]lower|d?[ _]?min|untergrenze|unten|de", re.IGNORECASE
)
UPPER_NAME = re.compile(
    rf"to|bis|upper(?:[ _-]{_OF_BOUNDS})?|high|{_OF_BOUNDS}[ _-]upper|d?[ _]?max|obergrenze|oben|à", re.IGNORECASE
)
# The same of columns of a length, whose names would mean an amount otherwise, such as `passing [mm]`.
LOWER_SIEVE = re.compile(
    r"(?:sieve |size )?retain(?:ed|ing)(?: on)?(?: sieve| size)?|refus|(?:sieb)?rückstand", re.IGNORECASE
)
UPPER_SIEVE = re.compile(
    r"(?:sieve |size )?pass(?:ing|ed)(?: through)?(?: sieve| size)?|passant|(?:sieb)?durchgang", re.IGNORECASE
)
SIZE = re.compile(r"[\d.,]+\s*[a-zµμ]*", re.IGNORECASE)
IN_PHI = re.compile(r"(?<![a-z])phi(?![a-z])|[φϕ]", re.IGNORECASE)  # anywhere in the name of a column, or in a cell
NO_PHI = "classes in phi are not read; give the classes in mm, or the openings in a column `phi`"
NO_SIZE = re.compile(r"[-–—−]?|inf(?:inity)?|∞", re.IGNORECASE)  # of a class that is open at this end


def class_patterns():
    """Return the regular expressions, dict by what they recognise.

    Whole texts match, except for phi, in upper or lower case.
    """
    patterns = {"name": CLASS_NAME, "label": CLASS_LABEL, "end": OPEN_END, "date": DATE}
    patterns |= {"lower": LOWER_NAME, "upper": UPPER_NAME, "size": SIZE, "no_size": NO_SIZE}
    patterns |= {"lower_sieve": LOWER_SIEVE, "upper_sieve": UPPER_SIEVE}
    patterns["phi"] = IN_PHI
    return {key: pattern.pattern for key, pattern in patterns.items()}


def group_noun(header, position):
    """Return what the column that groups the rows names, "class" or "sample"; position: in the header, or None."""
    return "class" if position is not None and CLASS_NAME.fullmatch(header[position]) else "sample"


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
    """Return the bounds [m] of a class; those of "< 2 mm" are 0 and 2 mm, those of "> 63 mm" 63 mm and infinity.

    where: file and row, for messages. unit: text of the unit in the name of the column, or None. ValueError if the
    label is no class, or has no unit or an unknown one.
    """
    is_text = f"{where}: {column} is '{label}'"
    if IN_PHI.search(label) or (known_unit(unit or "") == PHI and not _has_length(label)):
        raise ValueError(f"{is_text}; {NO_PHI}")
    in_header = "" if unit else f", or put the unit in the header, `{column} [mm]`"
    end = OPEN_END.fullmatch(label)
    if end:
        mark, size, of_size = (end[1], end[2], end[3]) if end[1] else ("+", end[4], end[5])
        value = _size(where, column, label, size, of_size or unit, in_header)
        return (0.0, value) if mark.lower() in BELOW else (value, math.inf)
    match = CLASS_LABEL.fullmatch(label)
    if not match and DATE.fullmatch(label):
        raise ValueError(f"{is_text}; a spreadsheet took the class for a date: format the column as text, and enter it")
    if not match and PAN.fullmatch(label):
        raise ValueError(f"{is_text}; write it with the finest sieve, such as '{'< 2' if unit else '< 2 mm'}'")
    if not match:
        units = ("8-11.2", "> 63") if unit else ("8-11.2 mm", "> 63 mm")
        raise ValueError(
            f"{is_text}; give both sieves, such as '{units[0]}', or an end such as '{units[1]}'{in_header}; remove "
            "rows that are no class"
        )
    low, low_unit, mark, high, high_unit = match.groups()
    high_unit = high_unit or unit
    if mark == "/" and known_unit(high_unit or "") == "in":
        raise ValueError(f"{is_text}, which may be a fraction of an inch; write a class as '{low}-{high}'")
    lower = _size(where, column, label, low, low_unit or high_unit, in_header)
    upper = _size(where, column, label, high, high_unit, in_header)
    if not lower < upper:
        raise ValueError(f"{is_text}; give the smaller size first")
    return lower, upper


def class_text(low, high):
    """Return the text of a class with these bounds [m]."""
    if low == 0.0:
        return f"below {1e3 * high:g} mm"
    return f"{1e3 * low:g} to {1e3 * high:g} mm" if math.isfinite(high) else f"above {1e3 * low:g} mm"


def _has_length(label):
    """Return whether a label has a unit of length; φ in the name of its column is then the sign of a diameter."""
    match, end = CLASS_LABEL.fullmatch(label), OPEN_END.fullmatch(label)
    unit = match[5] if match else (end[3] or end[5]) if end else None
    return known_unit(unit or "") in LENGTHS


def _size(where, column, label, text, unit, in_header):
    """Return a size [m] in the text of a label; unit: text, or None."""
    if not unit:
        raise ValueError(f"{where}: {column} is '{label}' without a unit; write it as '{label} mm'{in_header}")
    meaning = known_unit(unit)
    if meaning not in LENGTHS:
        raise ValueError(f"{where}: {column} is '{label}'; its unit '{unit}' is unknown, use {', '.join(LENGTHS)}")
    return read_number(f"{where}, {column} '{label}'", "size", text) * LENGTHS[meaning]


def _number(text):
    return float(text.replace(",", "."))

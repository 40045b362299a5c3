"""Finds the names of the columns of a table below its title, and joins a row of units with them."""

import re

from simcore.grains.cell_numbers import SHEET_ERROR

_WORDS_OF_UNITS = r"(?:units?|einheit(?:en)?|unités?)\s*:?"
_UNIT = (
    r"[µμumcd]?m|in|inch(?:es)?|microns?|millimet(?:er|re)s?|phi|[φΦϕ]|psi|[ψΨ]|mg|g|kg|t|lbs?|grams?|percent"
    r"|(?:[a-z]+\.?[\s-]?)?%"
)
_WITHOUT_UNIT = r"[-–—1]"
_IN_BRACKETS = r"[\[(]?\s*({})\s*[\])]?"
_NUMBER = r"[-+−<>]?\s*[.,]?\d.*"  # also with a unit, a date, or a class
MAX_NUMBERS = 1  # in a row of the title, such as a date


def head_patterns():
    """Return the regular expressions of whole cells, in any case, dict: unit (group 1), without_unit, number."""
    return {
        "unit": _IN_BRACKETS.format(_UNIT),
        "without_unit": f"{_IN_BRACKETS.format(_WITHOUT_UNIT)}|{_WORDS_OF_UNITS}",
        "number": _NUMBER,
    }


def comments_above(rows) -> int:
    """Return how many of the first rows of a table are comments, such as `# km 650, left bank`.

    rows: as for rows_above_header. A row that begins with # above a row with numbers has the names of the columns.
    """
    comments = 0
    for texts, below in zip(rows, rows[1:], strict=False):
        if not comment_of(texts) or any(map(_is_number, below)):
            break
        comments += 1
    return comments


def rows_above_header(rows) -> int:
    """Return how many rows of a table are a title above the names of the columns.

    rows: list of the texts of each row, without empty rows. The names are in the first row unless a later one is wider,
    has at least two cells and no number, and the rows above it have at most MAX_NUMBERS each.
    """
    above = 0
    for i, texts in enumerate(rows):
        names = [text for text in texts if text]
        numbers = sum(map(_is_number, names))
        if numbers > MAX_NUMBERS:
            break
        if width(texts) > width(rows[above]) and numbers == 0 and len(names) > 1 and not join_units(names, names):
            above = i
    return above


def may_be_names(texts) -> bool:
    """Return whether the cells of a row may be names of columns: at least two, without numbers."""
    return sum(map(bool, texts)) > 1 and not any(map(_is_number, texts))


def join_units(names, texts):
    """Return the names of columns with the units in the row below them, or None if it is not a row of units.

    names, texts: cells of the two rows, as long as each other. A name that has a unit already stays as it is.
    """
    patterns = head_patterns()
    units = [re.fullmatch(patterns["unit"], text, re.IGNORECASE) for text in texts]
    bare = [re.fullmatch(patterns["without_unit"], text, re.IGNORECASE) for text in texts]
    if not any(units) or not all(a or b or not text for a, b, text in zip(units, bare, texts, strict=True)):
        return None
    return [
        f"{name} [{unit[1]}]" if unit and name and not _has_unit(name, unit[1]) else name
        for name, unit in zip(names, units, strict=True)
    ]


def nameless_column(title, names, rows, sample_names):
    """Return the position of the first column whose name is in the title instead, and that of its row, or None.

    title: texts of the rows above the names, names: those of the names, rows: those below. A text of the title is taken
    for a name if the column has values but no name, and values repeat or the text is one of sample_names, in any case.
    """
    for position, name in enumerate(names[: width(names)]):
        above = [i for i, texts in enumerate(title) if texts[position]]
        values = [texts[position] for texts in rows if texts[position]]
        if above and values and not name:
            if len(set(values)) < len(values) or title[above[-1]][position].lower() in sample_names:
                return position, above[-1]
    return None


def comment_of(texts):
    """Return the text of a row that is a comment, such as `# end`, without numbers in its other cells, or ""."""
    if not texts[0].startswith("#"):
        return ""
    text = " ".join(filter(None, texts))
    is_value = SHEET_ERROR.fullmatch(texts[0]) or any(re.match(r"[-+]?[.,]?\d", text) for text in texts[1:])
    return text if re.match(r"#\s*[^\d\s]", text) and not is_value else ""


def width(texts) -> int:
    """Return the number of cells up to the last one with text."""
    return max((i + 1 for i, text in enumerate(texts) if text), default=0)


def _has_unit(name, unit):
    return name.lower().rstrip(")] ").endswith(unit.lower())


def _is_number(text):
    return re.fullmatch(_NUMBER, text, re.IGNORECASE) is not None

"""Reads numbers from the cells of a table, with a decimal point or comma."""

import re
from math import isfinite

# A number at the beginning of a cell, before its unit; one that may have separators of thousands; one with decimals.
_LEADING = re.compile(r"[-+\u2212]?[\d.,]+(?:[eE][-+]?\d+)?")
_IN_GROUPS = re.compile(r"[-+\u2212]?[1-9]\d{0,2}(?:(?:\.\d{3})+|(?:,\d{3})+)")
_WHOLE = re.compile(r"[-+\u2212]?[1-9]\d+")  # it may be beside a number with separators
_LARGE = re.compile(r"[-+\u2212]?[1-9]\d{2,}")
_DECIMAL = re.compile(r"[-+\u2212]?\d*[.,]\d+(?:[eE][-+]?\d+)?")
_SPLIT = re.compile(r"\d[ \u00a0\u202f'\u2019]\d")
_MARKS = {".": "a point", ",": "a comma"}
_MONTH = r"(?:jan|feb|fév|mär|mrz|mar|apr|avr|mai|may|jun|jui|jul|aug|aoû|sep|okt|oct|nov|dez|dec|déc)[a-zûé]{0,6}\.?"
# What a spreadsheet makes of the number 31.5 or of the class 2-4.
DATE = re.compile(
    rf"\d{{4}}-\d\d-\d\d.*|\d{{1,2}}[./]\d{{1,2}}[./]\d{{2,4}}"
    rf"|\d{{1,2}}[-. ]+{_MONTH}(?:[-. ]+\d{{2,4}})?|{_MONTH}[-. ]+\d{{2,4}}",
    re.IGNORECASE,
)
SHEET_ERROR = re.compile(
    r"#(?:[A-ZÜ\d/_]+[!?]|N/A|NV)"
)  # what a spreadsheet displays instead of the result of a formula
NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity)", re.IGNORECASE)


def read_number(where, name, text):
    """Return the finite number in the text of a cell.

    where: file and row, name: column, both for the message. ValueError if the text is no finite number.
    """
    plain = text.replace("\u2212", "-")
    if not NUMBER.fullmatch(plain):
        raise ValueError(_no_number(where, name, text, plain))
    value = float(plain.replace(",", "."))
    if not isfinite(value):
        raise ValueError(f"{where}: {name} is {text}; a finite number is needed; remove the row if it is unknown")
    return value


def _no_number(where, name, text, plain):
    """Return the message for a cell that is no number; plain: the text with ASCII minus signs."""
    if plain.rstrip().endswith("%"):
        return f"{where}: {name} is '{text}'; give a fraction, 0.65 instead of 65 %"
    if SHEET_ERROR.fullmatch(text):
        return _sheet_error(where, name, text)
    if DATE.fullmatch(plain):
        return (
            f"{where}: {name} is '{text}'; a spreadsheet took the number for a date: format the column as text, and "
            "enter it"
        )
    if "±" in plain or "+-" in plain or "+/-" in plain:
        return f"{where}: {name} is '{text}'; a number is needed; write its error into a column of its own"
    marks = "." in plain and "," in plain or max(plain.count(mark) for mark in ",.") > 1 or _SPLIT.search(plain)
    if marks and re.search(r"\d", plain):
        return (
            f"{where}: {name} is '{text}'; a number is needed, without separators of thousands; write its unit, if "
            "any, in the header"
        )
    remedy = "write its unit, if any, in the header" if re.search(r"\d", plain) else "enter it, or remove the row"
    return f"{where}: {name} is '{text}'; a number is needed; {remedy}"


def _sheet_error(where, name, text):
    return f"{where}: {name} is '{text}', an error of the spreadsheet; correct its formula"


def check_sheet_error(where, name, text):
    """Raise ValueError if a cell has an error of a spreadsheet, such as #DIV/0!."""
    if SHEET_ERROR.fullmatch(text):
        raise ValueError(_sheet_error(where, name, text))


def check_decimal_marks(path, names, cells, in_grams=()):
    """Raise ValueError if a number has separators of thousands, which would be read as a decimal mark.

    path: file, for the message. cells: DataFrame of str, its index is the row. names: dict from the columns of `cells`
    with numbers to their names. in_grams: those with masses in grams. A number such as 1.410 is refused if other cells
    have decimals behind a comma and none has decimals behind a point, or if its column has whole numbers of three
    digits (in grams: of two) or more and no other decimals.
    """
    decimals, with_decimals, in_groups, whole = {}, set(), [], set()
    for row, *texts in cells[list(names)].itertuples(name=None):
        for (position, name), text in zip(names.items(), texts, strict=True):
            leading = _LEADING.match(text)
            number = leading[0] if leading else ""
            mark = next((mark for mark in _MARKS if mark in number), None)
            if _IN_GROUPS.fullmatch(number):
                in_groups.append((row, name, text, number, mark))
            elif _DECIMAL.fullmatch(number):
                decimals.setdefault(mark, number)
                with_decimals.add(name)
            elif (_WHOLE if position in in_grams else _LARGE).fullmatch(number):
                whole.add(name)
    for row, name, text, number, mark in in_groups:
        is_text = f"{path}, row {row}: {name} is '{text}'"
        if len(decimals) == 1 and mark not in decimals:
            ((used, example),) = decimals.items()
            raise ValueError(
                f"{is_text}, but this table writes decimals with {_MARKS[used]} ({example}); write numbers without "
                "separators of thousands"
            )
        if name in whole and name not in with_decimals:
            raise ValueError(
                f"{is_text}; if it is {number.replace(mark, '')}, write it so, without a separator of thousands; if "
                f"not, write another number of decimals, such as {number}0"
            )

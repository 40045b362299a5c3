"""Reads numbers from the cells of a table, with a decimal point or comma."""

import re
from math import isfinite

NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity)", re.IGNORECASE)


def read_number(where, name, text):
    """Return the finite number in the text of a cell.

    where: file and row, name: column, both for the message. ValueError if the text is no finite number.
    """
    plain = text.replace("\u2212", "-")
    if plain.rstrip().endswith("%"):
        raise ValueError(f"{where}: {name} is '{text}'; give a fraction, 0.65 instead of 65 %")
    if "." in plain and "," in plain or plain.count(",") > 1 or plain.count(".") > 1:
        raise ValueError(
            f"{where}: {name} is '{text}'; a number is needed, without separators of thousands; write its unit, if "
            "any, in the header"
        )
    if not NUMBER.fullmatch(plain):
        raise ValueError(f"{where}: {name} is '{text}'; a number is needed; write its unit, if any, in the header")
    value = float(plain.replace(",", "."))
    if not isfinite(value):
        raise ValueError(f"{where}: {name} is {text}; a finite number is needed; remove the row if it is unknown")
    return value

"""Numbers rounded to their errors, as text."""

import numpy as np

MAX_DECIMALS = 4  # for errors that are nearly zero


def error_decimals(error, digits=None, max_decimals=MAX_DECIMALS):
    """Return the number of decimals at which an error has `digits` significant digits, at most `max_decimals`.

    digits: None gives one digit, or two if the first digit is 1, so that rounding changes the error by a quarter at
    most. An error that is zero, negative or not finite has `max_decimals` decimals.
    """
    if not (np.isfinite(error) and error > 0.0):
        return max_decimals
    power = int(np.floor(np.log10(error)))
    if digits is None:
        digits = 2 if error < 1.95 * 10.0**power else 1
    return int(np.clip(digits - 1 - power, 0, max_decimals))


def rounded(value, error=np.nan, decimals=3, sign=""):
    """Return a value as text, rounded to its error: "0.398 ± 0.005"; with `decimals` if it has no error.

    sign: "+" writes the sign of positive values too. A negative number has a minus sign, not a hyphen. A value that is
    not finite gives an empty text.
    """
    if not np.isfinite(value):
        return ""
    if np.isfinite(error):
        decimals = error_decimals(error)
    text = with_decimals(value, decimals, sign)
    return f"{text} ± {error:.{decimals}f}" if np.isfinite(error) else text


def heights_in_mm(*heights):
    """Return heights [m] above the floor in mm as texts: with one decimal, or of thin beds with three digits."""
    largest = 1e3 * max(heights)
    decimals = 1 if not 0.0 < largest < 10.0 else int(2 - np.floor(np.log10(largest)))
    return [f"{1e3 * height:.{decimals}f}" for height in heights]


def with_decimals(value, decimals, sign=""):
    """Return a value with so many decimals as text, with a minus sign instead of a hyphen; a zero has no sign.

    sign: "+" writes the sign of positive values too.
    """
    text = f"{value:{sign}.{decimals}f}"
    return (text.lstrip("+-") if float(text) == 0.0 else text).replace("-", "−")

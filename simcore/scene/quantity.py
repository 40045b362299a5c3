"""Converts quantities, text such as "31.5 mm" or "9.81 m/s2", to floats in SI units."""

import functools
import math
import re
from fractions import Fraction

# Exponents of (m, kg, s) and the factor to SI. It is a fraction, so that "31.5 mm" is the float nearest to 0.0315.
_UNITS = {
    "m": ((1, 0, 0), Fraction(1)),
    "g": ((0, 1, 0), Fraction(1, 1000)),
    "s": ((0, 0, 1), Fraction(1)),
    "min": ((0, 0, 1), Fraction(60)),
    "h": ((0, 0, 1), Fraction(3600)),
    "Pa": ((-1, 1, -2), Fraction(1)),
}
_PREFIXES = {"G": 9, "M": 6, "k": 3, "c": -2, "m": -3, "µ": -6, "μ": -6, "u": -6, "n": -9}
_UNPREFIXED = {"min", "h"}
_NAMES = {
    (1, 0, 0): "length",
    (0, 1, 0): "mass",
    (0, 0, 1): "time",
    (1, 0, -1): "velocity",
    (1, 0, -2): "acceleration",
    (-3, 1, 0): "density",
    (2, 0, 0): "area",
    (3, 0, 0): "volume",
    (-1, 1, -2): "pressure",
}
_EXAMPLES = {
    "m": "'0.2 m'",
    "kg": "'16 kg'",
    "s": "'0.025 s'",
    "kg/m3": "'2650 kg/m3'",
    "m/s": "'0.1 m/s'",
    "m/s2": "'9.81 m/s2'",
    "Pa": "'10 MPa'",
}
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*([A-Za-zµμ][A-Za-zµμ0-9²³^/]*)\s*")


def parse_quantity(text, unit):
    """Return the quantity `text`, such as "31.5 mm", as a float in the SI unit `unit`; ValueError if it is none."""
    dimension, _ = _parse_unit(unit)
    needed = describe_quantity(unit)
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise ValueError(f"{text!r} is not a quantity; {needed}")
    if isinstance(text, int | float):
        raise ValueError(f"{text!r} has no unit; {needed}")
    match = _QUANTITY.fullmatch(text)
    if not match:
        if re.fullmatch(rf"\s*{NUMBER}\s*", text):
            raise ValueError(f"'{text}' has no unit; {needed}")
        raise ValueError(f"'{text}' is not a number with a unit; {needed}")
    try:
        exponents, factor = _parse_unit(match[2])
    except ValueError as error:
        raise ValueError(f"'{text}': {error}; {needed}") from None
    if exponents != dimension:
        name = _NAMES.get(exponents)
        article = "an" if name and name[0] in "aeiou" else "a"
        raise ValueError(f"'{text}' is {f'{article} {name}' if name else 'another kind of quantity'}; {needed}")
    number = float(match[1])  # a Fraction of 1e-999999999 would be computed for hours
    try:
        value = float(Fraction(match[1]) * factor) if math.isfinite(number) and number else number
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ValueError(f"'{text}' is not finite; {needed}")
    return value


@functools.cache
def describe_quantity(unit):
    """Describe the quantity that the SI unit `unit` needs, with an example."""
    name = _NAMES.get(_parse_unit(unit)[0], unit)
    article = "an" if name[0] in "aeiou" else "a"
    return f"{article} {name} is needed, such as {_EXAMPLES.get(unit, repr('1 ' + unit))}"


@functools.cache
def _parse_unit(text):
    """Return (exponents of m, kg and s; factor to SI as a Fraction) of a unit such as "mm", "kg/m3" or "m/s2"."""
    exponents, factor = (0, 0, 0), Fraction(1)
    for position, part in enumerate(text.split("/")):
        match = re.fullmatch(r"([A-Za-zµμ]+)\^?([23²³])?", part)
        base = _parse_base(match[1]) if match else None
        if base is None:
            raise ValueError(f"unknown unit '{text}'")
        power = {None: 1, "2": 2, "²": 2, "3": 3, "³": 3}[match[2]] * (1 if position == 0 else -1)
        exponents = tuple(total + power * own for total, own in zip(exponents, base[0], strict=True))
        factor *= base[1] ** power
    return exponents, factor


def _parse_base(text):
    if text in _UNITS:
        return _UNITS[text]
    prefix, base = text[:1], text[1:]
    if prefix in _PREFIXES and base in _UNITS and base not in _UNPREFIXED:
        exponents, factor = _UNITS[base]
        return exponents, factor * Fraction(10) ** _PREFIXES[prefix]
    return None


def rounded_down(value: float) -> float:
    """Return a positive number rounded down to two digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / digit) * digit


def rounded_up(value: float) -> float:
    """Return a positive number rounded up to two digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / digit) * digit

"""Recognises masses in a table of sieves that look like sums over sieves, and compares them with their total."""

import re

import numpy as np

from simcore.grains.cell_numbers import read_number

LOSS = 0.02  # share of the mass that sieving may lose: an amount in the row of the total that differs more is noticed
FEWEST_SUMS = 4  # rows from which masses that only rise or only fall may be sums
SMALL_STEP = 0.1  # maximum of the last step of sums, as a share of the largest sum


def notices_of_sums(name, unit, masses, in_pan):
    """Return a notice if masses on the sieves, from the coarsest to the finest, look like sums over sieves.

    Sums retained rise, with a pan that adds little to few of them; masses that pass fall from the total to nearly
    nothing. Such masses may also be retained on single sieves, so that they are no error. in_pan: mass, or None.
    """
    rows = masses if in_pan is None else np.r_[masses, in_pan]
    little = SMALL_STEP * rows.max()
    if _only_rise(masses) or in_pan is not None and _only_rise(rows) and in_pan - masses[-1] < little:
        return [
            f"{name} rises from the coarsest sieve to the finest; if these are sums, name the column "
            f"`cumulative retained [{unit or 'g'}]`"
        ]
    if _only_rise(-rows) and rows[-1] < little:
        return [
            f"{name} falls from the coarsest sieve to the finest; if these masses pass the sieves, name the column "
            f"`passing [{unit or 'g'}]`"
        ]
    return []


def _only_rise(masses):
    """Return whether there are at least FEWEST_SUMS masses that rise in at least two steps and never fall."""
    steps = np.diff(masses)
    return len(masses) >= FEWEST_SUMS and bool(np.all(steps >= 0)) and np.count_nonzero(steps) >= 2


def notices_of_total(name, amounts, totals):
    """Return a notice if the sum of the amounts differs from all given totals by more than LOSS.

    amounts (n,): of the sieves and the pan. totals: (row, label, text of the amount) of each row with a total. A text
    that is no number is left out. A separator of thousands is allowed here, because a total is often the only large
    number of a table.
    """
    total, differing = float(np.sum(amounts)), []
    for row, label, text in totals:
        readings = []
        for plain in (text.rstrip("% "), re.sub(r"[.,' \u00a0\u202f\u2019]", "", text.rstrip("% "))):
            try:
                readings.append(read_number(f"row {row}", name, plain))
            except ValueError:
                continue
        readings = [value for value in readings if value > 0]
        if any(abs(total / value - 1) <= LOSS for value in readings):
            return []
        if readings:
            differing.append((row, label, text))
    return [
        f"row {row} ({label}): {name} is {text}, but the other rows sum to {total:.10g}; if a sieve or class is "
        "missing, add it, or else correct the row that is wrong"
        for row, label, text in differing[:1]
    ]

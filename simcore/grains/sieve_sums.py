"""Recognises masses in a table of sieves that look like sums over sieves, and compares them with their total."""

import numpy as np

from simcore.grains.cell_numbers import read_number

LOSS = 0.02  # share of the mass that sieving may lose: an amount in the row of the total that differs more is noticed
FEWEST_SUMS = 4  # rows from which masses that only rise or only fall may be sums
SMALL_STEP = 0.1  # maximum of the last step of sums, as a share of the largest sum


def notices_of_sums(name, unit, masses, has_pan):
    """Return a notice if masses, from the coarsest sieve to the finest row, look like sums over sieves.

    Sums retained rise down to the pan, which adds little; masses that pass fall from the total to nearly nothing. Such
    masses may also be retained on single sieves, so that they are no error. has_pan: whether the last is in the pan.
    """
    steps, little = np.diff(masses), SMALL_STEP * masses.max()
    if len(masses) < FEWEST_SUMS:
        return []
    if has_pan and np.all(steps >= 0) and np.count_nonzero(steps) >= 2 and steps[-1] < little:
        return [
            f"{name} rises from the coarsest sieve to the pan; if these are sums, name the column "
            f"`cumulative retained [{unit or 'g'}]`"
        ]
    if np.all(steps <= 0) and np.count_nonzero(steps) >= 2 and masses[-1] < little:
        return [
            f"{name} falls from the coarsest sieve to the finest; if these masses pass the sieves, name the column "
            f"`passing [{unit or 'g'}]`"
        ]
    return []


def notices_of_total(name, amounts, totals):
    """Return a notice for each row of a total that differs from the sum of the amounts by more than LOSS.

    amounts (n,): of the sieves and the pan. totals: (row, label, text of the amount) of each row with their total. A
    text that is no number is left out.
    """
    notices, total = [], float(np.sum(amounts))
    for row, label, text in totals:
        try:
            given = read_number(f"row {row}", name, text.rstrip("% "))
        except ValueError:
            continue
        if given > 0 and abs(total / given - 1) > LOSS:
            notices.append(
                f"row {row} ({label}): {name} is {given:g}, but the other rows sum to {total:g}; add a sieve or class "
                "that is missing, or correct the row that is wrong"
            )
    return notices

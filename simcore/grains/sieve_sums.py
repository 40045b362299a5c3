"""Recognises masses in a table of sieves that look like sums over sieves."""

import numpy as np

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

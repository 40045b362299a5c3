"""Closed forms and published formulas for the middles of the expected bands."""

import heapq
from collections.abc import Sequence

import numpy as np

# Gap beside a rod over its length; value of Farr and Groot, with which equal spheres have a solid fraction of 0.6435.
GAP = 0.7654


def zigzag_porosity(ratio: float) -> float:
    """Return the porosity of a column of equal spheres in a tube of `ratio` sphere diameters, 1 < ratio < 1 + √3/2.

    Each sphere touches the wall opposite to the one below it, so centres rise by √(d² - (D - d)²) per sphere.
    ValueError for other ratios.
    """
    if not 1.0 < ratio < 1.0 + 0.5 * np.sqrt(3.0):
        raise ValueError(f"a zigzag column needs a tube of 1 to 1.866 sphere diameters, not {ratio:g}")
    return float(1.0 - 2.0 / (3.0 * ratio**2 * np.sqrt(2.0 * ratio - ratio**2)))


def wall_porosity(ratio: float) -> float:
    """Return the mean porosity of equal spheres in a cylinder of `ratio` diameters (Benyahia and O'Neill 2005)."""
    return 0.390 + 1.740 / (ratio + 1.140) ** 2


def rod_porosity(diameters: Sequence[float], volume_shares: Sequence[float], rods: int = 20_000) -> float:
    """Return the porosity of close-packed spheres after Farr and Groot (2009), who pack chords on a line instead.

    diameters, volume_shares (k,): of the classes of spheres. rods: number of representative chords.
    The chords L that a random line cuts from a sphere of diameter D have the density 2 L / D²; the line meets the
    sphere with a frequency proportional to D². The chords are placed from the longest to the shortest, each in the
    largest remaining gap, which is divided into GAP times the length of the chord and the rest, or, if the rest is
    less, into twice GAP times this length.
    """
    order = np.argsort(diameters)
    size = np.asarray(diameters, float)[order]
    frequency = np.asarray(volume_shares, float)[order] / size  # number, volume / D³, times D²
    frequency /= frequency.sum()
    # The share of chords shorter than L is linear in L² between the diameters.
    knots = np.concatenate([[0.0], size**2])
    shorter = np.concatenate([[0.0], [(frequency * np.minimum(knot / size**2, 1.0)).sum() for knot in size**2]])
    chords = np.sqrt(np.interp((np.arange(rods) + 0.5) / rods, shorter, knots))[::-1]
    gaps = [-GAP * chords[0]]
    for chord in chords[1:]:
        rest = -gaps[0] - (1.0 + GAP) * chord
        heapq.heapreplace(gaps, -GAP * chord)
        heapq.heappush(gaps, -max(rest, GAP * chord))
    solid, void = chords.sum(), -sum(gaps)
    return float(void / (solid + void))

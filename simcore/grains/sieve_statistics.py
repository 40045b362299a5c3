"""Statistics of a sieve curve: percentiles, Folk and Ward (1957), moments, and the words of Blott and Pye (2001).

The logarithmic scale is phi = -log2(D / 1 mm), so that a larger phi is a finer grain. Percentiles are interpolated
linearly in phi. In the moments, the mass of a class is at the middle of the class: in phi, or in mm.
"""

from dataclasses import dataclass, field

import numpy as np

PERCENTILES = (5, 10, 16, 25, 30, 50, 60, 75, 84, 90, 95)

# Upper limits of the classes in phi units, of sizes in mm, and their words (Blott and Pye 2001). A value on a limit has
# the word above it for sorting and kurtosis, and the word nearer to symmetrical for skewness.
_SORTING = (
    (0.35, "very well sorted"), (0.5, "well sorted"), (0.7, "moderately well sorted"), (1.0, "moderately sorted"),
    (2.0, "poorly sorted"), (4.0, "very poorly sorted"), (np.inf, "extremely poorly sorted"),
)  # fmt: skip
_KURTOSIS = (
    (0.67, "very platykurtic"), (0.9, "platykurtic"), (1.11, "mesokurtic"), (1.5, "leptokurtic"),
    (3.0, "very leptokurtic"), (np.inf, "extremely leptokurtic"),
)  # fmt: skip
_KURTOSIS_OF_MOMENTS = (
    (1.7, "very platykurtic"), (2.55, "platykurtic"), (3.7, "mesokurtic"), (7.4, "leptokurtic"),
    (np.inf, "very leptokurtic"),
)  # fmt: skip
_SKEWNESS, _SKEWNESS_OF_MOMENTS = (0.1, 0.3), (0.43, 1.3)
_SIZES = (
    (0.002, "clay"), (0.004, "very fine silt"), (0.008, "fine silt"), (0.016, "medium silt"), (0.031, "coarse silt"),
    (0.063, "very coarse silt"), (0.125, "very fine sand"), (0.25, "fine sand"), (0.5, "medium sand"),
    (1.0, "coarse sand"), (2.0, "very coarse sand"), (4.0, "very fine gravel"), (8.0, "fine gravel"),
    (16.0, "medium gravel"), (32.0, "coarse gravel"), (64.0, "very coarse gravel"), (128.0, "very small boulders"),
    (256.0, "small boulders"), (512.0, "medium boulders"), (1024.0, "large boulders"), (np.inf, "very large boulders"),
)  # fmt: skip


@dataclass(frozen=True)
class Moments:
    """Mean, sorting (standard deviation), skewness and kurtosis, and their words, if any.

    mean and sorting: in phi; or in mm; or, if geometric, mean in mm and sorting as a factor [-].
    """

    mean: float
    sorting: float
    skewness: float
    kurtosis: float
    words: tuple = ()

    def geometric(self):
        """Return the geometric Moments (those of ln D) of these, which are in phi; with the same words.

        Their skewness is positive for a tail of coarse grains, that in phi for a tail of fine grains.
        """
        return Moments(2.0**-self.mean, 2.0**self.sorting, -self.skewness + 0.0, self.kurtosis, self.words)


@dataclass(frozen=True)
class SieveStatistics:
    """Statistics of a sieve curve; nan where the sieves do not determine a number.

    percentiles: D [m] by percent finer. folk_ward: in phi. phi_moments: in phi. mm_moments: in mm. uniformity: Cu =
    D60/D10; curvature: Cc = D30²/(D10 D60). notices: sentences on what was assumed, or is not determined.
    """

    percentiles: dict
    folk_ward: Moments
    phi_moments: Moments
    mm_moments: Moments
    uniformity: float
    curvature: float
    notices: list = field(default_factory=list)


def sieve_statistics(table):
    """Return the SieveStatistics of a SieveTable."""
    D = {percent: percentile(table, percent / 100) for percent in PERCENTILES}
    notices = []
    unknown = [f"D{percent}" for percent, size in D.items() if np.isnan(size)]
    if unknown:
        notices.append(
            f"{', '.join(unknown)} {'are' if len(unknown) > 1 else 'is'} outside the sieves, because "
            f"{_describe_ends(table)}; what needs these sizes is not given. {_REMEDY}"
        )
    closed, assumed = table.with_small_ends_closed()
    if closed.below > 0.0 or closed.above > 0.0:
        notices.append(f"the moments are not given, because {_describe_ends(closed)}. {_REMEDY}")
        empty = Moments(*4 * [np.nan])
        phi_moments, mm_moments = empty, empty
    else:
        notices += [f"the moments assume that {text}" for text in assumed]
        phi_moments, mm_moments = _moments(closed.openings, np.diff(closed.passing))
    return SieveStatistics(
        percentiles=D,
        folk_ward=folk_ward(D),
        phi_moments=phi_moments,
        mm_moments=mm_moments,
        uniformity=D[60] / D[10],
        curvature=D[30] ** 2 / (D[10] * D[60]),
        notices=notices,
    )


_REMEDY = "Give the size of these grains with --finest or --coarsest"


def percentile(table, share):
    """Return the size [m] that a share of the mass is finer than; nan if it lies outside the sieves.

    share: more than 0 and less than 1. If no grain lies between two sieves there, the smaller one is returned.
    """
    passing = table.passing
    if not passing[0] <= share <= passing[-1]:
        return np.nan
    upper = int(np.searchsorted(passing, share, side="left"))
    if upper == 0 or passing[upper] == share:
        return float(table.openings[upper])
    low, high = np.log2(table.openings[upper - 1 : upper + 1])
    part = (share - passing[upper - 1]) / (passing[upper] - passing[upper - 1])
    return float(2.0 ** (low + part * (high - low)))


def to_phi(D):
    """Return -log2 of the size D [m] in mm."""
    return -np.log2(np.asarray(D) * 1e3) + 0.0  # + 0.0: no negative zero


def folk_ward(D):
    """Return the graphical Moments in phi (Folk and Ward 1957), nan where a percentile is nan.

    D: sizes [m] by percent finer. In the formulas, phi_p is the size that p percent of the mass are coarser than.
    """
    p5, p16, p25, p50, p75, p84, p95 = (float(to_phi(D[100 - percent])) for percent in (5, 16, 25, 50, 75, 84, 95))
    mean = (p16 + p50 + p84) / 3
    sorting = (p84 - p16) / 4 + (p95 - p5) / 6.6
    with np.errstate(divide="ignore", invalid="ignore"):
        skewness = np.float64(p16 + p84 - 2 * p50) / (2 * (p84 - p16)) + np.float64(p5 + p95 - 2 * p50) / (
            2 * (p95 - p5)
        )
        kurtosis = np.float64(p95 - p5) / (2.44 * (p75 - p25))
    words = (
        size_word(2.0**-mean),
        _word(_SORTING, sorting),
        _skewness_word(skewness, _SKEWNESS),
        _word(_KURTOSIS, kurtosis),
    )
    return Moments(mean, sorting, float(skewness), float(kurtosis), words)


def size_word(D):
    """Return the word for a mean size D [mm] (Blott and Pye 2001); "" for nan."""
    return _word(_SIZES, D)


def _moments(openings, shares):
    """Return the Moments in phi and in mm of classes with these bounds (k + 1,) [m] and shares (k,)."""
    phi = to_phi(openings)
    in_phi = _moments_of(0.5 * (phi[1:] + phi[:-1]), shares)
    in_mm = _moments_of(500.0 * (openings[1:] + openings[:-1]), shares)
    words = (
        size_word(2.0**-in_phi.mean),
        _word(_SORTING, in_phi.sorting),
        _skewness_word(in_phi.skewness, _SKEWNESS_OF_MOMENTS),
        _word(_KURTOSIS_OF_MOMENTS, in_phi.kurtosis),
    )
    return Moments(in_phi.mean, in_phi.sorting, in_phi.skewness, in_phi.kurtosis, words), in_mm


def _moments_of(values, shares):
    mean = float(shares @ values)
    deviation = values - mean
    sorting = float(np.sqrt(shares @ deviation**2))
    if sorting <= 1e-9 * max(abs(mean), 1.0):  # one class: only round-off
        return Moments(mean, 0.0, np.nan, np.nan)
    return Moments(mean, sorting, float(shares @ deviation**3 / sorting**3), float(shares @ deviation**4 / sorting**4))


def _describe_ends(table):
    ends = []
    if table.below > 0.0:
        ends.append(f"{table.below:.1%} of the mass pass the finest sieve ({table.openings[0] * 1e3:g} mm)")
    if table.above > 0.0:
        ends.append(f"{table.above:.1%} stay on the coarsest sieve ({table.openings[-1] * 1e3:g} mm)")
    return " and ".join(ends)


def _word(classes, value):
    return "" if np.isnan(value) else next(word for limit, word in classes if value < limit)


def _skewness_word(skewness, limits):
    """Return the word for a skewness in phi, positive for a tail of fine grains."""
    if np.isnan(skewness):
        return ""
    small, large = limits
    if abs(skewness) <= small:
        return "symmetrical"
    return f"{'very ' if abs(skewness) > large else ''}{'fine' if skewness > 0 else 'coarse'} skewed"

"""Results of deposits of many forms: their densest forms, and the symmetry between eta and zeta."""

import json
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.campaign.deposits import (
    PLAIN,
    curve,
    experiment_differences,
    is_plain_diagonal,
    is_plain_spread,
    means,
    plain_means,
)
from simcore.evaluation.crossing_angle import crossing_angle
from simcore.evaluation.fabric import fabric_over_seeds

# ASSUME: half width in ln(ratio) of the window about the highest mean. Density rises faster from the sphere than it
# falls beyond its maximum. A cubic can follow this; the maximum of a parabola is shifted to the flat side.
WINDOW = 0.3
DEGREE = 3
RESAMPLED = 2000
LINES = ("diagonal", "prolate", "oblate")


def findings(rows):
    """Return the results that rows of deposits give without their packings: means, maxima, symmetry, changes.

    rows: from deposits.deposit_rows, with their family. The result is a dict of DataFrames.
    """
    return {
        "means": means(rows),
        "maxima": maxima(rows),
        "symmetry": symmetry(rows),
        "changes": experiment_differences(rows[rows["family"] == "change"]),
    }


class Maximum(NamedTuple):
    """Maximum of a curve over a ratio of axes: where it is, how high it is, and their standard errors."""

    ratio: float
    ratio_error: float
    value: float
    value_error: float
    packings: int  # in the window


def maximum(ratio, value, seed=1, resampled=RESAMPLED):
    """Return the Maximum of a value over a ratio, both (n,), from a cubic fit to all packings near the highest mean.

    The cubic (with fewer than five ratios: a parabola) is in ln(ratio), within WINDOW of the ratio with the highest
    mean. If it has no maximum inside the window, the higher end is used. The standard errors are from a bootstrap: in
    each of `resampled` draws the packings of each ratio are drawn again, and the window is placed again. They are nan
    with one packing per ratio. ValueError if there are fewer than three ratios in the window.
    """
    ratio, value = np.asarray(ratio, float), np.asarray(value, float)
    ratios, counts = np.unique(ratio, return_counts=True)
    value = value[np.argsort(ratio, kind="stable")]
    starts = np.cumsum(counts) - counts
    means = np.add.reduceat(value, starts) / counts
    (top,), (height,) = _tops(np.log(ratios), counts, means[None])
    if np.isnan(top):
        raise ValueError("maximum: there are fewer than three ratios near the highest mean; pack more forms near it")
    # A packing is drawn from those of its ratio.
    rng = np.random.default_rng(seed)
    chosen = np.repeat(starts, counts) + rng.integers(0, np.repeat(counts, counts), (resampled, len(value)))
    drawn = _tops(np.log(ratios), counts, np.add.reduceat(value[chosen], starts, axis=1) / counts)
    draws = np.transpose(drawn)[~np.isnan(drawn[0])]
    # The spread of n packings drawn with replacement is too small by √((n-1)/n); n is the median over the ratios.
    n = np.median(counts)
    scale = np.sqrt(n / (n - 1.0)) if n > 1 else np.nan
    errors = scale * np.std(draws, axis=0, ddof=1)
    packings = counts[_window(np.log(ratios), np.argmax(means))].sum()
    return Maximum(float(top), float(errors[0]), float(height), float(errors[1]), int(packings))


def _window(places, highest):
    """Return a mask (k,) of the places in the window about the one with the index `highest`."""
    return np.abs(places - places[highest]) <= WINDOW


def _tops(places, counts, means):
    """Return (ratios, values), each (m,), of the maxima of m curves; nan with fewer than three ratios in the window.

    places (k,): ln(ratio), ascending; counts (k,): packings at each; means (m, k): of the value over these packings. A
    fit to the means, weighted by their counts, is that to the packings, and curves with the same window are solved at
    once.
    """
    ratios, values = np.full((2, len(means)), np.nan)
    highest = np.argmax(means, axis=1)
    for index in np.unique(highest):
        near = _window(places, index)
        x = places[near]
        if len(x) < 3:
            continue
        degree = DEGREE if len(x) > DEGREE + 1 else 2
        middle, half = (x[-1] + x[0]) / 2.0, (x[-1] - x[0]) / 2.0
        powers = np.vander((x - middle) / half, DEGREE + 1, increasing=True)
        powers[:, degree + 1 :] = 0.0
        weights = np.sqrt(counts[near])
        curves = highest == index
        fit = np.linalg.pinv(weights[:, None] * powers) @ (weights * means[curves][:, near]).T
        ends = np.broadcast_to([[-1.0], [1.0]], (2, curves.sum()))
        turns = _turns(fit)
        inside = np.where(np.abs(turns) < 1.0, turns, -1.0)
        candidates = np.concatenate([inside, ends])
        heights = np.polynomial.polynomial.polyval(candidates, fit[:, None, :], tensor=False)
        best = np.argmax(heights, axis=0)[None]
        ratios[curves] = np.exp(middle + half * np.take_along_axis(candidates, best, axis=0)[0])
        values[curves] = np.take_along_axis(heights, best, axis=0)[0]
    return ratios, values


def _turns(fit):
    """Return the places (2, m) where cubics with the coefficients fit (4, m) are level; nan or infinite without one.

    Both roots are from the same sum, so that the smaller one is exact also if the cubic is nearly a parabola.
    """
    constant, linear, square = fit[1], 2.0 * fit[2], 3.0 * fit[3]
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(linear**2 - 4.0 * square * constant)
        half_sum = -0.5 * (linear + np.copysign(root, linear))
        return np.stack([half_sum / square, constant / half_sum])


def maxima(rows, names=("solid_fraction", "coordination_number")):
    """Return the maxima of each of `names` on the diagonal and on both families of spheroids as a DataFrame.

    rows: with their family. Families with too few forms are left out. above_prolate, above_oblate: difference of the
    diagonal's maximum to theirs, in standard errors of the difference.
    """
    table = []
    for name in names:
        tops = {}
        for line_name in LINES:
            line = curve(rows, line_name)
            try:
                tops[line_name] = maximum(line["ratio"], line[name])
            except ValueError:
                continue
        for line_name, top in tops.items():
            entry = {"of": name, "family": line_name, **top._asdict()}
            for other in ("prolate", "oblate"):
                if line_name == "diagonal" and other in tops:
                    error = np.hypot(top.value_error, tops[other].value_error)
                    entry[f"above_{other}"] = (top.value - tops[other].value) / error
            table.append(entry)
    columns = ["of", "family", *Maximum._fields, "above_prolate", "above_oblate"]
    return pd.DataFrame(table).reindex(columns=columns)


def symmetry(rows, names=("solid_fraction", "coordination_number")):
    """Compare forms (eta, zeta) with (zeta, eta): DataFrame with one row for each of `names`; nan without pairs.

    mean: of the differences of forms with eta > zeta to their mirror images, with its standard error over the pairs.
    rms, largest: of the absolute differences. expected_rms: the rms that the scatter over seeds alone would cause, from
    forms with several seeds.
    """
    plain = plain_means(rows)
    by_form = {(row.eta, row.zeta): row for row in plain.itertuples()}
    pairs = [(row, by_form[zeta, eta]) for (eta, zeta), row in by_form.items() if eta > zeta and (zeta, eta) in by_form]
    several = rows[rows["family"].isin(PLAIN)].groupby(["eta", "zeta"]).filter(lambda group: len(group) > 1)
    table = []
    for name in names:
        groups = several.groupby(["eta", "zeta"])[name]
        freedom = len(several) - groups.ngroups
        variance = ((several[name] - groups.transform("mean")) ** 2).sum() / freedom if freedom else np.nan
        differences = np.array([getattr(a, name) - getattr(b, name) for a, b in pairs])
        share = np.mean([1.0 / a.packings + 1.0 / b.packings for a, b in pairs]) if pairs else np.nan
        table.append(
            {
                "of": name,
                "pairs": len(pairs),
                "mean": differences.mean() if pairs else np.nan,
                "mean_error": differences.std(ddof=1) / np.sqrt(len(pairs)) if len(pairs) > 1 else np.nan,
                "rms": np.sqrt(np.mean(differences**2)) if pairs else np.nan,
                "largest": np.abs(differences).max() if pairs else np.nan,
                "expected_rms": np.sqrt(variance * share),
            }
        )
    return pd.DataFrame(table)


def diagonal_fabrics(studies, fabrics, max_forms=5):
    """Return the fabrics of `max_forms` forms with eta = zeta or fewer, evenly spread: dict of label to Dataset.

    studies: name of the study of each of `fabrics`. A form with several seeds has the mean over them. Beds with a
    distribution of form are left out.
    """
    by_form = {}
    for study, fabric in zip(studies, fabrics, strict=True):
        specification = json.loads(fabric.attrs["scene"])
        if is_plain_diagonal(study, specification):
            by_form.setdefault(specification["shapes"]["eta"], []).append(fabric)
    ratios = sorted(by_form)
    chosen = np.unique(np.linspace(0, len(ratios) - 1, min(max_forms, len(ratios))).round().astype(int))
    return {
        f"η = ζ = {ratio:g}": fabric_over_seeds(by_form[ratio]) if len(by_form[ratio]) > 1 else by_form[ratio][0]
        for ratio in (ratios[k] for k in chosen)
    }


def spread_fabrics(studies, fabrics, max_spreads=5):
    """Return the fabrics of grains of one form over the spread of their sizes: dict of label to Dataset.

    studies: name of the study of each of `fabrics`. Of the forms in the family `sizes`, the one with the most spreads
    is used, and of these one that is not a sphere; at most `max_spreads` spreads, the smallest first. A spread with
    several seeds has the mean over them. Beds with a sieve curve or a distribution of form are left out. Empty without
    that family.
    """
    by_form = {}
    for study, fabric in zip(studies, fabrics, strict=True):
        specification = json.loads(fabric.attrs["scene"])
        if is_plain_spread(study, specification):
            form = (specification["shapes"]["eta"], specification["shapes"]["zeta"])
            by_form.setdefault(form, {}).setdefault(specification["sizes"]["beta"]["spread"], []).append(fabric)
    if not by_form:
        return {}
    by_spread = by_form[max(by_form, key=lambda form: (len(by_form[form]), form != (1.0, 1.0)))]
    return {
        f"S = {spread:g}": fabric_over_seeds(by_spread[spread]) if len(by_spread[spread]) > 1 else by_spread[spread][0]
        for spread in sorted(by_spread)[:max_spreads]
    }


def crossings(studies, fabrics):
    """Return the angle at which the curves of the diagonal's forms cross: direction, angle, std_error [rad], forms.

    The DataFrame uses forms with at least two seeds; nan with fewer than two such forms. The sphere has no long axis.
    """
    with_seeds = [
        fabric for fabric in diagonal_fabrics(studies, fabrics, len(fabrics)).values() if "legendre_of_seed" in fabric
    ]
    table = []
    for direction in ("contact_normal", "long_axis"):
        usable = [fabric for fabric in with_seeds if np.isfinite(fabric["legendre"].sel(direction=direction)).all()]
        angle, error = np.nan, np.nan
        if len(usable) > 1:
            angle, error, _ = crossing_angle(usable, direction)
        table.append({"direction": direction, "angle": angle, "std_error": error, "forms": len(usable)})
    return pd.DataFrame(table)

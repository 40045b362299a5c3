"""What deposits of many forms show: where they are densest, by how much, and how alike eta and zeta are."""

import json
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.campaign.deposits import PLAIN, curve, experiment_differences, family, means, plain_means
from simcore.evaluation.crossing_angle import crossing_angle
from simcore.evaluation.fabric import fabric_over_seeds

# ASSUME: in ln(ratio) from the highest mean. Density rises faster from the sphere than it falls beyond its maximum; a
# cubic follows that, where a parabola is drawn to the flat side.
WINDOW = 0.3
DEGREE = 3
RESAMPLED = 2000
LINES = ("diagonal", "prolate", "oblate")


def findings(rows):
    """What rows of deposits show without their packings, dict of DataFrames: means, maxima, symmetry, changes.

    rows: of deposits.deposit_rows, with their family.
    """
    return {
        "means": means(rows),
        "maxima": maxima(rows),
        "symmetry": symmetry(rows),
        "changes": experiment_differences(rows[rows["family"] == "change"]),
    }


class Maximum(NamedTuple):
    ratio: float
    ratio_error: float
    value: float
    value_error: float
    packings: int  # in the window


def maximum(ratio, value, seed=1, resampled=RESAMPLED):
    """Maximum of a value over a ratio, both (n,), by a cubic through all packings near the highest mean.

    The cubic (of fewer than five ratios a parabola) is in ln(ratio), within WINDOW of the ratio with the highest mean;
    where it has no maximum inside, the window's end is taken. Standard errors: of `resampled` draws of the packings of
    each ratio, each of which looks for its highest mean anew; nan with one packing each. ValueError if there are fewer
    than three ratios in the window.
    """
    ratio, value = np.asarray(ratio, float), np.asarray(value, float)
    found = _vertex(ratio, value)
    if found is None:
        raise ValueError("maximum: fewer than three ratios lie about the highest mean; pack more forms near it")
    rng = np.random.default_rng(seed)
    groups = [np.flatnonzero(ratio == each) for each in np.unique(ratio)]
    draws = []
    for _ in range(resampled):
        some = np.concatenate([rng.choice(group, len(group)) for group in groups])
        drawn = _vertex(ratio[some], value[some])
        draws += [] if drawn is None else [drawn[:2]]
    # Of n packings drawn anew the spread is √((n-1)/n) of what it should be; n is that of most ratios in the window.
    n = np.median([len(group) for group in groups])
    scale = np.sqrt(n / (n - 1.0)) if n > 1 else np.nan
    errors = scale * np.std(draws, axis=0, ddof=1)
    return Maximum(found[0], float(errors[0]), found[1], float(errors[1]), found[2])


def _vertex(ratio, value):
    """(ratio, value, packings behind it) of the top of the curve; None with fewer than three ratios."""
    x = np.log(ratio)
    places = np.unique(x)
    highest = places[np.argmax([value[x == place].mean() for place in places])]
    near = np.abs(x - highest) <= WINDOW
    if len(np.unique(x[near])) < 3:
        return None
    degree = DEGREE if len(np.unique(x[near])) > DEGREE + 1 else 2
    fit = np.polynomial.Polynomial.fit(x[near] - highest, value[near], degree)
    low, high = fit.domain
    slope = fit.deriv()
    # Of a parabola, a cubic's leading coefficient is round-off, and spoils the roots.
    turns = slope.trim(1e-9 * np.abs(slope.coef).max()).roots()
    turns = np.real(turns[np.abs(np.imag(turns)) < 1e-9])
    tops = np.concatenate([turns[(turns > low) & (turns < high)], [low, high]])
    top = tops[np.argmax(fit(tops))]
    return float(np.exp(highest + top)), float(fit(top)), int(near.sum())


def maxima(rows, names=("solid_fraction", "coordination_number")):
    """Maxima of each of `names` on the diagonal and of both families of spheroids, DataFrame.

    rows: with their family. Families of too few forms are left out. above_prolate, above_oblate: how far the diagonal's
    maximum lies above theirs, in standard errors of the difference.
    """
    table = []
    for name in names:
        found = {}
        for line_name in LINES:
            line = curve(rows, line_name)
            try:
                found[line_name] = maximum(line["ratio"], line[name])
            except ValueError:
                continue
        for line_name, top in found.items():
            entry = {"of": name, "family": line_name, **top._asdict()}
            for other in ("prolate", "oblate"):
                if line_name == "diagonal" and other in found:
                    error = np.hypot(top.value_error, found[other].value_error)
                    entry[f"above_{other}"] = (top.value - found[other].value) / error
            table.append(entry)
    columns = ["of", "family", *Maximum._fields, "above_prolate", "above_oblate"]
    return pd.DataFrame(table).reindex(columns=columns)


def symmetry(rows, names=("solid_fraction", "coordination_number")):
    """How alike (eta, zeta) and (zeta, eta) are, DataFrame with one row for each of `names`; nan without pairs.

    mean: of the differences of forms with eta > zeta to their mirror images, with its error over the pairs; rms and
    largest of their absolute values; expected_rms: what the scatter over seeds alone gives, of forms that have several.
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
        each = np.array([getattr(a, name) - getattr(b, name) for a, b in pairs])
        share = np.mean([1.0 / a.packings + 1.0 / b.packings for a, b in pairs]) if pairs else np.nan
        table.append(
            {
                "of": name,
                "pairs": len(pairs),
                "mean": each.mean() if pairs else np.nan,
                "mean_error": each.std(ddof=1) / np.sqrt(len(pairs)) if len(pairs) > 1 else np.nan,
                "rms": np.sqrt(np.mean(each**2)) if pairs else np.nan,
                "largest": np.abs(each).max() if pairs else np.nan,
                "expected_rms": np.sqrt(variance * share),
            }
        )
    return pd.DataFrame(table)


def diagonal_fabrics(studies, fabrics, most=5):
    """Fabrics of at most `most` forms of eta = zeta, evenly from the first to the last, dict from label to Dataset.

    studies: name of the study of each of `fabrics`. Means over the seeds where a form has several.
    """
    by_form = {}
    for study, found in zip(studies, fabrics, strict=True):
        if family(study) == "diagonal":
            by_form.setdefault(json.loads(found.attrs["scene"])["shapes"]["eta"], []).append(found)
    ratios = sorted(by_form)
    some = np.unique(np.linspace(0, len(ratios) - 1, min(most, len(ratios))).round().astype(int))
    return {
        f"η = ζ = {ratio:g}": fabric_over_seeds(by_form[ratio]) if len(by_form[ratio]) > 1 else by_form[ratio][0]
        for ratio in (ratios[k] for k in some)
    }


def crossings(studies, fabrics):
    """Angle at which the curves of the diagonal's forms cross, DataFrame: direction, angle, std_error [rad], forms.

    Of forms with two seeds at least; nan where there are fewer than two such forms. The sphere has no long axis.
    """
    known = [
        found for found in diagonal_fabrics(studies, fabrics, len(fabrics)).values() if "legendre_of_seed" in found
    ]
    table = []
    for direction in ("contact_normal", "long_axis"):
        some = [found for found in known if np.isfinite(found["legendre"].sel(direction=direction)).all()]
        angle, error = np.nan, np.nan
        if len(some) > 1:
            angle, error, _ = crossing_angle(some, direction)
        table.append({"direction": direction, "angle": angle, "std_error": error, "forms": len(some)})
    return pd.DataFrame(table)

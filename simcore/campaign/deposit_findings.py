"""Results of deposits of many forms: their densest forms, and the symmetry between eta and zeta."""

import json

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
from simcore.evaluation.curve_maximum import Maximum, maximum
from simcore.evaluation.fabric import fabric_over_seeds

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

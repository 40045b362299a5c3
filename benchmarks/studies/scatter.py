"""Scatter of the porosity over seeds beside the sampling errors that the packings state, by the draw of sizes.

    python -m benchmarks.studies.scatter
    python -m benchmarks.studies.scatter --draws

It reads results/reference/wide_random.csv and wide_quota.csv, wide_both_random.csv and wide_both.csv (with the settings
of the preset `wide`), wide_spheres.csv (the check of the sampling error on spheres) and scatter_forms.csv (the same on
small beds with a distribution of form), and applies the rules that config/wide.yaml states. It prints one line per
sieve curve and draw: the number of seeds, the mean porosity, the standard deviation over the seeds with its 95 %
confidence limits, the root mean square of the stated errors, chi-squared of the scatter over the stated errors with its
95 % limits, and the ratio of the variances by quota and by random draw with the lower 5 % limit of the F distribution.
The last line has this ratio over all sieve curves that were packed by both draws.

With --draws it draws the grains of these packings instead, without packing them. It prints how the share of the mass in
the coarsest class scatters over the seeds. It also prints how the porosity scatters that the model of size and form
predicts for the drawn sizes, over all seeds and over those that are packed. This takes about half a minute.
"""

import argparse
from dataclasses import replace

import numpy as np
import pandas as pd
import yaml
from scipy.special import polygamma
from scipy.stats import chi2, f, norm

from simcore.campaign.studies import expand, merge
from simcore.grains.sieve import class_fractions
from simcore.grains.sources import load_grains
from simcore.models.size_and_form.sized_model import current_model
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY
from simcore.packing.forecast import draw_packing
from simcore.paths import CONFIG, REFERENCE
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

CONFIDENCE = 0.95
BETTER = 0.05  # a ratio of variances below this quantile of the F distribution is less scatter
DRAWS = ("random", "quota")
PRESET = ", preset wide"
# Added to the name of the sieve curve: study of each draw.
STUDIES = {
    "": {"random": "wide_random", "quota": "wide_quota"},
    PRESET: {"random": "wide_both_random", "quota": "wide_both"},
}
SPHERES = "wide_spheres.csv"  # contains both draws
FORMS = "scatter_forms.csv"
OF_FORMS = ", distributions of form"  # added to the name of their sieve curve
# Columns that tell sets of beds with different distributions of form apart; each set has a mean porosity of its own.
FORM = [f"{kind}_{X}_nominal" for X in ("FL", "EL") for kind in ("mu", "sigma")]
SETS = {f"U1{OF_FORMS}": FORM}
# First seed whose stated error was evaluated after the last correction of simcore.evaluation.sampling_error. The
# errors of all other polyhedra are older, except those of scatter_forms.csv.
CORRECTED_FROM = {f"B50{PRESET}": 4}


def scatter(rows: pd.DataFrame, corrected_from=None, sets=()) -> dict:
    """Return the scatter of the packings of one sieve curve and draw as a dict.

    rows: columns n and n_error, one row per packing. corrected_from: first seed, in the column seed, whose stated error
    counts; None: all count. sets: columns whose values tell sets of beds apart. The scatter is that about the mean of
    each set, which has at least two packings; without sets all beds are one.
    """
    groups = [group for _, group in rows.groupby(list(sets))] if sets else [rows]
    freedoms = np.array([len(group) - 1 for group in groups])
    squares = np.array([np.sum((group["n"] - group["n"].mean()) ** 2) for group in groups])
    errors = [
        group["n_error"] if corrected_from is None else group["n_error"][group["seed"] >= corrected_from]
        for group in groups
    ]
    stated = np.array([np.mean(error**2) for error in errors])
    freedom = freedoms.sum()
    low, high = chi2.ppf([0.5 * (1 - CONFIDENCE), 0.5 * (1 + CONFIDENCE)], freedom)
    variance = squares.sum() / freedom
    return {
        "seeds": len(rows),
        "freedom": freedom,
        "n": rows["n"].mean(),
        "std": np.sqrt(variance),
        "std_lower": np.sqrt(variance * freedom / high),
        "std_upper": np.sqrt(variance * freedom / low),
        "stated": np.sqrt(stated @ freedoms / freedom),
        "chi2": np.sum(squares / stated),
        "chi2_lower": low,
        "chi2_upper": high,
    }


def read_tables(folder=REFERENCE) -> dict:
    """Return the rows of the packings by draw, DataFrames; other settings and spheres are curves of their own."""
    tables = {}
    for settings, studies in STUDIES.items():
        for draw, study in studies.items():
            if (folder / f"{study}.csv").exists():
                rows = pd.read_csv(folder / f"{study}.csv")
                tables.setdefault(draw, []).append(rows.assign(case=rows["case"] + settings))
    if (folder / SPHERES).exists():
        spheres = pd.read_csv(folder / SPHERES)
        for draw, rows in spheres.assign(case=spheres["case"] + " spheres").groupby("draw"):
            tables.setdefault(draw, []).append(rows)
    if (folder / FORMS).exists():
        forms = pd.read_csv(folder / FORMS)
        tables.setdefault("random", []).append(forms.assign(case=forms["case"] + OF_FORMS))
    return {draw: pd.concat(parts, ignore_index=True) for draw, parts in tables.items()}


def scatter_table(tables: dict) -> pd.DataFrame:
    """Return one row per sieve curve and draw with two packings or more; tables: DataFrame of rows by draw."""
    rows = [
        {"case": case, "draw": draw, **scatter(group, CORRECTED_FROM.get(case), SETS.get(case, ()))}
        for draw, table in tables.items()
        for case, group in table.groupby("case", sort=False)
        if len(group) > 1
    ]
    table = pd.DataFrame(rows)
    variance = table["std"] ** 2
    for case, group in table.groupby("case"):
        if set(group["draw"]) == set(DRAWS):
            of = {row.draw: row for row in group.itertuples()}
            quota = (table["case"] == case) & (table["draw"] == "quota")
            table.loc[quota, "variance_ratio"] = variance[of["quota"].Index] / variance[of["random"].Index]
            table.loc[quota, "limit"] = f.ppf(BETTER, of["quota"].freedom, of["random"].freedom)
    return table


def pooled_ratio(table: pd.DataFrame) -> tuple:
    """Return the ratio of the variances by quota and by random draw over all sieve curves, and its confidence limits.

    table: of scatter_table. It is the mean of the logarithms, weighted by their variances for normal porosities.
    """
    ratios = table.dropna(subset="variance_ratio")
    random = table[table["draw"] == "random"].set_index("case")["freedom"]
    variances = polygamma(1, ratios["freedom"] / 2) + polygamma(1, ratios["case"].map(random) / 2)
    mean = np.average(np.log(ratios["variance_ratio"]), weights=1.0 / variances)
    half = norm.ppf(0.5 * (1 + CONFIDENCE)) / np.sqrt(np.sum(1.0 / variances))
    return tuple(np.exp([mean, mean - half, mean + half]))


def drawn_sizes(packings: list[tuple[dict, list]]) -> pd.DataFrame:
    """Return the sizes that these packings draw, one row per packing.

    packings: resolved specifications with sieve curves, and the grains of each. Columns: case, draw, seed, required and
    share, the share of the mass in the coarsest class by the curve and as drawn, and n, the porosity of the drawn sieve
    curve by the model of size and form, for the mean form of the Rhine.
    """
    rows, model = [], current_model()
    for specification, shapes in packings:
        setup = set_up(specification, lambda _, shapes=shapes: shapes)
        grains = draw_packing(setup)
        shares = class_fractions(setup.curve, grains.D, grains.volume)
        coarsest = np.flatnonzero(setup.curve.mass_fractions)[-1]
        drawn = replace(setup.curve, mass_fractions=shares / shares.sum())
        sizes = specification["sizes"]
        rows.append(
            (
                sizes["case"], sizes["draw"], specification["seed"], setup.curve.mass_fractions[coarsest],
                shares[coarsest], model.predict(drawn, REFERENCE_POROSITY),
            )
        )  # fmt: skip
    return pd.DataFrame(rows, columns=["case", "draw", "seed", "required", "share", "n"])


def coarsest_classes(drawn: pd.DataFrame, packed=()) -> pd.DataFrame:
    """Return how the drawn sizes scatter over the seeds, one row per sieve curve and draw.

    drawn: result of drawn_sizes; packed: set of (case, draw, seed) that are packed. Columns: case, draw, required;
    seeds, least, largest and std of the share of the coarsest class; n_std, standard deviation of the porosity by the
    model, and n_std_packed, the same of the packed seeds, nan if there are fewer than two.
    """
    keys = ["case", "draw", "required"]
    is_packed = [key in packed for key in drawn[["case", "draw", "seed"]].itertuples(index=False, name=None)]
    groups = drawn.assign(n_packed=drawn["n"].where(is_packed)).groupby(keys, sort=False)
    table = groups["share"].agg(seeds="size", least="min", largest="max", std="std")
    table["n_std"], table["n_std_packed"] = groups["n"].std(), groups["n_packed"].std()
    return table.reset_index()


def packed_seeds(tables: dict) -> set:
    """Return (case, draw, seed) of the packings of polyhedra in the tables of read_tables."""
    return {
        (case.removesuffix(PRESET), draw, seed)
        for draw, table in tables.items()
        for case, seed in table[["case", "seed"]].itertuples(index=False)
    }


def planned(studies) -> list[tuple[dict, list]]:
    """Return the specifications of the packings of these studies in config/wide.yaml, and their undecimated grains.

    Packings with the same grains are returned once.
    """
    files = [yaml.safe_load((CONFIG / name).read_text(encoding="utf-8")) for name in ("config.yaml", "wide.yaml")]
    plan = expand(resolve(merge(*files), "config"))
    plan = plan[plan["study"].isin(studies)]
    grains = load_grains(plan["grains"].iloc[0])
    return [(specification, grains) for specification in with_different_grains(plan["specification"])]


def with_different_grains(specifications) -> list[dict]:
    """Return the specifications without those that have sieve curve, draw and seed of an earlier one."""
    first = {}
    for specification in specifications:
        sizes = specification["sizes"]
        first.setdefault((sizes["case"], sizes["draw"], specification["seed"]), specification)
    return list(first.values())


def main(arguments=None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", action="store_true", help="draw the grains and print their coarsest class")
    if parser.parse_args(arguments).draws:
        packings = planned([study for studies in STUDIES.values() for study in studies.values()])
        table = coarsest_classes(drawn_sizes(packings), packed_seeds(read_tables()))
        print(table.to_string(index=False, float_format="%.4f", na_rep=""))
        return
    table = scatter_table(read_tables())
    print(table.drop(columns="freedom").to_string(index=False, float_format="%.4f", na_rep=""))
    if "variance_ratio" in table:
        ratio, low, high = pooled_ratio(table)
        print(f"variance by quota over that by random draws, all sieve curves: {ratio:.2f} ({low:.2f} to {high:.2f})")


if __name__ == "__main__":
    main()

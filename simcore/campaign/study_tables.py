"""Tables of a study: one row per packing, and means over the seeds."""

import json

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import error_of_mean
from simcore.reference.columns import FORM

OWN_CURVE = "own"  # case of a sieve curve that a study gives by its classes


def tabulate(study, rows, evaluations):
    """Return a DataFrame with one row per packing of a study.

    study: its name. rows: dicts {packing, varied} as in simcore.campaign.studies. evaluations: their datasets from
    simcore.evaluation.evaluate. Columns: study, packing, case, the other varied settings, grain (of single forms),
    kind, seed, grains, L, I, S [m] (means), mean and standard deviation of FL, EL, EQ, n and n_std_error (from spheres,
    as in Rettinger et al. (2022)), the same from exact slices, coordination_number, spearman_D (trend of size over
    height), steps, cpu_s, and warnings (those of the packing, one per line).
    """
    table = []
    for row, data in zip(rows, evaluations, strict=True):
        scene = json.loads(data.attrs["scene"])
        shapes = scene["shapes"]
        single = shapes["choice"] == "one" and shapes["kind"] != "sphere"
        form = data.form.to_series()
        trend = float(data.spearman_r.sel(quantity="D")) if "spearman_r" in data else np.nan
        table.append(
            {
                "study": study,
                "packing": row["packing"],
                "case": scene["sizes"]["case"] or OWN_CURVE,
                **row["varied"],
                **({"grain": shapes["grain"]} if single else {}),
                "kind": shapes["kind"],
                "seed": data.attrs["seed"],
                "grains": data.attrs["n_grains"],
                **data.axes.to_series(),
                **{name: form[feature] for name, feature in FORM.items()},
                "n": float(data.n),
                "n_std_error": float(data.n_std_error),
                "n_exact": float(data.n_exact),
                "n_std_error_exact": float(data.n_std_error_exact),
                "coordination_number": float(data.coordination_number),
                "spearman_D": trend,
                "steps": data.attrs["steps"],
                "cpu_s": float(data.attrs["cpu_seconds"]),
                "warnings": data.attrs.get("warnings", ""),
            }
        )
    return pd.DataFrame(table)


def summarise(packings, varied):
    """Return the means over the seeds, a DataFrame with one row for each combination of the other varied settings.

    packings: as from `tabulate`. varied: the columns that the study varies. runs: number of packings. n_std: standard
    deviation over the runs. n_seed_error: standard error of their mean (nan for one run). n_std_error: standard error
    of the mean from the sampling errors of the runs, because three seeds determine the scatter only to a factor of two.
    cpu_h: of all runs together.
    """
    settings = dict.fromkeys(["study", "case", *varied, "grain"])
    # A setting without a value, such as the grain of spheres, is still a group: dropna=False.
    keys = [key for key in settings if key in packings and key != "seed"]
    groups = packings.groupby(keys, sort=False, dropna=False)
    table = groups["n"].agg(runs="size", n="mean", n_std="std")
    table["n_seed_error"] = table["n_std"] / np.sqrt(table["runs"])
    table["n_std_error"] = groups["n_std_error"].agg(error_of_mean)
    table = table.join(groups[[*FORM, "grains", "n_exact", "coordination_number"]].mean())
    table["cpu_h"] = groups["cpu_s"].sum() / 3600.0
    return table.reset_index()


def tabulate_features(packings, evaluations):
    """Return a DataFrame with one row per packing: packing, case, sample, kind, n and the form statistics.

    The 104 statistics are those of simcore.grains.statistics. sample: the settings without the seed in words, equal for
    packings that differ only in their seed. kind: "discrete" if forms are drawn from the grain set, else "continuous".
    """
    rows = [data.form.to_series() for data in evaluations]
    choices = [json.loads(data.attrs["scene"])["shapes"]["choice"] for data in evaluations]
    settings = [name for name in packings.loc[:, "case":"grains"] if name not in ("seed", "grains")]
    samples = packings[settings].apply(lambda row: ", ".join(f"{name} {value}" for name, value in row.items()), axis=1)
    table = packings[["packing", "case"]].assign(
        sample=samples,
        kind=["discrete" if choice == "random" else "continuous" for choice in choices],
        n=packings.n,
    )
    return pd.concat([table.reset_index(drop=True), pd.DataFrame(rows).reset_index(drop=True)], axis=1)


def mark(table, test_only):
    """Return the table; if `test_only`, with a first column `note` that marks every row as a test."""
    marked = table.copy()
    if test_only:
        marked.insert(0, "note", "test only")
    return marked

"""Beds of U7 with a distribution of form, predicted by the model of size and form, to which they were not fitted.

    python -m benchmarks.studies.mixtures_wide

The beds are the study mixtures_wide of config/size_and_form.yaml (mixtures_wide.csv).
docs/appendices/size_and_form_plan.md has the rules, "Distributions of form in U7". Printed are the beds with their
errors, by three one-class porosities: that of beds which were made as these, with the effect of form of a rain or of
lattices, to which the rules apply; and that of the command `predict`, of beds on lattices that were shaken for 6 s.
Then follow what the rules say, and how much of the effect of form on one class remains in U7. Seconds.
"""

import numpy as np
import pandas as pd

from benchmarks.studies.base_forms import of_all_forms, rain_model
from benchmarks.studies.size_and_form_fit import OTHER_BASES, STUDY, read_rows
from simcore.campaign.gathering import OF_SETS
from simcore.grains.statistics import STATISTICS, equancy_statistics
from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.bases import fit_bases
from simcore.models.size_and_form.bed_prediction import rhine_one_class
from simcore.models.size_and_form.beds import ALL_FORMS, BASE, form_labels
from simcore.models.size_and_form.sized_model import current_model
from simcore.models.unified import unified_features
from simcore.reference.share_columns import realised_curve

BEDS = "mixtures_wide"
SETS = OF_SETS[1:-1]  # mean and standard deviation of FL and of EL
RHINE = (0.647, 0.175, 0.682, 0.139)  # values of SETS, as in the study application of config/config.yaml
PROCESSES = ("rain", "lattices")  # of the rules
PREDICT = "predict"
RHINE_LIMIT, SETS_LIMIT = 0.005, 0.010  # of the rules


def specified_statistics(rows):
    """Return the STATISTICS of the distributions of form that the beds are specified with, for `unified_features`."""
    values = [rows[name].to_numpy(float) for name in SETS]
    return pd.DataFrame(dict(zip(STATISTICS, (*equancy_statistics(*values), *values[2:]), strict=True)), rows.index)


def comparison(beds=None) -> pd.DataFrame:
    """Return one row per bed: SETS, seed, n, n_error, and for PROCESSES and PREDICT one_class_<process>, <process>.

    one_class is the predicted porosity of the same grains in one sieve class, <process> the predicted porosity of the
    bed. beds: as from `read_rows`; None: the packed ones.
    """
    beds = read_rows(BEDS) if beds is None else beds
    of_plan = read_rows(STUDY)
    bases = pd.concat([of_plan[of_plan["case"] == BASE], read_rows(OTHER_BASES)], ignore_index=True)
    fitted = fit_bases(bases.assign(form=form_labels(bases)))
    references = fitted.constants[ALL_FORMS] + fitted.effect(beds)
    curves = [realised_curve(bed, BEDS) for _, bed in beds.iterrows()]
    table = beds[[*SETS, "seed", "n", "n_error"]].copy()
    fitted = fit_reference_models()
    on_lattices = fitted.models["unified", BASE]
    of_process = {"rain": (rain_model(), references), "lattices": (on_lattices, references)}
    of_process[PREDICT] = on_lattices, np.full(len(beds), rhine_one_class(fitted))
    for process, (of_form, of_rhine) in of_process.items():
        one_class = of_form.predict(unified_features(specified_statistics(beds)))
        if process in PROCESSES:
            one_class = one_class + references - of_form.predict(unified_features(of_all_forms().to_frame().T))
        table[f"one_class_{process}"] = one_class
        table[process] = [
            float(np.squeeze(current_model().predict(curve, float(n1), reference=float(reference))))
            for curve, n1, reference in zip(curves, one_class, of_rhine, strict=True)
        ]
    return table


def is_rhine(table):
    """Return which rows of a table of `comparison` have the Rhine's distribution of form; bool array (beds,)."""
    return (table[SETS].to_numpy(float) == RHINE).all(axis=1)


def judgement(table, process="rain") -> pd.DataFrame:
    """Return what the rules say: `beds`, their `error`, its `limit`, and whether they are `confirmed`.

    Two rows: the Rhine's beds, with the mean of predicted minus packed porosity, and the sets, with its root mean
    square. The error is nan if no such bed is packed.
    """
    errors = (table[process] - table["n"]).to_numpy()
    rhine, sets = errors[is_rhine(table)], errors[~is_rhine(table)]
    values = [
        (len(rhine), rhine.mean() if len(rhine) else np.nan, RHINE_LIMIT),
        (len(sets), np.sqrt(np.mean(sets**2)) if len(sets) else np.nan, SETS_LIMIT),
    ]
    rows = pd.DataFrame(values, ["Rhine", "sets"], ["beds", "error", "limit"])
    return rows.assign(confirmed=rows["error"].abs() <= rows["limit"])


def slopes(table, process="rain") -> dict:
    """Return the slopes of porosity on one-class porosity: `packed`, its standard error `error`, and `predicted`.

    Beds are weighted by their sampling errors. The standard error is at least that which follows from these.
    """
    x = table[f"one_class_{process}"].to_numpy()
    n = table["n"].to_numpy()
    weights = 1.0 / np.square(table["n_error"].to_numpy())
    away = x - np.average(x, weights=weights)
    squares = np.sum(weights * away**2)
    packed, predicted = (float(np.sum(weights * away * y) / squares) for y in (n, table[process].to_numpy()))
    residuals = n - np.average(n, weights=weights) - packed * away
    scatter = np.sum(weights * residuals**2) / (len(table) - 2)
    return {"packed": packed, "error": float(np.sqrt(max(1.0, scatter) / squares)), "predicted": predicted}


def main() -> None:
    """Print the beds, what the rules say of them, and the slopes."""
    try:
        table = comparison()
    except ValueError as error:
        raise SystemExit(f"mixtures_wide: {error}") from None
    names = (*PROCESSES, PREDICT)
    shown = table.assign(**{f"error_{process}": table[process] - table["n"] for process in names})
    print(shown.drop(columns=list(names)).to_string(index=False, float_format="%.4f"))
    for process in names:
        title = f"With the effect of form of beds of one class by the process {process!r}:"
        print(f"\n{title if process in PROCESSES else 'By the command predict, to which the rules do not apply:'}")
        judged = judgement(table, process)
        shown = judged if process in PROCESSES else judged[["beds", "error"]]
        print(shown.to_string(float_format="%+.4f"))
        if len(table) > 2:
            slope = slopes(table, process)
            print(
                f"slope on the one-class porosity: packed {slope['packed']:.2f} +- {slope['error']:.2f}, "
                f"predicted {slope['predicted']:.2f}"
            )


if __name__ == "__main__":
    main()

"""The model of size and form on beds whose porosity is known; nothing is fitted to them.

    python -m benchmarks.studies.size_and_form_validation            # prints the tables
    python -m benchmarks.studies.size_and_form_validation --write    # into results/reference/size_and_form_*.csv
    python -m benchmarks.studies.size_and_form_validation --figure docs/size_and_form.png   # draws them

There are three tables:

    size_and_form_known.csv      measured gravels, packings of them, and U7 and B50 at the Rhine's mean form
    size_and_form_mixtures.csv   U7 with 52 distributions of form, by the published models
    size_and_form_slopes.csv     how much of the effect of form on one class remains in U7 and B50

Each bed is predicted from its sieve curve and the porosity of U1 of the same set
(simcore.models.size_and_form.known_beds), by the model that `predict --sieve` uses, by the candidates without fitted
parameters, and by the packing models of the literature. `half_width` is that of the stated 95 % interval for a known
porosity of U1. It takes seconds.
"""

import argparse

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from simcore.models.packing_models.literature import LITERATURE, POURED_COMPACTION, VIBRATED_COMPACTION
from simcore.models.size_and_form.bed_prediction import interval, rhine_sample
from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.known_beds import (
    BASE,
    MEASURED,
    MIXTURES,
    OF_MIXTURES,
    OF_ONE_FORM,
    PACKED,
    PACKED_BY_R22,
    PUBLISHED,
    known_beds,
    known_forms,
    known_mixtures,
    published_mixture,
    published_slopes,
)
from simcore.models.size_and_form.sized_model import current_model, unfitted_model
from simcore.models.size_and_form.stretch import REFERENCE_EL, REFERENCE_EQ, REFERENCE_POROSITY
from simcore.paths import REFERENCE
from simcore.reference.committed_rows import read_single_forms
from simcore.reference.r22_comparison import ROUNDING
from simcore.report.figures.saving import save_figure
from simcore.scene.sizes import all_cases

KNOWN, OF_DISTRIBUTIONS, SLOPES = (f"size_and_form_{name}.csv" for name in ("known", "mixtures", "slopes"))
OURS = "size and form"
R22 = "Rettinger et al."
PACKED_FORMS, SINGLE_FORMS = "packings of one form", REFERENCE / "single_form.csv"
# Candidates without fitted parameters: name, parameters. The first one is used as long as no parameter is fitted.
UNFITTED = {
    "H, K = 4.1": ("H", {"K": POURED_COMPACTION}), "L": ("L", {}), "F": ("F", {}),
    "H, K = 4.75": ("H", {"K": VIBRATED_COMPACTION}), "H, K = 9": ("H", {"K": 9.0}),
}  # fmt: skip
LEVEL = 0.95
# Label, marker and colour of each set in the figure.
SETS = {
    MEASURED: ("gravels measured by Rettinger et al.", "o", "#20313b"),
    PACKED: ("the same gravels, packed by us", "s", "#2f6f8f"),
    PACKED_BY_R22: ("the same gravels, packed by Rettinger et al.", "^", "#5a8f3c"),
    PUBLISHED: ("U7 and B50, mean form, model of Rettinger et al.", "D", "#b3541e"),
    MIXTURES: ("U7, 52 distributions of form, model of Rettinger et al.", "o", "#8d7aa3"),
}

MARKERS = {False: {"ms": 7, "mec": "white", "mew": 0.4}, True: {"ms": 3, "mew": 0.0}}  # True: of the many mixtures


def models(names=None):
    """Return porosity(curve, one_class, forms, of_rhine) -> (s,) by name.

    one_class (s,). forms: pair of EQ and EL (s,). of_rhine: one-class porosity of the Rhine's grains that are placed
    and shaken like these, a number. names: of the models that are returned; None: all.
    """
    candidates = {name: _candidate(*values) for name, values in UNFITTED.items()}
    literature = {name: _one_by_one(porosity) for name, porosity in LITERATURE.items()}
    all_models = {OURS: _many(current_model().predict)} | candidates | literature
    return {name: porosity for name, porosity in all_models.items() if names is None or name in names}


def _many(porosity):
    def of_beds(curve, one_class, forms, of_rhine):
        columns = (np.asarray(values, float).reshape(-1, 1) for values in (one_class, *forms))
        n1, *by_form = columns
        return porosity(curve, n1, tuple(by_form), of_rhine)

    return of_beds


def _candidate(name, parameters):
    values = parameters | {"m0": 1.0, "kappa": 0.0}
    return _many(lambda curve, n1, forms, of_rhine: predict(name, curve, n1, values, forms, "mass", of_rhine))


def _one_by_one(porosity):
    return lambda curve, one_class, forms, of_rhine: np.array([porosity(curve, n1) for n1 in one_class])


def known_table():
    """Return the known beds with `predicted`, `half_width` and, by each model, `error_<model>`, predicted minus known.

    half_width: of the stated interval of a bed whose porosity of U1 is known.
    """
    beds = known_beds()
    forms = np.full(1, REFERENCE_EQ), np.full(1, REFERENCE_EL)
    curves = [all_cases()[case].curve for case in beds["case"]]
    rows = list(zip(curves, beds["n_one_class"], beds["n"], strict=True))
    errors = {
        f"error_{name}": np.array([float(porosity(curve, [n1], forms, n1)[0]) - n for curve, n1, n in rows])
        for name, porosity in models().items()
    }
    predicted = beds["n"] + errors[f"error_{OURS}"]
    halves = [half_width(curve, n, n1, n1) for (curve, n1, _), n in zip(rows, predicted, strict=True)]
    return beds.assign(predicted=predicted, half_width=np.concatenate(halves), **errors).round(4)


def mixtures_table(names=None):
    """Return `known_mixtures` with the same columns of predictions as `known_table`; names: of models, None: all."""
    beds, curve = known_mixtures(), all_cases()[OF_MIXTURES].curve
    n1, forms = beds["n_one_class"].to_numpy(), (beds["mu_EQ"].to_numpy(), beds["mu_EL"].to_numpy())
    of_rhine = _of_rhine_mixture()
    porosities = {name: porosity(curve, n1, forms, of_rhine) for name, porosity in models(names).items()}
    errors = {f"error_{name}": n - beds["n"] for name, n in porosities.items()}
    predicted = beds["n"] + errors[f"error_{OURS}"]
    halves = half_width(curve, predicted.to_numpy(), n1, of_rhine)
    return beds.assign(predicted=predicted, half_width=halves, **errors).round(4)


def _of_rhine_mixture():
    """Return the porosity of U1 with the Rhine's distribution of form, by the published model."""
    rhine = pd.DataFrame([rhine_sample()])[["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]]
    return float(published_mixture(BASE, rhine)[0])


def half_width(curve, n, one_class, of_rhine):
    """Return the half width (s,) of the current model's interval of beds whose one-class porosity is known.

    n, one_class (s,): porosity of beds with this SieveCurve, and of U1. of_rhine: that of U1 with the Rhine's forms.
    """
    n = np.atleast_1d(n)
    return interval(curve, np.array([n, n, n]), np.atleast_1d(one_class), of_rhine, current_model(), LEVEL)


def slopes_table(names=None):
    """Return the slopes of the porosity of wide curves on that of U1, by linear regression over forms.

    One row per model, the published ones of Rettinger et al. first, then our packings of one form: model, slope_U7 and
    slope_B50 over the 63 forms of `known_forms`, or over the packed ones, each with its standard error, and
    slope_mixtures over the distributions of `known_mixtures`. The standard error of the published slopes is that of the
    rounding of the coefficients. That of the current model follows from the covariance of its parameters; nan without
    fitted parameters.
    names: of models, None: all.
    """
    forms, mixtures = known_forms(), known_mixtures()
    n1, of_forms = forms["n_one_class"].to_numpy(), (forms["EQ"].to_numpy(), forms["EL"].to_numpy())
    curves = {case: all_cases()[case].curve for case in OF_ONE_FORM}
    row = {"model": R22}
    for case in curves:
        row |= {f"slope_{case}": _slope(n1, forms[f"n_{case}"]), f"slope_{case}_std_error": _rounding(case, forms)}
    rows = [row | {"slope_mixtures": _slope(mixtures["n_one_class"], mixtures["n"])}, packed_slopes()]
    of_mixtures, of_rhine = (mixtures["mu_EQ"].to_numpy(), mixtures["mu_EL"].to_numpy()), _of_rhine_mixture()
    for name, porosity in models(names).items():
        row = {"model": name}
        for case, curve in curves.items():
            row[f"slope_{case}"] = _slope(n1, porosity(curve, n1, of_forms, REFERENCE_POROSITY))
            row[f"slope_{case}_std_error"] = _slope_error(curve, n1, of_forms) if name == OURS else np.nan
        wide = porosity(curves[OF_MIXTURES], mixtures["n_one_class"].to_numpy(), of_mixtures, of_rhine)
        rows.append(row | {"slope_mixtures": _slope(mixtures["n_one_class"], wide)})
    return pd.DataFrame(rows).round(4)


def packed_slopes():
    """Return the slopes of our packings of one form in U7 and B50 on those in U1, over the forms that have both."""
    rows = read_single_forms(SINGLE_FORMS, "synthetic", [BASE, *OF_ONE_FORM])
    n = rows.groupby(["grain", "case"])["n"].mean().unstack()
    slopes = {"model": PACKED_FORMS}
    for case in OF_ONE_FORM:
        both = n[[BASE, case]].dropna()
        (slope, _), covariance = np.polyfit(both[BASE], both[case], 1, cov=True)
        slopes |= {f"slope_{case}": float(slope), f"slope_{case}_std_error": float(np.sqrt(covariance[0, 0]))}
    return slopes


def _slope(one_class, n):
    return float(np.polyfit(one_class, n, 1)[0])


def _rounding(case, forms):
    """Return the standard deviation of a published slope by the rounding of its four coefficients."""
    features = np.column_stack([1.0 / forms["EQ"], 1.0 / forms["EL"]])
    slopes = np.array([published_slopes(BASE), published_slopes(case)])
    changes = []
    for index in np.ndindex(slopes.shape):
        changed = slopes.copy()
        changed[index] += ROUNDING
        base, wide = (features @ values for values in changed)
        changes.append(_slope(base, wide) - _slope(*(features @ values for values in slopes)))
    return float(np.sqrt(np.sum(np.square(changes))))


def _slope_error(curve, n1, forms):
    """Return the standard error of the current model's slope, nan without a covariance of its parameters."""
    model = current_model()
    names, covariance = parameter_covariance(model)
    if not names:
        return np.nan
    slope = _slope(n1, _many(model.predict)(curve, n1, forms, REFERENCE_POROSITY))
    changes = []
    for name, error in zip(names, np.sqrt(np.diag(covariance)), strict=True):
        changed = model._replace(parameters=model.parameters | {name: model.parameters[name] + 0.1 * error})
        changed_slope = _slope(n1, _many(changed.predict)(curve, n1, forms, REFERENCE_POROSITY))
        changes.append((changed_slope - slope) / (0.1 * error))
    return float(np.sqrt(np.array(changes) @ covariance @ np.array(changes)))


def parameter_covariance(model):
    """Return names (p,) and covariance (p, p) of the fitted parameters of a SizedModel; ([], None) if none is fitted.

    A parameter at a bound has no covariance and is left out.
    """
    folder = REFERENCE / "models"
    if model == unfitted_model() or not (folder / "size_and_form_covariance.csv").exists():
        return [], None
    rows = pd.read_csv(folder / "size_and_form_parameters.csv").query("model == @model.candidate")
    names = list(rows.loc[rows["at_bound"] != "yes", "parameter"])
    pairs = pd.read_csv(folder / "size_and_form_covariance.csv").query("model == @model.candidate")
    matrix = pairs.pivot(index="parameter", columns="with_parameter", values="covariance")
    return names, matrix.loc[names, names].to_numpy()


def rms_errors(tables):
    """Return the root mean square error of each model over each set, one row per set.

    tables: dict with the tables of `known_table` and `mixtures_table` by file name.
    """
    beds = pd.concat([tables[KNOWN], tables[OF_DISTRIBUTIONS].assign(set=MIXTURES)], ignore_index=True)
    columns = [name for name in beds if name.startswith("error_")]
    return beds.groupby("set", sort=False)[columns].agg(lambda error: np.sqrt(np.mean(error**2)))


def validation_figure(known, mixtures) -> Figure:
    """Draw predicted against known porosity of all sets, and the errors of each set with the stated intervals.

    known, mixtures: as of known_table and mixtures_table.
    """
    figure = Figure(figsize=(10.4, 6.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    beds = pd.concat([mixtures.assign(set=MIXTURES, case=""), known], ignore_index=True)
    ends = np.array([beds[["n", "predicted"]].min().min() - 0.01, beds[["n", "predicted"]].max().max() + 0.01])
    left.plot(ends, ends, color="0.5", lw=1.0, zorder=1, label="predicted = known")
    right.axvline(0.0, color="0.5", lw=1.0, zorder=1)
    for name in reversed(SETS):  # the measured gravels on top
        label, marker, colour = SETS[name]
        rows = beds[beds["set"] == name]
        small = name == MIXTURES
        style = {"fmt": marker, "color": colour, "elinewidth": 0.8, **MARKERS[small]}
        left.errorbar(rows["n"], rows["predicted"], yerr=None if small else rows["half_width"], label=label, **style)
    _draw_errors(right, beds)
    left.set(xlabel="known porosity [-]", ylabel="predicted porosity [-]", xlim=ends, ylim=ends, aspect="equal")
    left.set_title("Predicted and known porosity", fontsize="medium")
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles[::-1], labels[::-1], loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def _draw_errors(axes, beds):
    """Draw the error of each bed in a line of its own, set by set; the mixtures share a line."""
    place, places, words = 0.0, [], []
    for name, (_, marker, colour) in SETS.items():
        rows = beds[beds["set"] == name].reset_index(drop=True)
        errors, small = rows["predicted"] - rows["n"], name == MIXTURES
        lines = place - np.arange(len(rows)) * (0.0 if small else 1.0)
        if small:
            spread = 2.0 * ((rows.index.to_numpy() * 0.618) % 1.0 - 0.5)  # apart from each other, in no order
            axes.plot(errors, lines + spread, marker, color=colour, **MARKERS[small])
            half = rows["half_width"].median()
            axes.errorbar(0.0, place - 1.6, xerr=half, fmt="none", ecolor=colour, elinewidth=3.0)
            places, words = [*places, place - 1.6, place], [*words, "median interval", "52 distributions"]
        else:
            bars = {"xerr": rows["half_width"], "elinewidth": 3.0, "ecolor": colour}
            axes.errorbar(np.zeros(len(rows)), lines, fmt="none", alpha=0.3, **bars)
            axes.plot(errors, lines, marker, color=colour, **MARKERS[small])
            places, words = [*places, *lines], [*words, *rows["case"]]
        place = lines.min() - 1.7 - small - (list(SETS)[-2] == name)
    axes.set_yticks(places, words, fontsize="small")
    axes.set(xlabel="predicted minus known porosity [-]", ylim=(place + 0.3, 1.0))
    axes.set_title("Points: errors. Bars: stated 95 % intervals", fontsize="medium")


def main(arguments=None) -> None:
    """Print the tables and the root mean squares, write the tables, or draw the committed ones."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the tables into results/reference")
    parser.add_argument("--figure", metavar="OUT.png", help="draw the committed tables, and do nothing else")
    options = parser.parse_args(arguments)
    if options.figure:
        tables = (pd.read_csv(REFERENCE / name) for name in (KNOWN, OF_DISTRIBUTIONS))
        save_figure(validation_figure(*tables), options.figure)
        return
    tables = {KNOWN: known_table(), OF_DISTRIBUTIONS: mixtures_table(), SLOPES: slopes_table()}
    for name, table in tables.items():
        if options.write:
            table.to_csv(REFERENCE / name, index=False, lineterminator="\n")
        print(f"{name}\n{table.to_string(index=False, na_rep='')}\n")
    print(f"Root mean square error\n{rms_errors(tables).T.to_string(float_format='%.4f')}")


if __name__ == "__main__":
    main()

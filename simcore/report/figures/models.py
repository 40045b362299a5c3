"""Figures of models: porosity against form, predicted against simulated, polyhedra against ellipsoids."""

from itertools import cycle

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from simcore.grains.form import features as form_features
from simcore.reference.r22_tables import parse_r22_models

# Markers and lightness distinguish the cases without colour.
STYLES = [
    ("o", "#20313b"), ("s", "#b3541e"), ("^", "#7f9aa0"), ("D", "#c9a227"), ("v", "#6b4c7a"), ("P", "#4f7a4f"),
    ("X", "#2f6f9f"), ("<", "#8a6d3b"), (">", "#a34a6b"),
]  # fmt: skip
LINES = ["-", (0, (5, 2)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2)), (0, (3, 1))]
FEATURE_LABELS = {
    "EQ_inv": "longest over shortest axis L/S [-]",
    "JFF_inv": "inverse Janke form factor [-]",
    "WFI": "Wentworth flatness (L + I)/(2 S) [-]",
    "EL_inv": "longest over middle axis L/I [-]",
}
R22_SPHERES = {"U1": 0.36}  # of equal spheres, approached by the ellipsoids in Fig. 10 of Rettinger et al.


def form_figure(packings, features=("EQ_inv", "JFF_inv", "WFI"), r22_correlations=None, r22_models=None):
    """Draw porosity against features of the form with fit lines and Pearson's r, a panel per feature, a row per case.

    packings: columns case, L, I, S, n and, optionally, n_std_error. r22_correlations: correlations.csv of Rettinger et
    al. (2022), whose r are added to the legend. r22_models: models.csv, whose single-form model is drawn over EQ^-1, at
    the mean EL^-1 of our packings; Rettinger et al. give no line over the other features.
    """
    cases = list(packings.groupby("case", sort=False))
    figure = Figure(figsize=(3.4 * len(features), 0.6 + 2.9 * len(cases)), layout="constrained")
    grid = figure.subplots(len(cases), len(features), sharey="row", sharex="col", squeeze=False)
    for row, (case, rows), style in zip(grid, cases, cycle(STYLES), strict=False):
        values = form_features(*(rows[axis].to_numpy() for axis in "LIS"))
        for axes, feature in zip(row, features, strict=True):
            _draw_feature(axes, case, values[feature], rows, feature, style, r22_correlations)
            if feature == "EQ_inv" and r22_models is not None:
                _draw_r22_line(axes, case, values, r22_models)
            axes.legend(frameon=False, fontsize="x-small", loc="upper left")
        low, high = row[0].get_ylim()
        row[0].set_ylim(low, high + 0.25 * (high - low))  # space for the legends
        row[0].set_ylabel(f"{case}: porosity n [-]")
    for axes, feature in zip(grid[-1], features, strict=True):
        axes.set_xlabel(FEATURE_LABELS.get(feature, f"{feature} [-]"))
    return figure


def _draw_feature(axes, case, x, rows, feature, style, r22_correlations):
    """Draw the packings of a case over one feature, with the line of a fit."""
    (marker, color), n = style, rows["n"].to_numpy()
    axes.errorbar(
        x, n, rows.get("n_std_error"), fmt=marker, color=color, ms=5, elinewidth=0.8, mec="white", mew=0.4,
        label=f"{len(rows)} forms",
    )  # fmt: skip
    if len(rows) > 2 and np.ptp(x) > 0.0:
        line = np.array([x.min(), x.max()])
        label = f"fit: r = {np.corrcoef(x, n)[0, 1]:.3f}" + _r22_r(r22_correlations, case, feature)
        axes.plot(line, np.polyval(np.polyfit(x, n, 1), line), color=color, lw=1.2, label=label)


def _draw_r22_line(axes, case, values, r22_models):
    """Draw the model of single forms of Rettinger et al. over EQ^-1."""
    model = parse_r22_models(r22_models).get(("single_form", case))
    if model is None:
        return
    ends = pd.DataFrame({"EQ_inv": [values["EQ_inv"].min(), values["EQ_inv"].max()], "EL_inv": values["EL_inv"].mean()})
    label = f"Rettinger et al., Eq. {model.equation} at mean L/I = {values['EL_inv'].mean():.2f}"
    axes.plot(ends["EQ_inv"], model.porosity(ends), ls="--", color="0.55", lw=1.6, label=label)


def prediction_figure(predictions, models=()):
    """Draw predicted against simulated porosity, for our models and, in a second panel, those of Rettinger et al.

    predictions: columns case, simulated, predicted and, optionally, n_std_error of the simulated and r22_predicted;
    models: PorosityModels, whose R² and root mean square error are given in the legend. Without predictions the figure
    is empty and says so.
    """
    if predictions.empty:
        return _without_predictions()
    has_r22 = "r22_predicted" in predictions and predictions["r22_predicted"].notna().any()
    panels = {"predicted": "our model"} | ({"r22_predicted": "model of Rettinger et al."} if has_r22 else {})
    figure = Figure(figsize=(0.4 + 4.2 * len(panels), 4.6), layout="constrained")
    grid = figure.subplots(1, len(panels), squeeze=False, sharex=True, sharey=True)[0]
    both = predictions[["simulated", *panels]].to_numpy()
    margin = 0.06 * max(np.nanmax(both) - np.nanmin(both), 1e-3)
    if "n_std_error" in predictions:
        margin = max(margin, 1.1 * predictions["n_std_error"].max())  # space for the bars
    ends = np.array([np.nanmin(both) - margin, np.nanmax(both) + margin])
    by_case = {model.case: model for model in models}
    for axes, (column, title) in zip(grid, panels.items(), strict=True):
        axes.plot(ends, ends, color="0.3", lw=0.8, zorder=0)
        axes.fill_between(ends, ends - 0.01, ends + 0.01, color="0.92", zorder=-1, label="within 0.01")
        for (case, rows), (marker, color) in zip(predictions.groupby("case", sort=False), cycle(STYLES), strict=False):
            axes.errorbar(
                rows["simulated"], rows[column], xerr=rows.get("n_std_error"), fmt=marker, color=color, ms=5,
                elinewidth=0.8, mec="white", mew=0.4, label=case + _quality(rows, column, by_case.get(case)),
            )  # fmt: skip
        axes.set(xlim=ends, ylim=ends, aspect="equal", xlabel="simulated porosity n [-]")
        axes.set_title(title, fontsize="medium")
        axes.legend(frameon=False, fontsize="small", loc="upper left")
    grid[0].set_ylabel("predicted porosity n [-]")
    return figure


def _quality(rows, column, model):
    """Describe how well the model fits the packings, as text."""
    if column == "predicted":
        return f": R² = {model.r_squared:.3f}, RMSE = {model.rmse:.4f}" if model else ""
    error = rows[column] - rows["simulated"]
    return f": mean error {error.mean():+.4f}, RMS {np.sqrt(np.mean(error**2)):.4f}".replace("-", "−")


def _without_predictions():
    """Return a figure that says why it is empty."""
    figure = Figure(figsize=(4.6, 1.6), layout="constrained")
    axes = figure.subplots()
    axes.set_axis_off()
    axes.text(0.5, 0.5, "No model was fitted; the log has the reasons.", ha="center", va="center")
    return figure


def shape_kind_figure(pairs, near_spheres=None):
    """Draw the porosity of polyhedra and of their equivalent ellipsoids against EQ^-1, one panel per case.

    pairs: columns case, EQ, n_mesh, n_ellipsoid and, optionally, n_mesh_error and n_ellipsoid_error. near_spheres: a
    sphere (EQ 1) and ellipsoids rounder than any grain, columns case, EQ, n, n_std_error.
    """
    cases = list(pairs.groupby("case", sort=False))
    figure = Figure(figsize=(4.6 * len(cases), 4.2), layout="constrained")
    grid = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
    bars = {"elinewidth": 0.8, "ms": 5, "ls": "none"}
    for axes, (case, rows) in zip(grid, cases, strict=True):
        x = 1.0 / rows["EQ"]
        axes.vlines(x, rows["n_mesh"], rows["n_ellipsoid"], color="0.8", lw=0.8, zorder=0)
        axes.errorbar(
            x,
            rows["n_mesh"],
            rows.get("n_mesh_error"),
            marker="o",
            color="#20313b",
            label="grains (polyhedra)",
            **bars,
        )
        axes.errorbar(
            x, rows["n_ellipsoid"], rows.get("n_ellipsoid_error"), marker="o", mfc="white", color="#b3541e",
            label="their equivalent ellipsoids", **bars,
        )  # fmt: skip
        if near_spheres is not None and (near_spheres["case"] == case).any():
            _draw_near_spheres(axes, near_spheres[near_spheres["case"] == case], bars)
            if case in R22_SPHERES:
                n = R22_SPHERES[case]
                label = f"equal spheres, Rettinger et al.: {n:g}"
                axes.plot([1.0, 1.5], [n, n], "--", color="0.4", lw=1.0, zorder=0, label=label)
        rms = np.sqrt(np.mean((rows["n_mesh"] - rows["n_ellipsoid"]) ** 2))
        axes.set(
            xlabel=FEATURE_LABELS["EQ_inv"],
            title=f"sieve curve {case}: difference {rms:.4f}, root mean square",
            xlim=(0.9, None),
        )
        axes.title.set_fontsize("medium")
    grid[0].set_ylabel("porosity n [-]")
    handles, labels = max((axes.get_legend_handles_labels() for axes in grid), key=lambda pair: len(pair[1]))
    figure.legend(handles, labels, frameon=False, fontsize="small", loc="outside lower center", ncols=2)
    return figure


def _draw_near_spheres(axes, rows, bars):
    """Draw the sphere and the ellipsoids near it, beginning with the roundest."""
    rows = rows.sort_values("EQ", ascending=False)
    round_ones = np.isclose(rows["EQ"], 1.0)
    axes.plot(1.0 / rows["EQ"], rows["n"], color="#7f9aa0", lw=0.8, zorder=1)
    for mask, marker, label in ((~round_ones, "^", "ellipsoids with FL = EL"), (round_ones, "*", "spheres")):
        some = rows[mask]
        if some.empty:
            continue
        size = {"ms": 10} if marker == "*" else {}
        axes.errorbar(
            1.0 / some["EQ"], some["n"], some["n_std_error"], marker=marker, color="#7f9aa0", mec="black", mew=0.5,
            label=label, **(bars | size),
        )  # fmt: skip


def _r22_r(r22_correlations, case, feature):
    """Return the r of Rettinger et al. for single forms as text, empty if they give none."""
    if r22_correlations is None:
        return ""
    row = r22_correlations.query("study == 'single_form' and case == @case and feature == @feature")
    return f" (Rettinger et al. {row['r'].iloc[0]:.3f})" if len(row) else ""

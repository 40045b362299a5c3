"""Figures of many packings: porosity against form, predicted against simulated, and ours beside the study's."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from simcore.grains.form import features as form_features

# Markers and greys tell the cases apart without colour.
STYLES = [("o", "#20313b"), ("s", "#b3541e"), ("^", "#7f9aa0"), ("D", "#c9a227"), ("v", "#6b4c7a"), ("P", "#4f7a4f")]
FEATURE_LABELS = {
    "EQ_inv": "EQ$^{-1}$ = L/S [-]",
    "JFF_inv": "JFF$^{-1}$ [-]",
    "WFI": "WFI = (L + I)/(2 S) [-]",
    "EL_inv": "EL$^{-1}$ = L/I [-]",
}


def form_figure(packings, features=("EQ_inv", "JFF_inv", "WFI"), study=None):
    """Porosity against features of the form with fit lines and Pearson's r, one panel a feature.

    packings: columns case, L, I, S, n and, if known, n_std_error; study: correlations.csv, whose r stand beside ours.
    """
    figure = Figure(figsize=(3.2 * len(features), 3.4), layout="constrained")
    grid = figure.subplots(1, len(features), sharey=True, squeeze=False)[0]
    values = form_features(*(packings[axis].to_numpy() for axis in "LIS")).set_index(packings.index)
    for axes, feature in zip(grid, features, strict=True):
        for (case, rows), (marker, color) in zip(packings.groupby("case", sort=False), STYLES, strict=False):
            x = values.loc[rows.index, feature].to_numpy()
            label = case
            if len(rows) > 2 and np.ptp(x) > 0.0:
                line = np.array([x.min(), x.max()])
                axes.plot(line, np.polyval(np.polyfit(x, rows["n"], 1), line), color=color, lw=1.2)
                label += f": r = {np.corrcoef(x, rows['n'])[0, 1]:.3f}" + _study_r(study, case, feature)
            axes.errorbar(
                x,
                rows["n"],
                rows.get("n_std_error"),
                fmt=marker,
                color=color,
                ms=4,
                lw=0.6,
                mec="white",
                mew=0.4,
                label=label,
            )
        axes.set_xlabel(FEATURE_LABELS.get(feature, f"{feature} [-]"))
        axes.legend(frameon=False, fontsize="x-small", loc="best")
    grid[0].set_ylabel("porosity n [-]")
    return figure


def prediction_figure(predictions, models=()):
    """Predicted against simulated porosity; predictions: columns case, simulated, predicted; models: PorosityModels.

    The models' R² and root mean square error stand in the legend.
    """
    figure = Figure(figsize=(4.4, 4.4), layout="constrained")
    axes = figure.subplots()
    by_case = {model.case: model for model in models}
    for (case, rows), (marker, color) in zip(predictions.groupby("case", sort=False), STYLES, strict=False):
        label = case
        if case in by_case:
            label += f": R² = {by_case[case].r_squared:.3f}, RMSE = {by_case[case].rmse:.4f}"
        axes.plot(rows["simulated"], rows["predicted"], marker, color=color, ms=4.5, mec="white", mew=0.4, label=label)
    both = predictions[["simulated", "predicted"]].to_numpy()
    margin = 0.05 * max(np.ptp(both), 1e-3)
    ends = np.array([both.min() - margin, both.max() + margin])
    axes.plot(ends, ends, color="0.3", lw=0.8, zorder=0)
    axes.fill_between(ends, ends - 0.01, ends + 0.01, color="0.92", zorder=-1, label="within 0.01")
    axes.set(xlim=ends, ylim=ends, aspect="equal", xlabel="simulated porosity n [-]", ylabel="predicted porosity n [-]")
    axes.legend(frameon=False, fontsize="small")
    return figure


def shape_kind_figure(pairs):
    """Porosity of meshes and of their equivalent ellipsoids against EQ^-1; columns case, EQ, n_mesh, n_ellipsoid."""
    cases = list(pairs.groupby("case", sort=False))
    figure = Figure(figsize=(4.2 * len(cases), 3.6), layout="constrained")
    for axes, (case, rows) in zip(figure.subplots(1, len(cases), sharey=True, squeeze=False)[0], cases, strict=True):
        x = 1.0 / rows["EQ"]
        axes.vlines(x, rows["n_mesh"], rows["n_ellipsoid"], color="0.75", lw=0.8, zorder=0)
        axes.plot(x, rows["n_mesh"], "o", color="#20313b", ms=5, label="grains (convex hulls)")
        axes.plot(x, rows["n_ellipsoid"], "o", mfc="white", color="#b3541e", ms=5, label="equivalent ellipsoids")
        axes.axvline(2.0, color="0.5", lw=0.8, ls=":")
        rms = np.sqrt(np.mean((rows["n_mesh"] - rows["n_ellipsoid"]) ** 2))
        axes.set(xlabel=FEATURE_LABELS["EQ_inv"], ylabel="porosity n [-]", title=f"{case}: rms difference {rms:.4f}")
        axes.legend(frameon=False, fontsize="small")
    return figure


def study_figure(table, label):
    """Simulated porosity beside the study's, one line a row of `table`.

    table: columns n, n_std_error, study_n and, if known, n_std and study_n_std; label: column names that name the row.
    Bars are one standard error of our mean and the study's standard deviation over its runs.
    """
    figure = Figure(figsize=(5.6, 1.2 + 0.28 * len(table)), layout="constrained")
    axes = figure.subplots()
    y = np.arange(len(table))[::-1]
    axes.errorbar(
        table["n"],
        y + 0.1,
        xerr=table["n_std_error"],
        fmt="o",
        color="#20313b",
        ms=5,
        capsize=2,
        label="simulated (± std. error)",
    )
    spread = table["study_n_std"] if "study_n_std" in table else None
    axes.errorbar(
        table["study_n"],
        y - 0.1,
        xerr=spread,
        fmt="D",
        color="#b3541e",
        mfc="white",
        ms=5,
        capsize=2,
        label="study (± std. over runs)",
    )
    names = table[list(label)].map(lambda value: f"{value:g}" if isinstance(value, float) else str(value))
    axes.set_yticks(y, names.agg(", ".join, axis=1))
    axes.set(xlabel="porosity n [-]", ylim=(-0.7, len(table) - 0.3), title=", ".join(label))
    axes.title.set_fontsize("medium")
    axes.grid(axis="x", color="0.9")
    axes.set_axisbelow(True)
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def form_sets_figure(mixtures):
    """Form mixtures in the Zingg diagram: an ellipse of one standard deviation around each mean.

    mixtures: columns mu_FL, sigma_FL, mu_EL, sigma_EL and n, the porosity that shades the ellipses.
    """
    figure = Figure(figsize=(5.0, 4.4), layout="constrained")
    axes = figure.subplots()
    low, high = mixtures["n"].min(), mixtures["n"].max()
    image = axes.scatter(
        mixtures["mu_FL"], mixtures["mu_EL"], c=mixtures["n"], cmap="cividis", s=22, zorder=3, vmin=low, vmax=high
    )
    for _, row in mixtures.iterrows():
        color = image.cmap(image.norm(row["n"]))
        size = (2 * row["sigma_FL"], 2 * row["sigma_EL"])
        axes.add_patch(Ellipse((row["mu_FL"], row["mu_EL"]), *size, fill=False, ec=color, lw=0.7, alpha=0.8, zorder=2))
    for line in (axes.axvline, axes.axhline):
        line(2 / 3, color="0.6", lw=0.8, ls=":")
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="flatness FL = S/I [-]", ylabel="elongation EL = I/L [-]")
    figure.colorbar(image, ax=axes, label="porosity n [-]")
    return figure


def _study_r(study, case, feature):
    """The study's r of the single-form study as text, empty if unknown."""
    if study is None:
        return ""
    row = study.query("study == 'single_form' and case == @case and feature == @feature")
    return f" (study {row['r'].iloc[0]:.3f})" if len(row) else ""

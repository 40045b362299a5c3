"""Figures of a study's porosities, compared with Rettinger et al. (2022), and of the trends over height."""

from itertools import cycle

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from simcore.reference.columns.headings import find_heading
from simcore.report.figures.models import LINES, STYLES
from simcore.report.outcomes import SWEEPS, differ_in_form, named_setting, other_settings
from simcore.report.words import value_in_words

R22 = "Rettinger et al."  # in legends
OUR_STYLE, R22_STYLE = {"color": "#20313b", "fmt": "o"}, {"color": "#b3541e", "fmt": "D", "mfc": "white"}
# Labels of axes whose headings in tables are too short.
_AXES = {
    "shaking_s": "duration of shaking [s]",
    "width_m": "width of the domain [mm]",
    "faces": "maximum number of faces of a polyhedron [-]",
    "mass_kg": "mass [kg]",
}
FORM_COLUMNS = ("grain", "flatness", "elongation", "mean_FL", "mean_EL")
TREND_LIMIT = 2.7  # P(|z| > 2.7) = 0.0069; for four quantities this is 1/36
TREND_LABELS = {
    "D": "sieve size D",
    "FL": "flatness FL",
    "EL": "elongation EL",
    "angle": "angle of the long axis\nto the vertical",
}


def porosities_figure(table, varied):
    """Draw the porosities of a study over its one varied quantity, over form, or as a list of settings.

    table: as from r22_comparison.add_reference; varied: the columns that the study varies.
    """
    if any(name in table for name in FORM_COLUMNS) and differ_in_form(table):
        return equancy_figure(table)
    settings = [name for name in dict.fromkeys(["case", *varied]) if name in table and name != "seed"]
    for name in SWEEPS:
        if name in varied and table[name].nunique() > 1 and not table.duplicated(["case", name]).any():
            return sweep_figure(table, name)
    return study_figure(table, settings)


def study_figure(table, label):
    """Draw simulated porosities, those of Rettinger et al. and, if given, of experiments, one line per row of `table`.

    table: columns n, n_std_error, r22_n and, optionally, r22_n_std, experiment_n, experiment_n_std; label: names of the
    columns that label the rows. Bars are one standard error of our mean, and standard deviations over runs of the
    others.
    """
    figure = Figure(figsize=(6.0, 1.5 + 0.36 * len(table)), layout="constrained")
    axes = figure.subplots()
    y = np.arange(len(table))[::-1]
    axes.errorbar(
        table["n"], y + 0.17, xerr=table["n_std_error"], ms=5, capsize=2, label="simulated (± std. error)", **OUR_STYLE
    )
    if table["r22_n"].notna().any():
        std = table.get("r22_n_std")
        axes.errorbar(table["r22_n"], y, xerr=std, ms=5, capsize=2, label=R22 + _bars(std), **R22_STYLE)
    if "experiment_n" in table:
        axes.errorbar(
            table["experiment_n"], y - 0.17, xerr=table["experiment_n_std"], fmt="s", color="0.55", ms=5, capsize=2,
            label="experiment (± std.)",
        )  # fmt: skip
    names = [
        ", ".join(_label(name, value) for name, value in row.items()) for row in table[list(label)].to_dict("records")
    ]
    axes.set_yticks(y, names)
    axes.set(xlabel="porosity n [-]", ylim=(-0.7, len(table) - 0.3))
    axes.set_ylabel("\n".join(find_heading(name).words for name in label))
    axes.grid(axis="x", color="0.9")
    axes.set_axisbelow(True)
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def sweep_figure(table, column):
    """Draw porosity over the one quantity that a study varies, one line per case, with points of Rettinger et al.

    table: as for study_figure, with `column`, one of SWEEPS; settings in words, such as "original", come last.
    """
    heading, settings = find_heading(column), _in_order(table[column])
    # Numbers of faces are given by factors, and "original" is none: they are labels in order.
    labelled = column == "faces" or not all(map(_is_number, settings))
    position = {str(value): k if labelled else heading.factor * float(value) for k, value in enumerate(settings)}
    figure = Figure(figsize=(5.0, 4.2), layout="constrained")
    axes = figure.subplots()
    for (case, rows), (marker, color), line in zip(
        table.groupby("case", sort=False), cycle(STYLES), cycle(LINES), strict=False
    ):
        x = rows[column].map(lambda value: position[str(value)])
        order = np.argsort(x.to_numpy(), kind="stable")
        rows, x = rows.iloc[order], x.to_numpy()[order]
        axes.errorbar(
            x, rows["n"], rows["n_std_error"], marker=marker, color=color, ls=line, ms=5, lw=1.2, capsize=2,
            label=f"{case}, simulated (± std. error)",
        )  # fmt: skip
        if rows["r22_n"].notna().any():
            axes.errorbar(
                x, rows["r22_n"], rows.get("r22_n_std"), marker=marker, color=color, mfc="white", ls=line, ms=6,
                lw=0.6, capsize=2, label=f"{case}, {R22}" + _bars(rows.get("r22_n_std")),
            )  # fmt: skip
    if labelled:
        axes.set_xticks(range(len(settings)), [str(value) for value in settings])
    axes.set(xlabel=_AXES.get(column, f"{heading.words} [{heading.unit or '-'}]"), ylabel="porosity n [-]")
    axes.margins(x=0.08)
    axes.grid(color="0.93", lw=0.6)
    axes.set_axisbelow(True)
    figure.legend(loc="outside lower center", ncols=1, frameon=False, fontsize="small")
    return figure


def equancy_figure(table):
    """Draw porosity over EQ^-1 of the mean form, one panel per case, with predictions of the model of Rettinger et al.

    table: columns case, EQ, n, n_std_error, r22_n and, optionally, r22_n_error. Packings that differ in other settings
    have markers of their own.
    """
    cases, others = list(table.groupby("case", sort=False)), other_settings(table)
    figure = Figure(figsize=(0.6 + 3.9 * len(cases), 3.9), layout="constrained")
    grid = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
    for axes, (case, rows) in zip(grid, cases, strict=True):
        x, label = 1.0 / rows["EQ"], "simulated (± std. error)"
        groups = rows.groupby(others, sort=False, dropna=False) if others else [((), rows)]
        styles = ({"fmt": marker, "color": color} for marker, color in cycle(STYLES)) if others else [OUR_STYLE]
        for (values, group), style in zip(groups, styles, strict=False):
            names = ", ".join(named_setting(*item) for item in zip(others, values, strict=True))
            axes.errorbar(
                x[group.index], group["n"], group["n_std_error"], ms=5, elinewidth=0.8,
                label=f"{names}: {label}" if names else label, **style,
            )  # fmt: skip
        if rows["r22_n"].notna().any():
            axes.errorbar(
                x, rows["r22_n"], rows.get("r22_n_error"), ms=5, elinewidth=0.8,
                label=f"model of {R22} for these forms (± its error)", **R22_STYLE,
            )  # fmt: skip
        axes.set(xlabel="1/mean equancy, L/S [-]", title=f"sieve curve {case}")
        axes.title.set_fontsize("medium")
        axes.grid(color="0.93", lw=0.6)
        axes.set_axisbelow(True)
    grid[0].set_ylabel("porosity n [-]")
    handles, labels = max((axes.get_legend_handles_labels() for axes in grid), key=lambda pair: len(pair[1]))
    figure.legend(handles, labels, loc="outside lower center", ncols=1, frameon=False, fontsize="small")
    return figure


def trends_figure(trends):
    """Draw the change of size, form and orientation from the lower to the upper end of beds, one panel per quantity.

    trends: of trend_tables.summarise_trends. Bars are two standard errors. Points are filled if the rank correlation
    exceeds 2.7 standard errors; without trends, this happens for one of the four quantities in one study of 36.
    """
    studies = list(dict.fromkeys(zip(trends["study"], trends["case"], trends["kind"], strict=True)))
    figure = Figure(figsize=(10.0, 1.8 + 0.3 * len(studies)), layout="constrained")
    grid = figure.subplots(1, len(TREND_LABELS), sharey=True)
    place = {study: y for y, study in enumerate(reversed(studies))}
    for axes, (quantity, label) in zip(grid, TREND_LABELS.items(), strict=True):
        rows = trends[trends["quantity"] == quantity]
        y = [place[key] for key in zip(rows["study"], rows["case"], rows["kind"], strict=True)]
        x, error = 100.0 * rows["relative_change"], 200.0 * rows["relative_change_std_error"]
        axes.axvline(0.0, color="0.6", lw=0.8, zorder=0)
        axes.errorbar(x, y, xerr=error, fmt="none", color="#20313b", lw=0.9, capsize=2)
        shades = np.where(rows["spearman_z"].abs() > TREND_LIMIT, "#20313b", "white")
        axes.scatter(x, y, s=26, c=list(shades), ec="#20313b", lw=0.9, zorder=3)
        axes.set(title=label, xlabel="change over height [%]")
        axes.title.set_fontsize("medium")
        axes.grid(axis="y", color="0.93", lw=0.6)
        axes.set_axisbelow(True)
    names = [f"{study.replace('_', ' ')}, {case}, {kind}" for study, case, kind in place]
    grid[0].set_yticks(list(place.values()), names)
    grid[0].set_ylim(-0.7, max(len(studies), 1) - 0.3)
    points = [
        Line2D([], [], ls="none", marker="o", mfc=shade, mec="#20313b", label=label)
        for shade, label in (
            ("white", "no trend"),
            ("#20313b", f"rank correlation beyond {TREND_LIMIT} standard errors"),
        )
    ]
    bar = Line2D([], [], color="#20313b", lw=0.9, label="± 2 standard errors")
    figure.legend(handles=[*points, bar], loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return figure


def _label(name, value):
    """Return a setting of a row as text: numbers in the printed unit, names in words."""
    heading = find_heading(name)
    if isinstance(value, float):
        return f"{heading.factor * value:g}" + (f" {heading.unit}" if heading.unit else "")
    return value_in_words(name, value)


def _bars(std):
    """Return the meaning of the bars of Rettinger et al. for the legend, empty if they have none."""
    return "" if std is None or std.isna().all() else " (± std. over runs)"


def _in_order(values):
    """Return the distinct settings: numbers in ascending order, then words."""
    numbers = {float(value): value for value in values if _is_number(value)}
    words = [value for value in dict.fromkeys(values) if not _is_number(value)]
    return [numbers[key] for key in sorted(numbers)] + words


def _is_number(value):
    try:
        return np.isfinite(float(value))
    except ValueError:
        return False

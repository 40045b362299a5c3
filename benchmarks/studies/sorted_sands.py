"""The model of size and form on sands of six sortings, as a trend; nothing is fitted to them.

    python -m benchmarks.studies.sorted_sands              # prints the tables
    python -m benchmarks.studies.sorted_sands --write      # into results/reference/sorted_sands.csv
    python -m benchmarks.studies.sorted_sands --figure docs/sorted_sands.png   # draws that table

Beard and Weyl (1973) mixed quartz sands of eight grain sizes and six sortings, with weights normally distributed about
the median size, and measured the porosity of wet-packed beds. `results/reference/beard_weyl_1973.csv` has 42 of the 48
porosities: the transcription that was read repeats another grain size for lower medium sand. Its other two rows are the
means that the abstract gives.

These sands have other forms than our grains and were packed in another way. Therefore the porosity of the best sorted
sand of each grain size is given to each model, and the test is how the porosity decreases with sorting. Sorting is that
of Trask, S0, the root of the ratio of the quartiles; the midpoint of each class is taken. At which sizes the sands were
cut is not known: here they are cut at two standard deviations of ln D, which is ln(S0) / 0.639 then, so that the cut
curve has this sorting. The printed table shows what other cuts change. It takes about ten seconds.

# ASSUME: the weights are normally distributed over the logarithm of size.
"""

import argparse
from functools import cache

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.stats import norm

from simcore.grains.sieve import SieveCurve
from simcore.models.packing_models.literature import LITERATURE
from simcore.models.size_and_form.bed_prediction import wider
from simcore.models.size_and_form.one_class import LARGEST, LEAST
from simcore.models.size_and_form.sized_model import current_model
from simcore.paths import REFERENCE
from simcore.report.figures.saving import save_figure

DATA, TABLE = "beard_weyl_1973.csv", "sorted_sands.csv"
OURS = "size and form"
FROM_ABSTRACT = "mean of eight"  # rows of the data that are no sand
MEDIAN = 0.5e-3  # [m]; models depend on ratios of sizes only
CUT, OTHER_CUTS = 2.0, (1.5, 2.5)  # standard deviations of ln D on each side of the median
WIDEST, FEWEST = 2 ** (1 / 8), 16  # ratio of the bounds of a class, and number of classes
ROUNDS, TOLERANCE = 30, 1e-9
LINES = {  # style, colour and width of each model in the figure
    OURS: ("-", "#b3541e", 2.6),
    "linear": ("--", "#2f6f8f", 1.5),
    "linear mixture": ("-.", "#5a8f3c", 1.5),
    "rods": ((0, (4, 1, 1, 1, 1, 1)), "#7a5c99", 1.5),
}


def read_sands() -> pd.DataFrame:
    """Return the 42 sands of Beard and Weyl: grain_size, sorting, trask_sorting, n, and the deviation of ln D."""
    sands = pd.read_csv(REFERENCE / DATA)
    sands = sands[sands["grain_size"] != FROM_ABSTRACT].drop(columns="source").reset_index(drop=True)
    return sands.assign(log_deviation=deviation(sands["trask_sorting"]))


def deviation(trask_sorting, cut=CUT):
    """Return the standard deviation of ln D of the log-normal curve that has this sorting of Trask after the cut.

    cut: as in log_normal.
    """
    beyond = norm.cdf(-cut)
    return np.log(trask_sorting) / norm.ppf(beyond + 0.75 * (1.0 - 2.0 * beyond))


@cache
def log_normal(log_deviation, cut=CUT) -> SieveCurve:
    """Return a SieveCurve of narrow classes, log-normal by mass, with this standard deviation of ln D before the cut.

    cut: standard deviations on each side of the median, beyond which there is no mass.
    """
    number = max(FEWEST, int(np.ceil(2 * cut * log_deviation / np.log(WIDEST))))
    z = np.linspace(-cut, cut, number + 1)
    masses = np.diff(norm.cdf(z))
    return SieveCurve(MEDIAN * np.exp(log_deviation * z), masses / masses.sum(), f"log-normal {log_deviation:.3f}")


def models(names=None):
    """Return porosity(curve, one_class) by name: the current model, and packing models as they are published.

    The current model takes the unknown form of the sands for that of the Rhine's grains. names: of the models that are
    returned; None: all.
    """
    all_models = {OURS: _of_rhine} | LITERATURE
    return {name: porosity for name, porosity in all_models.items() if names is None or name in names}


def _of_rhine(curve, one_class):
    return current_model().predict(curve, one_class, reference=one_class)


def one_class_of(porosity, curve, n) -> float:
    """Return the one-class porosity at which the model porosity(curve, one_class) gives n; nan if none was found."""
    one_class = float(np.clip(n, LEAST, LARGEST))
    for _ in range(ROUNDS):
        left = n - float(porosity(curve, one_class))
        one_class = float(np.clip(one_class + left, LEAST, LARGEST))
        if abs(left) <= TOLERANCE:
            return one_class
    return np.nan


def predicted(porosity, sands, cut=CUT) -> np.ndarray:
    """Return the porosity (s,) of each sand by a model that gets the best sorted sand of its grain size; nan: refused.

    sands: as of read_sands.
    """
    n = pd.Series(np.nan, sands.index)
    for _, rows in sands.groupby("grain_size", sort=False):
        best = rows.loc[rows["trask_sorting"].idxmin()]
        one_class = one_class_of(porosity, log_normal(deviation(best.trask_sorting, cut), cut), best.n)
        for index, row in rows.iterrows():
            try:
                n[index] = float(porosity(log_normal(deviation(row.trask_sorting, cut), cut), one_class))
            except ValueError:  # outside the range of the model
                n[index] = np.nan
    return n.to_numpy()


def sands_table(names=None) -> pd.DataFrame:
    """Return one row per sand: grain_size, sorting, trask_sorting, log_deviation, outside, n, and n by each model.

    outside: yes if the curve is wider than those for which the errors of the current model are known. names: of the
    models, None: all.
    """
    sands = read_sands()
    wide = [wider(log_normal(value), current_model()) > 1.0 for value in sands["log_deviation"]]
    columns = ["grain_size", "sorting", "trask_sorting", "log_deviation", "outside", "n"]
    table = sands.assign(outside=np.where(wide, "yes", ""))[columns]
    return table.assign(
        **{f"predicted_{name}": predicted(model, sands) for name, model in models(names).items()}
    ).round(4)


def mean_ratios(table) -> pd.DataFrame:
    """Return the porosity relative to that of the best sorted sand, means over the grain sizes by sorting.

    table: as of sands_table. Columns: log_deviation, measured, spread (standard deviation over the grain sizes), and
    each model.
    """
    best = table.groupby("grain_size")["log_deviation"].transform("idxmin")
    base = table["n"].to_numpy()[best]
    numbers = table[["n", *_predictions(table)]].div(base, axis=0)
    numbers.columns = ["measured", *_names(table)]
    groups = numbers.assign(log_deviation=table["log_deviation"]).groupby(table["sorting"], sort=False)
    means = groups.mean()
    means.insert(0, "spread", groups["measured"].std())
    return means[["log_deviation", "measured", "spread", *numbers.columns[1:]]]


def rms_errors(table) -> pd.Series:
    """Return the root mean square of predicted minus measured porosity by model, without the best sorted sands."""
    others = table[table["log_deviation"] > table["log_deviation"].min()]
    errors = others[_predictions(table)].sub(others["n"], axis=0).set_axis(_names(table), axis=1)
    return np.sqrt((errors**2).mean(skipna=False))


def _predictions(table):
    return [name for name in table if name.startswith("predicted_")]


def _names(table):
    return [name.removeprefix("predicted_") for name in _predictions(table)]


def sands_figure(table) -> Figure:
    """Draw the mean ratios over the standard deviation of ln D: sands with their spread, models as lines."""
    means = mean_ratios(table)
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.subplots()
    x = means["log_deviation"]
    outside = table.loc[table["outside"] == "yes", "log_deviation"]
    if len(outside):
        inside = table.loc[table["outside"] != "yes", "log_deviation"]
        axes.axvspan(np.sqrt(inside.max() * outside.min()), 1.3 * x.max(), color="0.92", lw=0.0, zorder=0)
        words = "wider than any bed\nbehind our model"
        axes.text(outside.min(), 1.03, words, va="center", fontsize="small", color="0.35")
    for name in means.columns[3:]:
        style, colour, width = LINES.get(name, (":", "#666666", 1.5))
        label = "our model of size and form" if name == OURS else f"packing model: {name}"
        axes.plot(x, means[name], ls=style, color=colour, lw=width, label=label)
    axes.errorbar(
        x, means["measured"], yerr=means["spread"], fmt="o", color="#20313b", ms=6, capsize=3, zorder=3,
        label="measured: mean over the grain sizes,\nbars: standard deviation over them",
    )  # fmt: skip
    words = [f"{value:.2g}\n{name.replace(' ', chr(10))}" for name, value in x.items()]
    axes.set_xscale("log")
    axes.set_xticks(x, words)
    axes.set_xticks([], minor=True)
    axes.set(
        xlabel="standard deviation of ln(grain size) [-], and how well the sand is sorted",
        ylabel="porosity / porosity of the best sorted sand [-]",
        ylim=(0.2, 1.08),
        xlim=(0.8 * x.min(), 1.25 * x.max()),
    )
    handles, labels = axes.get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda i: (labels[i].startswith("packing"), labels[i].startswith("our")))
    axes.legend([handles[i] for i in order], [labels[i] for i in order], loc="lower left", frameon=False)
    return figure


def main(arguments=None) -> None:
    """Print the ratios, the errors and the effect of the cut; write or draw the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"write results/reference/{TABLE}")
    parser.add_argument("--figure", metavar="OUT.png", help="draw the committed table, and do nothing else")
    options = parser.parse_args(arguments)
    if options.figure:
        save_figure(sands_figure(pd.read_csv(REFERENCE / TABLE)), options.figure)
        return
    table = sands_table()
    if options.write:
        table.to_csv(REFERENCE / TABLE, index=False, lineterminator="\n")
    with pd.option_context("display.width", 200):
        print("Porosity relative to that of the best sorted sand of the same grain size, means over the grain sizes")
        print(mean_ratios(table).to_string(float_format="%.3f"))
        print("\nRoot mean square of predicted minus measured porosity of the other sands")
        print(rms_errors(table).to_string(float_format="%.4f"))
        print("\nRatios by the model of size and form, cut at other sizes [standard deviations]")
        print(_other_cuts(read_sands()).to_string(float_format="%.3f"))


def _other_cuts(sands):
    """Return the mean ratios by the current model, one column per cut."""
    best = sands.groupby("grain_size")["log_deviation"].transform("idxmin")
    base = sands["n"].to_numpy()[best]
    columns = {cut: predicted(_of_rhine, sands, cut) / base for cut in sorted({CUT, *OTHER_CUTS})}
    return pd.DataFrame(columns).groupby(sands["sorting"], sort=False).mean()


if __name__ == "__main__":
    main()

"""The picture of the page on wide sieve curves: difference in porosity over the CPU time of cheaper settings."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from benchmarks.studies.wide_cost import LARGEST_DIFFERENCE, compare_means, compare_r22, paired
from docs.generate.porosity_pictures import DARK, ORANGE
from simcore.paths import REFERENCE

R22 = "settings of Rettinger et al."
LABELS = {
    "wide_quota": "reference, sizes by quota",
    "wide_random": "sizes at random",
    "wide_short": "1 s of shaking",
    "wide_soft": "0.5 ms",
    "wide_both": "both: the preset wide",
    "wide_rain": "rain",
    "wide_filled": "one dense batch",
    R22: R22,
}
PLACES = {
    "wide_random": (6, 8),
    "wide_quota": (6, -14),
    "wide_both": (-20, -24),
    "wide_soft": (6, -16),
    R22: (6, 8),
}  # of labels that would cover others [points]


def settings_of(case="U5"):
    """Return a table of settings: mean CPU time of a packing [s], difference from `wide_quota` with its error."""
    table = pd.read_csv(REFERENCE / "wide_cost.csv").query("case == @case")
    seconds = table.groupby("settings")["cpu_s"].mean()
    rows = {"wide_quota": (seconds["wide_quota"], 0.0, 0.0)}
    for row in pd.concat([paired(table), compare_means(table)]).query("settings in @LABELS").itertuples():
        rows[row.settings] = seconds["wide_quota"] * row.cost, row.difference, row.error
    # Packings with the settings of Rettinger et al. have the grains of `wide_random`.
    differences = compare_r22(table, pd.read_csv(REFERENCE / "difference_wide.csv"))
    cpu_s, difference, error = rows["wide_random"]
    rows[R22] = (
        cpu_s / differences["cost"].mean(),
        difference - differences["difference"].mean(),
        np.hypot(error, differences["difference"].sem()),
    )
    return pd.DataFrame.from_dict(rows, orient="index", columns=["cpu_s", "difference", "error"])


def wide_cost():
    """Draw the difference in porosity over the CPU time of a packing of U5, for each setting."""
    figure = Figure(figsize=(7.5, 4.6), layout="constrained")
    axes = figure.subplots()
    axes.axhspan(-LARGEST_DIFFERENCE, LARGEST_DIFFERENCE, color="#e4ecf2", lw=0)
    axes.axhline(0.0, color=DARK, lw=0.8)
    for name, row in settings_of().iterrows():
        colour = ORANGE if name == "wide_both" else DARK
        axes.errorbar(row.cpu_s, row.difference, np.nan_to_num(row.error), fmt="o", color=colour, capsize=3)
        axes.annotate(LABELS[name], (row.cpu_s, row.difference), PLACES.get(name, (7, 5)), color=colour, fontsize=9,
                      textcoords="offset points")  # fmt: skip
    axes.set(xlabel="CPU time of a packing of U5, 1.4 kg [s]", ylabel="porosity minus that of the reference")
    axes.set(xlim=(200, 950), ylim=(-0.007, None))
    return figure


FIGURES = {"explanation/wide_cost.png": wide_cost}

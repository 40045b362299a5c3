"""Draw the README's picture of the model: porosity of one sieve class against the form of its grains.

python -m benchmarks.studies.form_picture docs/porosity_over_form.png
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from simcore.paths import REFERENCE
from simcore.reference.committed_rows import read_single_forms
from simcore.report.figures.saving import save_figure

SOURCES = {"synthetic": ("63 synthetic pebbles", "o", "#20313b"), "scans": ("63 scanned grains", "s", "#b3541e")}


def form_picture(packings: pd.DataFrame, r22_models: pd.DataFrame) -> Figure:
    """Draw the mean porosity of each grain over its L/S, and the line of Rettinger et al. at the mean L/I.

    packings: columns source, grain, L, I, S, n of one sieve class. r22_models: results/reference/r22/models.csv.
    """
    means = packings.groupby(["source", "grain"], as_index=False)[["L", "I", "S", "n"]].mean()
    figure = Figure(figsize=(5.2, 5.4), layout="constrained")
    axes = figure.subplots()
    for source, (label, marker, color) in SOURCES.items():
        rows = means[means.source == source]
        axes.plot(rows.L / rows.S, rows.n, marker, color=color, ms=5.5, mec="white", mew=0.5, label=label)
    model = r22_models.query("model == 'single_form' and case == 'U1'").iloc[0]
    line = np.array([(means.L / means.S).min(), (means.L / means.S).max()])
    n = model["intercept"] + model["EQ_inv"] * line + model["EL_inv"] * (means.L / means.I).mean()
    axes.plot(line, n, "--", color="0.45", lw=1.8, label="formula of Rettinger et al. (2022)")
    axes.set_xlabel("longest over shortest axis of the grains, L/S")
    axes.set_ylabel("porosity of the bed")
    axes.legend(frameon=False, loc="upper left")
    return figure


def main(arguments=None) -> int:
    """Draw the picture from the committed rows and return 0."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path, metavar="OUT.png", help="picture to write")
    options = parser.parse_args(arguments)
    packings = read_single_forms(REFERENCE / "single_form.csv", cases=["U1"])
    save_figure(form_picture(packings, pd.read_csv(REFERENCE / "r22" / "models.csv")), options.output)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

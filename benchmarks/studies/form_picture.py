"""Draw the README's picture of the model: porosity of one sieve class against the form of its grains.

python -m benchmarks.studies.form_picture docs/porosity_over_form.png
"""

import argparse
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from simcore.paths import REFERENCE
from simcore.reference.committed_rows import read_single_forms
from simcore.reference.r22_tables import R22Model, read_r22_models
from simcore.report.figures.saving import save_figure

SOURCES = {"synthetic": ("63 synthetic pebbles", "o", "#20313b"), "scans": ("63 scanned grains", "s", "#b3541e")}


def form_picture(packings: pd.DataFrame, model: R22Model) -> Figure:
    """Draw the mean porosity of each grain over its L/S, and the line of Rettinger et al. at the mean L/I.

    packings: columns source, grain, L, I, S, n of one sieve class. model: of beds of one form of this class.
    """
    means = packings.groupby(["source", "grain"], as_index=False)[["L", "I", "S", "n"]].mean()
    figure = Figure(figsize=(5.2, 5.4), layout="constrained")
    axes = figure.subplots()
    for source, (label, marker, color) in SOURCES.items():
        rows = means[means.source == source]
        axes.plot(rows.L / rows.S, rows.n, marker, color=color, ms=5.5, mec="white", mew=0.5, label=label)
    inverse_equancy, inverse_elongation = means.L / means.S, means.L / means.I
    ends = pd.DataFrame({"EQ_inv": [inverse_equancy.min(), inverse_equancy.max()], "EL_inv": inverse_elongation.mean()})
    axes.plot(
        ends["EQ_inv"], model.porosity(ends), "--", color="0.45", lw=1.8, label="formula of Rettinger et al. (2022)"
    )
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
    save_figure(form_picture(packings, read_r22_models()["single_form", "U1"]), options.output)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

"""Porosity over height: how far floor and surface affect a shaken bed in a periodic box.

    python -m benchmarks.studies.height results/inserted_above_bed/porosity/single_form ... > height.csv

It prints one CSV row per folder of evaluations, end of the bed and distance from it in mean grains: the porosity of
that layer minus that of the middle, as a mean over the beds with its standard error. The middle begins MIDDLE grains
from both ends. Beds whose middle is lower than LEAST_MIDDLE grains are left out.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

MIDDLE, LEAST_MIDDLE = 6.0, 2.0  # in mean grains: distance of the middle from either end, least height
DEEPEST = 8  # layers, a mean grain high, from either end


def profile_of(evaluation):
    """Return rows (end, grains_from_it, difference) of a bed; None if it is too low.

    evaluation: Dataset of simcore.evaluation.evaluate.
    """
    grain = float(evaluation["D_mean"].mean())
    top = float(evaluation["bed_top"])
    height = evaluation["z"].values
    n = evaluation["profile_exact"].values
    middle = (height > MIDDLE * grain) & (height < top - MIDDLE * grain)
    if top < (2.0 * MIDDLE + LEAST_MIDDLE) * grain:
        return None
    rows = []
    for end, distance in (("floor", height), ("surface", top - height)):
        layer = np.floor(distance / grain)
        rows += [
            {"end": end, "grains_from_it": k, "difference": n[layer == k].mean() - n[middle].mean()}
            for k in range(DEEPEST)
        ]
    return pd.DataFrame(rows)


def table(folder):
    """Return the means over the evaluations in a folder; ValueError if no bed there is high enough."""
    beds = []
    for path in sorted(Path(folder).glob("*.nc")):
        with xr.open_dataset(path) as evaluation:
            beds.append(profile_of(evaluation))
    beds = [bed for bed in beds if bed is not None]
    if not beds:
        raise ValueError(f"{folder} has no evaluation of a bed that is {2.0 * MIDDLE + LEAST_MIDDLE:g} grains high")
    layers = pd.concat(beds).groupby(["end", "grains_from_it"])["difference"]
    means = layers.agg(beds="size", difference="mean", std_error="sem").reset_index()
    return means.assign(study=Path(folder).name)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", metavar="FOLDER", help="of evaluations, results/NAME/porosity/STUDY")
    options = parser.parse_args(arguments)
    columns = ["study", "end", "grains_from_it", "beds", "difference", "std_error"]
    try:
        rows = pd.concat([table(folder) for folder in options.folders])
    except ValueError as error:
        parser.exit(2, f"height: {error}\n")
    rows[columns].to_csv(sys.stdout, index=False, float_format="%.5f")


if __name__ == "__main__":
    main()

"""Porosity over height: how far from floor and surface a shaken bed in a periodic box is not as it is in its middle.

    python -m benchmarks.studies.height results/workstation/porosity/single_form ... > results/reference/height.csv

One CSV row a folder of evaluations, end of the bed and distance from it in mean grains: mean over the beds of the
porosity of that layer less that of the middle, which begins MIDDLE grains from both ends, with its standard error over
the beds. Beds without so much of a middle are left out.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

MIDDLE, LEAST_MIDDLE = 6.0, 2.0  # mean grains: distance of the middle from either end, its least height
DEEPEST = 8  # layers, a mean grain high, from either end


def profile_of(evaluation):
    """Rows (end, distance, difference) of a bed; None if it is too low.

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
    """Means over the evaluations in a folder, as the module says."""
    beds = []
    for path in sorted(Path(folder).glob("*.nc")):
        with xr.open_dataset(path) as evaluation:
            beds.append(profile_of(evaluation))
    beds = [bed for bed in beds if bed is not None]
    if not beds:
        raise ValueError(f"{folder}: holds no evaluation of a bed of {2.0 * MIDDLE + LEAST_MIDDLE:g} grains' height")
    layers = pd.concat(beds).groupby(["end", "grains_from_it"])["difference"]
    found = layers.agg(beds="size", difference="mean", std_error="sem").reset_index()
    return found.assign(study=Path(folder).name)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", metavar="FOLDER", help="of evaluations, results/NAME/porosity/STUDY")
    options = parser.parse_args(arguments)
    columns = ["study", "end", "grains_from_it", "beds", "difference", "std_error"]
    try:
        found = pd.concat([table(folder) for folder in options.folders])
    except ValueError as error:
        parser.exit(2, f"height: {error}\n")
    found[columns].to_csv(sys.stdout, index=False, float_format="%.5f")


if __name__ == "__main__":
    main()

"""Effect of the size of a bed on its porosity: single forms in periodic boxes of several widths and depths.

    python -m benchmarks.studies.bed_size results/bed_size/packings/*/*.nc > results/reference/bed_size.csv

It prints one CSV row per packing, evaluated by the current rule. Packings that differ in more than form, size and seed
are refused.
"""

import argparse
import json
import re
import sys

import pandas as pd

from simcore.evaluation.porosity import bulk_porosity
from simcore.packing.file import read_packing

COLUMNS = ["case", "grain", "width_mm", "grains", "seed", "n", "n_error", "cpu_s"]
# Settings in which the beds may differ, or that have no effect on them, such as the source of their grains.
FREE = {"name", "seed", "domain", "amount", "grains"}


def row_of(packing):
    """Return (row, settings): the row of a packing, and, as text, the settings that all packings must share."""
    scene = json.loads(packing.attrs["scene"])
    if scene["domain"]["type"] != "periodic":
        raise ValueError(f"{scene['name']}: is in a {scene['domain']['type']}; only periodic boxes are compared")
    bulk = bulk_porosity(packing)
    row = {
        "case": scene["sizes"]["case"],
        "grain": scene["shapes"].pop("grain"),
        "width_mm": 1e3 * scene["domain"]["width"],
        "grains": packing.sizes["grain"],
        "seed": scene["seed"],
        "n": float(bulk.n),
        "n_error": float(bulk.n_std_error),
        "cpu_s": float(packing.attrs["cpu_seconds"]),
    }
    scene["numerics"].pop("progress_interval")
    # A campaign decimates its grains once, and then packs them as they are.
    decimated = re.search(r"faces_(\d+)\.nc$", scene["grains"]["source"])
    if decimated and scene["faces"] == "original":
        scene["faces"] = int(decimated[1])
    return row, json.dumps({key: value for key, value in scene.items() if key not in FREE}, sort_keys=True)


def table(paths):
    """Return the rows of all packings; ValueError if two are not comparable."""
    rows, shared = [], None
    for path in paths:
        packing = read_packing(path)
        row, settings = row_of(packing)
        packing.close()
        shared = shared or settings
        if settings != shared:
            raise ValueError(f"{path}: is of other settings than {paths[0]}: {settings} and {shared}")
        rows.append(row)
    return pd.DataFrame(rows, columns=COLUMNS).sort_values(COLUMNS[:5])


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packings", nargs="+", metavar="PACKING.nc")
    options = parser.parse_args(arguments)
    try:
        rows = table(options.packings)
    except ValueError as error:
        parser.exit(2, f"bed_size: {error}\n")
    rows.round({"n": 6, "n_error": 6, "width_mm": 3, "cpu_s": 1}).to_csv(sys.stdout, index=False)


if __name__ == "__main__":
    main()

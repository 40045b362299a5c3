"""What the size of a bed does to its porosity: single forms in periodic boxes of several widths and depths.

    python -m benchmarks.studies.bed_size results/*/packings/single_form/*.nc ... > results/reference/bed_size.csv

One CSV row a packing, by today's rule of evaluation. Packings that differ in more than form, size and seed are refused.
"""

import argparse
import json
import re
import sys

import pandas as pd

from simcore.evaluation.porosity import bulk_porosity
from simcore.packing.file import read_packing

COLUMNS = ["case", "grain", "width_mm", "grains", "seed", "n", "n_error", "cpu_s"]
# What the beds may differ in, or does not matter to them, such as where their grains were read.
FREE = {"name", "seed", "domain", "amount", "grains"}


def row_of(packing):
    """(row, settings): what the table has of a packing, and all that it must share with the others, as text."""
    scene = json.loads(packing.attrs["scene"])
    if scene["domain"]["type"] != "periodic":
        raise ValueError(f"{scene['name']}: stands in a {scene['domain']['type']}; periodic boxes are compared")
    found = bulk_porosity(packing)
    row = {
        "case": scene["sizes"]["case"],
        "grain": scene["shapes"].pop("grain"),
        "width_mm": 1e3 * scene["domain"]["width"],
        "grains": packing.sizes["grain"],
        "seed": scene["seed"],
        "n": float(found.n),
        "n_error": float(found.n_std_error),
        "cpu_s": float(packing.attrs["cpu_seconds"]),
    }
    scene["numerics"].pop("progress_interval")
    # A campaign decimates its grains once, and then packs them as they are.
    decimated = re.search(r"faces_(\d+)\.nc$", scene["grains"]["source"])
    if decimated and scene["faces"] == "original":
        scene["faces"] = int(decimated[1])
    return row, json.dumps({key: value for key, value in scene.items() if key not in FREE}, sort_keys=True)


def table(paths):
    """The rows of all packings; ValueError where two are not comparable."""
    rows, first = [], None
    for path in paths:
        packing = read_packing(path)
        row, settings = row_of(packing)
        packing.close()
        first = first or settings
        if settings != first:
            raise ValueError(f"{path}: is of other settings than {paths[0]}: {settings} and {first}")
        rows.append(row)
    return pd.DataFrame(rows, columns=COLUMNS).sort_values(COLUMNS[:5])


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packings", nargs="+", metavar="PACKING.nc")
    options = parser.parse_args(arguments)
    try:
        found = table(options.packings)
    except ValueError as error:
        parser.exit(2, f"bed_size: {error}\n")
    found.round({"n": 6, "n_error": 6, "width_mm": 3, "cpu_s": 1}).to_csv(sys.stdout, index=False)


if __name__ == "__main__":
    main()

"""How the rate of insertion, the time of shaking and the size of the grains change porosity, from beds on lattices.

    python -m benchmarks.studies.insertion_rate

It prints the bases of lattice_beds.csv, base_time.csv, base_rate.csv and base_size.csv in results/reference with their
rates of insertion, and the slopes of the one-class porosity on the logarithms of the three quantities. A second table
compares beds that were packed on a lattice and as a rain (size_and_form.csv): porosity by both, and their difference
relative to one class of the same form, which would be 0 if a sieve curve had the same effect in both. Seconds.
"""

import numpy as np
import pandas as pd

from benchmarks.studies.size_and_form_fit import describe_bases, read_rows
from simcore.models.size_and_form.bases import RATE, process_logs
from simcore.models.size_and_form.beds import BASE, form_labels
from simcore.paths import CONFIG

CONFIGURATION = CONFIG / "insertion_rate.yaml"
LATTICE, OTHER_BASES = "lattice_beds", ("base_time", "base_rate", "base_size")


def bases():
    """Return the rows of all bases on lattices."""
    rows = [read_rows(name, CONFIGURATION) for name in (LATTICE, *OTHER_BASES)]
    rows[0] = rows[0][rows[0]["case"] == BASE]
    return pd.concat(rows, ignore_index=True)


def bases_table():
    """Return one row per base on a lattice: case, form, spacing, rate in kg/(m² s), time_s, n, n_error."""
    rows = bases()
    rows = rows.assign(form=form_labels(rows), rate=np.exp(process_logs(rows)[RATE]))
    return rows[["case", "form", "spacing", "rate", "time_s", "n", "n_error"]].sort_values(["form", "rate"])


def paired_beds():
    """Return one row per bed that was packed by both processes: case, form, n, n_error and rate of each, difference.

    difference: n of the rain less that of the lattice, less the same for one class of the form. Rates in kg/(m² s).
    """
    tables = {}
    for name, rows in (("lattice", read_rows(LATTICE, CONFIGURATION)), ("rain", read_rows())):
        rows = rows.assign(form=form_labels(rows), rate=np.exp(process_logs(rows)[RATE]))
        tables[name] = rows.set_index(["case", "form", "seed"])[["n", "n_error", "rate"]]
    pairs = tables["lattice"].join(tables["rain"], lsuffix="_lattice", rsuffix="_rain", how="inner").reset_index()
    change = pairs["n_rain"] - pairs["n_lattice"]
    of_bases = dict(zip(pairs["form"][pairs["case"] == BASE], change[pairs["case"] == BASE], strict=True))
    return pairs.assign(difference=change - pairs["form"].map(of_bases))


def main() -> None:
    """Print both tables."""
    print(bases_table().to_string(index=False, float_format="%.4g"))
    print(describe_bases(bases()))
    print(paired_beds().to_string(index=False, float_format="%.4f"))


if __name__ == "__main__":
    main()

"""Read the committed rows of packings with the columns that the porosity models need."""

import pandas as pd

from simcore.reference.columns import FORM, study_names

_STATISTICS = ["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]


def read_single_forms(path):
    """Read the packings of polyhedra of one form each from a CSV file: one row per packing.

    Columns: case, source ("" if the file has none), grain (with its source), L, I, S (full axes, any one unit) and n,
    the porosity. The file is one of the committed tables or the table of a study.
    """
    table = pd.read_csv(path)
    if "representation" in table:
        table = table[table.representation == "polyhedron"]
    if "source" not in table:
        table = table.assign(source="")
    table = table.assign(grain=table.source + " " + table.grain)
    if not {"L", "I", "S"} <= set(table):
        table = table.assign(L=1 / table.EL, I=1.0, S=table.FL)
    return table[["case", "source", "grain", "L", "I", "S", "n"]]


def read_mixtures(path):
    """Read the packings of grains with a distribution of form from a CSV file: one row per packing.

    Columns: case, sample (the same for packings that differ only in their seed), n, mean_FL and mean_EL of the
    specification, and the statistics mu_EQ, sigma_EQ, mu_EL, sigma_EL over the grains.
    """
    table = pd.read_csv(path)
    if "mu_EQ" not in table:
        table = table.rename(columns={name: FORM[name] for name in ("EQ", "EL")})
    asked_for = ["mean_FL", "std_FL", "mean_EL", "std_EL"]
    table = table.rename(columns=study_names(*asked_for))
    sample = table[asked_for].astype(str).agg(" ".join, axis=1)
    return table.assign(sample=sample)[["case", "sample", "n", "mean_FL", "mean_EL", *_STATISTICS]]


def read_cases_of_single_forms(path, cases):
    """Read the rows of these cases as `read_single_forms` does; an empty table without a path."""
    if not path:
        return pd.DataFrame()
    table = read_single_forms(path)
    return table[table.case.isin(cases)]

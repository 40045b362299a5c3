"""Select the rows of packings to which the porosity models are fitted, and read them from committed tables.

`fitted_forms` and `fitted_mixtures` are the only rule of which rows these are. Uses differ in the source of the grains:

    python -m simcore predict         all sources together, or the one of --source
    report of the committed rows      each source by itself; for mixtures and the unified model SOURCE_OF_MIXTURES
    models of a campaign              all sources together, only the cases that the campaign does not pack itself
    benchmarks.studies.extrapolation  all sources together
"""

import pandas as pd

from simcore.reference.columns import FORM, SPECIFIED_FORM, SPECIFIED_MEANS, study_names
from simcore.reference.named_tables import read_named_table

FITTED_KIND = "polyhedron"  # real grains have facets, so ellipsoids are not fitted
SOURCE_OF_MIXTURES = "synthetic"  # mixtures are drawn around synthetic grains; their table has no column for it
_STATISTICS = ["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]


def fitted_forms(packings, source=None, cases=None):
    """Return the packings of one form each that the models are fitted to: those of polyhedra.

    packings: DataFrame with one row per packing; a table without the column kind (representation in committed tables)
    has only polyhedra. source: source of the grains, in the column source; None: all sources together. cases: cases of
    which packings are returned; None: all.
    """
    fitted = pd.Series(True, index=packings.index)
    for name in {"kind", *study_names("kind")} & set(packings):
        fitted &= packings[name] == FITTED_KIND
    if source is not None:
        fitted &= packings["source"] == source
    if cases is not None:
        fitted &= packings["case"].isin(cases)
    return packings[fitted]


def fitted_mixtures(packings):
    """Return the packings with a distribution of form that the models are fitted to: all of them.

    packings: DataFrame with one row per packing, columns case, n, the specified mean_FL, std_FL, mean_EL and std_EL,
    and mu_EQ (or EQ), sigma_EQ, mu_EL (or EL), sigma_EL over the grains. Columns of the result: case, sample (the same
    for packings that differ only in their seed), n, mean_FL, mean_EL, mu_EQ, sigma_EQ, mu_EL and sigma_EL.
    """
    if "mu_EQ" not in packings:
        packings = packings.rename(columns={name: FORM[name] for name in ("EQ", "EL")})
    sample = packings[list(SPECIFIED_FORM)].astype(str).agg(" ".join, axis=1)
    return packings.assign(sample=sample)[["case", "sample", "n", *SPECIFIED_MEANS, *_STATISTICS]]


def read_single_forms(path, source=None, cases=None):
    """Read the packings of one form that the models are fitted to from a CSV file: one row per packing.

    Columns: case, source ("" if the file has none), grain (with its source), L, I, S (full axes, any one unit) and n,
    the porosity. The file is one of the committed tables or the table of a study. source, cases: as in `fitted_forms`.
    """
    table = read_named_table(path)
    if "source" not in table:
        table = table.assign(source="")
    table = fitted_forms(table, source, cases)
    table = table.assign(grain=table.source + " " + table.grain)
    if not {"L", "I", "S"} <= set(table):
        table = table.assign(L=1 / table.EL, I=1.0, S=table.FL)
    return table[["case", "source", "grain", "L", "I", "S", "n"]]


def read_mixtures(path):
    """Read the packings with a distribution of form from a CSV file, with the columns of `fitted_mixtures`.

    The file is one of the committed tables or the table of a study.
    """
    return fitted_mixtures(read_named_table(path).rename(columns=study_names(*SPECIFIED_FORM)))


def read_cases_of_single_forms(path, cases):
    """Read the rows of these cases as `read_single_forms` does; an empty table without a path."""
    return read_single_forms(path, cases=cases) if path else pd.DataFrame()

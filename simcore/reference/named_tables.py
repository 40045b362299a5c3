"""Reads CSV tables that have names which a user chooses: of studies, packings, sieve curves and grains."""

import pandas as pd

NAMES = ("study", "packing", "case", "grain", "source", "sample")  # columns with such names


def read_named_table(path, *, text=()):
    """Read a table. Names are text: a grain may be named 007, 1e5 or NA. text: further columns that are text."""
    return pd.read_csv(path, dtype=dict.fromkeys([*NAMES, *text], str), keep_default_na=False, na_values=[""])

"""Scatter of the porosity over seeds beside the sampling errors that the packings state, by the draw of sizes.

    python -m benchmarks.studies.scatter

It reads results/reference/wide_random.csv and wide_quota.csv and applies the rule that config/wide.yaml states. A line
is one sieve curve and draw: the number of seeds, the mean porosity, the standard deviation over the seeds with its 95 %
confidence limits, the root mean square of the stated errors, chi-squared of the scatter over the stated errors with its
95 % limits, and the ratio of the variances by quota and by random draw with the lower 5 % limit of the F distribution.
"""

import argparse

import numpy as np
import pandas as pd
from scipy.stats import chi2, f

from simcore.paths import REFERENCE

CONFIDENCE = 0.95
BETTER = 0.05  # a ratio of variances below this quantile of the F distribution is less scatter
DRAWS = {"random": "wide_random.csv", "quota": "wide_quota.csv"}


def scatter(rows: pd.DataFrame) -> dict:
    """Scatter of the packings of one sieve curve and draw.

    rows: columns n and n_error, one row a seed, at least two.
    """
    n, freedom = rows["n"].to_numpy(), len(rows) - 1
    low, high = chi2.ppf([0.5 * (1 - CONFIDENCE), 0.5 * (1 + CONFIDENCE)], freedom)
    variance, stated = n.var(ddof=1), np.mean(rows["n_error"] ** 2)
    return {
        "seeds": len(rows),
        "n": n.mean(),
        "std": np.sqrt(variance),
        "std_lower": np.sqrt(variance * freedom / high),
        "std_upper": np.sqrt(variance * freedom / low),
        "stated": np.sqrt(stated),
        "chi2": freedom * variance / stated,
        "chi2_lower": low,
        "chi2_upper": high,
    }


def scatter_table(tables: dict) -> pd.DataFrame:
    """One row a sieve curve and draw that has two packings or more; tables: DataFrame of rows by draw."""
    rows = [
        {"case": case, "draw": draw, **scatter(group)}
        for draw, table in tables.items()
        for case, group in table.groupby("case", sort=False)
        if len(group) > 1
    ]
    table = pd.DataFrame(rows)
    variance = table["std"] ** 2
    for case, group in table.groupby("case"):
        if set(group["draw"]) == set(DRAWS):
            of = {row.draw: row for row in group.itertuples()}
            quota = (table["case"] == case) & (table["draw"] == "quota")
            table.loc[quota, "variance_ratio"] = variance[of["quota"].Index] / variance[of["random"].Index]
            table.loc[quota, "limit"] = f.ppf(BETTER, of["quota"].seeds - 1, of["random"].seeds - 1)
    return table


def main(arguments=None) -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args(arguments)
    tables = {draw: pd.read_csv(REFERENCE / name) for draw, name in DRAWS.items() if (REFERENCE / name).exists()}
    print(scatter_table(tables).to_string(index=False, float_format="%.4f", na_rep=""))


if __name__ == "__main__":
    main()

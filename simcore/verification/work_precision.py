"""Error against run time: evaluation of tables of runs with several settings.

A table has one row per run: columns case, quantity, method, setting, default (bool), repeat, error, cpu_s [s],
reference_error (error of the reference solution, in the unit of error) and, if the error itself is uncertain,
error_std. The value of a setting is the median over its repeats.
"""

import numpy as np
import pandas as pd

KEYS = ["case", "quantity", "method", "setting"]
COLUMNS = [*KEYS, "default", "repeat", "error", "cpu_s", "reference_error"]


def settings_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return one row per setting, in the order of `runs`: medians of cpu_s and error, cpu_least, cpu_most, on_front.

    on_front: no other setting of the same case and quantity is as good in both error and CPU time and better in one.
    An error below that of the reference counts as equal to it, as it cannot be resolved. ValueError if a column is
    missing.
    """
    missing = [name for name in COLUMNS if name not in runs]
    if missing:
        raise ValueError(
            f"work-precision table: columns {', '.join(missing)} are missing; it needs the columns {', '.join(COLUMNS)}"
        )
    extra = {"error_std": ("error_std", "median")} if "error_std" in runs else {}
    table = runs.groupby(KEYS, sort=False, as_index=False).agg(
        default=("default", "first"),
        error=("error", "median"),
        cpu_s=("cpu_s", "median"),
        cpu_least=("cpu_s", "min"),
        cpu_most=("cpu_s", "max"),
        reference_error=("reference_error", "max"),
        **extra,
    )
    table["on_front"] = False
    for _, rows in table.groupby(["case", "quantity"], sort=False):
        resolved = np.maximum(rows["error"], rows["reference_error"])
        table.loc[rows.index, "on_front"] = pareto_front(rows["cpu_s"].to_numpy(), resolved.to_numpy())
    return table


def pareto_front(cost, error) -> np.ndarray:
    """Return whether no other point is as good in both cost and error and better in one, (n,) bool; False for nan."""
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    as_good = (cost[:, None] <= cost) & (error[:, None] <= error)
    better = (cost[:, None] < cost) | (error[:, None] < error)
    return ~(as_good & better).any(axis=0) & np.isfinite(cost) & np.isfinite(error)


def observed_order(setting, error) -> np.ndarray:
    """Return the orders of convergence (n - 1,) between successive settings, which are numbers of steps."""
    setting, error = np.asarray(setting, float), np.asarray(error, float)
    return np.log(error[:-1] / error[1:]) / np.log(setting[1:] / setting[:-1])

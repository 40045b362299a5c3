"""Table of the verification cases: measured values and expected bands."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from simcore.verification.outside.cases import CASES, Case
from simcore.verification.outside.measures import MEASURES
from simcore.verification.outside.packings import PACKINGS

EACH_SEED = ("energy_ratio",)  # largest deviations of either sign, which would cancel in a mean


def case_table(read: Callable, cases: list[Case] = CASES) -> pd.DataFrame:
    """Return one row per case, in their order.

    read(run) returns the Dataset of the run of that name, such as "column_1.5_seed2". Columns: name, quantity, seeds,
    measured (mean over seeds), std_error (of that mean), low, high, inside, cpu_s [s] (of all runs of the row), source.
    A measure of EACH_SEED must be inside with each seed.
    """
    return pd.DataFrame([_row(case, read) for case in cases])


def _row(case, read):
    means, variances, judged, cpu = [], [], [], 0.0
    for name in case.packings:
        runs = [read(f"{name}_seed{seed}") for seed in PACKINGS[name].seeds]
        values = np.array([MEASURES[case.measure](run, **case.options) for run in runs])
        means.append(values.mean())
        judged += list(values) if case.measure in EACH_SEED else []
        variances.append(values.var(ddof=1) / len(values))
        cpu += sum(float(run.attrs["cpu_seconds"]) for run in runs)
    measured = means[0] - sum(means[1:])
    return {
        "name": case.name,
        "quantity": case.quantity,
        "seeds": len(PACKINGS[case.packings[0]].seeds),
        "measured": measured,
        "std_error": np.sqrt(sum(variances)),
        "low": case.low,
        "high": case.high,
        "inside": all(case.low <= value <= case.high for value in (measured, *judged)),
        "cpu_s": cpu,
        "source": case.source,
    }

"""One-class porosities from the bases: packed beds of one sieve class, with the effect of how they were packed.

The porosity of a base depends on its form, and on the process. A bed that is shaken longer or inserted more slowly is
denser, and shaking with one amplitude acts less on large grains. The bases of all forms give one constant for each form
and common slopes on the logarithms of three quantities:

    time  [s]          whole time of shaking, from the first grain on
    rate  [kg/(m² s)]  mass per area of the box and time, until the last grain has fallen
    size  [m]          geometric mean of the sieve size, by volume

docs/appendices/size_and_form_plan.md has the rule by which a slope is left out.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.reference.share_columns import realised_curve

TIME, RATE, SIZE = "time", "rate", "size"
PROCESS = (TIME, RATE, SIZE)
LEAST_RATIO = 2.0  # of a slope to its standard error


class Bases(NamedTuple):
    """The one-class porosity as a function of form and process."""

    constants: dict  # form -> porosity at `mean`
    slopes: dict  # of PROCESS -> slope on the logarithm; those that are left out are missing
    std_errors: dict  # of the slopes
    mean: dict  # of PROCESS -> mean logarithm over the bases

    def effect(self, rows) -> np.ndarray:
        """Return by how much the process of each row (n,) changes its one-class porosity."""
        if not self.slopes or rows.empty:
            return np.zeros(len(rows))
        logs, names = process_logs(rows), list(self.slopes)
        return (logs[names] - pd.Series(self.mean)[names]).to_numpy() @ np.array(list(self.slopes.values()))


def process_logs(rows) -> pd.DataFrame:
    """Return the logarithms of PROCESS of each row; rows: with time_s, after_s, fall_s, mass_kg, width_m, share_A-Bmm.

    after_s [s]: time of shaking after the last grain was inserted. fall_s [s]: time of the fall of a grain from the top
    of the box.
    """
    inserted = rows["time_s"] - rows["after_s"] + rows["fall_s"]
    curves = [realised_curve(row, "") for _, row in rows.iterrows()]
    sizes = [curve.mass_fractions @ (0.5 * np.log(curve.bounds[1:] * curve.bounds[:-1])) for curve in curves]
    rate = rows["mass_kg"] / (rows["width_m"] ** 2 * inserted)
    return pd.DataFrame({TIME: np.log(rows["time_s"]), RATE: np.log(rate), SIZE: sizes}, rows.index)


def fit_bases(rows, process=PROCESS) -> Bases:
    """Fit constants and slopes to bases; rows: as for process_logs, with form, n and n_error.

    process: those of PROCESS whose slopes are tried. A slope below LEAST_RATIO standard errors is left out, the one
    with the smallest ratio first; so is a quantity that varies within no form, and those that vary least if there are
    too few bases for all.
    """
    rows = rows.reset_index(drop=True)
    forms = pd.get_dummies(rows["form"], dtype=float)
    logs = process_logs(rows) if process else pd.DataFrame(index=rows.index)
    mean = logs.mean()
    logs = logs - mean
    within = logs - logs.groupby(rows["form"]).transform("mean") if process else logs
    kept = [name for name in process if within[name].abs().max() > 1e-9]
    # One degree of freedom must remain; the quantities that vary least cannot be separated from the others.
    kept = sorted(kept, key=lambda name: -within[name].std())[: max(len(rows) - forms.shape[1] - 1, 0)]
    while kept:
        result = _weighted_fit(rows, pd.concat([forms, logs[kept]], axis=1))
        ratios = (result.params[kept] / _std_errors(result)[kept]).abs()
        if ratios.min() >= LEAST_RATIO:
            break
        kept.remove(ratios.idxmin())
    result = _weighted_fit(rows, pd.concat([forms, logs[kept]], axis=1))
    errors = _std_errors(result)[kept].to_dict() if kept else {}
    return Bases(result.params[list(forms)].to_dict(), result.params[kept].to_dict(), errors, mean.to_dict())


def _weighted_fit(rows, columns):
    # Imported here because it loads slowly and a prediction needs no fit.
    from statsmodels.regression.linear_model import WLS

    return WLS(rows["n"], columns, weights=rows["n_error"] ** -2.0).fit()


def _std_errors(result):
    """Return the standard errors of a fit: those of the sampling errors, larger if the residuals are larger."""
    return result.bse / np.sqrt(min(result.scale, 1.0))

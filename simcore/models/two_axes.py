"""Range of the porosity of grains of which only two axes are measured, over plausible third axes.

A photo taken from above shows the longest and the middle axis, so that elongation EL = I/L is known and flatness FL =
S/I is not. No porosity is predicted then. The models are evaluated with the flatness, mean and deviation, of each
sample of Table 2 of Rettinger et al. (2022), and the range of the results is given.
# ASSUME: FL and EL are independent, as Rettinger et al. assume.
"""

import json

import numpy as np
import pandas as pd

from simcore.grains.measured_forms import Sample
from simcore.grains.statistics import equancy_statistics
from simcore.grains.text_columns import text_columns
from simcore.models.measured_text_parts import records
from simcore.models.prediction import NO_MODEL, model_case, predict_samples, remedy_without_model
from simcore.paths import R22_TABLES
from simcore.reference.r22_tables import read_r22_table

WITHOUT_FEW_GRAINS = "The intervals do not contain the error of measuring few grains"
RANGE = ["sample", "grains", "mu_EL", "sigma_EL", "n_low", "n_high", "lower", "upper", "flatness_low", "flatness_high"]
RANGE += ["refused"]


def predict_two_axes(samples, case, fitted, level=0.95, r22_tables=R22_TABLES):
    """Return the range of the porosity of each sample, DataFrame with the columns RANGE, one row per TwoAxisSample.

    case, fitted, level: as in predict_samples. n_low, n_high: smallest and largest porosity over the flatness of the
    samples of Table 2, by the preferred of our models, or by that of Rettinger et al. if we have none. lower, upper:
    outer ends of the prediction intervals, nan for the model of Rettinger et al. flatness_low, flatness_high: range of
    the mean flatness for which a model was evaluated. refused: why no model is evaluated at any flatness, "" otherwise;
    the six numbers are nan then. ValueError if there is no model for the case, or if none is evaluated for any sample.
    """
    forms = read_r22_table("table2_form_statistics", r22_tables)
    rows = []
    for sample in samples:
        assumed = [_assume(sample, form.mu_FL, form.sigma_FL, i) for i, form in enumerate(forms.itertuples())]
        predicted = predict_samples(assumed, case, fitted, level, r22_tables, require=False)
        best = predicted[predicted.n.notna()].sort_values("preferred", ascending=False, kind="stable")
        best = best.drop_duplicates("name")
        refused = predicted.refused[predicted.refused != ""].iloc[0] if best.empty else ""
        rows.append(
            [sample.name, sample.grains, sample.mu_EL, sample.sigma_EL, best.n.min(), best.n.max()]
            + [best.lower.min(skipna=False), best.upper.max(skipna=False), best.mu_FL.min(), best.mu_FL.max(), refused]
        )
    table = pd.DataFrame(rows, columns=RANGE)
    if (table.refused != "").all():
        reason, remedy = table.refused.iloc[0], "correct the axes, or measure all three"
        if reason.startswith(NO_MODEL):
            remedy = f"measure the third axis too, and {remedy_without_model(model_case(case))}"
        raise ValueError(
            f"case {case}, sample {table['sample'].iloc[0]}: no model can be evaluated at any flatness: {reason}; "
            f"{remedy}"
        )
    return table


def two_axes_text(table, case, notices=(), level=0.95, output="text"):
    """Return the result of predict_two_axes as text for people, or as "csv" or "json" if `output` is one of these."""
    if output == "csv":
        return table.to_csv(index=False).rstrip("\n")
    if output == "json":
        content = {"case": model_case(case), "level": level, "notices": list(notices), "samples": records(table)}
        return json.dumps(content, indent=1, allow_nan=False)
    low, high = table.flatness_low.min(), table.flatness_high.max()
    lines = [
        f"Range of the porosity of a bed, case {model_case(case)}; only two axes of the grains are measured",
        "Flatness FL = S/I is unknown, so that no single porosity can be predicted. The range is that over the",
        f"flatness of the samples in Table 2 of Rettinger et al. (2022), with mean FL from {low:.2f} to {high:.2f}.",
        "a and b, or the axes of an ellipse in a photo, are taken as L and I: the grains must lie flat.",
        "",
    ]
    cells = [["sample", "grains", "EL", "porosity", f"with {100 * level:g} % intervals", "FL"]]
    for row in table.itertuples():
        interval = f"{row.lower:.3f} to {row.upper:.3f}" if np.isfinite(row.lower) else "-"
        flatness = f"{row.flatness_low:.2f} to {row.flatness_high:.2f}"
        ranges = [f"{row.n_low:.3f} to {row.n_high:.3f}", interval, flatness]
        cells.append(
            [str(row.sample), str(row.grains), f"{row.mu_EL:.3f} ± {row.sigma_EL:.3f}"]
            + (["-"] * 3 if row.refused else ranges)
        )
    lines += text_columns(cells)
    refused = table[table.refused != ""]
    if len(refused):
        lines += ["", "- not evaluated at any flatness; correct the axes, or measure all three"]
        lines += [f"  {row.sample}: {row.refused}" for row in refused.itertuples()]
    lines += ["", "Measure the third axis of some of the grains to get a porosity instead of a range."]
    return "\n".join([*lines, f"{WITHOUT_FEW_GRAINS}."])


def _assume(sample, mu_FL, sigma_FL, number):
    """Return the Sample with the elongation of a TwoAxisSample and this flatness."""
    mu_EQ, sigma_EQ = equancy_statistics(mu_FL, sigma_FL, sample.mu_EL, sample.sigma_EL)
    statistics = (mu_FL, sigma_FL, sample.mu_EL, sample.sigma_EL, float(mu_EQ), float(sigma_EQ))
    return Sample(f"{sample.name}, flatness {number + 1}", sample.grains, *statistics)

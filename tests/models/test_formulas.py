"""Fitted models as formulas."""

import numpy as np
import pandas as pd

from simcore.models.formulas import formulas
from simcore.models.regression import fit_and_validate


def test_the_formula_is_that_of_the_fit():
    """The text of the formula, evaluated, gives the porosity that the model predicts, to the digits it shows."""
    rng = np.random.default_rng(1)
    features = pd.DataFrame({"EQ_inv": rng.uniform(1.2, 4.0, 30), "EL_inv": rng.uniform(1.0, 2.5, 30)})
    n = 0.27 + 0.02 * features["EQ_inv"] - 0.015 * features["EL_inv"] + rng.normal(0.0, 0.002, 30)
    model = fit_and_validate(features, n.to_numpy(), "single_form", "U1", seed=1)
    table = formulas(model.to_rows().assign(source="scans")).iloc[0]
    assert list(table[["beds", "case", "source", "samples", "r22"]]) == ["of one form", "U1", "scans", 30, None]
    text = (
        table["porosity"].removeprefix("n = ").replace("−", "-").replace("L/S", "* EQ_inv").replace("L/I", "* EL_inv")
    )
    np.testing.assert_allclose(features.eval(text), model.predict(features), atol=1e-3)
    assert table["error"] == model.mean_absolute_error
    assert table["range"] == ", ".join(
        f"{name} {features[key].min():.2g} to {features[key].max():.2g}"
        for name, key in (("L/S", "EQ_inv"), ("L/I", "EL_inv"))
    )


def test_r22_is_shown_and_auxiliary_columns_of_the_fit_are_not():
    rows = pd.DataFrame(
        {
            "model": ["form_mixture"] * 3 + ["single_form_EQ"],
            "case": "U1",
            "term": ["intercept", "mu_EQ_inv", "sigma_EL_inv", "intercept"],
            "coefficient": [0.2866, 0.0278, -0.00266, 0.28],
            "r22_coefficient": [0.287, 0.032, np.nan, np.nan],
            "feature_min": [np.nan, 1.6, 5.3, np.nan],
            "feature_max": [np.nan, 6.3, 10.3, np.nan],
            "mean_absolute_error": 0.006,
            "samples": 52,
        }
    )
    table = formulas(rows)
    assert list(table["porosity"]) == ["n = 0.287 + 0.0278 µ_EQ⁻¹ − 0.00266 σ_EL⁻¹"]
    assert list(table["r22"]) == ["n = 0.287 + 0.032 µ_EQ⁻¹"]
    assert list(table["source"]) == [None]

"""The published linear models of porosity: coefficients, features without a coefficient, and models that are absent."""

import numpy as np
import pandas as pd
import pytest

from simcore.reference.r22_tables import parse_r22_models, read_r22_models, rhine_statistics


def test_the_published_models_have_the_printed_coefficients():
    models = read_r22_models()
    assert {(name, case): model.equation for (name, case), model in models.items()} == {
        ("single_form", "U1"): "17",
        ("single_form", "U7"): "18",
        ("single_form", "B50"): "19",
        ("form_mixture", "U1"): "23",
        ("form_mixture", "U7"): "24",
    }
    assert models["single_form", "U1"].intercept == 0.278
    assert dict(models["single_form", "B50"].slopes) == {"EQ_inv": 0.014, "EL_inv": -0.006}
    # The published model of distributions in U1 has no sigma_EL.
    assert list(models["form_mixture", "U1"].slopes.index) == ["mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv"]


def test_the_porosity_is_linear_in_the_features_whatever_their_order_and_further_columns():
    beds = pd.DataFrame({"further": [np.nan, 7.0], "EL_inv": [1.0, 1.5], "EQ_inv": [1.0, 2.0]})
    predicted = read_r22_models()["single_form", "U1"].porosity(beds)
    np.testing.assert_allclose(predicted, [0.278 + 0.019 + 0.014, 0.278 + 2 * 0.019 + 1.5 * 0.014], rtol=1e-14)
    with pytest.raises(KeyError, match="EQ_inv"):
        read_r22_models()["single_form", "U1"].porosity(beds[["EL_inv"]])


def test_a_table_without_equations_is_read():
    table = pd.DataFrame({"model": ["single_form"], "case": "U1", "intercept": 0.3, "EQ_inv": 0.01, "EL_inv": np.nan})
    (model,) = parse_r22_models(table).values()
    assert (model.equation, model.intercept, dict(model.slopes)) == ("", 0.3, {"EQ_inv": 0.01})
    assert not parse_r22_models(table.iloc[:0])


def test_the_rhine_is_the_first_row_of_table_2():
    assert rhine_statistics()[["mu_FL", "sigma_FL", "mu_EL", "sigma_EL"]].tolist() == [0.647, 0.175, 0.682, 0.139]

"""The model of predictions: fitted if its tables meet the conditions of the plan, otherwise without parameters."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.sieve import SieveCurve
from simcore.models.packing_models.curves import gap, span, split
from simcore.models.size_and_form.bed_prediction import wider
from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.sized_model import (
    NOT_FITTED,
    WIDE_FAMILIES,
    current_model,
    fitted_model,
    relative_error,
    unfitted_model,
)
from simcore.models.size_and_form.stretch import REFERENCE_EL, REFERENCE_EQ
from simcore.scene.sizes import all_cases

PARAMETERS = {"m0": 1.1, "kappa": 0.5}


def write_tables(folder, chosen="L", unfitted=0.02, families=WIDE_FAMILIES):
    """Write the tables of a comparison of L, rods and H_form."""
    errors = {"L": 0.004, "rods": 0.006, "H_form": 0.005, NOT_FITTED: unfitted}
    candidates = [
        {"model": name, "chosen": "yes" if name == chosen else "", "error_by_family": error}
        for name, error in errors.items()
    ]
    parameters = [{"model": "L", "parameter": key, "value": value} for key, value in PARAMETERS.items()]
    beds = [
        {"family": family, "n_one_class": 0.36, "n": 0.30, "predicted_L": 0.30 + error,
         "predicted_rods": 0.31, "widest": widest, "gap": 0.5 * widest}
        for family, error, widest in zip(sorted(families), (3e-3, -3e-3) * 3, (2, 3, 4, 5, 5.6, 4), strict=False)
    ]  # fmt: skip
    (folder / "models").mkdir()
    for name, rows in (("candidates", candidates), ("parameters", parameters), ("beds", beds)):
        pd.DataFrame(rows).to_csv(folder / "models" / f"size_and_form_{name}.csv", index=False)
    return folder


def test_the_chosen_candidate_is_used(tmp_path):
    model = current_model(write_tables(tmp_path))
    assert (model.candidate, model.parameters, model.freedom, model.widest) == ("L", PARAMETERS, 5, 5.6)
    assert model.error == pytest.approx(0.003 / 0.06)
    assert model.behind == "fitted to 6 packed beds of 6 families of sieve curves."
    curve = all_cases()["U5"].curve
    assert model.predict(curve, 0.35) == predict("L", curve, 0.35, PARAMETERS, law="mass")


@pytest.mark.parametrize(
    "changes",
    [{"unfitted": 0.004}, {"families": WIDE_FAMILIES - {"fractal"}}, {"chosen": "rods"}],
    ids=["no better", "a family missing", "literature"],
)
def test_otherwise_no_parameter_is_fitted(tmp_path, changes):
    folder = write_tables(tmp_path, **changes)
    assert fitted_model(folder) is None and current_model(folder) == unfitted_model()


def test_without_tables_no_parameter_is_fitted(tmp_path):
    assert current_model(tmp_path) == unfitted_model()


def test_relative_errors_are_those_of_the_decrease():
    assert relative_error(np.array([0.31, 0.29]), np.array([0.30, 0.30]), np.array([0.35, 0.35])) == pytest.approx(0.2)


def test_the_error_grows_beyond_the_widest_curve(tmp_path):
    model = current_model(write_tables(tmp_path))
    assert wider(all_cases()["U3"].curve, model) == 1.0
    assert wider(all_cases()["U7"].curve, model) == pytest.approx(np.log(span(all_cases()["U7"].curve)) / np.log(5.6))


def test_the_error_grows_beyond_the_widest_gap(tmp_path):
    model = current_model(write_tables(tmp_path))  # gaps of up to 2.8
    curve = SieveCurve([4e-3, 5.6e-3, 20e-3, 21e-3], [0.3, 0.0, 0.7])
    assert gap(curve) > 20 / 5.6 and span(curve) < 5.6
    assert wider(curve, model) == pytest.approx(np.log(gap(curve)) / np.log(2.8))


def test_the_effect_of_form_is_compared_with_the_published_models(tmp_path):
    """A candidate that transfers less of the effect than another has the smaller error of form."""
    weak = fitted_model(write_tables(tmp_path))
    assert weak.form_error < unfitted_model().form_error


def test_splitting_the_classes_of_every_named_curve_changes_less_than_a_thousandth():
    model, n1 = current_model(), np.array([[0.31], [0.342], [0.40]])
    forms = np.full(n1.shape, REFERENCE_EQ), np.full(n1.shape, REFERENCE_EL)
    for name, case in all_cases().items():
        whole = model.predict(case.curve, n1, forms)
        for number in (2, 4, 8):
            parts = model.predict(split(case.curve, number, model.law), n1, forms)
            np.testing.assert_allclose(parts, whole, rtol=0, atol=1e-3, err_msg=f"{name} in {number} parts")

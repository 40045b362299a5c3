"""Packings in which form depends on size: the forms of each class, and the rule that confirms predictions by class."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies import form_by_size
from benchmarks.studies.form_by_size import USED, comparison, confirmed, ranges, statistics_by_class
from simcore.grains.statistics import equancy_statistics
from simcore.models.fitting import fit_reference_models
from simcore.scene.sizes import all_cases


def test_each_class_has_the_form_that_its_bed_was_specified_with():
    curve = all_cases()["U5"].curve
    flat_coarse, flat_fine = (
        statistics_by_class(curve, ranges(study)) for study in ("flat_coarse_grains", "flat_fine_grains")
    )
    fine = curve.bounds[1:] < 8.1e-3
    coarse = curve.bounds[:-1] > 11.1e-3
    assert fine.sum() >= 2 and coarse.sum() >= 2
    round_form, flat_form = (equancy_statistics(flatness, 0.1, 0.7, 0.1)[0] for flatness in (0.75, 0.4))
    np.testing.assert_allclose(flat_coarse["mu_EQ"][fine], round_form)
    np.testing.assert_allclose(flat_coarse["mu_EQ"][coarse], flat_form)
    np.testing.assert_allclose(flat_fine["mu_EQ"][fine], flat_form)
    np.testing.assert_allclose(flat_fine["mu_EQ"][coarse], round_form)
    assert (flat_fine[["mu_EL", "sigma_EL"]] == [0.7, 0.1]).all(axis=None)


def test_a_packed_bed_is_predicted_from_both(monkeypatch):
    """A model that returns the mean of its one-class porosities shows what it was given."""
    given = {USED: lambda curve, n1, n_ref: np.mean(n1)}
    monkeypatch.setattr(form_by_size, "models", lambda: given)
    (row,) = comparison(("flat_coarse_grains",)).to_dict("records")
    by_class, together = (row["n"] + row[f"{kind}_{USED}"] for kind in ("by_class", "together"))
    assert 0.33 < by_class < 0.38 and 0.33 < together < 0.38
    assert by_class != together


def test_a_bed_that_is_not_packed_is_named(monkeypatch, tmp_path):
    table = pd.read_csv(form_by_size.REFERENCE / "form_by_size.csv")
    table[table["study"] == "flat_coarse_grains"].to_csv(tmp_path / "form_by_size.csv", index=False)
    monkeypatch.setattr("benchmarks.studies.size_and_form_fit.REFERENCE", tmp_path)
    with pytest.raises(ValueError, match="has no bed of flat_fine_grains yet"):
        form_by_size.read_rows("flat_fine_grains")


def test_predict_says_what_the_packed_beds_show():
    """CHECK_BY_CLASS in bed_prediction_text is a sentence on these beds; if this fails, change the sentence."""
    for of_form in (None, fit_reference_models().models["unified", "U1"]):
        table = comparison(of_form=of_form)
        by_class, together = (np.sqrt(np.mean(table[f"{kind}_{USED}"] ** 2)) for kind in ("by_class", "together"))
        assert by_class < 0.9 * together


@pytest.mark.parametrize("by_class, expected", [([0.01, -0.02], False), ([0.01, -0.01], True), ([0.0, 0.015], True)])
def test_predictions_by_class_are_confirmed_by_the_mean_square_of_both_beds(by_class, expected):
    table = pd.DataFrame({f"by_class_{USED}": by_class, f"together_{USED}": [0.015, 0.0]})
    assert confirmed(table) is expected


def test_the_packed_curves_differ_from_the_specified_one_as_the_page_states():
    """They were packed before grains were counted by the volume of their form."""
    rows = pd.read_csv(form_by_size.REFERENCE / "form_by_size.csv")
    shares = rows.filter(like="share_").to_numpy()[:, 1:-1]
    page = (form_by_size.REFERENCE.parents[1] / "docs/appendices/size_and_form_plan.md").read_text(encoding="utf-8")
    worst = np.abs(shares - all_cases()["U5"].curve.without_empty_ends().mass_fractions).max()
    assert f"differ from U5 by up to {worst:.3f} in a class" in " ".join(page.split())

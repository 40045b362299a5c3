"""The page of the checks of the model of size and form follows from its tables."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.size_and_form_validation import KNOWN, OURS, R22, SETS
from docs.generate import size_and_form
from simcore.models.size_and_form.sized_model import current_model, unfitted_model
from simcore.paths import REFERENCE


def test_the_page_has_every_set_and_both_pictures():
    text = size_and_form.page()
    assert all(f"| {label} |" in text for label, _, _ in SETS.values())
    assert "](../size_and_form.png)" in text and "](../sorted_sands.png)" in text and "nan" not in text


def test_fitted_parameters_have_their_intervals():
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_parameters.csv").set_index(["model", "parameter"])
    text = " ".join(size_and_form.page().split())
    model = current_model()
    for name, value in model.parameters.items():
        row = table.loc[(model.candidate, name)]
        assert f"{name} = {value:.3f} ({row.lower_95:.3f} to {row.upper_95:.3f})" in text
    assert size_and_form._parameters(unfitted_model()) == "with K = 4.1, m0 = 1, kappa = 0"


def test_slopes_agree_within_two_standard_errors():
    slopes = pd.DataFrame(
        [[R22, 0.69, 0.02, 0.51, 0.01, 0.66], [OURS, 0.72, np.nan, 0.60, 0.03, 0.7]],
        columns=["model", "slope_U7", "slope_U7_std_error", "slope_B50", "slope_B50_std_error", "slope_mixtures"],
    )
    text = size_and_form._judgement(slopes)
    assert "For U7 the slope of this model minus the published one is +0.03 ± 0.02: they agree" in text
    assert "is +0.09 ± 0.03: they do not agree" in text


def test_a_curve_that_a_model_refuses_is_named_so():
    sands = pd.DataFrame(
        {"grain_size": "a", "sorting": ["well", "poorly"], "log_deviation": [0.1, 1.0], "n": [0.4, 0.3]}
    ).assign(**{f"predicted_{name}": [0.4, 0.28] for name in size_and_form._MODELS})
    sands.loc[1, f"predicted_{OURS}"] = np.nan
    assert "| poorly | 1.00 | 0.750 ± nan | refused | 0.700 |" in size_and_form._ratios(sands)


def test_a_miss_is_explained_only_if_its_direction_is_known():
    known = pd.DataFrame(
        {"set": ["measured", "packed", "packed"], "case": ["U5", "U7", "U3"], "n": 0.3, "predicted": [0.32, 0.32, 0.28]}
    ).assign(half_width=0.01)
    mixtures = pd.DataFrame({"n": 0.3, "predicted": [0.305, 0.32, 0.33]}).assign(half_width=0.01)
    text = size_and_form._misses(known, mixtures)
    assert "denser than predicted are U7 (the same gravels, packed by us). Slower" in text
    assert "Also outside their intervals are U5 (gravels measured by Rettinger et al.); U3 (the same" in text
    assert "are 2 of the 3 distributions of form in U7, whose predicted minus published porosity is +0.025 on" in text
    wide = known.assign(half_width=0.03), mixtures.assign(half_width=0.04)
    assert size_and_form._misses(*wide) == "All beds are inside their stated intervals."


def test_u7_at_the_mean_form_is_that_of_the_paper_after_the_same_shaking():
    """Issue 36 requires 0.006; the difference by shaking is that of Table 8 of Rettinger et al."""
    known = pd.read_csv(REFERENCE / KNOWN)
    bed = known[(known["set"] == "published") & (known["case"] == "U7")].iloc[0]
    assert bed.n == pytest.approx(0.276, abs=5e-4)
    assert size_and_form.shorter_shaking() == pytest.approx(0.291 - 0.282)
    left = bed.predicted - bed.n - 0.009
    assert abs(left) <= 0.006
    text = " ".join(size_and_form.page().split())
    assert f"With this correction, predicted minus published porosity is {left:+.3f}. The correction may be" in text


def test_sands_that_are_not_wider_than_our_beds():
    """The step interval follows from the committed model; the best sorted sand is one class."""
    sands = pd.DataFrame(
        {"grain_size": "a", "sorting": ["best", "well", "poorly"], "log_deviation": [0.1, 0.3, 1.0],
         "outside": ["", "", "yes"], "n": [0.4, 0.35, 0.2]}
    ).assign(**{f"predicted_{name}": [0.4, 0.37, 0.3] for name in size_and_form._MODELS})  # fmt: skip
    model = unfitted_model()._replace(error=0.1, freedom=5)
    assert "1 of the 1 sands are outside" in size_and_form._narrow_sands(sands, model)
    assert "0 of the 1 sands are outside" in size_and_form._narrow_sands(sands, model._replace(error=0.3))
    assert "is +0.020 on average; its root mean square by model is: this model 0.0200;" in (
        size_and_form._narrow_sands(sands, model)
    )

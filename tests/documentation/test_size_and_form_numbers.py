"""Numbers of the model of size and form in the texts are those of its tables."""

import pandas as pd
import pytest

from benchmarks.studies.size_and_form_validation import OURS, R22
from simcore.paths import REFERENCE, ROOT

PLAN, HOW_TO, FINDINGS = (
    "docs/appendices/size_and_form_plan.md",
    "docs/how_to/predict_from_a_sieve_curve.md",
    "docs/reference/findings.md",
)
CASES = ("slope_U7", "slope_B50")


@pytest.fixture(scope="module")
def chosen():
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_candidates.csv")
    return table[table["chosen"] == "yes"].iloc[0]


def states(page, *texts):
    content = " ".join((ROOT / page).read_text(encoding="utf-8").split())
    return [text for text in texts if text not in content] == []


def test_errors_of_left_out_beds(chosen):
    errors = f"{chosen.error_by_family:.4f}", f"{chosen.error_by_form:.4f}"
    assert states(PLAN, f"| {chosen.model}; chosen by the rule | {chosen.parameters} | {' | '.join(errors)} |")
    beds = pd.read_csv(REFERENCE / "models" / "size_and_form_beds.csv")
    assert states(
        FINDINGS, f"one formula, {len(beds)} beds", f"error {errors[0]} for a family", f"{errors[1]} for a form"
    )


def test_fitted_parameters(chosen):
    names = {"m0": "m0", "kappa": "κ"}
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_parameters.csv")
    for row in table[table["model"] == chosen.model].itertuples():
        assert states(HOW_TO, f"{names[row.parameter]} = {row.value:.2f} ± {row.std_error:.2f}")


def test_how_much_of_the_effect_of_form_remains():
    slopes = pd.read_csv(REFERENCE / "size_and_form_slopes.csv").set_index("model")
    ours = [f"{slopes.loc[OURS, case]:.2f} ± {slopes.loc[OURS, case + '_std_error']:.2f}" for case in CASES]
    theirs = [f"{slopes.loc[R22, case]:.2f}" for case in CASES]
    assert states(FINDINGS, f"| {'; '.join(ours)} by that formula | {'; '.join(theirs)} |")
    for page in (PLAN, HOW_TO):
        assert states(page, *ours, f"{theirs[0]} and {theirs[1]}")

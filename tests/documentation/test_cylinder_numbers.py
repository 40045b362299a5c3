"""The seven sieve curves in the cylinder beside the experiment, from the committed rows."""

import numpy as np
import pandas as pd

from simcore.paths import REFERENCE, ROOT
from simcore.reference.r22_tables import read_r22_table

PAGE = " ".join((ROOT / "docs" / "appendices" / "cylinder.md").read_text(encoding="utf-8").split())


def test_sieve_curves_beside_the_experiment():
    rows = pd.read_csv(REFERENCE / "validation.csv").groupby("case")
    measured = read_r22_table("table3_cases").set_index("case")["n_exp"]
    theirs = read_r22_table("table6_validation").set_index("case")["mean"]
    means, errors = rows["n"].mean(), rows["n_error"].agg(lambda error: np.sqrt((error**2).sum()) / len(error))
    percent = 100.0 * (means / measured[means.index] - 1.0)
    for case, n in means.items():
        cells = f"| {case} | {n:.3f} ± {errors[case]:.3f} | {measured[case]:.3f} | {theirs[case]:.3f} | "
        assert f"{cells}{percent[case]:+.1f} |".replace("-", "−") in PAGE, case
    far = percent[percent.abs() > 5.0]
    (outside,) = far.index
    assert f"All but {outside} are within 5 % of the experiment" in PAGE
    of_far = 100.0 * errors[outside] / measured[outside]
    assert f"{outside} differs by {far[outside]:.1f} ± {of_far:.1f} %" in PAGE


def test_the_order_of_two_curves_is_not_that_of_the_experiment():
    rows = pd.read_csv(REFERENCE / "validation.csv").groupby("case")
    means, errors = rows["n"].mean(), rows["n_error"].agg(lambda error: np.sqrt((error**2).sum()) / len(error))
    difference, error = means["B30"] - means["B50"], np.hypot(errors["B30"], errors["B50"])
    assert f"B30 is looser than B50 by {difference:.3f} ± {error:.3f}, and also in" in PAGE and difference > 2.0 * error
    measured = read_r22_table("table3_cases").set_index("case")["n_exp"]
    theirs = read_r22_table("table6_validation").set_index("case")["mean"]
    assert theirs["B30"] > theirs["B50"] and measured["B30"] < measured["B50"]

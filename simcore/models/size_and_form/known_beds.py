"""Beds with wide sieve curves whose porosity is known, and that of one class of the same grains: tests of a model.

No parameter is fitted to them. The sets:

    measured         seven gravels in a cylinder, measured by Rettinger et al. (2022), Table 3
    packed           the same curves, packed by us in the same cylinder, means over the seeds (validation.csv)
    packed by r22    the same, packed by Rettinger et al., Table 6
    published        their models of beds of one form in a periodic box (U7, B50) at the Rhine's mean form
"""

import pandas as pd

from simcore.grains.form import features as form_features
from simcore.paths import REFERENCE
from simcore.reference.r22_tables import read_r22_table

BASE = "U1"
MEASURED, PACKED, PACKED_BY_R22, PUBLISHED = "measured", "packed", "packed by r22", "published"
COLUMNS = ["set", "case", "n_one_class", "n"]


def known_beds() -> pd.DataFrame:
    """Return one row per bed: set, case, n_one_class (porosity of U1 of the set) and n."""
    rows = pd.read_csv(REFERENCE / "validation.csv")
    rows["weight"] = rows["n_error"] ** -2.0
    packed = (rows["n"] * rows["weight"]).groupby(rows["case"]).sum() / rows.groupby("case")["weight"].sum()
    porosities = {
        MEASURED: read_r22_table("table3_cases").set_index("case")["n_exp"],
        PACKED: packed,
        PACKED_BY_R22: read_r22_table("table6_validation").set_index("case")["mean"],
        PUBLISHED: _at_mean_form(),
    }
    beds = [
        {"set": name, "case": case, "n_one_class": float(n[BASE]), "n": float(n[case])}
        for name, n in porosities.items()
        for case in n.index
        if case != BASE
    ]
    return pd.DataFrame(beds, columns=COLUMNS)


def _at_mean_form():
    """Return the porosity by the published models of single forms at the mean form of the Rhine, Series by case."""
    form = read_r22_table("table2_form_statistics").iloc[0]
    axes = [1.0, form["mu_EL"], form["mu_EL"] * form["mu_FL"]]
    features = form_features(*([axis] for axis in axes)).iloc[0]
    models = read_r22_table("models").query("model == 'single_form'").set_index("case")
    return models["intercept"] + models["EQ_inv"] * features["EQ_inv"] + models["EL_inv"] * features["EL_inv"]

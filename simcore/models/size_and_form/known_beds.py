"""Beds with wide sieve curves whose porosity is known, and that of one class of the same grains: tests of a model.

No parameter is fitted to them. The sets:

    measured         seven gravels in a cylinder, measured by Rettinger et al. (2022), Table 3
    packed           the same curves, packed by us in the same cylinder, means over the seeds (validation.csv)
    packed by r22    the same, packed by Rettinger et al., Table 6
    published        their models of beds of one form in a periodic box (U7, B50) at the Rhine's mean form

Two more sets compare published models of U7 and B50 over many forms: `known_mixtures`, distributions of form in U7, and
`known_forms`, beds of one form each in U7 and B50.
"""

import numpy as np
import pandas as pd

from simcore.grains.form import features as form_features
from simcore.models.single_form import SINGLE_FORM
from simcore.models.unified import unified_features
from simcore.paths import REFERENCE
from simcore.reference.committed_rows import read_single_forms
from simcore.reference.r22_tables import read_r22_models, read_r22_table, rhine_statistics

BASE = "U1"
MEASURED, PACKED, PACKED_BY_R22, PUBLISHED = "measured", "packed", "packed by r22", "published"
MIXTURES, OF_MIXTURES = "published mixtures", "U7"
OF_ONE_FORM = ("U7", "B50")  # wide cases for which Rettinger et al. published models of single forms
COLUMNS = ["set", "case", "n_one_class", "n"]


def known_beds() -> pd.DataFrame:
    """Return one row per bed: set, case, n_one_class (porosity of U1 of the set) and n."""
    packed = pd.read_csv(REFERENCE / "validation.csv").groupby("case")["n"].mean()
    measured = read_r22_table("table3_cases").set_index("case")["n_exp"]
    porosities = {
        MEASURED: measured,
        PACKED: packed.loc[measured.index],
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


def known_mixtures() -> pd.DataFrame:
    """Return the porosity of U7 with the 52 distributions of form of Rettinger et al., by their models (Eqs. 23, 24).

    One row per distribution: mu_FL_nominal, sigma_FL_nominal, mu_EL_nominal, sigma_EL_nominal as specified; mu_EQ,
    sigma_EQ, mu_EL, sigma_EL over the grains of our packings of them; n_one_class (of U1) and n (of U7).
    """
    rows = pd.read_csv(REFERENCE / "form_mixture.csv").query("case == @BASE")
    specified = [name for name in rows if name.endswith("_nominal")]
    beds = rows.groupby(specified, as_index=False)[["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]].mean()
    return beds.assign(n_one_class=published_mixture(BASE, beds), n=published_mixture(OF_MIXTURES, beds))


def published_mixture(case, statistics) -> np.ndarray:
    """Return the porosity (s,) by the published model of distributions of form of U1 or U7.

    statistics: DataFrame with columns mu_EQ, sigma_EQ, mu_EL, sigma_EL over the grains, one row per bed.
    """
    return read_r22_models()["form_mixture", case].porosity(unified_features(statistics))


def known_forms() -> pd.DataFrame:
    """Return the porosities of beds of one form each by the models of Rettinger et al., for our 63 synthetic forms.

    One row per form: EQ, EL, n_one_class (of U1), n_U7 and n_B50.
    """
    forms = read_single_forms(REFERENCE / "single_form.csv", "synthetic", [BASE]).drop_duplicates("grain")
    features = pd.DataFrame({"EQ_inv": forms.L / forms.S, "EL_inv": forms.L / forms.I}).reset_index(drop=True)
    models = read_r22_models()
    porosities = {case: models["single_form", case].porosity(features) for case in (BASE, *OF_ONE_FORM)}
    return pd.DataFrame(
        {"EQ": 1.0 / features["EQ_inv"], "EL": 1.0 / features["EL_inv"], "n_one_class": porosities[BASE]}
        | {f"n_{case}": porosities[case] for case in OF_ONE_FORM}
    )


def published_slopes(case) -> np.ndarray:
    """Return the published coefficients of the features SINGLE_FORM of beds of one form, (2,)."""
    return read_r22_models()["single_form", case].slopes[list(SINGLE_FORM)].to_numpy()


def _at_mean_form():
    """Return the porosity by the published models of single forms at the mean form of the Rhine, Series by case."""
    form = rhine_statistics()
    axes = [1.0, form["mu_EL"], form["mu_EL"] * form["mu_FL"]]
    features, models = form_features(*([axis] for axis in axes)), read_r22_models()
    return pd.Series({case: float(models["single_form", case].porosity(features)[0]) for case in (BASE, *OF_ONE_FORM)})

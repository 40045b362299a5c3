"""What the source study reports for a packing, to stand beside ours: its tables, or its fitted models."""

from pathlib import Path

import numpy as np
import pandas as pd

REFERENCE_FOLDER = Path(__file__).resolve().parents[1] / "results" / "reference" / "study"

# For each study its table, the names there of our columns, of porosity and of its standard deviation.
_TABLES = {
    "mesh_resolution": ("table4_mesh_resolution", {"case": "case", "faces": "faces"}, "n", None),
    "shaking_cylinder": ("table5_shaking_cylinder", {"case": "case", "t_s": "shaking_s"}, "n", "n_std"),
    "validation": ("table6_validation", {"case": "case"}, "mean", "std"),
    "domain_size": ("table7_domain_size", {"case": "case", "width_m": "width_m"}, "n", "n_std"),
    "shaking_periodic": ("table8_shaking_periodic", {"case": "case", "t_s": "shaking_s"}, "n", None),
}


def read_study_table(name, folder=REFERENCE_FOLDER):
    """The source study's table of that name, as a DataFrame."""
    return pd.read_csv(folder / f"{name}.csv")


def add_reference(table, study, folder=REFERENCE_FOLDER):
    """The summarised table of a study with the columns study_n and study_n_std; nan where the study has none.

    For single forms and mixtures the study gives no table of porosities: there study_n is what its fitted model
    says for the forms of our packing. Its values hold for its own sizes of domain, not for smaller ones.
    """
    value, std = np.full(len(table), np.nan), np.full(len(table), np.nan)
    if "case" in table and study in _TABLES:
        value, std = _from_table(table, *_TABLES[study], folder)
    elif "case" in table and study == "single_form":
        value = _from_model(table, "single_form", folder)
    elif "case" in table and study == "form_mixtures":
        value = _from_model(table, "form_mixture", folder)
    elif "case" in table and study == "application":
        value = _application(table, folder)
    return table.assign(study_n=value, study_n_std=std)


def _from_table(table, file, columns, value, std, folder):
    theirs = read_study_table(file, folder).rename(columns=columns)
    keys = list(columns.values())
    if not set(keys) <= set(table.columns):
        return np.nan, np.nan
    # "<=300" faces there is a target of 300 here
    known = {tuple(_plain(row[key]) for key in keys): row for _, row in theirs.iterrows()}
    found = [known.get(tuple(_plain(row[key]) for key in keys)) for _, row in table.iterrows()]
    values = [[row[name] if row is not None and name else np.nan for row in found] for name in (value, std)]
    return tuple(np.array(values, float))


def _plain(value):
    """One spelling of a key: 300, 300.0, "300" and "<=300" are the same."""
    try:
        return round(float(str(value).removeprefix("<=")), 9)
    except ValueError:
        return str(value)


def _from_model(table, model, folder):
    """What the study's linear model says for the mean and standard deviation of EQ and EL over the grains."""
    models = read_study_table("models", folder).query("model == @model").set_index("case")
    features = {
        "EQ_inv": 1 / table.EQ,
        "EL_inv": 1 / table.EL,
        "mu_EQ_inv": 1 / table.EQ,
        "sigma_EQ_inv": 1 / table.sigma_EQ.where(table.sigma_EQ > 0),
        "mu_EL_inv": 1 / table.EL,
        "sigma_EL_inv": 1 / table.sigma_EL.where(table.sigma_EL > 0),
    }
    coefficients = models.reindex(table.case)
    total = coefficients.intercept.to_numpy()
    for name, feature in features.items():
        slope = coefficients[name].to_numpy()
        total = total + np.where(np.isnan(slope), 0.0, np.nan_to_num(slope) * feature.to_numpy())
    return total


def _application(table, folder):
    theirs = read_study_table("table11_application", folder).set_index("case").reindex(table.case)
    drawn = (table.get("choice", pd.Series("random", table.index)) == "random").to_numpy()
    return np.where(drawn, theirs.discrete_simulated, theirs.continuous_simulated)

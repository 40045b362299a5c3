"""Values of Rettinger et al. (2022) beside our packings, from their tables or their fitted models."""

import numpy as np
import pandas as pd

from simcore.paths import R22_TABLES
from simcore.reference.r22_tables import read_r22_models, read_r22_table

# For each study: table, dict from its columns to ours, columns of porosity and its standard deviation, number of runs.
# ASSUME: a standard deviation is over three runs, as in Table 6, where the paper does not give their number.
_TABLES = {
    "mesh_resolution": ("table4_mesh_resolution", {"case": "case", "faces": "faces"}, "n", None, 3),
    "shaking_cylinder": ("table5_shaking_cylinder", {"case": "case", "t_s": "shaking_s"}, "n", "n_std", 3),
    "validation": ("table6_validation", {"case": "case"}, "mean", "std", 3),
    "domain_size": ("table7_domain_size", {"case": "case", "width_m": "width_m"}, "n", "n_std", 3),
    "shaking_periodic": ("table8_shaking_periodic", {"case": "case", "t_s": "shaking_s"}, "n", None, 1),
}
ROUNDING = 1e-3 / np.sqrt(12.0)  # standard deviation of the rounding error of three printed decimals
# Ratio of the standard deviation of normally distributed errors to their mean magnitude
_STD_OF_MAE = np.sqrt(0.5 * np.pi)


def add_reference(table, study, folder=R22_TABLES):
    """Add the values of Rettinger et al. (2022) and the differences to the summarised table of a study.

    table: as from study_tables.summarise. New columns: r22_n, r22_n_std (over their runs), r22_n_error (standard error
    of r22_n), difference (n minus r22_n) and z, the difference divided by the standard error of both; nan where
    Rettinger et al. give no value. For the validation also experiment_n, experiment_n_std, experiment_error_percent (of
    our packings) and r22_error_percent (of the packings of Rettinger et al.). For mesh_resolution also cpu_h_per_run of
    our packings, and r22_volume_change_percent and r22_runtime_h of the packings of Rettinger et al.

    For single forms and mixtures they give no table of porosities. There r22_n is the prediction of their fitted model
    for the forms of our packing, and r22_n_error the error of such a prediction, from the mean absolute error of their
    cross-validation. For other studies r22_n_error combines the rounding to three decimals with their standard
    deviation, divided by the square root of the number of runs minus one (their deviations divide by the number of
    runs, as the three runs of Table 6 show). If they give no deviation, it is only the rounding, and z is too large.
    Their values apply to their own sizes of the domain, not to smaller ones.
    """
    value, std, error = (np.full(len(table), np.nan) for _ in range(3))
    added = {}
    if "case" in table and study in _TABLES:
        value, std, error = _from_table(table, *_TABLES[study], folder)
    elif "case" in table and study.startswith("single_form"):
        value, error = _from_model(table, "single_form", folder), _single_form_error(table, folder)
    elif "case" in table and study == "form_mixtures":
        value, error = _from_model(table, "form_mixture", folder), _mixture_error(table, folder)
    elif "case" in table and study == "application":
        value, error = _application(table, folder), np.full(len(table), ROUNDING)
    if "case" in table and study == "validation":
        added = _experiment(table, folder)
    if "case" in table and study == "mesh_resolution":
        added = _cost_of_faces(table, folder)
    difference = table["n"] - value
    return table.assign(
        r22_n=value,
        r22_n_std=std,
        r22_n_error=np.where(np.isnan(value), np.nan, error),
        difference=difference,
        z=difference / np.hypot(table["n_std_error"], error),
        **added,
    )


def _from_table(table, file, columns, value, std, runs, folder):
    """Return the values, their standard deviations over the runs and their standard errors."""
    values, deviations = (_look_up(table, file, columns, name, folder) for name in (value, std))
    of_mean = np.nan_to_num(deviations) / np.sqrt(max(runs - 1, 1))
    return values, deviations, np.hypot(of_mean, ROUNDING)


def _look_up(table, file, columns, name, folder):
    """Return the column `name` of the r22 table `file` where `columns` of both tables agree, (n,); nan elsewhere."""
    published = read_r22_table(file, folder).rename(columns=columns)
    keys = list(columns.values())
    if name is None or not set(keys) <= set(table.columns):
        return np.full(len(table), np.nan)
    # "<=300" faces in the r22 table is a maximum of 300 here.
    by_key = {tuple(_plain(row[key]) for key in keys): row[name] for _, row in published.iterrows()}
    values = [by_key.get(tuple(_plain(row[key]) for key in keys), np.nan) for _, row in table.iterrows()]
    return np.array(values, float)


def _experiment(table, folder):
    """Return the columns with the measured porosities of the cases as a dict."""
    measured, std = (_look_up(table, "table3_cases", {"case": "case"}, name, folder) for name in ("n_exp", "n_exp_std"))
    r22_error = _look_up(table, "table6_validation", {"case": "case"}, "relative_error_percent", folder)
    return {
        "experiment_n": measured,
        "experiment_n_std": std,
        "experiment_error_percent": 100.0 * (table["n"] / measured - 1.0),
        "r22_error_percent": r22_error,
    }


def _cost_of_faces(table, folder):
    """Return columns with run times, and the change of volume of the grains of Rettinger et al. by decimation, dict."""
    columns = {"case": "case", "faces": "faces"}
    return {
        "cpu_h_per_run": table["cpu_h"] / table["runs"],
    } | {
        f"r22_{name}": _look_up(table, "table4_mesh_resolution", columns, name, folder)
        for name in ("volume_change_percent", "runtime_h")
    }


def _single_form_error(table, folder):
    """Return the standard deviation of the error of the published model {EQ^-1, EL^-1} for one packing."""
    errors = read_r22_table("table9_second_factor_mae", folder).set_index("case")["EL_inv"]
    return 1e-3 * _STD_OF_MAE * errors.reindex(table["case"]).to_numpy()


def _mixture_error(table, folder):
    """Return the standard deviation of the error of the published model of form mixtures, which has four features."""
    sets = read_r22_table("table10_form_mixture_features", folder)
    full = sets[(sets.filter(regex="_inv$") == 1).all(axis=1)].iloc[0]
    errors = [full.get(f"{case}_mae_1e-3", np.nan) for case in table["case"]]
    return 1e-3 * _STD_OF_MAE * np.array(errors, float)


def _plain(value):
    """Return the common form of a key: 300, 300.0, "300" and "<=300" are the same."""
    try:
        return round(float(str(value).removeprefix("<=")), 9)
    except ValueError:
        return str(value)


def _from_model(table, name, folder):
    """Predict with the published linear model, from the mean and standard deviation of EQ and EL over the grains."""
    features = pd.DataFrame({"EQ_inv": 1 / table["EQ"], "EL_inv": 1 / table["EL"]})
    for axis_ratio in ("EQ", "EL"):
        features[f"mu_{axis_ratio}_inv"] = 1 / table[axis_ratio]
        # Grains of one form have no standard deviation, and therefore no contribution of its inverse.
        sigma = table[f"sigma_{axis_ratio}"]
        features[f"sigma_{axis_ratio}_inv"] = (1 / sigma.where(sigma > 0)).fillna(0.0)
    n, models = np.full(len(table), np.nan), read_r22_models(folder)
    for case in table["case"].unique():
        if (name, case) in models:
            of_case = (table["case"] == case).to_numpy()
            n[of_case] = models[name, case].porosity(features[of_case])
    return n


def _application(table, folder):
    """Return the simulated porosities of Table 11: of drawn grains, or of continuous distributions of form."""
    published = read_r22_table("table11_application", folder).set_index("case").reindex(table.case)
    drawn = (table.get("choice", pd.Series("random", table.index)) == "random").to_numpy()
    return np.where(drawn, published.discrete_simulated, published.continuous_simulated)

"""What the tables of all models share: means over seeds, and the values of Rettinger et al. (2022) beside ours."""

import pandas as pd


def over_seeds(packings, key):
    """Means of all numbers over the packings of one case that agree in `key`; as given where there is no such column.

    Rows of one form with other seeds are no samples of their own: a fit would take its error for too small, and
    cross-validation would see the form it is to predict.
    """
    if key not in packings:
        return packings
    return packings.groupby(["case", key], sort=False).mean(numeric_only=True).copy().reset_index()


def compare_predictions(models, name, table):
    """One row a packing: case, simulated, predicted by the model `name` of its case; cases without one are left out.

    models: dict from (name, case) to PorosityModel; table: columns case, n and the features of the models. Its columns
    n_std_error and r22_n, where it has them, are kept, the latter as r22_predicted.
    """
    kept = {"n_std_error": "n_std_error", "r22_n": "r22_predicted"}
    names = ["case", "simulated", "predicted", *(new for old, new in kept.items() if old in table)]
    parts = [
        rows.rename(columns={"n": "simulated", **kept}).assign(predicted=models[name, case].predict(rows))[names]
        for case, rows in table.groupby("case", sort=False)
        if (name, case) in models
    ]
    return pd.concat(parts) if parts else pd.DataFrame(columns=names)


def beside(ours, study, keys, columns):
    """Our table with columns of the study's, renamed by `columns`, where the keys agree."""
    return ours.merge(study[[*keys, *columns]].rename(columns=columns), how="left", on=keys)


def beside_models(ours, study):
    """Our coefficients beside the study's, which come one row a model."""
    study = study.melt(id_vars=["model", "case"], value_name="coefficient", var_name="term").dropna()
    return beside(ours, study, ["model", "case", "term"], {"coefficient": "r22_coefficient"})

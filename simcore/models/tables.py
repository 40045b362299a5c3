"""Steps common to the tables of all models: means over seeds, and columns with values of Rettinger et al. (2022)."""

import pandas as pd

from simcore.evaluation.confidence import error_of_mean


def over_seeds(packings, key):
    """Return means of all numbers over the packings of one case that agree in `key`; unchanged without this column.

    Packings of one form with different seeds are not independent samples: the error of a fit would be too small, and
    cross-validation would train on the form that it predicts. n_std_error is that of the mean.
    """
    if key not in packings:
        return packings
    groups = packings.groupby(["case", key], sort=False, dropna=False)
    means, low, high = (getattr(groups, of)(numeric_only=True) for of in ("mean", "min", "max"))
    # The mean of three equal values may differ from them in the last digit.
    means = means.where(low != high, low.astype(means.dtypes)).copy()
    if "n_std_error" in packings:
        means["n_std_error"] = groups["n_std_error"].agg(error_of_mean)
    return means.reset_index()


def rows_of_models(models) -> pd.DataFrame:
    """Return the coefficients of PorosityModels, one row per term; without a model only the columns.

    models: dict from (name, case) to PorosityModel.
    """
    if not models:
        return pd.DataFrame(columns=["model", "case", "term", "coefficient"])
    return pd.concat([model.to_rows() for model in models.values()], ignore_index=True)


def compare_predictions(models, name, table):
    """Return one row per packing: case, simulated, predicted by the model `name` of its case.

    models: dict from (name, case) to PorosityModel; cases without this model are left out. table: columns case, n and
    the features of the models. Its optional columns n_std_error and r22_n are kept, the latter as r22_predicted.
    """
    kept = {"n_std_error": "n_std_error", "r22_n": "r22_predicted"}
    others = [new for old, new in kept.items() if old in table]
    given, names = ["case", "simulated", *others], ["case", "simulated", "predicted", *others]
    parts = [
        rows.rename(columns={"n": "simulated", **kept})[given].assign(predicted=models[name, case].predict(rows))[names]
        for case, rows in table.groupby("case", sort=False)
        if (name, case) in models
    ]
    return pd.concat(parts) if parts else pd.DataFrame(columns=names)


def join_r22(ours, r22, keys, columns):
    """Add columns of the table `r22` of Rettinger et al. to our table where the keys agree.

    columns: dict from their name in `r22` to the new name.
    """
    return ours.merge(r22[[*keys, *columns]].rename(columns=columns), how="left", on=keys)


def join_r22_models(ours, r22):
    """Add the coefficients of Rettinger et al. to the table of ours; `r22` has one row per model."""
    r22 = r22.melt(id_vars=["model", "case"], value_name="coefficient", var_name="term").dropna()
    return join_r22(ours, r22, ["model", "case", "term"], {"coefficient": "r22_coefficient"})

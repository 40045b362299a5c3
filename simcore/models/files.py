"""Write fitted models to netCDF files with the covariances of their coefficients, and read them."""

import numpy as np
import pandas as pd
import xarray as xr

from simcore.models.regression import PorosityModel
from simcore.models.scatter import line_of_row


def models_dataset(models, table, title):
    """Return the models' table as from table_dataset, with the covariances of the coefficients, which CSV cannot store.

    models: dict from (name, case) to PorosityModel, in the order of the table, which has one row per coefficient. The
    variable `covariance` contains, for each row, the covariances of its coefficient with all coefficients of its
    model, in their order; nan beyond the last.
    """
    dataset = table_dataset(table, title)
    covariance = np.full((len(table), max((len(model.terms) for model in models.values()), default=0)), np.nan)
    start = 0
    for model in models.values():
        size = len(model.terms)
        covariance[start : start + size, :size] = model.covariance
        start += size
    attrs = {"units": "1", "long_name": "covariance with the coefficients of the same model, in their order"}
    return dataset.assign(covariance=(("row", "term_of_model"), covariance, attrs))


def load_models(path):
    """Return the Dataset of a file of models, in memory; ValueError if there is no such file or it is not netCDF."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return dataset.load()
    except FileNotFoundError:
        raise ValueError(f"{path}: there is no such file; run the campaign's models first") from None
    except (OSError, ValueError) as error:
        raise ValueError(
            f"{path} cannot be read as a file of models ({error}); give a netCDF file of a campaign's folder "
            "results/models, or the JSON file of `fit`"
        ) from None


def read_models(path):
    """Read the models from a file written from models_dataset: dict from (name, case) to PorosityModel.

    ValueError if there is no such file or it is not of this kind.
    """
    dataset = load_models(path)
    if "covariance" not in dataset:
        raise ValueError(f"{path}: these models were written without covariances; run the rule that fits them again")
    if dataset.sizes["row"] == 0:
        return {}
    models = {}
    rows = pd.DataFrame({name: dataset[name].values for name in dataset.data_vars if dataset[name].dims == ("row",)})
    for (name, case), part in rows.groupby(["model", "case"], sort=False):
        size, first_row = len(part), part.iloc[0]
        column = {key: tuple(part[key].tolist()) for key in part}
        models[name, case] = PorosityModel(
            name=name,
            case=case,
            features=column["term"][1:],
            coefficients=column["coefficient"],
            std_errors=column["std_error"],
            lower=column["lower_95"],
            upper=column["upper_95"],
            bootstrap_lower=column["bootstrap_lower_95"],
            bootstrap_upper=column["bootstrap_upper_95"],
            covariance=tuple(map(tuple, dataset["covariance"].values[part.index, :size].tolist())),
            minimum=column["feature_min"][1:],
            maximum=column["feature_max"][1:],
            n_samples=int(first_row["samples"]),
            scatter_line=line_of_row(first_row),
            form_mixture_error=_finite_or_none(first_row.get("form_mixture_error", np.nan)),
            **{
                key: float(first_row[key])
                for key in ("scatter", "r_squared", "rmse", "mean_absolute_error", "median_absolute_error")
            },
        )
    return models


def _finite_or_none(value):
    """Return a number that a file may lack, as those of earlier versions do."""
    return float(value) if np.isfinite(value) else None


def table_dataset(table, title):
    """Return a table as a Dataset over `row`, for netCDF; all numbers of the table are dimensionless."""
    dataset = xr.Dataset(attrs={"Conventions": "CF-1.11", "title": title})
    for name in table.columns:
        values = table[name]
        text = not pd.api.types.is_numeric_dtype(values)
        attrs = {"long_name": name.replace("_", " ")} | ({} if text else {"units": "1"})
        # The CF conventions have no boolean type, and netCDF allows no slash in a name.
        data = values.astype(str) if text else values.astype("i1") if values.dtype == bool else values
        dataset[name.replace("/", "_per_")] = ("row", data.to_numpy(object if text else None), attrs)
    return dataset

"""The tables of Rettinger et al. (2022) in results/reference/r22, and the linear models of porosity in one of them."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from simcore.paths import R22_TABLES


def read_r22_table(name, folder=R22_TABLES):
    """Read the table `name`.csv of Rettinger et al. (2022) as a DataFrame."""
    return pd.read_csv(folder / f"{name}.csv")


def rhine_statistics(folder=R22_TABLES):
    """Return means and standard deviations of FL and EL of the gravel of the Rhine, from which their grains are.

    The row of Table 2 is returned as a Series; its entries are mu_FL, sigma_FL, mu_EL, sigma_EL and others.
    """
    return read_r22_table("table2_form_statistics", folder).iloc[0]


@dataclass(frozen=True)
class R22Model:
    """A published linear model: the porosity is the intercept plus the sum of slopes times features.

    name: "single_form" for beds of one form, or "form_mixture" for distributions of form. case: sieve curve of the
    beds. equation: number of the equation in the preprint, as text. slopes: Series, indexed by the feature.
    """

    name: str
    case: str
    equation: str
    intercept: float
    slopes: pd.Series

    def porosity(self, features):
        """Return the porosity (n,) of n beds; features: DataFrame with a row per bed and a column for each slope."""
        return self.intercept + features[list(self.slopes.index)].to_numpy(float) @ self.slopes.to_numpy()


def read_r22_models(folder=R22_TABLES):
    """Return the models of Equations 17 to 19, 23 and 24 of Rettinger et al., a dict from (name, case) to R22Model."""
    return parse_r22_models(read_r22_table("models", folder))


def parse_r22_models(table):
    """Return the models of a table, a dict from (name, case) to R22Model.

    table: columns model, case, intercept, optionally equation_arxiv, and one per feature. An empty coefficient means
    that the model does not have the feature.
    """
    models = {}
    for _, row in table.iterrows():
        name, case = row["model"], row["case"]
        slopes = row.drop(["model", "case", "intercept", "equation_arxiv"], errors="ignore").astype(float).dropna()
        equation = row.get("equation_arxiv", np.nan)
        models[name, case] = R22Model(
            name, case, "" if pd.isna(equation) else f"{equation:.0f}", float(row["intercept"]), slopes
        )
    return models

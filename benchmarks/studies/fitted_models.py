"""Coefficients, errors, ranges and covariances of all models that are fitted to the committed rows.

    python -m benchmarks.studies.fitted_models            # prints the coefficients
    python -m benchmarks.studies.fitted_models --write    # writes the tables to results/reference/models

It reads the rows in results/reference and fits the models in the report of the committed rows: models of single forms
for each sieve curve and source of grains, of mixtures, and the unified model. The tables `single_form`, `form_mixture`
and `unified` have one row per coefficient, with intervals, range and errors. `predict` has the coefficients that the
command `predict` uses, which are fitted to the grains of all sources together, and `covariance` has their covariances.
`*_correlations`, `*_second_features` and `*_feature_sets` correspond to Tables 9 and 10 of Rettinger et al. (2022).
`form_mixture_correlations` has all 104 statistics of form; benchmarks.studies.drawn_mixtures computes them. It takes
about a minute.
"""

import argparse

import pandas as pd

from benchmarks.studies.drawn_mixtures import correlations
from benchmarks.tables import significant
from simcore.models.fitting import fit_reference_models
from simcore.paths import REFERENCE
from simcore.report.committed import findings

FOLDER = REFERENCE / "models"
TABLES = (
    "single_form", "single_form_correlations", "single_form_second_features", "single_form_mean_form",
    "form_mixture", "form_mixture_feature_sets", "unified", "unified_feature_sets", "shape_kinds",
    "application_predictions",
)  # fmt: skip


def model_tables():
    """Return the tables, dict of DataFrames by name, with numbers of six significant digits."""
    tables, _ = findings(REFERENCE)
    chosen = {name: tables[name] for name in TABLES if name in tables}
    models = fit_reference_models().models
    chosen["form_mixture_correlations"] = correlations()
    chosen["predict"] = pd.concat([model.to_rows() for model in models.values()], ignore_index=True)
    chosen["covariance"] = covariances(models)
    return {name: significant(table) for name, table in chosen.items()}


def covariances(models):
    """Return the covariances of the coefficients of models, by (name, case): one row per pair of coefficients."""
    rows = [
        {"model": name, "case": case, "term": term, "with_term": other, "covariance": value}
        for (name, case), model in models.items()
        for term, values in zip(model.terms, model.covariance, strict=True)
        for other, value in zip(model.terms, values, strict=True)
    ]
    return pd.DataFrame(rows)


def main(arguments=None) -> None:
    """Print the coefficients, or write all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the tables to results/reference/models")
    options = parser.parse_args(arguments)
    tables = model_tables()
    if options.write:
        FOLDER.mkdir(exist_ok=True)
        for name, table in tables.items():
            table.to_csv(FOLDER / f"{name}.csv", index=False, lineterminator="\n")
        return
    columns = ["source", "case", "term", "coefficient", "lower_95", "upper_95", "mean_absolute_error", "samples"]
    for name in ("single_form", "form_mixture", "unified"):
        table = tables[name]
        print(table[[column for column in columns if column in table]].to_string(index=False, float_format="%.4g"))


if __name__ == "__main__":
    main()

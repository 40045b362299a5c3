"""Tables and figures of the report from committed rows, without simulating or reading any packing.

Tables and figures for which a folder such as results/reference has no rows are left out.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from simcore.campaign.biases import measured_biases
from simcore.campaign.gathering import PLAIN_STUDIES, SHOWN_TABLES
from simcore.campaign.study_tables import summarise
from simcore.campaign.trend_tables import summarise_trends
from simcore.grains.form import features as form_features
from simcore.grains.sieve import read_cases
from simcore.grains.statistics import STATISTICS, flatness_statistics
from simcore.models.mixtures import MIXTURE, application_table, mixture_models
from simcore.models.regression import FOLDS, fewest_samples
from simcore.models.shape_kinds import pair_shape_kinds, shape_kind_table
from simcore.models.single_form import SINGLE_FORM, single_form_models
from simcore.models.tables import compare_predictions
from simcore.models.unified import UNIFIED, unified_features, unified_models
from simcore.paths import CONFIG
from simcore.reference.columns import FORM, SPECIFIED_FORM, SPECIFIED_MEANS, study_names
from simcore.reference.committed_rows import SOURCE_OF_MIXTURES, fitted_forms, fitted_mixtures
from simcore.reference.named_tables import read_named_table
from simcore.reference.r22_comparison import add_reference
from simcore.reference.r22_tables import parse_r22_models, read_r22_table, rhine_statistics
from simcore.report.figures.models import form_figure, prediction_figure, shape_kind_figure
from simcore.report.figures.studies import porosities_figure, trends_figure
from simcore.report.figures.zingg import form_sets_figure, porosity_zingg_figure
from simcore.report.findings import Findings

EARLIER = "These packings were simulated with earlier settings of the campaign; their bias is not given here."
_RESULT = ("n", "n_std_error", "grains", "cpu_s")


def findings(folder, seed=0, folds=FOLDS, studies=None):
    """Return (tables, figures) of the rows in `folder`, dicts by name of DataFrames and matplotlib Figures.

    folder: contains the tables written by simcore.campaign.gathering. seed, folds: of the cross-validation. studies:
    names of the studies whose trends over height are shown; None: all. ValueError if the folder has no table of
    packings.
    """
    folder = Path(folder)
    rows = {name: read_rows(folder / f"{name}.csv") for name in SHOWN_TABLES if (folder / f"{name}.csv").exists()}
    if not rows:
        raise ValueError(f"{folder}: there is no table of packings; gather some first with: snakemake collect")
    results = Findings()
    if "single_form" in rows:
        results |= _single_forms(rows["single_form"], seed, folds)
        results |= _shape_kinds(rows["single_form"], rows.get("near_spheres"))
    if "form_mixture" in rows:
        results |= _mixtures(rows["form_mixture"], seed, folds)
    if {"single_form", "form_mixture"} <= set(rows):
        results |= _unified(rows["single_form"], rows["form_mixture"], seed, folds)
    if "application" in rows and any(name == "form_mixture" for name, _ in results.models):
        results |= Findings({"application_predictions": _application(rows["application"], results.models)})
    for study in set(PLAIN_STUDIES) & set(rows):
        results |= _plain_study(rows[study], study)
    results |= _biases(folder)
    results |= _trends(folder, studies)
    return results.tables, results.figures


def gathered_packings(folder, studies):
    """Return the gathered packings of these studies as {"collected": DataFrame}; empty without a collected.csv."""
    path = Path(folder) / "collected.csv"
    if not path.exists():
        return {}
    rows = read_named_table(path)
    return {"collected": rows[rows["study"].isin(studies)].drop(columns=["table", "command"])}


def notes_of_rows(biases, gathered):
    """Return the notes on biases by study; EARLIER for a study whose rows all have earlier settings.

    biases: notes by study, which describe the present settings. gathered: result of `gathered_packings`. A study of
    which no packing with the present settings was gathered has only rows of earlier settings.
    """
    if "collected" not in gathered:
        return dict(biases)
    n_packings = gathered["collected"].groupby("study")["packings"].sum()
    return biases | {study: EARLIER for study, packings in n_packings.items() if packings == 0}


def read_rows(path):
    """Read a committed table with the columns of study_tables.tabulate; a column that it lacks is nan.

    The statistics over the grains of a packing come from the columns L, I, S if there are any, else from the columns
    mu_EQ to sigma_EL. Cases are in the order of config/cases.tsv, followed by all others.
    """
    table = read_named_table(path)
    table = table.rename(columns={**study_names(), "run": "seed"})
    rank = {case: i for i, case in enumerate(read_cases(CONFIG / "cases.tsv"))}
    table = table.sort_values("case", key=lambda case: case.map(rank), kind="stable", ignore_index=True)
    if "L" in table:
        table = table.assign(EQ=table["S"] / table["L"], EL=table["I"] / table["L"], FL=table["S"] / table["I"])
        table = table.assign(sigma_EQ=0.0, sigma_EL=0.0, sigma_FL=0.0)
    elif {"flatness", "elongation"} <= set(table):
        flatness, elongation = (table[name].fillna(1.0) for name in ("flatness", "elongation"))  # nan for spheres
        table = table.assign(FL=flatness, EL=elongation, EQ=flatness * elongation)
    missing = [name for name in (*FORM, "n_exact", "coordination_number") if name not in table]
    return table.assign(**dict.fromkeys(missing, np.nan), study=Path(path).stem)


def _single_forms(packings, seed, folds):
    """Fit models of single forms for each source of grains; only those of SOURCE_OF_MIXTURES are among the models."""
    results, parts = Findings(), {}
    sources = fitted_forms(packings)["source"].dropna().unique()
    for source in sorted(sources, key=lambda name: (name != SOURCE_OF_MIXTURES, name)):
        of_source = _single_forms_of(source, fitted_forms(packings, source), seed, folds)
        for name, table in of_source.tables.items():
            parts.setdefault(name, []).append(_with_source(table, source))
        results |= of_source._replace(tables={}, models=of_source.models if source == SOURCE_OF_MIXTURES else {})
    return results._replace(tables={name: pd.concat(tables, ignore_index=True) for name, tables in parts.items()})


def _single_forms_of(source, rows, seed, folds):
    """Return the porosities of grains of one source, and the models of their cases with enough forms for a fit."""
    correlations, r22_models = read_r22_table("correlations"), read_r22_table("models")
    means = add_reference(summarise(rows, ["case"]), "single_form")
    tables = {"single_form_porosities": means}
    fitted = rows.groupby("case", sort=False).filter(lambda of: of["grain"].nunique() >= fewest_samples(SINGLE_FORM))
    if fitted.empty:
        return Findings(tables)
    of_source, models = single_form_models(
        fitted, correlations, read_r22_table("table9_second_factor_mae"), r22_models, seed, folds
    )
    for name, table in of_source.items():
        tables["single_form" if name == "models" else f"single_form_{name}"] = table
    tables["single_form_mean_form"] = _at_mean_form(models, r22_models)
    shown = {case: model for (name, case), model in models.items() if name == "single_form"}
    axes = rows.groupby(["case", "grain"])[list("LIS")].mean().reset_index()
    beds = means[means["case"].isin(shown)].merge(axes, on=["case", "grain"]).reset_index(drop=True)
    features = form_features(*(beds[axis] for axis in "LIS"))
    compared = pd.concat([beds[["case", "n", "n_std_error", "r22_n"]], features], axis=1)
    figures = {
        f"single_form_features_{source}": form_figure(beds, r22_correlations=correlations, r22_models=r22_models),
        f"single_form_zingg_{source}": porosity_zingg_figure(beds, shown),
        f"single_form_prediction_{source}": prediction_figure(
            compare_predictions(models, "single_form", compared), list(shown.values())
        ),
    }
    return Findings(tables, figures, models)


def _with_source(table, source):
    """Add the source of the grains as the first column."""
    return table.assign(source=source)[["source", *table.columns.drop("source", errors="ignore")]]


def _at_mean_form(models, r22_models):
    """Predict the porosity at the mean form of Rettinger et al., by our models and by theirs: one row per case."""
    form, published = rhine_statistics(), parse_r22_models(r22_models)
    features = pd.DataFrame({"EQ_inv": [1.0 / (form["mu_FL"] * form["mu_EL"])], "EL_inv": [1.0 / form["mu_EL"]]})
    rows = []
    for (name, case), model in models.items():
        if name == "single_form":
            n, lower, upper = (value[0] for value in model.predict_interval(features))
            r22_n = published[name, case].porosity(features)[0] if (name, case) in published else np.nan
            row = {"case": case, "FL": form["mu_FL"], "EL": form["mu_EL"], "n": n, "lower_95": lower, "upper_95": upper}
            rows.append(row | {"r22_n": r22_n})
    table = pd.DataFrame(rows)
    return table.assign(difference=table["n"] - table["r22_n"])


def _shape_kinds(packings, near_spheres):
    """Compare polyhedra with their equivalent ellipsoids, and show ellipsoids that are rounder than any grain."""
    ellipsoids = packings[(packings["source"] == SOURCE_OF_MIXTURES) & (packings["kind"] == "ellipsoid")]
    pairs = pair_shape_kinds(fitted_forms(packings, SOURCE_OF_MIXTURES), ellipsoids)
    if pairs.empty:
        return Findings()
    table = shape_kind_table(pairs, read_r22_table("polyhedron_ellipsoid_difference"))
    round_ones = None if near_spheres is None else _beside(near_spheres, "near_spheres")
    return Findings(
        {"shape_kind_pairs": pairs, "shape_kinds": table}, {"shape_kinds": shape_kind_figure(pairs, round_ones)}
    )


def _application(packings, models):
    """Predict packings to which no model was fitted; their values are means over the seeds."""
    kind = np.where(packings["choice"] == "random", "discrete", "continuous")
    packed = pd.concat([packings[["case", "n"]].assign(kind=kind), _statistics(packings)], axis=1)
    means = packed.groupby(["case", "kind"], sort=False).mean().reset_index()
    return application_table(models, means, read_r22_table("table11_application"))


def _mixtures(packings, seed, folds):
    """Fit the models of mixtures, and return them with their tables and figures."""
    fitted, models = mixture_models(
        _samples(packings),
        read_r22_table("correlations"),
        read_r22_table("table10_form_mixture_features"),
        read_r22_table("models"),
        seed,
        folds,
    )
    tables = {("form_mixture" if name == "models" else f"form_mixture_{name}"): part for name, part in fitted.items()}
    figures = {}
    means = add_reference(summarise(packings, list(SPECIFIED_FORM)), "form_mixtures")
    tables["form_mixture_porosities"] = means
    if models:
        compared = pd.concat([means[["case", "n", "n_std_error", "r22_n"]], _statistics(means)], axis=1)
        predictions = compare_predictions(models, "form_mixture", compared)
        # The two models are compared, not packings: Rettinger et al. do not publish porosities of single packings.
        means["model_n"] = predictions["predicted"]
        means["model_difference"] = means["model_n"] - means["r22_n"]
        figures["form_mixture_prediction"] = prediction_figure(predictions, list(models.values()))
    # The rows have statistics of EQ and EL; FL and EL of the grains were drawn independently.
    of_grains = _statistics(means)
    mu_FL, sigma_FL = flatness_statistics(*(of_grains[name] for name in STATISTICS))
    realised = of_grains.assign(mu_FL=mu_FL, sigma_FL=sigma_FL, case=means["case"], n=means["n"])
    figures["form_mixture_sets"] = form_sets_figure(realised, rhine_statistics())
    return Findings(tables, figures, models)


def _unified(forms, mixtures, seed, folds):
    """Fit the unified model for beds of one form and for mixtures."""
    fitted = fitted_forms(forms, SOURCE_OF_MIXTURES)
    unified, models = unified_models(fitted, _samples(mixtures), read_r22_table("models"), seed, folds)
    return Findings({"unified": unified["models"], "unified_feature_sets": unified["feature_sets"]}, {}, models)


def _samples(packings):
    """Return the mixtures that are fitted, with the features of all models of mixtures."""
    beds = fitted_mixtures(packings)[["case", "n", *SPECIFIED_MEANS, "sample"]]
    return pd.concat([beds, _statistics(packings)], axis=1)


def _statistics(packings):
    """Return the features of the models of mixtures, from the statistics over the grains of each packing."""
    renamed = packings.rename(columns={"EQ": "mu_EQ", "EL": "mu_EL"})
    return unified_features(renamed[list(STATISTICS)])[list(dict.fromkeys([*STATISTICS, *MIXTURE, *UNIFIED]))]


def _plain_study(packings, study):
    """Return the means of a study with the values of Rettinger et al. (2022), and its figure."""
    table = _beside(packings, study)
    return Findings({study: table}, {study: porosities_figure(table, ["case", *_varied(packings)])})


def _beside(packings, study):
    """Return means over the seeds with the values of Rettinger et al. (2022)."""
    return add_reference(summarise(packings, _varied(packings)), study)


def _varied(packings):
    """Return the columns of a study's table that the study varies."""
    others = {"study", "seed", *_RESULT, *FORM, "n_exact", "coordination_number", "case"}
    return [name for name in packings if name not in others]


def _biases(folder):
    biases = measured_biases(folder)
    return Findings({"biases": biases}) if len(biases) else Findings()


def _trends(folder, studies):
    """Return the trends over height of these studies, or of all."""
    if not (folder / "trends.csv").exists():
        return Findings()
    trends = read_named_table(folder / "trends.csv")
    trends = trends if studies is None else trends[trends["study"].isin(studies)]
    if trends.empty:
        return Findings()
    table = summarise_trends(trends)
    return Findings({"trends": table}, {"trends": trends_figure(table)})

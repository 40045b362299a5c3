"""The source study's tables and figures from rows that are committed: no packing is made, and none need be there.

What a folder such as results/reference has no rows of is left out.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from simcore.campaign.biases import measured_biases
from simcore.campaign.study_tables import summarise
from simcore.campaign.trend_tables import summarise_trends
from simcore.grains.form import features as form_features
from simcore.grains.sieve import read_cases
from simcore.models.mixtures import MIXTURE, application_table, mixture_models
from simcore.models.regression import FOLDS
from simcore.models.shape_kinds import pair_shape_kinds, shape_kind_table
from simcore.models.single_form import single_form_models
from simcore.models.tables import compare_predictions
from simcore.models.unified import STATISTICS, UNIFIED, unified_features, unified_models
from simcore.paths import CONFIG
from simcore.reference.columns import ASKED_FOR, FORM, study_names
from simcore.reference.r22_tables import add_reference, read_r22_table
from simcore.report.figures.models import form_figure, prediction_figure, shape_kind_figure
from simcore.report.figures.studies import porosities_figure, trends_figure
from simcore.report.figures.zingg import form_sets_figure, porosity_zingg_figure
from simcore.report.findings import Findings

MESH, ELLIPSOID = "polyhedron", "ellipsoid"
# Studies whose rows stand beside a table of the source study's, or by themselves.
PLAIN_STUDIES = (
    "mesh_resolution",
    "shaking_cylinder",
    "validation",
    "domain_size",
    "shaking_periodic",
    "near_spheres",
    "application",
)
EARLIER = "These rows are of settings that the campaign had before; this page does not give their bias."
_RESULT = ("n", "n_std_error", "grains", "cpu_s")


def findings(folder, seed=0, folds=FOLDS, studies=None):
    """(tables, figures) of the rows in `folder`, dicts by name of DataFrames and matplotlib Figures.

    folder: tables of simcore.campaign.gathering. seed and folds: of the cross-validation. studies: those whose trends
    over height are shown; None: all. ValueError where the folder has no table of packings.
    """
    folder = Path(folder)
    rows = {
        name: read_rows(folder / f"{name}.csv")
        for name in ("single_form", "form_mixture", *PLAIN_STUDIES)
        if (folder / f"{name}.csv").exists()
    }
    if not rows:
        raise ValueError(f"{folder}: has no table of packings; gather some first: snakemake collect")
    whole = Findings()
    if "single_form" in rows:
        whole |= _single_forms(rows["single_form"], seed, folds)
        whole |= _shape_kinds(rows["single_form"], rows.get("near_spheres"))
    if "form_mixture" in rows:
        whole |= _mixtures(rows["form_mixture"], seed, folds)
    if {"single_form", "form_mixture"} <= set(rows):
        whole |= _unified(rows["single_form"], rows["form_mixture"], seed, folds)
    if "application" in rows and any(name == "form_mixture" for name, _ in whole.models):
        whole |= Findings({"application_predictions": _application(rows["application"], whole.models)})
    for study in set(PLAIN_STUDIES) & set(rows):
        whole |= _plain_study(rows[study], study)
    whole |= _biases(folder)
    whole |= _trends(folder, studies)
    return whole.tables, whole.figures


def gathered_packings(folder, studies):
    """What was packed of these studies, as {"collected": DataFrame}; empty where there is no collected.csv."""
    path = Path(folder) / "collected.csv"
    if not path.exists():
        return {}
    rows = pd.read_csv(path)
    return {"collected": rows[rows["study"].isin(studies)].drop(columns=["table", "code", "command", "machine"])}


def notes_of_rows(biases, gathered):
    """The notes on bias of each study, which describe the settings of today; rows of earlier settings have another.

    biases: note by study. gathered: of `gathered_packings`; a study none of whose packings has the settings of today
    has only rows of earlier ones.
    """
    if "collected" not in gathered:
        return dict(biases)
    packed = gathered["collected"].groupby("study")["packings"].sum()
    return biases | {study: EARLIER for study, packings in packed.items() if packings == 0}


def read_rows(path):
    """One of the committed tables as study_tables.tabulate has them, what it does not hold as nan.

    Statistics over the grains of a bed: from L, I, S where it holds these, else from its columns mu_EQ to sigma_EL.
    Cases are in the order of config/cases.tsv, others behind.
    """
    table = pd.read_csv(path)
    table = table.rename(columns={**study_names(), "run": "seed"})
    place = {case: i for i, case in enumerate(read_cases(CONFIG / "cases.tsv"))}
    table = table.sort_values("case", key=lambda case: case.map(place), kind="stable", ignore_index=True)
    if "L" in table:
        table = table.assign(EQ=table["S"] / table["L"], EL=table["I"] / table["L"], FL=table["S"] / table["I"])
        table = table.assign(sigma_EQ=0.0, sigma_EL=0.0, sigma_FL=0.0)
    elif {"flatness", "elongation"} <= set(table):
        flatness, elongation = (table[name].fillna(1.0) for name in ("flatness", "elongation"))  # a sphere has none
        table = table.assign(FL=flatness, EL=elongation, EQ=flatness * elongation)
    missing = [name for name in (*FORM, "n_exact", "coordination_number") if name not in table]
    return table.assign(**dict.fromkeys(missing, np.nan), study=Path(path).stem)


def _single_forms(packings, seed, folds):
    """Models of beds of one form, for grains from each source; the models of the synthetic grains."""
    whole, parts = Findings(), {}
    of_sources = packings[packings["kind"] == MESH].groupby("source")
    for source, rows in sorted(of_sources, key=lambda each: (each[0] != "synthetic", each[0])):
        found = _single_forms_of(source, rows, seed, folds)
        for name, table in found.tables.items():
            parts.setdefault(name, []).append(_of_source(table, source))
        whole |= found._replace(tables={}, models=found.models if source == "synthetic" else {})
    return whole._replace(tables={name: pd.concat(each, ignore_index=True) for name, each in parts.items()})


def _single_forms_of(source, rows, seed, folds):
    """Porosities of one source of grains, and the models of its cases with more than four forms."""
    correlations, r22_models = read_r22_table("correlations"), read_r22_table("models")
    means = add_reference(summarise(rows, ["case"]), "single_form")
    tables = {"single_form_porosities": means}
    fitted = rows.groupby("case", sort=False).filter(lambda cases: cases["grain"].nunique() > 4)
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
        f"single_form_features_{source}": form_figure(beds, study=correlations, r22_models=r22_models),
        f"single_form_zingg_{source}": porosity_zingg_figure(beds, shown),
        f"single_form_prediction_{source}": prediction_figure(
            compare_predictions(models, "single_form", compared), list(shown.values())
        ),
    }
    return Findings(tables, figures, models)


def _of_source(table, source):
    """The table with its grains' source in front."""
    return table.assign(source=source)[["source", *table.columns.drop("source", errors="ignore")]]


def _at_mean_form(models, r22_models):
    """Porosity of beds of the study's mean form, by our models and by its own: one row a case."""
    form = read_r22_table("table2_form_statistics").iloc[0]
    features = pd.DataFrame({"EQ_inv": [1.0 / (form["mu_FL"] * form["mu_EL"])], "EL_inv": [1.0 / form["mu_EL"]]})
    rows = []
    for (name, case), model in models.items():
        if name == "single_form":
            n, lower, upper = (value[0] for value in model.predict_interval(features))
            published = r22_models.query("model == 'single_form' and case == @case").iloc[:1]
            r22_n = published["intercept"] + sum(published[each] * features[each][0] for each in features)
            row = {"case": case, "FL": form["mu_FL"], "EL": form["mu_EL"], "n": n, "lower_95": lower, "upper_95": upper}
            rows.append(row | {"r22_n": r22_n.iloc[0] if len(r22_n) else np.nan})
    table = pd.DataFrame(rows)
    return table.assign(difference=table["n"] - table["r22_n"])


def _shape_kinds(packings, near_spheres):
    """Grains beside their equivalent ellipsoids, and ellipsoids that are rounder than any."""
    own = packings[packings["source"] == "synthetic"]
    pairs = pair_shape_kinds(own[own["kind"] == MESH], own[own["kind"] == ELLIPSOID])
    if pairs.empty:
        return Findings()
    table = shape_kind_table(pairs, read_r22_table("polyhedron_ellipsoid_difference"))
    round_ones = None if near_spheres is None else _beside(near_spheres, "near_spheres")
    return Findings(
        {"shape_kind_pairs": pairs, "shape_kinds": table}, {"shape_kinds": shape_kind_figure(pairs, round_ones)}
    )


def _application(packings, models):
    """What the models say of beds that they have not seen, over the seeds."""
    kind = np.where(packings["choice"] == "random", "discrete", "continuous")
    unseen = pd.concat([packings[["case", "n"]].assign(kind=kind), _statistics(packings)], axis=1)
    seen = unseen.groupby(["case", "kind"], sort=False).mean().reset_index()
    return application_table(models, seen, read_r22_table("table11_application"))


def _mixtures(packings, seed, folds):
    """The model of mixtures, its tables and figures."""
    fitted, models = mixture_models(
        _samples(packings).drop(columns=["mean_FL", "mean_EL"]),
        read_r22_table("correlations"),
        read_r22_table("table10_form_mixture_features"),
        read_r22_table("models"),
        seed,
        folds,
    )
    tables = {("form_mixture" if name == "models" else f"form_mixture_{name}"): part for name, part in fitted.items()}
    figures = {}
    means = add_reference(summarise(packings, list(ASKED_FOR)), "form_mixtures")
    tables["form_mixture_porosities"] = means
    if models:
        compared = pd.concat([means[["case", "n", "n_std_error", "r22_n"]], _statistics(means)], axis=1)
        predictions = compare_predictions(models, "form_mixture", compared)
        # Model beside model: what one leaves of its own beds is not told of the study's, which are not published.
        means["model_n"] = predictions["predicted"]
        means["model_difference"] = means["model_n"] - means["r22_n"]
        figures["form_mixture_prediction"] = prediction_figure(predictions, list(models.values()))
    asked_for = means.drop(columns=list(ASKED_FOR.values()), errors="ignore").rename(columns=ASKED_FOR)
    figures["form_mixture_sets"] = form_sets_figure(asked_for)
    return Findings(tables, figures, models)


def _unified(forms, mixtures, seed, folds):
    """The model for beds of one form and for mixtures alike."""
    synthetic = forms[(forms["kind"] == MESH) & (forms["source"] == "synthetic")]
    unified, models = unified_models(synthetic, _samples(mixtures), read_r22_table("models"), seed, folds)
    return Findings({"unified": unified["models"], "unified_feature_sets": unified["feature_sets"]}, {}, models)


def _samples(packings):
    """Mixtures as the models take them; packings that differ in their seed alone are of one sample."""
    sample = packings[list(ASKED_FOR)].astype(str).agg(" ".join, axis=1)
    beds = packings[["case", "n", "mean_FL", "mean_EL"]].assign(sample=sample)
    return pd.concat([beds, _statistics(packings)], axis=1)


def _statistics(packings):
    """Features of the models of mixtures, from the statistics over the grains of each packing."""
    renamed = packings.rename(columns={"EQ": "mu_EQ", "EL": "mu_EL"})
    return unified_features(renamed[list(STATISTICS)])[list(dict.fromkeys([*STATISTICS, *MIXTURE, *UNIFIED]))]


def _plain_study(packings, study):
    """A study beside the values of Rettinger et al. (2022), and its figure."""
    table = _beside(packings, study)
    return Findings({study: table}, {study: porosities_figure(table, ["case", *_varied(packings)])})


def _beside(packings, study):
    """Means over the seeds beside the values of Rettinger et al. (2022)."""
    return add_reference(summarise(packings, _varied(packings)), study)


def _varied(packings):
    """Columns of the table of a study that say what it varies."""
    others = {"study", "seed", *_RESULT, *FORM, "n_exact", "coordination_number", "case"}
    return [name for name in packings if name not in others]


def _biases(folder):
    biases = measured_biases(folder)
    return Findings({"biases": biases}) if len(biases) else Findings()


def _trends(folder, studies):
    """Trends over height of the studies named, or of all."""
    if not (folder / "trends.csv").exists():
        return Findings()
    trends = pd.read_csv(folder / "trends.csv")
    trends = trends if studies is None else trends[trends["study"].isin(studies)]
    if trends.empty:
        return Findings()
    table = summarise_trends(trends)
    return Findings({"trends": table}, {"trends": trends_figure(table)})

"""Models fitted to the packings of a campaign, compared with those of Rettinger et al. (2022), with their figures."""

import pandas as pd

from simcore.grains.form import features as form_features
from simcore.models.mixtures import application_table, mixture_models
from simcore.models.shape_kinds import pair_shape_kinds, shape_kind_table
from simcore.models.single_form import single_form_models
from simcore.models.tables import compare_predictions, over_seeds
from simcore.models.unified import unified_models
from simcore.reference.columns import SPECIFIED_MEANS
from simcore.reference.columns.headings import find_heading
from simcore.reference.named_tables import NAMES
from simcore.reference.r22_comparison import add_reference
from simcore.reference.r22_tables import read_r22_table, rhine_statistics
from simcore.report.figures.models import form_figure, prediction_figure, shape_kind_figure
from simcore.report.figures.zingg import form_sets_figure, porosity_zingg_figure
from simcore.report.findings import OWN, Findings


def single_form_findings(packings, committed, seed, folds) -> Findings:
    """Return correlations, second features and models of beds of one form, per case; figures only of the own cases.

    packings: tables of the packings of this campaign, one DataFrame per study. committed: rows of further cases, as
    from read_single_forms; models are fitted to them too. The column packed_by distinguishes both. seed, folds: of the
    cross-validation.
    """
    require_one_setting(packings)
    packings = add_reference(pd.concat(packings, ignore_index=True), "single_form")
    correlations, r22_models = read_r22_table("correlations"), read_r22_table("models")
    tables, models = single_form_models(
        pd.concat([packings, committed], ignore_index=True) if len(committed) else packings,
        correlations,
        read_r22_table("table9_second_factor_mae"),
        r22_models,
        seed=seed,
        folds=folds,
    )
    own = set(packings.case)
    for table in tables.values():
        table["packed_by"] = [OWN if case in own else "committed rows" for case in table.case]
    shown = {case: model for (name, case), model in models.items() if name == "single_form" and case in own}
    beds = over_seeds(packings, "grain")
    compared = pd.concat([beds[["case", "n", "n_std_error", "r22_n"]], form_features(beds.L, beds.I, beds.S)], axis=1)
    predictions = compare_predictions(models, "single_form", compared)
    figures = {
        "features": form_figure(beds, r22_correlations=correlations, r22_models=r22_models),
        "zingg": porosity_zingg_figure(beds, shown),
        "prediction": prediction_figure(predictions, list(shown.values())),
    }
    return Findings(tables, figures, models)


def require_one_setting(tables):
    """Raise a ValueError if packings of one grain and sieve curve differ in another setting than the seed.

    tables: of studies, as from simcore.campaign.study_tables.tabulate, whose settings are before `kind`.
    """
    packings = pd.concat(tables, ignore_index=True)
    settings = dict.fromkeys(name for table in tables for name in list(table)[: list(table).index("kind")])
    for name in (*NAMES, "seed"):
        settings.pop(name, None)
    for (case, grain), rows in packings.groupby(["case", "grain"], sort=False):
        for name in settings:
            if rows[name].nunique(dropna=False) > 1:
                studies = " and ".join(dict.fromkeys(rows["study"]))
                raise ValueError(
                    f"study {studies}: packings of grain {grain} in {case} differ in {find_heading(name).words} "
                    f"({name}), and a model of beds of one form would mix them; pack the others in a study whose name "
                    "does not begin with single_form"
                )


def form_mixture_findings(features, packings, application, seed, folds) -> Findings:
    """Return correlations, feature sets and models of form mixtures, and predictions of packings outside the fit.

    features: table of features of the study form_mixtures; packings: the table of its packings. application: features
    of the packings to predict, or None. seed, folds: of the cross-validation.
    """
    specified = ["packing", *SPECIFIED_MEANS]
    sets = features.merge(packings[specified], on="packing") if set(specified) <= set(packings) else features
    tables, models = mixture_models(
        sets.drop(columns=["packing", "kind", "note"], errors="ignore"),
        read_r22_table("correlations"),
        read_r22_table("table10_form_mixture_features"),
        read_r22_table("models"),
        seed=seed,
        folds=folds,
    )
    if application is not None:
        tables["application"] = application_table(models, application, read_r22_table("table11_application"))
    rows = add_reference(packings, "form_mixtures")[["packing", "n_std_error", "r22_n"]]
    predictions = compare_predictions(models, "form_mixture", features.merge(rows, on="packing"))
    figures = {
        "sets": form_sets_figure(features, rhine_statistics()),
        "prediction": prediction_figure(predictions, list(models.values())),
    }
    return Findings(tables, figures, models)


def unified_findings(single_forms, mixtures, features, seed, folds) -> Findings:
    """Return the unified model for beds of one form and for mixtures, compared with separate models, per case.

    single_forms, mixtures: tables of the packings of both studies; features: table of features of the mixtures.
    """
    specified = ["packing", *SPECIFIED_MEANS]
    if set(specified) <= set(mixtures):
        features = features.merge(mixtures[specified], on="packing")
    tables, models = unified_models(single_forms, features, read_r22_table("models"), seed=seed, folds=folds)
    return Findings(tables, {}, models)


def shape_kind_findings(polyhedra, ellipsoids, near_spheres) -> Findings:
    """Return the differences in porosity between packings of polyhedra and of their equivalent ellipsoids.

    near_spheres: table of packings of rounder ellipsoids, or None.
    """
    pairs = pair_shape_kinds(polyhedra, ellipsoids)
    table = shape_kind_table(pairs, read_r22_table("polyhedron_ellipsoid_difference"))
    return Findings({"pairs": pairs, "table": table}, {"figure": shape_kind_figure(pairs, near_spheres)})

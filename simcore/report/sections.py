"""Texts and sections of a campaign's report page, and the page of committed rows."""

from pathlib import Path

import pandas as pd

from simcore.models.formulas import BEDS, formulas
from simcore.reference.columns import FORM
from simcore.report.page import bullets, page, paragraph, picture, rows_table, table

TITLE = "Scree: porosity from the form of grains"
LEAD = (
    "How porous is a bed of gravel, given the form of its grains? Packings were simulated by the discrete element "
    "method: grains fall into a box, are shaken, and come to rest. This page shows the models of porosity fitted to "
    "them, the cost of each study, {grains}and the results of each study. Porosity n is the volume fraction of voids, "
    "from 0 to 1. Form is described by the axes L ≥ I ≥ S of a grain: flatness FL = S/I, elongation EL = I/L and "
    "equancy EQ = S/L, which are 1 for a grain that is not flat and not elongated. X_inv is 1/X; mu and sigma are mean "
    "and standard deviation over the grains. Columns that begin with r22_ contain the values of Rettinger, Rüde, "
    "Vollmer and Frings (2022)."
)
STUDIES = (
    "n: bulk porosity by volume-equivalent spheres, as by Rettinger et al.; n_exact: by slices of the grains "
    "themselves. n_std_error: sampling error of the mean; n_seed_error: standard error from the scatter over the "
    "seeds. r22_n: porosity given by Rettinger et al., which applies to their own, larger domains; for single forms "
    "and mixtures it is the prediction of their fitted model for the forms of our packings. difference: n minus "
    "r22_n; z: the difference divided by the standard error of both. model_n: prediction of our model; "
    "model_difference: model_n minus r22_n, which compares the two models without the residuals of their packings. "
    "cpu_h: CPU hours of all packings of a row."
)
CAMPAIGN = (
    "r22_cpu_h: core hours that the program of Rettinger et al. takes for the same number of grains times steps. "
    "relative_change: change from the lower to the upper end of the beds, divided by the mean; spearman_z: rank "
    "correlation with height, divided by its standard error; isotropic: mean angle of long axes without a preferred "
    "direction [rad], for comparison with the mean."
)
IN_SHORT = (
    "The fitted models are for beds of clean gravel, poured and shaken. error: mean absolute error of porosity for "
    "beds that were left out of the fit (cross-validation); range: forms to which the model was fitted; µ, σ: mean and "
    "standard deviation over the grains of a bed; case: sieve curve, where U1 is a single sieve class; r22: formula of "
    "Rettinger et al."
)
COLLECTED = (
    "Number of packings gathered of each study, number planned, and estimated time for the rest. Packings with earlier "
    "settings are in the tables, but are not counted here."
)
BIASES = (
    "Biases of porosity caused by numerical settings, size of the bed, duration of shaking and insertion height. They "
    "were measured on separate packings."
)
# Order of the tables and figures of simcore.report.committed that concern models; others follow the one whose name is a
# prefix of theirs.
MODELS = (
    "single_form",
    "single_form_mean_form",
    "single_form_features",
    "single_form_prediction",
    "single_form_zingg",
    "form_mixture",
    "form_mixture_sets",
    "form_mixture_prediction",
    "unified",
    "application_predictions",
    "shape_kinds",
    "single_form_correlations",
    "single_form_second_features",
    "form_mixture_correlations",
    "form_mixture_feature_sets",
    "unified_feature_sets",
)
# Name of the table and figure of a study, where it differs from the name of the study.
OF_A_STUDY = {
    "single_form": "single_form_porosities",
    "form_mixtures": "form_mixture_porosities",
    "equivalent_ellipsoids": "shape_kind_pairs",
}
# Columns of the tables of studies and models that are moved to the right end.
BEHIND = (
    "n_std",
    "n_seed_error",
    *FORM,
    "r22_n_std",
    "r22_n_error",
    "grains",
    "n_exact",
    "coordination_number",
    "bootstrap_lower_95",
    "bootstrap_upper_95",
    "feature_min",
    "feature_max",
    "r_squared",
    "rmse",
    "scatter",
)
WARNINGS_SHOWN, NAMES_SHOWN = 12, 3  # maximum number of warnings per study, and of packings per warning
_CAPTIONS = {"application_predictions": "models_application"}


def read_caption(folder, name):
    """Return the text of `name`.rst in the folder of captions; Snakemake's own report uses the same files."""
    return " ".join((Path(folder) / f"{name}.rst").read_text(encoding="utf-8").split())


def in_short(paths):
    """Return fragments with the formulas of the models whose tables of coefficients are among the CSV files `paths`."""
    by_name = {Path(path).stem: path for path in paths}
    tables = [formulas(pd.read_csv(by_name[name])) for name in BEDS if name in by_name]
    return [paragraph(IN_SHORT), rows_table(pd.concat(tables, ignore_index=True))] if tables else []


def packing_warnings(path):
    """Return fragments that list the warnings of a study's packings, an empty list without warnings.

    path: CSV file with one row per packing, columns packing and warnings, from simcore.campaign.study_tables.tabulate.
    """
    rows = pd.read_csv(path, dtype=str, keep_default_na=False)
    by_text = {}
    for name, text in zip(rows["packing"], rows.get("warnings", [""] * len(rows)), strict=True):
        for line in filter(None, text.split("\n")):
            by_text.setdefault(line, []).append(name)
    if not by_text:
        return []
    items = [f"{_some_names(names)}: {line}" for line, names in list(by_text.items())[:WARNINGS_SHOWN]]
    n_hidden = len(by_text) - len(items)
    items += [f"{n_hidden} further warnings are listed in {path}."] if n_hidden else []
    return [paragraph("Warnings of packings:"), bullets(items)]


def _some_names(names):
    """Return the first names of these packings and the number of others as text."""
    shown, others = ", ".join(names[:NAMES_SHOWN]), len(names) - NAMES_SHOWN
    return f"{shown} and {others} more" if others > 0 else shown


def committed_page(folder, titles, biases, captions):
    """Return the page of a campaign's committed rows as HTML text.

    folder: contains the tables and figures of simcore.report.committed, with collected.csv of the gathered packings.
    titles, biases: dicts from the name of a study to its title and its text on biases. captions: folder of the
    captions, as in `read_caption`.
    """
    folder = Path(folder)
    tables, figures = ({path.stem: path for path in sorted(folder.glob(f"*.{end}"))} for end in ("csv", "png"))
    names_of_studies = {study: OF_A_STUDY.get(study, study) for study in titles}

    def of_models(paths):
        names = [name for name in paths if name.startswith(MODELS) and name not in names_of_studies.values()]
        names.sort(key=lambda name: (_place(name), not name.endswith("_synthetic"), name))
        return [(paths[name], _model_caption(captions, name)) for name in names]

    def fragment(path, caption):
        return picture(path, caption) if path.suffix == ".png" else table(path, caption, BEHIND)

    def caption_of(name):
        return read_caption(captions, name)

    cost = [paragraph(CAMPAIGN)]
    if "trends" in figures:
        cost.append(fragment(figures["trends"], caption_of("campaign_trends")))
    cost_tables = (
        ("collected", COLLECTED, ()),
        ("biases", BIASES, ("inserted", "kind", "source")),
        ("trends", caption_of("campaign_trends"), ()),
    )
    cost += [table(tables[name], *arguments) for name, *arguments in cost_tables if name in tables]
    sections = [
        ("In short", in_short(tables.values())),
        ("Models", [fragment(*shown) for shown in (*of_models(figures), *of_models(tables))]),
        ("Cost, and order in the beds", cost),
        ("Studies", [paragraph(STUDIES)]),
    ]
    for study, name in names_of_studies.items():
        if name in tables:
            shown = [fragment(figures[name], caption_of("study_porosities"))] if name in figures else []
            caption = caption_of("models_shape_kinds" if name == "shape_kind_pairs" else "study_table")
            sections.append((titles[study], [fragment(tables[name], caption), paragraph(biases[study]), *shown]))
    return page(TITLE, LEAD.format(grains=""), [section for section in sections if section[1]])


def _place(name):
    """Return the place in MODELS of the longest entry with which the name begins."""
    return MODELS.index(max((start for start in MODELS if name.startswith(start)), key=len))


def _model_caption(folder, name):
    """Return the caption of a model's table or figure; names of figures of single forms end with the grains' source."""
    available = {path.stem for path in Path(folder).glob("models_*.rst")}
    wanted = _CAPTIONS.get(name, f"models_{name}")
    caption = max((name for name in available if wanted.startswith(name)), key=len, default=None)
    if caption is None:
        return ""
    source = wanted.removeprefix(caption).strip("_")
    return read_caption(folder, caption) + (f" Grains: {source}." if source else "")

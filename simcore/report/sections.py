"""What a campaign's page says: of packings that are there, or of rows that are committed alone."""

from pathlib import Path

import pandas as pd

from simcore.models.formulas import BEDS, formulas
from simcore.reference.columns import FORM
from simcore.report.page import bullets, page, paragraph, picture, rows_table, table

TITLE = "Scree: porosity from the form of grains"
LEAD = (
    "How porous is a bed of gravel, given the form of its grains? Beds were packed by the discrete element method: "
    "grains fall into a box, are shaken, and come to rest. This page has the models of porosity fitted to them, "
    "what each study cost, {grains}and each study. Porosity n is the share of voids, from 0 to 1; form is described "
    "by the axes L, I, S of a grain: flatness FL = S/I, elongation EL = I/L, equancy EQ = S/L, of which X_inv is "
    "1/X, mu and sigma mean and standard deviation over the grains. Columns that begin with r22_ hold "
    "the values of Rettinger, Rüde, Vollmer and Frings (2022)."
)
STUDIES = (
    "n: bulk porosity by volume-equivalent spheres, as in the study; n_exact: by slicing the grains themselves. "
    "n_std_error: sampling error of the mean; n_seed_error: standard error from the scatter over the seeds; "
    "difference: ours less the study's; z: the same in standard errors of both. cpu_h: of all runs of a row. "
    "r22_n holds for the study's own, larger domains; for single forms and mixtures it is what the study's fitted "
    "model says for the forms of our packings; model_n is what ours says, model_difference that less the study's, "
    "without what either model leaves of its own beds."
)
CAMPAIGN = (
    "r22_cpu_h: core-hours of the source study's program for as many grains times steps. relative_change: from the "
    "lower to the upper end of the beds; spearman_z: rank correlation with height in its standard errors; isotropic: "
    "mean angle of long axes that point anywhere [rad], beside the mean."
)
IN_SHORT = (
    "The fitted models: beds of clean gravel, poured and shaken. error: mean absolute one in porosity, of beds the "
    "model was not fitted to (cross-validated); range: of the forms fitted; µ, σ: mean and standard deviation "
    "over the grains of a bed; case: sieve curve, U1 a single sieve class. The study's own formula stands beside."
)
COLLECTED = (
    "What was packed of each study, of how many packings planned, and how long the rest would take. Rows of earlier "
    "settings stand in the tables and are not counted here."
)
BIASES = "How far porosities are off for settings, size of the bed, time of shaking and births, measured on other beds."
# Of the tables and figures of simcore.report.committed those that tell of models, the models themselves first; and
# those of a study by its name. What is not named follows the one whose name it begins with.
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
OF_A_STUDY = {
    "single_form": "single_form_porosities",
    "form_mixtures": "form_mixture_porosities",
    "equivalent_ellipsoids": "shape_kind_pairs",
}
# Columns of a study's or a model's table that stand behind those a reader asks for first.
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
WARNINGS_SHOWN, NAMES_SHOWN = 12, 3  # on the page, of a study and of a warning
_CAPTIONS = {"application_predictions": "models_application"}


def read_caption(folder, name):
    """The text `name`.rst in the folder of captions, which Snakemake's own report has for this file too."""
    return " ".join((Path(folder) / f"{name}.rst").read_text(encoding="utf-8").split())


def in_short(paths):
    """Fragments that give the formulas of the models whose tables of coefficients are among the CSV files `paths`."""
    of_models = {Path(path).stem: path for path in paths}
    known = [formulas(pd.read_csv(of_models[name])) for name in BEDS if name in of_models]
    return [paragraph(IN_SHORT), rows_table(pd.concat(known, ignore_index=True))] if known else []


def packing_warnings(path):
    """Fragments that list the warnings of a study's packings; none where there are none.

    path: CSV file with one row a packing, columns packing and warnings, as of simcore.campaign.study_tables.tabulate.
    """
    rows = pd.read_csv(path, dtype=str, keep_default_na=False)
    by_text = {}
    for name, text in zip(rows["packing"], rows.get("warnings", [""] * len(rows)), strict=True):
        for line in filter(None, text.split("\n")):
            by_text.setdefault(line, []).append(name)
    if not by_text:
        return []
    items = [f"{_some_names(names)}: {line}" for line, names in list(by_text.items())[:WARNINGS_SHOWN]]
    more = len(by_text) - len(items)
    items += [f"{more} further warnings are listed in {path}."] if more else []
    return [paragraph("Warnings of packings:"), bullets(items)]


def _some_names(names):
    """Return the first of these names of packings, and how many others there are, in words."""
    shown, others = ", ".join(names[:NAMES_SHOWN]), len(names) - NAMES_SHOWN
    return f"{shown} and {others} more" if others > 0 else shown


def committed_page(folder, titles, biases, captions):
    """The page of a campaign's committed rows as text.

    folder: of the tables and figures of simcore.report.committed, with collected.csv, what was gathered. titles and
    biases: of each study, by its name. captions: their folder, as of `read_caption`.
    """
    folder = Path(folder)
    tables, figures = ({path.stem: path for path in sorted(folder.glob(f"*.{end}"))} for end in ("csv", "png"))
    of_a_study = {study: OF_A_STUDY.get(study, study) for study in titles}

    def of_models(paths):
        taken = [name for name in paths if name.startswith(MODELS) and name not in of_a_study.values()]
        taken.sort(key=lambda name: (_place(name), not name.endswith("_synthetic"), name))
        return [(paths[name], _model_caption(captions, name)) for name in taken]

    def fragment(path, caption):
        return picture(path, caption) if path.suffix == ".png" else table(path, caption, BEHIND)

    def said(name):
        return read_caption(captions, name)

    cost = [paragraph(CAMPAIGN)]
    if "trends" in figures:
        cost.append(fragment(figures["trends"], said("campaign_trends")))
    told = (
        ("collected", COLLECTED, ()),
        ("biases", BIASES, ("born", "kind", "source")),
        ("trends", said("campaign_trends"), ()),
    )
    cost += [table(tables[name], *what) for name, *what in told if name in tables]
    sections = [
        ("In short", in_short(tables.values())),
        ("Models", [fragment(*each) for each in (*of_models(figures), *of_models(tables))]),
        ("Cost, and order in the beds", cost),
        ("Studies", [paragraph(STUDIES)]),
    ]
    for study, name in of_a_study.items():
        if name in tables:
            shown = [fragment(figures[name], said("study_porosities"))] if name in figures else []
            caption = said("models_shape_kinds" if name == "shape_kind_pairs" else "study_table")
            sections.append((titles[study], [fragment(tables[name], caption), paragraph(biases[study]), *shown]))
    return page(TITLE, LEAD.format(grains=""), [section for section in sections if section[1]])


def _place(name):
    """Of the longest of MODELS that a name begins with."""
    return MODELS.index(max((start for start in MODELS if name.startswith(start)), key=len))


def _model_caption(folder, name):
    """Of a model's table or figure; figures of single forms have the grains' source behind their name."""
    known = {path.stem for path in Path(folder).glob("models_*.rst")}
    wanted = _CAPTIONS.get(name, f"models_{name}")
    found = max((each for each in known if wanted.startswith(each)), key=len, default=None)
    if found is None:
        return ""
    behind = wanted.removeprefix(found).strip("_")
    return read_caption(folder, found) + (f" Grains: {behind}." if behind else "")

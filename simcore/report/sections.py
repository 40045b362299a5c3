"""Texts and sections of a campaign's report page, and the page of committed rows."""

from pathlib import Path

import pandas as pd

from simcore.grains.text_lists import join_first
from simcore.reference.columns.headings import find_heading
from simcore.report.answers import answer, by_stem, how_sure, unseen
from simcore.report.outcomes import outcome, shows_more, varied_columns
from simcore.report.page import Section, bullets, folded, page, paragraph, picture, rows_table, table
from simcore.report.tables import read_table
from simcore.report.words import value_in_words

TITLE = "Scree: porosity of gravel from the form of its grains"
LEAD = (
    "How porous is a bed of gravel, given the form of its grains? Packings were simulated by the discrete element "
    "method: grains fall into a box, are shaken, and come to rest. Porosity n is the volume fraction of voids, from 0 "
    "to 1. Form is described by the axes L ≥ I ≥ S of a grain: flatness FL = S/I, elongation EL = I/L and equancy EQ = "
    "S/L, which are 1 for a grain that is not flat and not elongated. A number after ± is a standard error. Rettinger "
    "et al. are Rettinger, Rüde, Vollmer and Frings (Granular Matter, 2022)."
)
STUDIES = (
    "A study is a table of packings in which one thing is varied. Errors of differences take packings as independent; "
    "`scree compare` pairs those of equal seeds. Where values of Rettinger et al. are given, they apply to their own "
    "beds; for beds of one form and for distributions of form, they are predictions of their fitted models for the "
    "forms of our packings."
)
COLLECTED = (
    "Number of packings gathered of each study, number planned, and estimated time for the rest. Packings with earlier "
    "settings are in the tables, but are not counted here."
)
EFFECTS = "Effects of the settings of this study on the porosity, measured on other packings. They may not be added."
ANSWER, SURE, MODELS_HEADING, STUDIES_HEADING = "The answer", "How sure is this?", "Models", "Studies"
COST_HEADING = "Cost, and order in the beds"
# Studies that show how good the models are, so that they come before the others
EVIDENCE = ("validation", "application")
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
WARNINGS_SHOWN, NAMES_SHOWN = 12, 3  # maximum number of warnings per study, and of packings per warning
_CAPTIONS = {"application_predictions": "models_application"}


def read_caption(folder, name):
    """Return the text of `name`.rst in the folder of captions; Snakemake's own report uses the same files."""
    return " ".join((Path(folder) / f"{name}.rst").read_text(encoding="utf-8").split())


def packing_warnings(path):
    """Return parts that list the warnings of a study's packings, an empty list without warnings.

    path: CSV file with one row per packing, columns packing and warnings, from simcore.campaign.study_tables.tabulate.
    """
    rows = pd.read_csv(path, dtype=str, keep_default_na=False)
    by_text = {}
    for name, text in zip(rows["packing"], rows.get("warnings", [""] * len(rows)), strict=True):
        for line in filter(None, text.split("\n")):
            by_text.setdefault(line, []).append(name)
    if not by_text:
        return []
    items = [f"{join_first(names, NAMES_SHOWN)}: {line}" for line, names in list(by_text.items())[:WARNINGS_SHOWN]]
    n_hidden = len(by_text) - len(items)
    items += [f"{n_hidden} further warnings are listed in {path}."] if n_hidden else []
    return [paragraph("Warnings of packings:"), bullets(items)]


def study_section(title, path, question="", effects="", **more):
    """Return the Section of a study: what was asked, what came out, its table, its effects and its figures.

    path: its table. question: what was asked; by default it follows from the columns of the table. effects: measured
    effects of its settings, (kind, text) each, or a text. more: caption of the table, warnings and pictures, lists of
    parts; figure, the part with its porosities, which is left out if the sentences contain as much; before and remarks,
    sentences before and after those on what came out.
    """
    rows = read_table(path)
    summary, *others = [*more.get("before", ()), *outcome(rows)]
    parts = [paragraph(question or _question(rows), "asked"), paragraph(summary, "outcome")]
    parts += [paragraph(" ".join(others), "text")] if others else []
    parts += [paragraph(text, "text") for text in more.get("remarks", ())]
    parts.append(table(path, more.get("caption") or _study_caption(rows)))
    figure = more.get("figure")
    parts += [figure] if figure is not None and shows_more(rows) else []
    if isinstance(effects, str):
        parts += [paragraph(effects)] if effects else []
    elif effects:
        listed = rows_table(pd.DataFrame(effects, columns=["of", "effect"]), EFFECTS, "report/effects")
        parts.append(folded("Effects of the settings on these porosities", [listed]))
    return Section(title, [*parts, *more.get("warnings", ()), *more.get("pictures", ())], 3)


def _question(rows):
    """Return what a study asks, from the settings that differ between its rows."""
    varied = varied_columns(rows)
    if not varied:
        return "What is the porosity with these settings?"
    return f"How does the porosity depend on: {', '.join(find_heading(name).words for name in varied)}?"


def _study_caption(rows):
    published = "r22_n" in rows and rows["r22_n"].notna().any()
    return "Porosity for each setting of the study" + (
        " and the values of Rettinger et al. (2022)." if published else "."
    )


def committed_page(folder, titles, biases, captions, questions=None, made=""):
    """Return the page of a campaign's committed rows as HTML text.

    folder: contains the tables and figures of simcore.report.committed, with collected.csv of the gathered packings.
    titles, questions: dicts from the name of a study to its title and what it asks. biases: dict from the name to the
    measured effects of its settings, as for `study_section`. captions: folder of the captions, as in `read_caption`.
    made: when and by which code the page is made.
    """
    return page(TITLE, LEAD, committed_sections(folder, titles, biases, captions, questions or {}), "", made)


def committed_sections(folder, titles, biases, captions, questions, names=(ANSWER, SURE, MODELS_HEADING)):
    """Return the sections on a campaign's committed rows; arguments as of `committed_page`.

    names: headings of the answer, of what it rests on, and of the models.
    """
    folder = Path(folder)
    tables, figures = (by_stem(sorted(folder.glob(f"*.{end}"))) for end in ("csv", "png"))
    of_studies = {study: OF_A_STUDY.get(study, study) for study in titles}
    studies = {
        study: study_section(
            titles[study],
            tables[name],
            questions.get(study, ""),
            biases.get(study, ""),
            before=unseen(tables) if study == "application" else (),
            caption=read_caption(captions, "models_shape_kinds") if name == "shape_kind_pairs" else "",
            figure=picture(figures[name], read_caption(captions, "study_porosities")) if name in figures else None,
        )
        for study, name in of_studies.items()
        if name in tables
    }
    sections = [
        Section(names[0], answer(tables)),
        Section(names[1], how_sure(tables) if set(tables) & {"biases", *MODELS} else []),
        *(section for study, section in studies.items() if study in EVIDENCE),
        Section(names[2], _model_parts(tables, figures, {*of_studies.values(), *OF_A_STUDY.values()}, captions)),
        Section(STUDIES_HEADING, [paragraph(STUDIES)] if set(studies) - set(EVIDENCE) else []),
        *(section for study, section in studies.items() if study not in EVIDENCE),
        Section(COST_HEADING, _cost_parts(tables, figures, captions)),
    ]
    return without_empty(sections)


def without_empty(sections):
    """Return the sections that have parts, or sections of their own below them."""
    following = [*sections[1:], None]
    return [
        section
        for section, other in zip(sections, following, strict=True)
        if section.parts or (section.level == 2 and other is not None and other.level == 3)
    ]


def _model_parts(tables, figures, of_studies, captions):
    """Return the figures of models and, folded, their tables."""

    def of_models(paths):
        names = [name for name in paths if name.startswith(MODELS) and name not in of_studies]
        names.sort(key=lambda name: (_place(name), not name.endswith("_synthetic"), name))
        return [(paths[name], _model_caption(captions, name)) for name in names]

    drawn = [picture(*shown) for shown in of_models(figures)]
    listed = [table(*shown) for shown in of_models(tables)]
    return [*drawn, *([folded(f"Tables of the models ({len(listed)})", listed)] if listed else [])]


def _cost_parts(tables, figures, captions):
    parts = []
    if "trends" in figures:
        parts.append(picture(figures["trends"], read_caption(captions, "campaign_trends")))
    for name, caption in (("collected", COLLECTED), ("trends", read_caption(captions, "campaign_trends"))):
        parts += [table(tables[name], caption)] if name in tables else []
    return parts


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
    return read_caption(folder, caption) + (f" Grains: {value_in_words('source', source)}." if source else "")

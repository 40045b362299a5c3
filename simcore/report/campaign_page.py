"""The report page of a finished campaign: all its tables and figures, from their files."""

import os
from pathlib import Path

import pandas as pd

from simcore.paths import R22_TABLES
from simcore.reference.named_tables import read_named_table
from simcore.report.answers import answer, by_stem, check, how_sure, replaced_by_ellipsoids, unseen
from simcore.report.findings import OWN
from simcore.report.page import Section, folded, is_picture, page, paragraph, picture, table
from simcore.report.sections import (
    ANSWER,
    COST_HEADING,
    EVIDENCE,
    LEAD,
    MODELS_HEADING,
    OF_A_STUDY,
    STUDIES,
    STUDIES_HEADING,
    SURE,
    TITLE,
    committed_sections,
    packing_warnings,
    read_caption,
    study_section,
    without_empty,
)

TEST_ONLY = "Test only: these packings are far too small for valid results."
STUDY_PICTURES = ("study_picture", "study_profile")  # captions of the figures of a study's first packing
GRAINS = (
    "The grains of which the packings are made, compared with measured gravels and scanned grains. Form factors are "
    "functions of the axes L, I and S; their definitions are at the end of this section."
)
FIRST_PACKING = "First packing: picture, and porosity over the height"
FEW_GRAINS = 0.5  # share of the committed number of grains, below which a bed is small
CHECK_HEADING, OWN_STUDIES = "Check: what this campaign packed itself", "This campaign: "
LARGEST = (
    "This page begins with the committed rows, of packings that were gathered before. Below them are the packings of "
    "this campaign, as a check: settings that both have are compared."
)


def campaign_page(files, titles, biases, captions, questions=None, test_only=False, made=""):
    """Return the page as HTML text, and the page of this campaign's own packings without pictures.

    files: object with lists of paths: models, model_figures, campaign_tables, campaign_figures, grain_tables and
    grain_figures, each of which may be empty; tables, packings, study_figures, pictures and profiles, each with one
    path per study; and committed, the list of no folder or of one with the tables and figures of committed rows, with
    which the page begins. titles, questions, biases: dicts from the stem of a study's table to its title, what it asks,
    and the measured effects of its settings, as in `study_section`. captions: folder of the captions, as in
    `read_caption`. test_only: mark the page as a test. made: when and by which code the page is made.
    """
    banner, committed = TEST_ONLY if test_only else "", next(iter(files.committed), None)
    models = _named_models(files.models)
    studies = _studies(files, models, (titles, questions or {}, biases), captions, committed)
    own = _own_sections(files, models, studies, captions)
    sections = own
    if committed is not None:
        committed_parts = committed_sections(committed, titles, {}, captions, questions or {})
        of_cost = [section for section in committed_parts if section.heading == COST_HEADING]
        parts = _check_parts(files, titles, committed)
        sections = [
            *(section for section in committed_parts if section not in of_cost),
            Section(CHECK_HEADING, [*parts, *_own_answer(models), *_model_parts(files, captions)]),
            *(section._replace(heading=OWN_STUDIES + section.heading) for section in studies.values()),
            *_grain_sections(files, captions),
            _cost_section(files, captions, of_cost[0].parts if of_cost else []),
        ]
    lead = f"{LEAD} {LARGEST}" if committed is not None else LEAD
    bare = [section._replace(parts=_without_pictures(section.parts)) for section in own]
    return page(TITLE, lead, without_empty(sections), banner, made), page(TITLE, LEAD, bare, banner, made)


def _own_sections(files, models, studies, captions):
    """Return the sections of a page on this campaign alone."""
    tables = models | {OF_A_STUDY.get(study, study): path for study, path in by_stem(files.tables).items()}
    return without_empty(
        [
            Section(ANSWER, answer(models)),
            Section(SURE, how_sure(tables) if models else []),
            *(section for study, section in studies.items() if study in EVIDENCE),
            Section(MODELS_HEADING, _model_parts(files, captions)),
            *_grain_sections(files, captions),
            Section(STUDIES_HEADING, [paragraph(STUDIES)] if set(studies) - set(EVIDENCE) else []),
            *(section for study, section in studies.items() if study not in EVIDENCE),
            _cost_section(files, captions, []),
        ]
    )


def _own_answer(models):
    """Return the answer by the models of this campaign, after a sentence that names their packings."""
    parts = answer(models)
    if not parts:
        return []
    rows = read_named_table(models["single_form"]) if "single_form" in models else pd.DataFrame()
    committed = list(rows.loc[rows["packed_by"] != OWN, "case"].unique()) if "packed_by" in rows else []
    others = f", for {' and '.join(committed)} to committed packings" if committed else ""
    return [paragraph(f"By the models that are fitted to the packings of this campaign{others}:", "text"), *parts]


def _named_models(paths):
    """Return the tables of models by name; predictions have the name that committed rows use."""
    models = by_stem(paths)
    return models | ({"application_predictions": models["application"]} if "application" in models else {})


def _studies(files, models, texts, captions, committed):
    """Return the sections of the studies by name.

    texts: titles, questions and effects of settings, dicts by name. committed: folder of committed rows with which the
    page begins, or None; the packings of the campaign are then a check, and their pictures are folded.
    """
    before = {"application": unseen(models), "equivalent_ellipsoids": replaced_by_ellipsoids(models)}
    remarks, is_check = _remarks(committed, by_stem(files.tables)), committed is not None
    titles, questions, biases = texts
    by_study = zip(files.tables, files.packings, files.study_figures, files.pictures, files.profiles, strict=True)
    sections = {}
    for path, packings, figure, *pictures in by_study:
        study = Path(path).stem
        shown = [picture(*named) for named in _with_captions(pictures, captions)]
        sections[study] = study_section(
            titles[study],
            path,
            questions.get(study, ""),
            biases[study],
            figure=picture(figure, read_caption(captions, "study_porosities")),
            warnings=packing_warnings(packings),
            pictures=shown if not is_check else [folded(FIRST_PACKING, shown)],
            before=before.get(study, ()),
            remarks=remarks.get(study, ()),
        )
    return sections


def _with_captions(pictures, captions):
    return [(path, read_caption(captions, kind)) for path, kind in zip(pictures, STUDY_PICTURES, strict=True)]


def _remarks(committed, own):
    """Return sentences that explain studies of small beds by the committed ones, lists by study.

    committed: their folder, or None. own: paths of the tables of this campaign by study.
    """
    path = None if committed is None else Path(committed) / "validation.csv"
    if path is None or not path.exists() or "validation" not in own:
        return {}
    larger, smaller = (read_named_table(each).groupby("case") for each in (path, own["validation"]))
    percent = larger["experiment_error_percent"].mean().dropna()
    if percent.empty or not (smaller["grains"].max() / larger["grains"].mean()).min() < FEW_GRAINS:
        return {}
    text = (
        "A narrow cylinder with few grains is looser at its wall. In the cylinder of Rettinger et al. with 3 kg, the "
        f"same comparison gives {percent.min():+.1f} to {percent.max():+.1f} % (committed packings)."
    )
    return {"validation": [text.replace("-", "−")]}


def _check_parts(files, titles, committed):
    """Return the comparison of this campaign's packings with committed ones."""
    tables = by_stem(Path(committed).glob("*.csv"))
    paired = {study: tables[OF_A_STUDY.get(study, study)] for study in titles if OF_A_STUDY.get(study, study) in tables}
    return check(by_stem(files.tables), paired, titles, tables.get("biases"))


def _shown(show, paths, captions):
    """Return parts of figures or tables; folder and file name of each give the name of its caption."""
    return [show(path, read_caption(captions, f"{Path(path).parent.name}_{Path(path).stem}")) for path in paths]


def _model_parts(files, captions):
    tables = _shown(table, files.models, captions)
    folds = [folded(f"Tables of the models ({len(tables)})", tables)] if tables else []
    return [*_shown(picture, files.model_figures, captions), *folds]


def _grain_sections(files, captions):
    parts = [*_shown(picture, files.grain_figures, captions), *_shown(table, files.grain_tables, captions)]
    if parts:
        parts.insert(0, paragraph(GRAINS, "text"))
        definitions = table(
            Path(os.path.relpath(R22_TABLES)) / "form_factors.csv", "Form factors of a grain.", name="r22/form_factors"
        )
        parts.append(folded("Definitions of the form factors", [definitions]))
    return [Section("Grains", parts)] if parts else []


def _cost_section(files, captions, committed):
    """Return the section on cost and order; committed: its parts on the committed rows, which are folded."""
    parts = [*_shown(picture, files.campaign_figures, captions), *_shown(table, files.campaign_tables, captions)]
    folds = [folded("Cost and order of the committed campaign", committed)] if committed else []
    return Section(COST_HEADING, [*parts, *folds])


def _without_pictures(parts):
    """Return the parts that are no pictures, also inside folded ones."""
    kept = []
    for part in parts:
        if part["part"] == "folded":
            part = part | {"parts": _without_pictures(part["parts"])}
        if not is_picture(part):
            kept.append(part)
    return kept

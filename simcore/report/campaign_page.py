"""The report page of a finished campaign: all its tables and figures, from their files."""

from pathlib import Path

from simcore.report.page import is_picture, page, paragraph, picture, table
from simcore.report.sections import BEHIND, CAMPAIGN, LEAD, STUDIES, TITLE, in_short, packing_warnings, read_caption

TEST_ONLY = "Test only: these packings are far too small for valid results."
STUDY_PICTURES = ("study_porosities", "study_picture", "study_profile")  # captions of a study's figures, in their order


def campaign_page(files, titles, biases, captions, test_only=False):
    """Return the page as HTML text, and the same page without its pictures.

    files: object with lists of paths: models, model_figures, campaign_tables, campaign_figures, grain_tables and
    grain_figures, each of which may be empty; and tables, packings, study_figures, pictures and profiles, each with one
    path per study. titles, biases: dicts from the stem of a study's table to its title and its text on biases.
    captions: folder of the captions, as in `read_caption`. test_only: mark the page as a test.
    """
    sections = [*_of_all_studies(files, captions), ("Studies", [paragraph(STUDIES)])]
    by_study = zip(files.tables, files.packings, files.study_figures, files.pictures, files.profiles, strict=True)
    for path, packings, *pictures in by_study:
        study = Path(path).stem
        fragments = [
            table(path, read_caption(captions, "study_table"), BEHIND),
            paragraph(biases[study]),
            *packing_warnings(packings),
            *(picture(file, read_caption(captions, kind)) for file, kind in zip(pictures, STUDY_PICTURES, strict=True)),
        ]
        sections.append((titles[study], fragments))
    lead, banner = LEAD.format(grains="the grains, "), TEST_ONLY if test_only else ""
    bare = [(heading, [part for part in fragments if not is_picture(part)]) for heading, fragments in sections]
    return page(TITLE, lead, sections, banner), page(TITLE, lead, bare, banner)


def _of_all_studies(files, captions):
    """Return the sections on models, cost and grains; models and grains are optional."""

    def shown(show, paths, *others):
        """Return fragments of figures or tables; folder and file name of each give the name of its caption."""
        return [
            show(path, read_caption(captions, f"{Path(path).parent.name}_{Path(path).stem}"), *others) for path in paths
        ]

    cost = [*shown(picture, files.campaign_figures), paragraph(CAMPAIGN), *shown(table, files.campaign_tables)]
    sections = [
        ("In short", in_short(files.models)),
        ("Models", [*shown(picture, files.model_figures), *shown(table, files.models, BEHIND)]),
        ("Cost, and order in the beds", cost),
        ("Grains", [*shown(picture, files.grain_figures), *shown(table, files.grain_tables)]),
    ]
    return [section for section in sections if section[1]]

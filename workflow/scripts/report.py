"""One page with every table and figure of the campaign."""

from pathlib import Path

from simcore.report.page import is_picture, page, paragraph, picture, table
from simcore.report.sections import BEHIND, CAMPAIGN, LEAD, STUDIES, TITLE, in_short, packing_warnings, read_caption

TEST_ONLY = "Test only: these packings are far too small to mean anything."

files, params = snakemake.input, snakemake.params


def caption(name):
    return read_caption(Path(snakemake.scriptdir).parent / "report", name)


def shown_table(path, text):
    return table(path, text, BEHIND)


def captioned(show, paths):
    """Fragments of figures or tables that lie in folders named as their captions."""
    return [show(path, caption(f"{Path(path).parent.name}_{Path(path).stem}")) for path in paths]


# A campaign need not have a model, nor grains of its own.
sections = [
    ("In short", in_short(files.models)),
    ("Models", [*captioned(picture, files.model_figures), *captioned(shown_table, files.models)]),
    (
        "Cost, and order in the beds",
        [
            *captioned(picture, files.campaign_figures),
            paragraph(CAMPAIGN),
            *captioned(table, files.campaign_tables),
        ],
    ),
    ("Grains", [*captioned(picture, files.grain_figures), *captioned(table, files.grain_tables)]),
]
sections = [section for section in sections if section[1]] + [("Studies", [paragraph(STUDIES)])]
kinds = ("study_porosities", "study_picture", "study_profile")
shown_files = zip(files.tables, files.packings, files.study_figures, files.pictures, files.profiles, strict=True)
for path, packings, *pictures in shown_files:
    study = Path(path).stem
    shown = [picture(file, caption(kind)) for file, kind in zip(pictures, kinds, strict=True)]
    said = [shown_table(path, caption("study_table")), paragraph(params.biases[study]), *packing_warnings(packings)]
    sections.append((params.titles[study], [*said, *shown]))
lead = LEAD.format(grains="the grains, ")
banner = TEST_ONLY if params.test_only else ""
Path(snakemake.output.report).write_text(page(TITLE, lead, sections, banner), encoding="utf-8")
without = [(heading, [each for each in fragments if not is_picture(each)]) for heading, fragments in sections]
Path(snakemake.output.tables).write_text(page(TITLE, lead, without, banner), encoding="utf-8")

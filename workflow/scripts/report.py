"""One page with every table and figure of the campaign."""

from pathlib import Path

from simcore.page import is_picture, page, paragraph, picture, table

TITLE = "Scree: porosity from the form of grains"
LEAD = (
    "How porous is a bed of gravel, given the form of its grains? Beds were packed by the discrete element method: "
    "grains fall into a box, are shaken, and come to rest. This page has the models of porosity fitted to them, "
    "what each study cost, the grains, and each study. Porosity n is the share of voids, from 0 to 1; form is told "
    "by the axes L, I, S of a grain: flatness FL = S/I, elongation EL = I/L, equancy EQ = S/L, of which X_inv is "
    "1/X, mu and sigma mean and standard deviation over the grains. Columns that begin with study_ are the source "
    "study's (Rettinger, Rüde, Vollmer, Frings 2022)."
)
STUDIES = (
    "n: bulk porosity by volume-equivalent spheres, as in the study; n_exact: by slicing the grains themselves. "
    "n_std_error: sampling error of the mean; n_seed_error: standard error from the scatter over the seeds; "
    "difference: ours less the study's; z: the same in standard errors of both. cpu_h: of all runs of a row. "
    "study_n holds for the study's own, larger domains; for single forms and mixtures it is what the study's fitted "
    "model says for the forms of our packings."
)
CAMPAIGN = (
    "study_cpu_h: core-hours of the source study's program for as many grains times steps. relative_change: from the "
    "lower to the upper end of the beds; spearman_z: rank correlation with height in its standard errors; isotropic: "
    "mean angle of long axes that point anywhere [rad], beside the mean."
)
TEST_ONLY = "Test only: these packings are far too small to mean anything."

files, params = snakemake.input, snakemake.params


def caption(name):
    """The text that Snakemake's own report has for this file too."""
    path = Path(snakemake.scriptdir).parent / "report" / f"{name}.rst"
    return " ".join(path.read_text(encoding="utf-8").split())


def captioned(show, paths):
    """Fragments of figures or tables that lie in folders named as their captions."""
    return [show(path, caption(f"{Path(path).parent.name}_{Path(path).stem}")) for path in paths]


# A campaign need not have a model, nor grains of its own.
sections = [
    ("Models", [*captioned(picture, files.model_figures), *captioned(table, files.models)]),
    (
        "Cost, and order in the beds",
        [*captioned(picture, files.campaign_figures), paragraph(CAMPAIGN), *captioned(table, files.campaign_tables)],
    ),
    ("Grains", [*captioned(picture, files.grain_figures), *captioned(table, files.grain_tables)]),
]
sections = [section for section in sections if section[1]] + [("Studies", [paragraph(STUDIES)])]
kinds = ("study_porosities", "study_picture", "study_profile")
for path, *pictures in zip(files.tables, files.study_figures, files.pictures, files.profiles, strict=True):
    study = Path(path).stem
    shown = [picture(file, caption(kind)) for file, kind in zip(pictures, kinds, strict=True)]
    said = [table(path, caption("study_table")), paragraph(params.biases[study])]
    sections.append((params.titles[study], [*said, *shown]))
banner = TEST_ONLY if params.test_only else ""
Path(snakemake.output.report).write_text(page(TITLE, LEAD, sections, banner), encoding="utf-8")
without = [(heading, [each for each in fragments if not is_picture(each)]) for heading, fragments in sections]
Path(snakemake.output.tables).write_text(page(TITLE, LEAD, without, banner), encoding="utf-8")

"""One page with every table and figure of the campaign."""

from pathlib import Path

from simcore.page import page, paragraph, picture, table

TITLE = "Scree: porosity from the form of grains"
LEAD = (
    "Porosities were measured on discrete element packings of this campaign; columns that begin with study_ are the "
    "source study's (Rettinger, Rüde, Vollmer, Frings 2022)."
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
# A campaign need not have a model, nor grains of its own.
sections = [
    ("Models", [*map(picture, files.model_figures), *map(table, files.models)]),
    ("Campaign", [*map(picture, files.campaign_figures), paragraph(CAMPAIGN), *map(table, files.campaign_tables)]),
    ("Grains", [*map(picture, files.grain_figures), *map(table, files.grain_tables)]),
]
sections = [section for section in sections if section[1]] + [("Studies", [paragraph(STUDIES)])]
for path, *pictures in zip(files.tables, files.study_figures, files.pictures, files.profiles, strict=True):
    sections.append((params.titles[Path(path).stem], [table(path), *map(picture, pictures)]))
text = page(TITLE, LEAD, sections, TEST_ONLY if params.test_only else "")
Path(snakemake.output.report).write_text(text, encoding="utf-8")

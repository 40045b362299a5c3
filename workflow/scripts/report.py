"""One page with every table and figure of the campaign."""

from pathlib import Path

from simcore.page import page, paragraph, table

TITLE = "Scree: porosity from the form of grains"
LEAD = "Every number here was measured on discrete element packings of this campaign, unless its column says study."
STUDY_NOTE = (
    "n: bulk porosity by volume-equivalent spheres, n_exact: by slicing the grains themselves; n_std_error: sampling "
    "error of the mean over the runs; study_n: the source study's value, for its own, larger domains; for single "
    "forms and mixtures that of its fitted model."
)
TEST_ONLY = "Test only: these packings are far too small to mean anything."

files, params = snakemake.input, snakemake.params
sections = [("Models", [table(path, "") for path in files.models])] if files.models else []
sections.append(("Studies", [paragraph(STUDY_NOTE)]))
sections += [(params.titles[Path(path).stem], [table(path, "")]) for path in files.tables]
text = page(TITLE, LEAD, sections, TEST_ONLY if params.test_only else "")
Path(snakemake.output.report).write_text(text, encoding="utf-8")

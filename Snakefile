# Snakemake looks here first. The workflow is in workflow/Snakefile, where the catalogue of workflows looks for it.
include: "workflow/Snakefile"


# An included file does not set the target that is made without one on the command line.
workflow.default_target = "all"

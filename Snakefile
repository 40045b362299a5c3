# Scree: from grains to a model of porosity. This file is the table of contents.
#   config/      the science: what is packed (config.yaml, work_precision.yaml; overlays smoke.yaml, r22.yaml,
#                deposits.yaml and others)
#   profiles/    the machine: how it is run
#   workflow/    the rules, and a script for each


# Snakemake 9.27 looks for jobs to start a second after each look while any wait, and once more for each job that ended:
# dozens of looks a second after a day. The limit of starts a second is behind it, and is for clusters. Its settings are not
# there yet when this file is read; the scheduler is, when the first job starts.
onstart:
    if workflow.local_exec:
        workflow.scheduler.job_rate_limiter = None


configfile: "config/config.yaml"
configfile: "config/work_precision.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/grains.smk"
include: "workflow/rules/packings.smk"
include: "workflow/rules/models.smk"
include: "workflow/rules/deposits.smk"
include: "workflow/rules/verification.smk"
include: "workflow/rules/report.smk"


rule all:
    default_target: True
    input:
        "<results>/report.html",

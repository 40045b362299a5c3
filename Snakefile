# Scree: from grains to a model of porosity. This file lists the parts of the workflow.
#   config/      the packings (config.yaml, work_precision.yaml; overlays smoke.yaml, r22.yaml, deposits.yaml and
#                others)
#   profiles/    settings of the machine
#   workflow/    the rules, and a script for each rule


# Snakemake 9.27 searches for jobs to start every second while jobs wait, and again for each job that ended, which adds
# up to dozens of searches per second after a day. The cause is the rate limit for job starts, which is meant for
# clusters. It is switched off when the first job starts, because the scheduler does not exist when this file is read.
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

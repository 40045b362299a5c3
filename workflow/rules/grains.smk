# What a grain is: read or made, decimated, put in order, reported.
from simcore.grains.sources import content_digest


# A function, so that files are read only where the rule is planned. Overwritten files keep their folder's time.
def grain_content(wildcards):
    return content_digest(source_files(campaign["grains"]))


rule grain_set:
    input:
        source_files(campaign["grains"]),
    output:
        grains="<results>/grains/original.nc",
    log:
        "<results>/logs/grain_set.log",
    params:
        grains=campaign["grains"],
        content=grain_content,
        code=digest("workflow/scripts/grain_set.py"),
    script:
        "../scripts/grain_set.py"


rule decimated_grain_set:
    input:
        grains="<results>/grains/original.nc",
    output:
        grains="<results>/grains/faces_{faces}.nc",
    log:
        "<results>/logs/decimated_grain_set/{faces}.log",
    params:
        code=digest("workflow/scripts/decimated_grain_set.py"),
    script:
        "../scripts/decimated_grain_set.py"


rule form_order:
    input:
        grains="<results>/grains/original.nc",
    output:
        forms="<results>/grains/forms.csv",
    log:
        "<results>/logs/form_order.log",
    params:
        code=digest("workflow/scripts/form_order.py"),
    script:
        "../scripts/form_order.py"


rule grain_report:
    input:
        grains="<results>/grains/original.nc",
    output:
        forms="<results>/grains/form_factors.csv",
        statistics="<results>/grains/form_statistics.csv",
        correlations="<results>/grains/factor_correlations.csv",
        components="<results>/grains/principal_components.csv",
        decimation="<results>/grains/decimation.csv",
        decimation_summary="<results>/grains/decimation_summary.csv",
        shapes="<results>/grains/shapes_against_scans.csv",
        zingg=figure("<results>/figures/grains/zingg", "Grains"),
        histograms=figure("<results>/figures/grains/histograms", "Grains"),
        matrix=figure("<results>/figures/grains/factor_correlations", "Grains"),
        scans=figure("<results>/figures/grains/shapes_against_scans", "Grains"),
        changes=figure("<results>/figures/grains/decimation", "Grains"),
    log:
        "<results>/logs/grain_report.log",
    params:
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/grain_report.py"),
    script:
        "../scripts/grain_report.py"

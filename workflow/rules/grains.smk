# Grains: read or generated, decimated, ordered by form, and reported.


rule grain_set:
    input:
        files_of_set,
    output:
        grains="<results>/grains/{grains}/original.nc",
    log:
        "<results>/logs/grain_set/{grains}.log",
    params:
        grains=group_of_set,
        code=digest("workflow/scripts/grain_set.py"),
    script:
        "../scripts/grain_set.py"


rule decimated_grain_set:
    input:
        grains="<results>/grains/{grains}/original.nc",
    output:
        grains="<results>/grains/{grains}/faces_{faces}.nc",
    log:
        "<results>/logs/decimated_grain_set/{grains}/{faces}.log",
    params:
        code=digest("workflow/scripts/decimated_grain_set.py"),
    script:
        "../scripts/decimated_grain_set.py"


rule form_order:
    input:
        grains="<results>/grains/{grains}/original.nc",
    output:
        forms="<results>/grains/{grains}/forms.csv",
    log:
        "<results>/logs/form_order/{grains}.log",
    params:
        code=digest("workflow/scripts/form_order.py"),
    script:
        "../scripts/form_order.py"


rule grain_report:
    input:
        grains=f"<results>/grains/{plan.grain_set}/original.nc",
    output:
        forms="<results>/grains/form_factors.csv",
        statistics="<results>/grains/form_statistics.csv",
        correlations="<results>/grains/factor_correlations.csv",
        components="<results>/grains/principal_components.csv",
        decimation="<results>/grains/decimation.csv",
        decimation_summary="<results>/grains/decimation_summary.csv",
        shapes="<results>/grains/shapes_against_scans.csv",
        sheet=figure("<results>/figures/grains/sheet", "Grains"),
        steps=figure("<results>/figures/grains/steps", "Grains"),
        zingg=figure("<results>/figures/grains/zingg", "Grains"),
        histograms=figure("<results>/figures/grains/histograms", "Grains"),
        matrix=figure("<results>/figures/grains/factor_correlations", "Grains"),
        scans=figure("<results>/figures/grains/shapes_against_scans", "Grains"),
        changes=figure("<results>/figures/grains/decimation", "Grains"),
    log:
        "<results>/logs/grain_report.log",
    params:
        test_only=campaign["test_only"],
        code=digest(
            "workflow/scripts/grain_report.py",
            *published,
            "simcore/grains/scan_ranges.csv",
        ),
    script:
        "../scripts/grain_report.py"

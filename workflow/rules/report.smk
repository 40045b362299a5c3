# Pictures, and one static page of all tables and figures.


rule study_figure:
    input:
        table="results/tables/{study}.csv",
    output:
        figure="results/figures/studies/{study}.png",
    log:
        "results/logs/study_figure/{study}.log",
    params:
        rows=lookup(query="study == '{study}'", within=packings, cols="row"),
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/study_figure.py"),
    script:
        "../scripts/study_figure.py"


# Of each study, its first packing.
rule packing_figures:
    input:
        packing=collect(
            "results/packings/{{study}}/{packing}.nc",
            packing=lookup(
                query="study == '{study}' & is_first", within=packings, cols="packing"
            ),
        ),
        evaluation=collect(
            "results/porosity/{{study}}/{packing}.nc",
            packing=lookup(
                query="study == '{study}' & is_first", within=packings, cols="packing"
            ),
        ),
    output:
        picture="results/figures/packings/{study}.png",
        profile="results/figures/profiles/{study}.png",
    log:
        "results/logs/packing_figures/{study}.log",
    params:
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/packing_figures.py"),
    script:
        "../scripts/packing_figures.py"


rule report:
    input:
        grain_tables=collect(
            "results/grains/{table}.csv",
            table=[
                "form_statistics",
                "shapes_against_scans",
                "decimation_summary",
                "principal_components",
            ],
        ),
        grain_figures=collect(
            "results/figures/grains/{figure}.png",
            figure=[
                "zingg",
                "histograms",
                "shapes_against_scans",
                "decimation",
                "factor_correlations",
            ],
        ),
        models=collect("results/models/{model}.csv", model=models),
        model_figures=collect(
            "results/figures/models/{figure}.png", figure=model_figures
        ),
        tables=collect("results/tables/{study}.csv", study=studies),
        study_figures=collect("results/figures/studies/{study}.png", study=studies),
        pictures=collect("results/figures/packings/{study}.png", study=studies),
        profiles=collect("results/figures/profiles/{study}.png", study=studies),
    output:
        report="results/report.html",
    log:
        "results/logs/report.log",
    params:
        titles=titles,
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/report.py"),
    script:
        "../scripts/report.py"

# Pictures, and one static page of all tables and figures.


# Of each study its porosities beside the source study's, and its first packing.
rule study_figures:
    input:
        table="results/tables/{study}.csv",
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
        porosities="results/figures/studies/{study}.png",
        picture="results/figures/packings/{study}.png",
        profile="results/figures/profiles/{study}.png",
    log:
        "results/logs/study_figures/{study}.log",
    params:
        rows=lookup(query="study == '{study}'", within=packings, cols="row"),
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/study_figures.py"),
    script:
        "../scripts/study_figures.py"


# Spheres, and ellipsoids of a given form, are made of no grain: then there is none to report.
has_grains = (packings.grain_set != "").any()


rule report:
    input:
        grain_tables=branch(
            has_grains,
            then=collect(
                "results/grains/{table}.csv",
                table=[
                    "form_statistics",
                    "shapes_against_scans",
                    "decimation_summary",
                    "principal_components",
                ],
            ),
        ),
        grain_figures=branch(
            has_grains,
            then=collect(
                "results/figures/grains/{figure}.png",
                figure=[
                    "zingg",
                    "histograms",
                    "shapes_against_scans",
                    "decimation",
                    "factor_correlations",
                ],
            ),
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

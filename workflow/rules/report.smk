# Pictures, and one static page with all tables and figures.
from simcore.campaign.showpieces import corner_mixtures, showpieces


# Figures of a study: its porosities compared with Rettinger et al. (2022), and its first packing.
rule study_figures:
    input:
        table="<results>/tables/{study}.csv",
        packing=collect(
            "<results>/packings/{{study}}/{packing}.nc",
            packing=lookup(
                query="study == '{study}' & is_first", within=packings, cols="packing"
            ),
        ),
        evaluation=collect(
            "<results>/porosity/{{study}}/{packing}.nc",
            packing=lookup(
                query="study == '{study}' & is_first", within=packings, cols="packing"
            ),
        ),
    output:
        porosities=figure(
            "<results>/figures/studies/{study}",
            "Studies",
            "study_porosities",
            study="{study}",
        ),
        picture=figure(
            "<results>/figures/packings/{study}",
            "Studies",
            "study_picture",
            study="{study}",
        ),
        profile=figure(
            "<results>/figures/profiles/{study}",
            "Studies",
            "study_profile",
            study="{study}",
        ),
    log:
        "<results>/logs/study_figures/{study}.log",
    params:
        rows=lookup(query="study == '{study}'", within=packings, cols="row"),
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/study_figures.py"),
    script:
        "../scripts/study_figures.py"


# Tables over all studies: their cost, and trends over height.
rule campaign_tables:
    input:
        packings=collect("<results>/tables/{study}_packings.csv", study=studies),
        trends=collect("<results>/tables/{study}_trends.csv", study=studies),
    output:
        cost="<results>/campaign/cost.csv",
        trends="<results>/campaign/trends.csv",
        figure=figure(
            "<results>/figures/campaign/trends", "Cost, and order in the beds"
        ),
    log:
        "<results>/logs/campaign_tables.log",
    params:
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/campaign_tables.py"),
    script:
        "../scripts/campaign_tables.py"


# One packing of each kind of domain, seen from the side.
shown = showpieces(plan.in_report)


rule domain_pictures:
    input:
        packings=collect(
            "<results>/packings/{study}/{packing}.nc",
            zip,
            study=shown.study,
            packing=shown.packing,
        ),
    output:
        figure=figure(
            "<results>/figures/campaign/domains", "Cost, and order in the beds"
        ),
    log:
        "<results>/logs/domain_pictures.log",
    params:
        labels=[
            f"{plan.title(study)}\n{packing}"
            for study, packing in zip(shown.study, shown.packing)
        ],
        azimuth=-60.0,
        elevation=22.0,
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/packing_pictures.py"),
    script:
        "../scripts/packing_pictures.py"


campaign_figures = ["domains", "trends"]
corners = corner_mixtures(plan.in_report.query("study == 'form_mixtures'"))

if len(corners):
    campaign_figures += ["mixtures"]

    # Four distributions of form, seen from above.
    rule mixture_pictures:
        input:
            packings=collect(
                "<results>/packings/form_mixtures/{packing}.nc",
                packing=corners.packing,
            ),
        output:
            figure=figure(
                "<results>/figures/campaign/mixtures", "Cost, and order in the beds"
            ),
        log:
            "<results>/logs/mixture_pictures.log",
        params:
            labels=list(corners.label),
            azimuth=-90.0,
            elevation=90.0,
            test_only=campaign["test_only"],
            code=digest("workflow/scripts/packing_pictures.py"),
        script:
            "../scripts/packing_pictures.py"


captions = sorted(
    f"workflow/report/{path.name}" for path in (ROOT / "workflow/report").iterdir()
)


rule report:
    input:
        grain_tables=branch(
            plan.shows_grains,
            then=collect(
                "<results>/grains/{table}.csv",
                table=[
                    "form_statistics",
                    "shapes_against_scans",
                    "decimation_summary",
                    "principal_components",
                ],
            ),
        ),
        grain_figures=branch(
            plan.shows_grains,
            then=collect(
                "<results>/figures/grains/{figure}.png",
                figure=[
                    "zingg",
                    "histograms",
                    "shapes_against_scans",
                    "decimation",
                    "factor_correlations",
                ],
            ),
        ),
        models=collect("<results>/models/{model}.csv", model=models),
        model_figures=collect(
            "<results>/figures/models/{figure}.png", figure=model_figures
        ),
        campaign_tables=collect(
            "<results>/campaign/{table}.csv", table=["cost", "trends"]
        ),
        campaign_figures=collect(
            "<results>/figures/campaign/{figure}.png", figure=campaign_figures
        ),
        tables=collect("<results>/tables/{study}.csv", study=studies),
        packings=collect("<results>/tables/{study}_packings.csv", study=studies),
        study_figures=collect("<results>/figures/studies/{study}.png", study=studies),
        pictures=collect("<results>/figures/packings/{study}.png", study=studies),
        profiles=collect("<results>/figures/profiles/{study}.png", study=studies),
    output:
        report="<results>/report.html",
        # For Snakemake's report, which has the figures as separate files: browsers show no frame above 2 MB.
        tables=report(
            "<results>/tables.html",
            caption="../report/page.rst",
            category=" Models and tables",
            labels={"page": "models, cost, grains and all studies"},
        ),
    log:
        "<results>/logs/report.log",
    params:
        titles=plan.titles,
        biases=bias_notes,
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/report.py", *captions),
    script:
        "../scripts/report.py"


# Tables, figures and a page of the committed rows: --configfile config/workstation.yaml -- committed_studies
rule committed_studies:
    input:
        rows=branch(
            bool(campaign["reference"]),
            then=sorted(map(str, Path(campaign["reference"] or "").glob("*.csv"))),
        ),
    output:
        folder=directory("<results>/committed"),
    log:
        "<results>/logs/committed_studies.log",
    params:
        folder=campaign["reference"],
        seed=campaign["models"]["seed"],
        folds=campaign["models"]["folds"],
        titles=plan.titles,
        biases=bias_notes,
        code=digest("workflow/scripts/committed_studies.py", *captions),
    script:
        "../scripts/committed_studies.py"

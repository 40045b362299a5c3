# Pictures, and one static page of all tables and figures.
from simcore.campaign.showpieces import corner_mixtures, showpieces


# Figures of a study: porosities compared with Rettinger et al. (2022), and its first packing.
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


# Tables of all studies together: cost, and trends over height.
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


# One packing in each kind of domain, from the side.
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

    # Packings with four distributions of form, from above.
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


# The page also follows from its captions, its template, style and scripts.
captions = sorted(
    path.relative_to(ROOT).as_posix()
    for folder in ("workflow/report", "simcore/report/static")
    for path in (ROOT / folder).rglob("*.*")
)


rule report:
    input:
        # The largest committed campaign comes first on the page.
        committed=branch(plan.committed_rows is not None, then=["<results>/committed"]),
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
                    "sheet",
                    "steps",
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
        campaign_tables=unless(
            (
                ""
                if studies
                else "no study of this campaign is part of `all`; name one as the target, such as "
                f"`snakemake --cores 2 {all_studies[0]}`, or set its key `in_all` to true"
            ),
            collect("<results>/campaign/{table}.csv", table=["cost", "trends"]),
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
        # The page without figures is for Snakemake's report, because browsers show no frame of more than 2 MB.
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
        questions=plan.questions,
        biases=bias_effects,
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/report.py", *captions, *published),
    script:
        "../scripts/report.py"


# Tables, figures and a page of the committed rows: --configfile config/workstation.yaml -- committed_studies
committed_rows = campaign["reference"] or os.path.relpath(REFERENCE)


rule committed_studies:
    input:
        rows=sorted(map(str, Path(committed_rows).rglob("*.csv"))),
    output:
        folder=directory("<results>/committed"),
    log:
        "<results>/logs/committed_studies.log",
    params:
        folder=Path(committed_rows),
        seed=campaign["models"]["seed"],
        folds=campaign["models"]["folds"],
        titles=plan.titles,
        questions=plan.questions,
        biases=bias_effects,
        code=digest("workflow/scripts/committed_studies.py", *captions, *published),
    script:
        "../scripts/committed_studies.py"


# Keeps the tables of this campaign as those of the default campaign: snakemake --cores 1 -- keep_default
rule keep_default:
    input:
        models=collect(
            "<results>/models/{model}.csv",
            model=[
                *models,
                *(["shape_kind_pairs"] if plan.compares_ellipsoids else []),
            ],
        ),
        tables=collect("<results>/tables/{study}.csv", study=studies),
        cost="<results>/campaign/cost.csv",
    log:
        "<results>/logs/keep_default.log",
    params:
        folder=f"{committed_rows}/default",
        test_only=campaign["test_only"],
        command=plan.command,
    script:
        "../scripts/keep_default.py"

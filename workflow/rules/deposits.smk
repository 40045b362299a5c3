# Deposits of general ellipsoids (config/deposits.yaml). They are not part of `all`; the target is `deposits`. Their
# packings are made like all others (packings.smk); this file has their evaluation and tables.
from simcore.campaign.deposits import PREFIX, figures_of_fabrics

deposit_studies = plan.studies_named(PREFIX)
deposit_packings = plan.of(*deposit_studies)
deposit_tables = ["packings", "means", "maxima", "symmetry", "crossings", "changes"]
# Tables and figures that need only the rows.
row_tables = ["means", "maxima", "symmetry", "changes"]
row_figures = ["map", "forms", "directions", "sizes", "bridge", "size_distributions"]
deposit_figures = [
    *row_figures,
    *figures_of_fabrics(deposit_packings.study, deposit_packings.specification),
    "picture",
]
# The packing of the picture: the middle one of the diagonal, or of all if there is no diagonal.
pictured = plan.of(*(plan.studies_named(PREFIX + "diagonal") or deposit_studies))
pictured = pictured.iloc[len(pictured) // 2 : len(pictured) // 2 + 1]


rule deposits:
    input:
        unless_none(
            collect("<results>/deposits/{table}.csv", table=deposit_tables),
            deposit_studies,
            "config/deposits.yaml",
        ),
        collect("<results>/figures/deposits/{figure}.png", figure=deposit_figures),


# Fabric of the bulk of one deposit.
rule deposit:
    input:
        packing="<results>/packings/{study}/{packing}.nc",
    output:
        fabric="<results>/fabric/{study}/{packing}.nc",
    log:
        "<results>/logs/deposit/{study}/{packing}.log",
    # Runs before the next packing, so that finished packings can be gathered.
    priority: 1
    params:
        code=digest("workflow/scripts/deposit.py"),
    script:
        "../scripts/deposit.py"


# All rows, their means over seeds, and the results.
rule deposit_tables:
    input:
        fabrics=collect(
            "<results>/fabric/{study}/{packing}.nc",
            zip,
            study=deposit_packings.study,
            packing=deposit_packings.packing,
        ),
    output:
        **{name: f"<results>/deposits/{name}.csv" for name in deposit_tables},
    log:
        "<results>/logs/deposit_tables.log",
    params:
        studies=list(deposit_packings.study),
        rows=list(deposit_packings.row),
        specifications=list(deposit_packings.specification),
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/deposit_tables.py"),
    script:
        "../scripts/deposit_tables.py"


rule deposit_figures:
    input:
        packings="<results>/deposits/packings.csv",
        crossings="<results>/deposits/crossings.csv",
        maxima="<results>/deposits/maxima.csv",
        pictured=collect(
            "<results>/packings/{study}/{packing}.nc",
            zip,
            study=pictured.study,
            packing=pictured.packing,
        ),
        fabrics=collect(
            "<results>/fabric/{study}/{packing}.nc",
            zip,
            study=deposit_packings.study,
            packing=deposit_packings.packing,
        ),
    output:
        **{
            name: multiext(f"<results>/figures/deposits/{name}", ".png", ".pdf")
            for name in deposit_figures
        },
    log:
        "<results>/logs/deposit_figures.log",
    params:
        studies=list(deposit_packings.study),
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/deposit_figures.py"),
    script:
        "../scripts/deposit_figures.py"


# Writes the rows of finished deposits to the committed table; see `collect`.
rule collect_deposits:
    log:
        "<results>/logs/collect_deposits.log",
    params:
        folder=campaign["reference"],
        test_only=campaign["test_only"],
        fabrics=f"{plan.results}/fabric",
        command=plan.command,
        packings={study: plan.planned(study) for study in deposit_studies},
    script:
        "../scripts/collect_deposits.py"


# Tables and figures of the committed rows, in seconds: --configfile config/deposits.yaml -- committed_deposits
rule committed_deposits:
    input:
        rows=f"{campaign['reference']}/deposits.csv",
    output:
        **{name: f"<results>/committed_deposits/{name}.csv" for name in row_tables},
        **{
            f"{name}_figure": multiext(
                f"<results>/committed_deposits/{name}", ".png", ".pdf"
            )
            for name in row_figures
        },
    log:
        "<results>/logs/committed_deposits.log",
    params:
        code=digest("workflow/scripts/committed_deposits.py"),
    script:
        "../scripts/committed_deposits.py"

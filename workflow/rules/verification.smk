# Error against run time. It is not part of `all`; the target is `work_precision`, with --cores 1 for undisturbed times.
precision_studies = [
    "one_contact",
    "rotation",
    "contact_query",
    "rest",
    "evaluation",
    "packings",
]
packing_precision_studies = plan.studies_named("precision_")


rule work_precision:
    input:
        collect("<results>/work_precision/{study}.csv", study=precision_studies),
        collect("<results>/work_precision/{study}.png", study=precision_studies),


rule one_contact_precision:
    output:
        runs="<results>/work_precision/one_contact.csv",
        figure="<results>/work_precision/one_contact.png",
        vector="<results>/work_precision/one_contact.pdf",
    log:
        "<results>/logs/one_contact_precision.log",
    params:
        code=digest("workflow/scripts/one_contact_precision.py"),
    script:
        "../scripts/one_contact_precision.py"


rule rotation_precision:
    output:
        runs="<results>/work_precision/rotation.csv",
        figure="<results>/work_precision/rotation.png",
        vector="<results>/work_precision/rotation.pdf",
    log:
        "<results>/logs/rotation_precision.log",
    params:
        code=digest("workflow/scripts/rotation_precision.py"),
    script:
        "../scripts/rotation_precision.py"


rule contact_query_precision:
    output:
        runs="<results>/work_precision/contact_query.csv",
        figure="<results>/work_precision/contact_query.png",
        vector="<results>/work_precision/contact_query.pdf",
    log:
        "<results>/logs/contact_query_precision.log",
    params:
        code=digest("workflow/scripts/contact_query_precision.py"),
    script:
        "../scripts/contact_query_precision.py"


rule rest:
    output:
        table="<results>/work_precision/rest.csv",
        figure="<results>/work_precision/rest.png",
        vector="<results>/work_precision/rest.pdf",
    log:
        "<results>/logs/rest.log",
    params:
        code=digest("workflow/scripts/rest.py"),
    script:
        "../scripts/rest.py"


# Error of the evaluation of porosity, on the finished packings of one study.
rule evaluation_precision:
    input:
        packings=collect(
            "<results>/packings/precision_shaking/{packing}.nc",
            packing=lookup(
                query="study == 'precision_shaking'", within=packings, cols="packing"
            ),
        ),
    output:
        runs="<results>/work_precision/evaluation.csv",
        figure="<results>/work_precision/evaluation.png",
        vector="<results>/work_precision/evaluation.pdf",
    log:
        "<results>/logs/evaluation_precision.log",
    params:
        code=digest("workflow/scripts/evaluation_precision.py"),
    script:
        "../scripts/evaluation_precision.py"


# Effect of each setting of a packing on its porosity; the studies are in config/work_precision.yaml.
rule packing_precision:
    input:
        tables=collect(
            "<results>/tables/{study}_packings.csv", study=packing_precision_studies
        ),
    output:
        rows="<results>/work_precision/rows.csv",
        errors="<results>/work_precision/packings.csv",
        settings="<results>/work_precision/cheapest_settings.csv",
        figure="<results>/work_precision/packings.png",
        vector="<results>/work_precision/packings.pdf",
    log:
        "<results>/logs/packing_precision.log",
    params:
        studies=packing_precision_studies,
        titles={name: plan.title(name) for name in packing_precision_studies},
        rows=[list(plan.of(study).row) for study in packing_precision_studies],
        code=digest("workflow/scripts/packing_precision.py"),
    script:
        "../scripts/packing_precision.py"


# Effects of our process and contact law on the difference in porosity to Rettinger et al.: config/differences.yaml.
difference_studies = plan.studies_named("difference_")


rule differences:
    input:
        tables=unless_none(
            collect("<results>/tables/{study}_packings.csv", study=difference_studies),
            difference_studies,
            "config/differences.yaml",
        ),
    output:
        table="<results>/differences.csv",
    log:
        "<results>/logs/differences.log",
    params:
        varied=[plan.varied(study) for study in difference_studies],
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/differences.py"),
    script:
        "../scripts/differences.py"


# Packings whose result is published or follows from a closed form: docs/reference/verification.md. Their runs, bands and
# sources are in simcore/verification/outside.
wildcard_constraints:
    outside="|".join(outside_packings.PACKED + outside_packings.ELASTIC_RUNS),


localrules:
    outside_dice,
    outside_specification,


rule verification_packings:
    input:
        packings=collect(
            "<results>/verification/packings/{outside}.nc",
            outside=outside_packings.PACKED + outside_packings.ELASTIC_RUNS,
        ),
    output:
        table="<results>/verification/packings_from_outside.csv",
        figure="<results>/verification/packings_from_outside.png",
        vector="<results>/verification/packings_from_outside.pdf",
    log:
        "<results>/logs/verification_packings.log",
    params:
        code=digest("workflow/scripts/verification_packings.py"),
    script:
        "../scripts/verification_packings.py"


rule outside_dice:
    output:
        collect(
            "<results>/verification/dice/{solid}.obj", solid=outside_packings.SOLIDS
        ),
    log:
        "<results>/logs/outside_dice.log",
    params:
        code=digest("workflow/scripts/outside_dice.py"),
    script:
        "../scripts/outside_dice.py"


rule outside_specification:
    output:
        specification="<results>/verification/packings/{outside}.yaml",
    log:
        "<results>/logs/outside_specification/{outside}.log",
    params:
        specification=specification_from_outside,
    script:
        "../scripts/outside_specification.py"


# Like `packing`, but on one core: these packings are small, and their CPU times are comparable.
rule outside_packing:
    input:
        specification="<results>/verification/packings/{outside}.yaml",
        dice=rules.outside_dice.output,
    output:
        packing="<results>/verification/packings/{outside}.nc",
    log:
        "<results>/logs/outside_packing/{outside}.log",
    benchmark:
        "<results>/benchmarks/outside_packing/{outside}.tsv"
    wildcard_constraints:
        outside="|".join(outside_packings.PACKED),
    params:
        code=digest(
            "simcore/scene/setup.py",
            "simcore/packing/process.py",
            "simcore/packing/file.py",
        ),
        checkpoints=f"{plan.results}/checkpoints",
    shell:
        "exec python -m simcore launch {input.specification} {output.packing}"
        " --ranks 1 --threads 1 --force --checkpoints {params.checkpoints:q}/outside --with-parent > {log} 2>&1"


rule outside_elastic:
    input:
        specification="<results>/verification/packings/{outside}.yaml",
    output:
        record="<results>/verification/packings/{outside}.nc",
    log:
        "<results>/logs/outside_elastic/{outside}.log",
    wildcard_constraints:
        outside="|".join(outside_packings.ELASTIC_RUNS),
    params:
        code=digest("workflow/scripts/outside_elastic.py"),
    script:
        "../scripts/outside_elastic.py"

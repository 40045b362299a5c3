# One packing per row of a study, its evaluation, and the table of the study.


localrules:
    packing_specification,


rule packing_specification:
    input:
        forms=branch(
            has_value("form"),
            then=collect(
                "<results>/grains/{grains}/forms.csv", grains=value_of("grain_folder")
            ),
        ),
    output:
        specification="<results>/packings/{study}/{packing}.yaml",
    log:
        "<results>/logs/packing_specification/{study}/{packing}.log",
    params:
        form=value_of("form"),
        specification=value_of("specification"),
        code=digest("workflow/scripts/packing_specification.py"),
    script:
        "../scripts/packing_specification.py"


# Compiles each step once, so that the ranks and packings of a cluster do not all compile it; see compile_first.
rule compiled_steps:
    output:
        steps="<results>/compiled/{studies}.txt",
    log:
        "<results>/logs/compiled_steps/{studies}.log",
    threads: campaign["threads"]
    params:
        specifications=specifications_to_compile,
        threads=campaign["threads"],
        code=digest("workflow/scripts/compiled_steps.py"),
    script:
        "../scripts/compiled_steps.py"


rule packing:
    input:
        compiled_steps,
        specification="<results>/packings/{study}/{packing}.yaml",
        grains=branch(
            has_value("grain_set"),
            then=collect(
                "<results>/grains/{grain_set}.nc", grain_set=value_of("grain_set")
            ),
        ),
    output:
        packing="<results>/packings/{study}/{packing}.nc",
    log:
        "<results>/logs/packing/{study}/{packing}.log",
    benchmark:
        "<results>/benchmarks/packing/{study}/{packing}.tsv"
    # Number of cores. If there are fewer, the number of ranks and threads remains, and they share the cores.
    threads: cores
    resources:
        tasks=ranks,
        nodes=nodes,
        cpus_per_task=campaign["threads"],
        mpi=mpiexec,
        check=check_of_height,
        mem_mb=memory_mb,
        runtime=minutes,
    params:
        code=digest(
            "simcore/scene/setup.py",
            "simcore/packing/process.py",
            "simcore/packing/file.py",
        ),
        curve=curve,
        checkpoints=f"{plan.results}/checkpoints",
    # The checkpoints are not an output, so that an interrupted packing resumes from them. Each study has its own folder
    # of checkpoints, because two studies may have the same packing, and only one process per folder may run a scene.
    # `exec` makes Snakemake the parent of the packing: if Snakemake is killed, the packing ends too instead of running
    # beside the next run. The height of each bed is checked with the cut of its evaluation, a resource here because the
    # packing does not depend on it.
    shell:
        "exec python -m simcore launch {input.specification} {output.packing}"
        " --ranks {resources.tasks} --threads {resources.cpus_per_task} --mpiexec={resources.mpi:q}"
        " --checkpoints {params.checkpoints:q}/{wildcards.study} --with-parent {resources.check} > {log} 2>&1"


# This runs as soon as the packing is finished, so that an interrupted campaign leaves rows and not only packings.
rule porosity:
    input:
        packing="<results>/packings/{study}/{packing}.nc",
    output:
        evaluation="<results>/porosity/{study}/{packing}.nc",
    log:
        "<results>/logs/porosity/{study}/{packing}.log",
    priority: 1
    params:
        settings=campaign["porosity"],
        code=digest("workflow/scripts/porosity.py"),
    script:
        "../scripts/porosity.py"


rule study_table:
    input:
        evaluations=collect(
            "<results>/porosity/{{study}}/{packing}.nc",
            packing=lookup(
                query="study == '{study}'", within=packings, cols="packing"
            ),
        ),
    output:
        packings="<results>/tables/{study}_packings.csv",
        features="<results>/tables/{study}_features.csv",
        trends="<results>/tables/{study}_trends.csv",
        table="<results>/tables/{study}.csv",
    log:
        "<results>/logs/study_table/{study}.log",
    params:
        rows=lookup(query="study == '{study}'", within=packings, cols="row"),
        specifications=lookup(
            query="study == '{study}'", within=packings, cols="specification"
        ),
        porosity=campaign["porosity"],
        test_only=campaign["test_only"],
        code=digest("workflow/scripts/study_table.py", *published),
    script:
        "../scripts/study_table.py"


# Each study is a target: `snakemake single_form`.
for study in all_studies:

    rule:
        name:
            study
        input:
            f"<results>/tables/{study}.csv",


# Pieces of a study that take some hours; an interrupted piece resumes: `snakemake single_form_piece_1`.
for study, piece, names in plan.pieces():

    rule:
        name:
            f"{study}_piece_{piece}"
        input:
            [f"<results>/porosity/{study}/{packing}.nc" for packing in names],


# The packings of a study that have no row in the committed tables yet, whether or not their files exist: `snakemake
# single_form_left`, then `snakemake collect`. A campaign can thus continue after its last row, also on another machine.
for study in all_studies:

    rule:
        name:
            f"{study}_left"
        input:
            unless(
                (
                    ""
                    if campaign["reference"]
                    else f"{study}_left needs the rows that `collect` writes: give a folder for them in the "
                    "configuration, such as `reference: my_rows`"
                ),
                plan.files_left(study) if campaign["reference"] else [],
            ),


# Writes rows of all finished packings to the committed tables; other packings can follow later. The tables are not
# outputs: they are part of a clone, and remain if the packings are deleted. Studies that are not part of `all` are
# included if they have packings here.
rule collect:
    log:
        "<results>/logs/collect.log",
    params:
        folder=campaign["reference"],
        test_only=campaign["test_only"],
        porosity=campaign["porosity"],
        evaluations=f"{plan.results}/porosity",
        command=plan.command,
        packings=plan.to_gather(),
    script:
        "../scripts/collect.py"

"""Scree: porosity of gravel from the form of its grains.

Data flow in one direction: grains -> scene -> dem -> packing -> evaluation -> models -> campaign -> report.

    grains/        grains: files, convex hull, mass-equivalent ellipsoid, form factors, sieve curves
    scene/         input of a packing: specification in SI units, sizes, domain, and the scene made from them
    dem/           discrete element method: shapes, contacts, force laws, time step, ranks
    packing/       one packing: insertion of grains, phases, checks, checkpoints, its file, its cost
    evaluation/    results of a finished packing: porosity, slices, order over height, fabric
    reference/     the tables of Rettinger et al. (2022) and the committed rows
    models/        regression, cross-validation, porosity models, prediction
    export/        files of a packing for other programs: surfaces, voxels, network of contacts
    campaign/      many packings: studies, their plan and cost, their tables, the committed rows
    report/        the page of a campaign and its figures
    verification/  comparison of parts of the code with closed forms
    commands/      the commands of the command line
    provenance/    version of the code, machine, CPU time

    paths          paths of the files that are part of the project
    compilation    options and cache of numba
    __main__       the command line
"""

__version__ = "0.1.0"

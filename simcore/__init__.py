"""Scree: porosity of gravel from the form of its grains.

Data flow one way: grains -> scene -> dem -> packing -> evaluation -> models -> campaign -> report.

    grains/        what a grain is: files, hull, mass-equivalent ellipsoid, form factors, sieve curves
    scene/         what is to be packed: specification in SI units, sizes, domain, the scene made of them
    dem/           what moves: shapes, contacts, force laws, the time step, ranks
    packing/       one packing: insertion of grains, phases, checks, checkpoints, its file, its cost
    evaluation/    what is computed from a finished packing: porosity, slices, order over height, fabric
    reference/     the tables of Rettinger et al. (2022) and the committed rows
    models/        regression, cross-validation, porosity models, prediction
    campaign/      many packings: studies, their plan and cost, their tables, the committed rows
    report/        the page of a campaign and its figures
    verification/  parts of the core against closed forms
    provenance/    which code, which machine, how much CPU time

    paths          where the files lie that come with the project
    compilation    how numba compiles
    __main__       the command line
"""

__version__ = "0.1.0"

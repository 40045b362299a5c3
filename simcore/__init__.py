"""Scree: porosity of gravel from the form of its grains.

    import simcore

    bed = simcore.pack("spec.yaml")             a packing, as an xarray Dataset; also from a dict
    bed = simcore.read_packing("bed.nc")        a packing from a file; write_packing(path, bed) writes one
    simcore.porosity(bed)                       bulk porosity with its sampling error
    simcore.porosity_profile(bed)               porosity over height
    simcore.fabric(bed)                         solid fraction, coordination number and directions of the bulk
    simcore.coordination_number(bed)            of all grains, and the contacts of each
    simcore.predict("forms.csv", "one-class")   porosity of measured grains, without packing them; also with a sieve
                                                curve, predict("forms.csv", curve="curve.csv")
    simcore.fit("measured.csv", case="U1")      models compared with measured porosities, and corrected or fitted
    simcore.query(shape, pose, shape, pose)     distance of two shapes: sphere, ellipsoid, convex
    simcore.Simulation(shapes, ...)             bodies that you place, moved by their contacts and by gravity

Functions of `bed` take the path of its file too. These names are imported when they are first used, so that
`import simcore` is fast.

Data flow in one direction: grains -> scene -> dem -> packing -> evaluation -> models -> campaign -> report.

    grains/        grains: files, convex hull, mass-equivalent ellipsoid, form factors, sieve curves
    scene/         input of a packing: specification in SI units, sizes, domain, and the scene made from them
    dem/           discrete element method: shapes, contacts, force laws, time step, ranks
    packing/       one packing: insertion of grains, phases, checks, checkpoints, its file, its cost
    evaluation/    results of a finished packing: porosity, slices, order over height, fabric
    reference/     the tables of Rettinger et al. (2022) and the committed rows
    models/        regression, cross-validation, porosity models, prediction
    export/        files of a packing for other programs: surfaces, voxels, network of contacts
    pores/         pore space of a packing: surface, tortuosity, permeability, pore sizes
    campaign/      many packings: studies, their plan and cost, their tables, the committed rows
    report/        the page of a campaign and its figures
    page/          the page that predicts porosity in a browser
    verification/  comparison of parts of the code with closed forms
    commands/      the commands of the command line
    provenance/    version of the code, machine, CPU time

    paths          paths of the files that are part of the project
    writing        files that are written whole or not at all
    compilation    options and cache of numba
    __main__       the command line
"""

from importlib import import_module

from simcore.provenance.version import VERSION as __version__

# Public name: (module, its name there).
_PUBLIC = {
    "pack": ("simcore.packing.single", "pack"),
    "read_packing": ("simcore.packing.file", "read_packing"),
    "write_packing": ("simcore.packing.file", "write_packing"),
    "porosity": ("simcore.evaluation.porosity", "bulk_porosity"),
    "porosity_profile": ("simcore.evaluation.porosity", "porosity_profile"),
    "fabric": ("simcore.evaluation.fabric", "fabric"),
    "coordination_number": ("simcore.evaluation.coordination", "coordination_number"),
    "predict": ("simcore.models.measured_prediction", "predict"),
    "fit": ("simcore.models.measured_fit", "fit"),
    "query": ("simcore.dem.contact.query", "query"),
    "query_many": ("simcore.dem.contact.query", "query_many"),
    "sphere": ("simcore.dem.shapes.polyhedra", "sphere"),
    "ellipsoid": ("simcore.dem.shapes.polyhedra", "ellipsoid"),
    "convex": ("simcore.dem.shapes.polyhedra", "convex"),
    "Simulation": ("simcore.dem.simulation", "Simulation"),
}
_OF_A_PACKING = ("porosity", "porosity_profile", "fabric", "coordination_number")
__all__ = ["__version__", *_PUBLIC]


def __getattr__(name):
    """Return a public name, imported now (PEP 562); AttributeError for any other name."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'simcore' has no attribute {name!r}; it has {', '.join(_PUBLIC)}")
    module, attribute = _PUBLIC[name]
    value = getattr(import_module(module), attribute)
    if name in _OF_A_PACKING:
        value = import_module("simcore.packing.file").takes_paths(value, name)
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *_PUBLIC})

"""What a kind of grain and what each feature costs: python -m benchmarks.speed.features [--grains 1000] [--csv FILE]

Kinds: one bed of equal spheres, stepped as spheres, as ellipsoids of equal axes, and as polyhedra of 320 faces.
Features: a bed with one thing changed at a time. Where `bed` says "own" it was poured with the change, else the change
comes after. Orientation is what spheres do not have (kinds), history goes with friction, and levels are those of the
grid in which near pairs are listed: a list's own cost, not a step's.
"""

import argparse
import csv
import dataclasses
import os
import sys

from benchmarks.progress import print_progress
from benchmarks.speed.throughput import default_beds, use_threads

COLUMNS = (
    "what", "shape", "bed", "grains", "cpu_us_per_grain_step", "ratio", "cpu_us_per_contact_step", "contacts_per_grain",
    "near_pairs_per_grain", "solid_fraction", "bytes_per_grain", "cpu_us_least", "cpu_us_most", "digest",
)  # fmt: skip
TWO_SIZES = {"bounds": ["5.6 mm", "8 mm", "16 mm", "22.4 mm"], "mass_fractions": [0.5, 0.0, 0.5]}
LISTS = 20
# What is changed, settings laid over the bed's, and whether the bed is poured with them.
FEATURES = (
    ("all as by default", {}, False),
    ("no friction, no history", {"material": {"friction": 0.0}}, True),
    ("no friction, no history, contacts as with it", {"material": {"friction": 0.0}}, False),
    ("no shaking", {"shaking": {"amplitude": "0 m"}}, False),
    ("clamped end of contact", {"material": {"end_of_contact": "clamped"}}, False),
    ("deepest point, no patch", {"numerics": {"polyhedron_contact": "point"}}, False),
    ("cylinder", {"domain": {"type": "cylinder"}}, True),
    ("two sizes 1:2.8 by half their mass", {"sizes": TWO_SIZES}, True),
)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shape", choices=["sphere", "ellipsoid", "polyhedron"], default="sphere", help="of features")
    parser.add_argument("--grains", type=int, default=1000)
    parser.add_argument("--duration", type=float, default=0.05, help="simulated time measured [s]")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--csv", metavar="FILE", help="otherwise printed")
    parser.add_argument("--beds", metavar="FOLDER", default=default_beds(), help="where beds are kept")
    options = parser.parse_args(arguments)
    use_threads(options.threads)
    rows = [*kinds(options), *features(options), *phases(options), *levels(options)]
    with open(options.csv, "w", newline="", encoding="utf-8") if options.csv else sys.stdout as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator=os.linesep)
        writer.writeheader()
        writer.writerows(rows)


def kinds(options):
    """Rows of one bed of spheres, stepped by each kind of scene."""
    from benchmarks.beds import RELAXING, bed_settings, prepare, settled_bed
    from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON, SPHERE, unit_sphere

    settings = bed_settings("sphere", options.grains)
    bed = settled_bed(settings, options.beds, print_progress)
    setup = prepare(settings)
    reference = None
    for name, kind, base in (
        ("spheres", SPHERE, unit_sphere()),
        ("spheres as ellipsoids", ELLIPSOID, unit_sphere()),
        ("spheres as polyhedra", POLYHEDRON, faceted_sphere()),
    ):
        scene = dataclasses.replace(setup.scene, kind=kind)
        row = _row(setup._replace(scene=scene, bases=[base]), bed, options, settings, RELAXING)
        reference = reference or row["cpu_us_per_grain_step"]
        yield row | {"what": name, "shape": "sphere", "bed": "same", "ratio": row["cpu_us_per_grain_step"] / reference}


def features(options):
    """Rows of a bed with one feature changed at a time; ratio to the unchanged one."""
    from benchmarks.beds import bed_settings, prepare, settled_bed
    from simcore.campaign.studies import merge

    settings = bed_settings(options.shape, options.grains)
    reference = None
    for name, change, own in FEATURES:
        if "numerics" in change and options.shape != "polyhedron":
            continue
        if "sizes" in change and options.shape == "sphere":
            change = {"sizes": {**change["sizes"], "allow_few_top_grains": True}}
        changed = merge(settings, change)
        if "sizes" in change:
            changed = widen(changed)
        bed = settled_bed(changed if own else settings, options.beds, print_progress)
        row = _row(prepare(changed), bed, options, changed)
        reference = reference or row["cpu_us_per_grain_step"]
        row["ratio"] = row["cpu_us_per_grain_step"] / reference
        yield row | {"what": name, "shape": options.shape, "bed": "own" if own else "same"}


def phases(options):
    """Rows of the same bed damped, and weightless with a floor and without; ratio to the same with shaking left out.

    Without weight it needs no floor to stay: for as short as it is measured it only springs apart.
    """
    from benchmarks.beds import bed_settings, prepare, settled_bed
    from benchmarks.measurement import measure
    from simcore.campaign.studies import merge
    from simcore.compilation import source_digest
    from simcore.packing.packed import DAMPING, SHAKING

    settings = bed_settings(options.shape, options.grains)
    bed = settled_bed(settings, options.beds, print_progress)
    setup = prepare(merge(settings, {"shaking": {"amplitude": "0 m"}}))
    light = dataclasses.replace(setup.scene, material=dataclasses.replace(setup.scene.material, gravity=0.0))
    reference = {}
    for name, scene, phase, changes in (
        ("no shaking", setup.scene, SHAKING, {}),
        ("no shaking, damping", setup.scene, DAMPING, {}),
        ("weightless", light, SHAKING, {}),
        ("weightless, no floor", light, SHAKING, {"floor": False}),
    ):
        figures, _ = measure(setup._replace(scene=scene), bed, options.duration, phase=phase, **changes)
        cost = figures["cpu_us_per_grain_step"]
        first = reference.setdefault(name.split(",")[0], cost)
        figures |= {"what": name, "shape": options.shape, "bed": "same", "ratio": cost / first}
        yield figures | {"grains": options.grains, "digest": source_digest()}


def levels(options):
    """Rows of listing the pairs of two sizes on the levels of the grid, and on one of cells for the largest; per list.

    cpu_us_per_grain_step is here CPU µs per grain and list, `what` tells how many levels there are.
    """
    import time

    import numpy as np

    from benchmarks.beds import bed_settings, prepare, settled_bed, start
    from simcore.campaign.studies import merge
    from simcore.compilation import source_digest
    from simcore.dem.state.contacts import Box
    from simcore.dem.step.candidate_pairs import _search, _sort_into_cells, _spheres, find_pairs
    from simcore.packing.neighbour_lists import SKIN

    few = {"allow_few_top_grains": True} if options.shape == "sphere" else {}
    settings = widen(merge(bed_settings(options.shape, options.grains), {"sizes": {**TWO_SIZES, **few}}))
    setup, bed = prepare(settings), settled_bed(settings, options.beds, print_progress)
    radius = start(setup, bed).bodies.radius
    box = Box(setup.scene.domain.width)
    skin = SKIN * float(np.mean(bed.sieve_size))
    reach = radius + 0.5 * skin
    count = len(np.unique(np.floor(np.log2(reach / reach.min()) + 1e-12)))

    def on_one():
        spheres = _spheres(bed.position, reach, box, np.ones(len(radius), np.bool_))
        width = 2.0 * reach.max()
        grid = _sort_into_cells(spheres.wrapped, np.arange(len(radius)), width, box)
        pairs = _search(spheres, grid.members, grid, width, True)
        return pairs[np.lexsort((pairs[:, 3], pairs[:, 2], pairs[:, 1], pairs[:, 0]))]

    reference = None
    for name, search in (
        (f"list on {count} levels", lambda: find_pairs(bed.position, reach, box)),
        ("list on one level", on_one),
    ):
        pairs = len(search())  # compiled
        began = time.process_time()
        for _ in range(LISTS):
            search()
        cost = (time.process_time() - began) / LISTS / len(radius) * 1e6
        reference = reference or cost
        row = {"what": name, "shape": options.shape, "bed": "own", "grains": len(radius), "ratio": cost / reference}
        row |= {"cpu_us_per_grain_step": cost, "near_pairs_per_grain": pairs / len(radius)}
        yield row | {"digest": source_digest()}


def widen(settings):
    """Settings with the box made as much larger as the grains of other sizes are, on average by volume."""
    import numpy as np

    from benchmarks.beds import SPHERE_DIAMETER, prepare

    setup = prepare(settings)
    volume = np.mean(setup.draw(np.arange(settings["amount"]["grains"])).sieve_size ** 3)
    factor = max(float(np.cbrt(volume)) / SPHERE_DIAMETER, 2.5 * setup.curve.largest / setup.scene.domain.width)
    domain = {key: f"{getattr(setup.scene.domain, key) * factor!r} m" for key in ("width", "height")}
    return {**settings, "domain": {**settings["domain"], **domain}}


def faceted_sphere():
    """A polyhedron of 320 faces in the unit sphere, as a base shape: none overlap where the spheres did not."""
    import trimesh

    from simcore.dem.shapes.polyhedra import Base
    from simcore.grains.mesh import make_grain

    grain = make_grain("faceted sphere", trimesh.creation.icosphere(subdivisions=2).vertices)
    return Base(grain.name, grain.vertices, grain.faces, grain.volume, grain.second_moments)


def _row(setup, bed, options, settings, *warm_up):
    from benchmarks.measurement import measure, solid_fraction
    from simcore.compilation import source_digest
    from simcore.scene.specification import resolve

    figures, process = measure(setup, bed, options.duration, *warm_up)
    fraction = solid_fraction(setup, process, resolve(settings))
    return figures | {"grains": options.grains, "solid_fraction": fraction, "digest": source_digest()}


if __name__ == "__main__":
    main()

"""Cost of each kind of grain and of each feature.

    python -m benchmarks.speed.features [--grains 1000] [--csv FILE]

Kinds: one bed of equal spheres is stepped as spheres, as ellipsoids of equal axes, and as polyhedra of 320 faces.
Spheres alone have no orientations, so the second row contains the cost of these. Features: one thing in a bed is
changed at a time. If the column `bed` is "own", the bed was poured with the change; otherwise it is changed afterwards.
The cost of remembered shear (history) is contained in that of friction. Levels: the cost of one listing of candidate
pairs, not of a step, with all levels of the grid and with one.
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
# Name of the change, settings that override those of the bed, and whether the bed is poured with them.
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
    parser.add_argument(
        "--shape",
        choices=["sphere", "ellipsoid", "polyhedron"],
        default="sphere",
        help="shape of the grains for the rows of features",
    )
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
    """Yield the rows of one bed of spheres that is stepped by each kind of scene."""
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
    """Yield the rows of a bed with one feature changed at a time; `ratio` refers to the unchanged bed."""
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
    """Yield the rows of the bed without shaking: as it is, damped, and weightless with and without a floor.

    `ratio` refers to the row without damping, or to the weightless row with a floor. Without weight the bed needs no
    floor, because it only expands a little in the short time of the measurement.
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
        unchanged = reference.setdefault(name.split(",")[0], cost)
        figures |= {"what": name, "shape": options.shape, "bed": "same", "ratio": cost / unchanged}
        yield figures | {"grains": options.grains, "digest": source_digest()}


def levels(options):
    """Yield the rows of listing the pairs of grains of two sizes, with all levels of the grid and with one.

    The single level has cells for the largest grains. Here, cpu_us_per_grain_step is the CPU time [µs] per grain and
    list.
    """
    import time

    import numpy as np

    from benchmarks.beds import bed_settings, prepare, settled_bed, start
    from simcore.campaign.studies import merge
    from simcore.compilation import source_digest
    from simcore.dem.state.contacts import Box
    from simcore.dem.step.close_spheres import _search, _sort_into_cells, _spheres, find_pairs, sort_pairs
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
        grid = _sort_into_cells(spheres, np.arange(len(radius)), 2.0 * reach.max(), box)
        return sort_pairs(np.concatenate(_search(spheres, grid, grid, True)), len(radius))

    reference = None
    for name, search in (
        (f"list on {count} levels", lambda: find_pairs(bed.position, reach, box)),
        ("list on one level", on_one),
    ):
        pairs = len(search())  # this also compiles it
        began = time.process_time()
        for _ in range(LISTS):
            search()
        cost = (time.process_time() - began) / LISTS / len(radius) * 1e6
        reference = reference or cost
        row = {"what": name, "shape": options.shape, "bed": "own", "grains": len(radius), "ratio": cost / reference}
        row |= {"cpu_us_per_grain_step": cost, "near_pairs_per_grain": pairs / len(radius)}
        yield row | {"digest": source_digest()}


def widen(settings):
    """Return the settings with a box scaled to the mean grain size, but at least 2.5 largest grains wide."""
    import numpy as np

    from benchmarks.beds import SPHERE_DIAMETER, prepare

    setup = prepare(settings)
    volume = np.mean(setup.draw(np.arange(settings["amount"]["grains"])).sieve_size ** 3)
    factor = max(float(np.cbrt(volume)) / SPHERE_DIAMETER, 2.5 * setup.curve.largest / setup.scene.domain.width)
    domain = {key: f"{getattr(setup.scene.domain, key) * factor!r} m" for key in ("width", "height")}
    return {**settings, "domain": {**settings["domain"], **domain}}


def faceted_sphere():
    """Return a polyhedron of 320 faces in the unit sphere as a base shape; its grains overlap only where spheres do."""
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

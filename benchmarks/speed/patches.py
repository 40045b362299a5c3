"""Cost of the patches of contacts, and how many could be kept from step to step.

    python -m benchmarks.speed.patches [--grains 1000] [--set numerics.contact_time=0.5ms]

In the shaken bed of benchmarks.speed.throughput it prints the CPU time of the patches of all contacts, per grain and
step; the share of them that have a closed form, and what a patch with and without it costs; and, for several
tolerances, the share of patches that a step could keep. A patch can be kept if the bodies have moved relative to each
other, since it was measured, by less than the tolerance times the overlap. A rotation counts with the sum of the
bounding radii as its lever.
"""

import sys
import time

import numpy as np

from benchmarks.speed.throughput import parse, use_threads

TOLERANCES = (0.05, 0.1, 0.2, 0.5)
WARM_UP = 0.02  # [s]
STEPS = 60  # over which patches are followed
REPETITIONS = 25


def kept_shares(snapshots, tolerances=TOLERANCES) -> dict[float, float]:
    """Return the share of the contacts that could keep their patch in a step, for each tolerance.

    snapshots: one dict per step, from (a, b, image) to (offset (3,) [m], turn (3, 3), lever [m], overlap [m]): position
    and rotation of b in the axes of a. At its first snapshot the patch of a contact is measured and counts as not kept.
    """
    shares = {}
    for tolerance in tolerances:
        measured, kept, total = {}, 0, 0
        for snapshot in snapshots:
            for key, (offset, turn, lever, overlap) in snapshot.items():
                total += 1
                if key in measured:
                    old_offset, old_turn, old_overlap = measured[key]
                    angle = np.linalg.norm(turn - old_turn) / np.sqrt(2.0)
                    moved = np.linalg.norm(offset - old_offset) + angle * lever
                    if moved < tolerance * min(overlap, old_overlap):
                        kept += 1
                        continue
                measured[key] = (offset, turn, overlap)
            measured = {key: value for key, value in measured.items() if key in snapshot}
        shares[tolerance] = kept / total
    return shares


def snapshot(process) -> dict:
    """Return the touching contacts of a Process as a snapshot of `kept_shares`."""
    bodies, contacts = process.bodies, process.contacts
    rows = np.flatnonzero(contacts.touching)
    a, b, image = contacts.body_a[rows], contacts.body_b[rows], contacts.image[rows]
    offset = bodies.position[b] - bodies.position[a]
    offset[:, :2] += process.scene.domain.width * image
    turn = np.einsum("nji,njk->nik", bodies.rotation[a], bodies.rotation[b])
    in_a = np.einsum("nji,nj->ni", bodies.rotation[a], offset)
    lever = bodies.radius[a] + bodies.radius[b]
    keys = zip(a.tolist(), b.tolist(), *image.T.tolist(), strict=True)
    return dict(zip(keys, zip(in_a, turn, lever, contacts.overlap[rows], strict=True), strict=True))


def main(arguments=None):
    options = parse(arguments)
    use_threads(options.threads)
    from benchmarks.beds import bed_settings, prepare, read_overrides, settled_bed, start
    from simcore.packing.packed import SHAKING

    overrides = read_overrides([*options.assignments, "numerics.polyhedron_contact=patch"])
    settings = bed_settings("polyhedron", options.grains, options.faces, options.seed, overrides)
    setup = prepare(settings)
    bed = settled_bed(settings, options.beds, lambda text: print(text, file=sys.stderr, flush=True))
    process = start(setup, bed)
    process.advance(round(WARM_UP / process.dt), SHAKING)
    process.evaluate()  # a step moves the bodies after it has found the contacts, which belong to the former positions
    closed, costs = patch_costs(process)
    share, contacts = np.mean(closed), len(closed)
    cost = costs["all"] * contacts / options.grains
    print(f"{contacts / options.grains:.2f} contacts per grain, {share:.0%} of the patches in closed form")
    print(f"patches: {1e6 * cost:.2f} µs CPU per grain and step, {1e9 * costs['all']:.0f} ns each")
    print(f"in closed form {1e9 * costs['closed']:.0f} ns each, cut by planes {1e9 * costs['cut']:.0f} ns each")
    snapshots = []
    for _ in range(STEPS):
        process.advance(1, SHAKING)
        snapshots.append(snapshot(process))
    for tolerance, share in kept_shares(snapshots).items():
        print(f"motion below {tolerance:g} of the overlap: {share:.1%} of the patches could be kept")


def patch_costs(process):
    """Return which touching contacts have a patch in closed form, and the CPU times [s] of a patch (dict).

    The times are those of all patches, of those in closed form and of those that planes cut; nan for none.
    """
    from numba import njit

    from simcore.dem.contact.pair import pair_of
    from simcore.dem.contact.patch.axes import View, axes_about
    from simcore.dem.contact.patch.patch import PATCH_DEPTH, closed_overlap, find_patch, read_facet
    from simcore.dem.state.touches import partner_offset
    from simcore.dem.vectors import plus_scaled, read

    @njit
    def patches(shapes, bodies, contacts, rows, width, workspace):
        for p in rows:
            find_patch(shapes, bodies, contacts, p, partner_offset(bodies, contacts, p, width, True), workspace, 0)

    @njit
    def find_closed(shapes, bodies, contacts, rows, width, workspace, closed):
        for k, p in enumerate(rows):
            i, j, overlap = contacts.body_a[p], contacts.body_b[p], contacts.overlap[p]
            axes = axes_about(read(contacts.direction, p))
            depth = min(overlap, PATCH_DEPTH * (bodies.radius[i] + bodies.radius[j]))
            offset = partner_offset(bodies, contacts, p, width, True)
            pair = pair_of(bodies, i, j, plus_scaled(offset, overlap - depth, axes.n))
            facet = read_facet(contacts.facet, p)
            shape, _ = closed_overlap(shapes, bodies, pair, View(axes, depth, 1.0), facet, workspace, 0)
            closed[k] = shape.exact

    stepper, rows = process.stepper, np.flatnonzero(process.contacts.touching)

    def scene(rows):
        return stepper.shapes, process.bodies, process.contacts, rows, stepper.box.width, stepper.workspace

    closed = np.empty(len(rows), bool)
    find_closed(*scene(rows), closed)
    kinds = {"all": rows, "closed": rows[closed], "cut": rows[~closed]}
    patches(*scene(rows))
    times = {name: [] for name, rows in kinds.items() if len(rows)}
    for _ in range(REPETITIONS):
        for name in times:
            began = time.process_time()
            for _ in range(5):
                patches(*scene(kinds[name]))
            times[name].append((time.process_time() - began) / 5 / len(kinds[name]))
    return closed, {name: min(times.get(name, [np.nan])) for name in kinds}


if __name__ == "__main__":
    main()

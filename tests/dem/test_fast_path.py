"""A shaken bed of hulls: what contacts remember gives what a search from nothing gives, at every look."""

import numba
import numpy as np

from simcore.dem.bodies import make_bodies
from simcore.dem.contact.patch import make_room
from simcore.dem.features import Features
from simcore.dem.force_laws import contact_law
from simcore.dem.neighbors import Box, list_near
from simcore.dem.shapes import CONVEX, collect_shapes
from simcore.dem.stepping import Drive, make_advance

WIDTH = 0.030


def make_bed(core):
    """48 hulls of 8 to 40 vertices, 5 to 9 mm across, above the floor of a periodic box four grains wide."""
    rng = np.random.default_rng(1)
    bases = [core.make_pebble(k, n) for k, n in enumerate((8, 12, 16, 24, 32, 40))]
    n = 48
    cell = np.stack(np.unravel_index(np.arange(n), (12, 2, 2)), axis=-1)[:, [1, 2, 0]]
    position = (cell + 0.5) * [WIDTH / 2, WIDTH / 2, 0.012]
    scale = np.repeat(rng.uniform(2.8e-3, 4.5e-3, (n, 1)), 3, axis=1)
    velocity = rng.uniform(-0.1, 0.1, (n, 3)) - [0.0, 0.0, 1.0]
    spin = rng.uniform(-10.0, 10.0, (n, 3))
    shape = rng.integers(0, len(bases), n)
    bodies = make_bodies(bases, shape, scale, position, core.orientations(n, rng), velocity, spin, density=2650.0)
    return bodies, collect_shapes(bases)


def test_the_memory_of_a_shaken_bed_is_right(core):
    bodies, shapes = make_bed(core)
    contact_time = 5e-4
    dt = contact_time / 40
    law = contact_law(0.1, contact_time, 0.22, 0.5)
    skin = 1e-3
    drive = Drive(dt, 6.108, 18.95, 251.3, 1.0, WIDTH, np.inf, 0.5 * skin)
    still = drive._replace(dt=0.0)
    features = Features(CONVEX, True)
    advance, clock, room = make_advance(features), np.zeros(3, np.int64), make_room(shapes, numba.get_num_threads())
    near = list_near(bodies, shapes, Box(WIDTH), skin, features)
    step, touches, others, excess_others = 0, 0, 0, []
    while step < 20000:
        # Odd numbers of steps, so that the look falls anywhere between two lists
        done, stale = advance(bodies, shapes, *near, room, law, drive, clock, step, 37)
        step += done
        if stale:
            near = list_near(bodies, shapes, Box(WIDTH), skin, features, near)
        if step % 10 and step < 19000:
            continue
        advance(bodies, shapes, *near, room, law, still, clock, step, 1)
        contacts = near.contacts
        listed = bodies.listed_position.copy()
        fresh = list_near(bodies, shapes, Box(WIDTH), 0.0, features).contacts
        bodies.listed_position[:] = listed
        core.look_at_polyhedra(shapes, bodies, fresh, WIDTH)
        remembered = {
            (contacts.body_a[p], contacts.body_b[p], *contacts.image[p]): p for p in range(len(contacts.body_a))
        }
        matched = 0
        for q in range(len(fresh.body_a)):
            # Every pair whose bounding spheres meet is listed.
            p = remembered[(fresh.body_a[q], fresh.body_b[q], *fresh.image[q])]
            size = bodies.radius[fresh.body_a[q]] + bodies.radius[fresh.body_b[q]]
            if not fresh.touching[q]:
                assert not contacts.touching[p] or contacts.overlap[p] < 1e-12 * size
                continue
            if not contacts.touching[p]:
                assert fresh.overlap[q] < 1e-12 * size, "an overlapping pair was taken for apart"
                continue
            matched += 1
            excess = (contacts.overlap[p] - fresh.overlap[q]) / size
            assert excess > -1e-12, "less overlap than the least"
            if excess > 1e-9:
                others += 1  # another local minimum: its depth is larger, its normal its own
                excess_others.append(excess)
                continue
            # The least is unique, or two facets are equally near to rounding.
            assert contacts.direction[p] @ fresh.direction[q] > 1.0 - 1e-9
        touches += matched
    assert touches > 3000
    # A bed's overlaps are small against its facets, so the local minimum is the global one nearly always.
    assert others <= 0.002 * touches, (others, max(excess_others))

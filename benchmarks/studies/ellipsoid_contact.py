"""Two constructions of the contact of ellipsoids, the common normal and the least potentials, side by side.

    python -m benchmarks.studies.ellipsoid_contact [--measures depth impact cost] >
        results/reference/ellipsoid_contact.csv

It prints one CSV row per measure, form, relative depth and construction. Lengths are in units of (abc)^(1/3) of the
larger grain. The two constructions define different depths, which agree only for spheres; the exact depth is the length
of the shortest translation that separates the pair.

depth    random pairs: error of the overlap relative to the exact depth, and angle between the normal and the exact one.
         The direction of the contact vector itself is listed beside the averaged gradients that replace it.
impact   random oblique elastic impacts without friction, to about the relative depth: energy gained, in units of the
         energy of relative motion before; its mean is the drift per collision. Rules for the direction of the force:
         the common normal; by potentials the averaged gradients, always or from 10 degrees of deviation on, or always
         the contact vector; and the averaged gradients with the contact vector's length along them as overlap.
cost     a query within a step: touching; near, where a remembered gap has expired and the direction is checked again;
         and both searched from nothing. Pairs go between two poses that differ by 1e-4 of their size, so that touching
         ones stay so.
"""

import argparse
import time

import numpy as np
from scipy.spatial.transform import Rotation

from simcore.compilation import kernel
from simcore.dem.contact.find_contact import check_ellipsoids, check_potentials, search_ellipsoids, search_potentials
from simcore.dem.contact.pair import Pair
from simcore.dem.contact.pairs.ellipsoid_potentials import meeting_of
from simcore.dem.contact.query import place_solids, query_many, table_of
from simcore.dem.contact.search.ellipsoid_climb import climb_normal, surface_point
from simcore.dem.shapes.polyhedra import ELLIPSOID, collect_shapes, ellipsoid, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.vectors import ZERO, minus_scaled, read, scaled, write
from simcore.verification import brute_force as brute

MEASURES = ("depth", "impact", "cost")
FORMS = {  # a : b : c
    "sphere": (1.0, 1.0, 1.0),
    "1.25:1:0.8": (1.25, 1.0, 0.8),
    "golden": (1.618034, 1.0, 0.618034),
    "prolate 3": (3.0, 1.0, 1.0),
    "oblate 3": (3.0, 3.0, 1.0),
    "prolate 10": (10.0, 1.0, 1.0),
    "oblate 10": (10.0, 10.0, 1.0),
    "prolate 100": (100.0, 1.0, 1.0),
}
DEPTHS = (1e-4, 1e-3, 1e-2)
PAIRS = 300
IMPACTS, STEPS, LONGEST = 1000, 200, 5  # STEPS per contact time; all impacts end within LONGEST contact times
MOVES = ("sphere", "1.25:1:0.8", "golden", "prolate 3", "oblate 3")  # forms in the impacts
DEVIATION = np.radians(10.0)
MOTION, GAP = 1e-4, 3e-3
REPEATS, ROUNDS = 5, 30
# Query, depth, and what is deleted before it (1: how long a gap is certain, 2: all that is remembered)
CASES = (
    ("touching", DEPTHS[1], 0),
    ("near", -GAP, 1),
    ("touching searched", DEPTHS[1], 2),
    ("near searched", -GAP, 2),
)


def random_pairs(form, n, depth, rng):
    """Return semi-axes (2n, 3), quaternions (2n, 4), offsets (n, 3), common normals (n, 3) of pairs of this depth."""
    axes = np.array(FORMS[form]) / np.prod(FORMS[form]) ** (1.0 / 3.0)
    semi = rng.uniform(0.5, 1.0, (2 * n, 1)) * axes
    semi /= np.repeat(np.maximum(semi[0::2, :1], semi[1::2, :1]) / axes[0], 2, axis=0)
    turns = Rotation.random(2 * n, rng=rng).as_quat(scalar_first=True)
    normal = rng.standard_normal((n, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    matrix = form_matrices(semi, Rotation.from_quat(turns, scalar_first=True).as_matrix())[1]
    reach = np.einsum("nij,nj->ni", matrix, np.repeat(normal, 2, axis=0))
    reach /= np.sqrt((reach * np.repeat(normal, 2, axis=0)).sum(axis=1, keepdims=True))
    return semi, turns, reach[0::2] + reach[1::2] - depth * normal, normal


def form_matrices(semi, rotation):
    """Return M = R diag(s²) Rᵀ as rows of Bodies.form_matrix (n, 6), and as matrices (n, 3, 3)."""
    whole = np.einsum("nij,nj,nkj->nik", rotation, semi**2, rotation)
    return np.ascontiguousarray(whole[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]), whole


@kernel
def find_common_normals(m, offset, normal, vector, middle):
    """Write normal, contact vector and middle of pairs 2k, 2k + 1; on entry, `normal` is close to the result."""
    for k in range(len(offset)):
        i, j = 2 * k, 2 * k + 1
        size = np.sqrt(max(m[i, 0], m[i, 1], m[i, 2])) + np.sqrt(max(m[j, 0], m[j, 1], m[j, 2]))
        top = climb_normal(m, Pair(i, j, read(offset, k), size), read(normal, k), np.inf)
        point, _ = surface_point(m, i, top.normal)
        write(normal, k, top.normal)
        write(vector, k, scaled(-top.value, top.normal))
        write(middle, k, minus_scaled(point, 0.5, read(vector, k)))


@kernel
def find_deepest(m, offset, normal, vector, middle):
    """Write the same by potentials, with the normal of the averaged gradients; the vector of a pair apart is 0."""
    for k in range(len(offset)):
        meeting = meeting_of(m, Pair(2 * k, 2 * k + 1, read(offset, k), 1.0), read(normal, k), 60)
        if not meeting.reached:
            raise ValueError("a centre lies in the other body")
        write(normal, k, meeting.normal)
        write(vector, k, meeting.vector if meeting.overlapping else ZERO)
        write(middle, k, meeting.middle)


def direct(construction, m, offset, normal):
    """Return overlap (n,), direction (n, 3) and middle (n, 3); normal (n, 3): of the last step, is replaced."""
    vector, middle = np.empty_like(offset), np.empty_like(offset)
    if construction == "common_normal":
        find_common_normals(m, offset, normal, vector, middle)
        return np.maximum((vector * normal).sum(axis=1), 0.0), normal, middle
    find_deepest(m, offset, normal, vector, middle)
    overlap = np.linalg.norm(vector, axis=1)
    if construction == "projected":
        return (vector * normal).sum(axis=1), normal, middle
    if construction == "potential":
        return overlap, normal, middle
    own = vector / np.where(overlap > 0.0, overlap, 1.0)[:, None]
    if construction == "from_10_degrees":
        deviates = np.linalg.norm(np.cross(own, normal), axis=1) > np.sin(DEVIATION)
        own = np.where(deviates[:, None], normal, own)
    return overlap, own, middle


def row(measure, form, depth, construction, values, unit):
    values = np.asarray(values)
    error = values.std() / np.sqrt(len(values))
    print(
        f"{measure},{form},{depth},{construction},{len(values)},{values.mean():.3e},{error:.1e},{values.std():.3e},"
        f"{np.quantile(np.abs(values), 0.5):.3e},{np.abs(values).max():.3e},{unit}",
        flush=True,
    )


def depths(rng):
    spiral = brute.spiral_directions()
    for form in FORMS:
        for depth in DEPTHS:
            semi, turns, offsets, normal = random_pairs(form, PAIRS, depth, rng)
            rotation = Rotation.from_quat(turns, scalar_first=True).as_matrix()
            m, _ = form_matrices(semi, rotation)
            shapes, index = tuple(ellipsoid(*axes) for axes in semi), np.arange(2 * PAIRS)
            table, solids = table_of(shapes)[0], place_solids(shapes, index, rotation)
            exact = brute.depths(table, solids, offsets, np.zeros(PAIRS, bool), spiral)
            here, there = index[0::2], index[1::2]
            result = query_many(shapes, here, (np.zeros((PAIRS, 3)), turns[0::2]), there, (offsets, turns[1::2]))
            # The exact normal is that of the placement, unless a shorter translation separates the pair.
            normal = np.where((np.abs(exact - depth) < 1e-6 * depth)[:, None], normal, result.normal)
            start = normal + 1e-3 * rng.standard_normal(normal.shape)
            start /= np.linalg.norm(start, axis=1, keepdims=True)
            for construction in ("common_normal", "potential", "contact_vector"):
                overlap, direction, _ = direct(construction, m, offsets, start.copy())
                angle = np.degrees(np.arcsin(np.minimum(np.linalg.norm(np.cross(direction, normal), axis=1), 1.0)))
                if construction != "contact_vector":
                    row("depth", form, depth, construction, overlap / exact - 1.0, "of the depth")
                row("normal", form, depth, construction, angle, "degrees")


def impact_gains(form, construction, depth, rng, n=IMPACTS, steps=STEPS):
    """Return the energy gained (n,) in elastic impacts, in units of the energy of relative motion before.

    The contact time is 1.
    """
    semi, turns, offsets, normal = random_pairs(form, n, 0.0, rng)
    rotation = Rotation.from_quat(turns, scalar_first=True).as_matrix()
    mass = 4.0 / 3.0 * np.pi * semi.prod(axis=1)
    moments = 0.2 * mass[:, None] * semi**2
    inertia = moments.sum(axis=1, keepdims=True) - moments
    reduced = mass[0::2] * mass[1::2] / (mass[0::2] + mass[1::2])
    stiffness, dt = reduced * np.pi**2, 1.0 / steps
    velocity = np.pi * depth * rng.standard_normal((2 * n, 3))
    spin = 0.5 * np.pi * depth * rng.standard_normal((2 * n, 3))
    angular = np.einsum("nij,nj->ni", rotation, inertia * np.einsum("nji,nj->ni", rotation, spin))

    def state():
        m, _ = form_matrices(semi, rotation)
        overlap, direction, middle = direct(construction, m, position[1::2] - position[0::2], normal)
        force = (stiffness * overlap)[:, None] * direction
        pushes, turning = np.empty((2 * n, 3)), np.empty((2 * n, 3))
        pushes[0::2], pushes[1::2] = -force, force
        turning[0::2] = np.cross(middle, -force)
        turning[1::2] = np.cross(middle - position[1::2] + position[0::2], force)
        return overlap, pushes, turning

    def spinning(r):
        return np.einsum("nij,nj->ni", r, np.einsum("nji,nj->ni", r, angular) / inertia)

    def energy():
        v = velocity - np.repeat(drift, 2, axis=0)
        energies = 0.5 * mass * (v**2).sum(axis=1) + 0.5 * (angular * spinning(rotation)).sum(axis=1)
        return energies[0::2] + energies[1::2]

    # A motion and its reverse are equally likely, so a pair that would separate is reversed. It starts within a step of
    # its first contact.
    position = np.zeros((2 * n, 3))
    position[1::2] = offsets
    point = direct("common_normal", form_matrices(semi, rotation)[0], offsets, normal)[2]
    at = velocity[1::2] + np.cross(spin[1::2], point - offsets) - velocity[0::2] - np.cross(spin[0::2], point)
    closing = -(at * normal).sum(axis=1)
    flip = np.repeat(np.sign(closing), 2)[:, None]
    velocity, angular = flip * velocity, flip * angular
    position[1::2] += (np.abs(closing) * dt * rng.uniform(0.0, 1.0, n))[:, None] * normal
    momentum = mass[:, None] * velocity
    drift = (momentum[0::2] + momentum[1::2]) / (mass[0::2] + mass[1::2])[:, None]
    before = energy()
    overlap, force, torque = state()
    for step in range(LONGEST * steps):
        velocity = velocity + 0.5 * dt * force / mass[:, None]
        angular = angular + 0.5 * dt * torque
        position += dt * velocity
        half = Rotation.from_rotvec(0.5 * dt * spinning(rotation)).as_matrix() @ rotation
        rotation = Rotation.from_rotvec(dt * spinning(half)).as_matrix() @ rotation
        overlap, force, torque = state()
        velocity = velocity + 0.5 * dt * force / mass[:, None]
        angular = angular + 0.5 * dt * torque
        if step > steps and not (overlap > 0.0).any():
            return (energy() - before) / before
    raise RuntimeError(f"{form}, {construction}: {(overlap > 0.0).sum()} impacts of {n} have not ended")


RULES = ("common_normal", "potential", "projected", "from_10_degrees", "contact_vector")


def impacts(seed):
    for form in MOVES:
        for depth in DEPTHS[1:]:
            for construction in RULES:
                gain = impact_gains(form, construction, depth, np.random.default_rng(seed))
                row("impact", form, depth, construction, gain, "of the energy")


def _make_asking(potential):
    @kernel
    def ask(first, second, contacts, rounds, fresh):
        """Query all pairs in both poses, `rounds` times; return the number of searches. fresh: see CASES."""
        searched = 0
        for turn in range(2 * rounds):
            bodies = first if turn % 2 == 0 else second
            for p in range(len(contacts.body_a)):
                if fresh > 0:
                    contacts.safe_until[p] = -np.inf
                if fresh > 1:
                    contacts.touching[p] = 0
                    contacts.direction[p] = 0.0
                if potential:
                    check_potentials(None, bodies, contacts, p, 0.0, False)
                    if contacts.pending[p] != 0:
                        searched += 1
                        search_potentials(None, bodies, contacts, p, 0.0, False)
                else:
                    check_ellipsoids(None, bodies, contacts, p, 0.0, False)
                    if contacts.pending[p] != 0:
                        searched += 1
                        search_ellipsoids(None, bodies, contacts, p, 0.0, False)
        return searched

    return ask


def costs(rng):
    asking = {"common_normal": _make_asking(False), "potential": _make_asking(True)}
    ball, still = collect_shapes([unit_sphere()]), np.zeros((2 * PAIRS, 3))
    features = Features(kind=ELLIPSOID, friction=False, periodic=False)
    for form in ("golden", "prolate 3", "prolate 10"):
        for case, depth, fresh in CASES:
            semi, turns, offsets, _ = random_pairs(form, PAIRS, depth, rng)
            reach = 8.0 * semi.max()  # no pair meets another
            poses = []
            for pose in range(2):
                position = np.zeros((PAIRS, 2, 3))
                position[:, 1] = offsets + pose * MOTION * rng.standard_normal((PAIRS, 3))
                position[:, :, 2] += reach * np.arange(PAIRS)[:, None]
                turn = Rotation.from_rotvec(pose * MOTION / semi.max() * rng.standard_normal((2 * PAIRS, 3)))
                turned = (turn * Rotation.from_quat(turns, scalar_first=True)).as_quat(scalar_first=True)
                shape, places = np.zeros(2 * PAIRS, int), position.reshape(-1, 3)
                poses.append(make_bodies([unit_sphere()], shape, semi, places, turned, still, still, density=1.0))
            for construction, ask in asking.items():
                contacts = list_candidates(poses[0], ball, Box(0.0), 0.1, features).contacts
                if len(contacts.body_a) != PAIRS:
                    raise RuntimeError(f"{form}, {case}: {len(contacts.body_a)} pairs are listed, not {PAIRS}")
                ask(*poses, contacts, 1, fresh)
                spent = []
                for _ in range(REPEATS):
                    began = time.process_time()
                    searched = ask(*poses, contacts, ROUNDS, fresh)
                    spent.append((time.process_time() - began) / (2 * ROUNDS * PAIRS) * 1e6)
                # A gap that shrinks to half between the poses is searched again, which happens to a pair or two.
                share = searched / (2 * ROUNDS * PAIRS)
                if contacts.touching.any() != (depth > 0.0) or not (share == 1.0 if fresh > 1 else share < 0.01):
                    raise RuntimeError(f"{form}, {case}, {construction}: not the pairs meant, {share:.3f} searched")
                row("cost", form, case, construction, [min(spent)], "us of CPU")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measures", nargs="+", choices=MEASURES, default=MEASURES)
    measures = parser.parse_args().measures
    print("measure,form,depth,construction,n,mean,standard_error,std,median_size,largest_size,unit")
    if "depth" in measures:
        depths(np.random.default_rng(1))
    if "impact" in measures:
        impacts(2)
    if "cost" in measures:
        costs(np.random.default_rng(3))


if __name__ == "__main__":
    main()

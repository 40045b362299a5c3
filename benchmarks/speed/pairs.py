"""CPU time of an overlap query of touching polyhedra: a cold search, and a check of a remembered contact.

    python -m benchmarks.speed.pairs [--export FILE]

The hulls of 152 random points on ellipsoids 1 : 0.75 : 0.5 are pressed into each other by 1e-3 of the distance at which
they touch. Each pair has two poses that differ by 1e-4 of its size, as a grain moves in some steps. Queries alternate
between the poses, so that a remembered contact is never that of the same pose. With --export the pairs are written for
benchmarks/speed/others/coal_pairs.py.
"""

import argparse
import json
import time

import numpy as np
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from benchmarks.measurement import machine
from simcore.compilation import kernel
from simcore.dem.contact.find_contact import check_polyhedra, search_polyhedra
from simcore.dem.shapes.polyhedra import POLYHEDRON, Base, collect_shapes
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.grains.mesh import make_grain

SEMI_AXES = np.array([1.0, 0.75, 0.5])  # [m]; tolerances are relative to the pair's size, here and in coal
DEPTH, MOTION = 1e-3, 1e-4
WARM_ROUNDS, COLD_ROUNDS, REPEATS = 2000, 20, 5


def make_pairs(n_pairs=64, n_points=152, seed=1):
    """Return bases of all hulls, rotation (n, 2, 2, 4) and position (n, 2, 2, 3) [m] by pair, pose and side.

    Rotations are quaternions w, x, y, z.
    """
    random = np.random.default_rng(seed)
    bases, rotation, position = [], np.zeros((n_pairs, 2, 2, 4)), np.zeros((n_pairs, 2, 2, 3))
    for pair in range(n_pairs):
        hulls, turned = [], Rotation.random(2, rng=random)
        for side in range(2):
            points = random.normal(size=(n_points, 3))
            points *= SEMI_AXES / np.linalg.norm(points, axis=1, keepdims=True)
            grain = make_grain(f"hull{2 * pair + side}", points)
            bases.append(Base(grain.name, grain.vertices, grain.faces, grain.volume, grain.second_moments))
            hulls.append(turned[side].apply(grain.vertices))
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        for pose in range(2):
            drift = pose * MOTION * random.normal(size=(2, 3))
            for side in range(2):
                pose_rotation = Rotation.from_rotvec(drift[0] * (2 * side - 1)) * turned[side]
                rotation[pair, pose, side] = pose_rotation.as_quat(scalar_first=True)
            position[pair, pose, 1] = (1.0 - DEPTH) * _touching_distance(*hulls, way) * way + drift[1]
    return bases, rotation, position


def _touching_distance(first, second, way):
    """Return the distance along `way` at which the second hull only touches the first, by a linear program."""
    n, m = len(first), len(second)
    equations = np.zeros((5, n + m + 1))
    equations[:3, :n], equations[:3, n : n + m], equations[:3, -1] = first.T, -second.T, -way
    equations[3, :n], equations[4, n : n + m] = 1.0, 1.0
    solution = linprog(np.r_[np.zeros(n + m), -1.0], A_eq=equations, b_eq=[0, 0, 0, 1, 1], bounds=(0, None))
    if solution.status != 0:
        raise RuntimeError(f"no touching distance: {solution.message}")
    return solution.x[-1]


@kernel
def ask(shapes, first, second, contacts, rounds, cold):
    """Query all pairs in both poses, `rounds` times; return the number of queries that needed a search."""
    searched = 0
    for turn in range(2 * rounds):
        bodies = first if turn % 2 == 0 else second
        for p in range(len(contacts.body_a)):
            if cold:
                contacts.touching[p] = 0
                contacts.direction[p] = 0.0
                contacts.facet[p] = -1
                contacts.safe_until[p] = -np.inf
            check_polyhedra(shapes, bodies, contacts, p, 0.0, False)
            if contacts.pending[p] != 0:
                searched += 1
                search_polyhedra(shapes, bodies, contacts, p, 0.0, False)
    return searched


def measure(bases, rotation, position):
    """Return a dict with the CPU times per cold and warm query [µs], minima of five, and overlaps in the last pose."""
    n = len(position)
    shapes = collect_shapes(bases)
    still, shape = np.zeros((2 * n, 3)), np.arange(2 * n)
    apart = np.array([0.0, 0.0, 10.0]) * np.arange(n)[:, None, None]  # no pair meets another
    poses = [
        make_bodies(
            bases,
            shape,
            np.ones((2 * n, 3)),
            (position[:, pose] + apart).reshape(-1, 3),
            rotation[:, pose].reshape(-1, 4),
            still,
            still,
            density=1.0,
        )  # fmt: skip
        for pose in range(2)
    ]
    features = Features(kind=POLYHEDRON, friction=False, periodic=False)
    contacts = list_candidates(poses[0], shapes, Box(0.0), 0.01, features).contacts
    if not (len(contacts.body_a) == n and (contacts.body_a == 2 * np.arange(n)).all()):
        raise RuntimeError("the neighbour list is not that of the pairs")
    result = {}
    for name, rounds, cold in (("cold", COLD_ROUNDS, True), ("warm", WARM_ROUNDS, False)):
        searched = ask(shapes, *poses, contacts, 1, cold)
        spent = []
        for _ in range(REPEATS):
            began = time.process_time()
            searched = ask(shapes, *poses, contacts, rounds, cold)
            spent.append(time.process_time() - began)
        result[f"{name}_us"] = min(spent) / (2 * rounds * n) * 1e6
        result[f"{name}_searched"] = searched / (2 * rounds * n)
    if not contacts.touching.all():
        raise RuntimeError("a pair does not touch")
    return result, contacts.overlap.copy()


def export(path, bases, rotation, position, overlap):
    """Write the pairs and our overlaps for benchmarks/speed/others/coal_pairs.py."""
    vertices, faces = [base.vertices for base in bases], [base.faces for base in bases]
    np.savez(
        path,
        vertices=np.concatenate(vertices),
        vertex_start=np.cumsum([0, *map(len, vertices)]),
        faces=np.concatenate(faces),
        face_start=np.cumsum([0, *map(len, faces)]),
        rotation=rotation,
        position=position,
        overlap=overlap,
    )


def run(export_to=None):
    pairs = make_pairs()
    result, overlap = measure(*pairs)
    if export_to:
        export(export_to, *pairs, overlap)
    return {"code": "Scree", **result, "pairs": len(overlap), "machine": machine()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--export", metavar="FILE")
    print(json.dumps(run(parser.parse_args().export)))


if __name__ == "__main__":
    main()

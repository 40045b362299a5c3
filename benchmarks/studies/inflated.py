"""Errors of the contact search in the program of Rettinger et al. (2022) for touching polyhedra, by size and form.

    python -m benchmarks.studies.inflated [--pairs 2000] [--overlap 1e-7] > results/reference/inflated.csv

Random pairs of synthetic grains with 300 faces, turned at random, overlap by exactly the given length [m]; in the beds
of Rettinger et al. at rest the mean is 1e-7 m. There is one CSV row per kind of pair: sieve sizes of both [m], factor
on the lengths of the grains, mean L/S; the share of pairs that the search does not find (lost); the share whose
polytope does not reach the bodies (short: the overlap is less than 0.99 of the true one, or lost); the overlap over the
true one, mean and 5 % quantile (0 if lost); the angle of the normal to the true one, 90 and 99 % quantiles without lost
pairs [rad]; and the CPU time of a search [µs].
"""

import argparse
import csv
import sys
import time

import numpy as np
from scipy.spatial.transform import Rotation

from simcore.compilation import kernel
from simcore.dem.contact.pair import pair_of
from simcore.dem.contact.pairs.inflated import search_inflated
from simcore.dem.contact.query import place_solids, query_many, table_of
from simcore.dem.shapes.polyhedra import convex
from simcore.dem.vectors import read, write
from simcore.grains.mesh import decimate
from simcore.grains.synthetic import synthetic_grains

FACES, GRAINS = 300, 63
KINDS = {  # sieve sizes of a and of b [m]; factor on lengths
    "U1": (6.7e-3, 6.7e-3, 1.0),
    "coarse sand": (1e-3, 1e-3, 1.0),
    "stones": (27e-3, 27e-3, 1.0),
    "stone and pebble": (27e-3, 3.3e-3, 1.0),
    "U1, rounder": (6.7e-3, 6.7e-3, 0.7),
    "U1, longer": (6.7e-3, 6.7e-3, 1.6),
    "U1, twice as long": (6.7e-3, 6.7e-3, 2.0),
}
COLUMNS = [
    "pairs", "size_a", "size_b", "longer", "mean_L_over_S", "overlap", "lost", "short", "mean_share", "share_5_percent",
    "angle_90_percent", "angle_99_percent", "us",
]  # fmt: skip


@kernel
def find(shapes, solids, offset, overlap, normal):
    """Write the overlap and the normal that the search finds for pairs 2k, 2k + 1; an overlap of 0 if it finds none."""
    for k in range(len(offset)):
        exists, contact = search_inflated(shapes, solids, pair_of(solids, 2 * k, 2 * k + 1, read(offset, k)))
        overlap[k] = contact.overlap if exists else 0.0
        write(normal, k, contact.normal)


def touching_pairs(hulls, index, overlap, rng):
    """Return quaternions (2n, 4), positions of b (n, 3), normals (n, 3), and which pairs have this exact overlap."""
    n = len(index) // 2
    turns = Rotation.random(2 * n, rng=rng).as_quat(scalar_first=True)
    way = rng.standard_normal((n, 3))
    radius = np.array([hull.radius for hull in hulls])[index]
    place_b = way / np.linalg.norm(way, axis=1, keepdims=True) * (radius[0::2] + radius[1::2])[:, None]
    origin = np.zeros((n, 3))
    for _ in range(40):
        observed = query_many(hulls, index[0::2], (origin, turns[0::2]), index[1::2], (place_b, turns[1::2]))
        place_b = place_b - (observed.signed_distance + overlap)[:, None] * observed.normal
    right = np.abs(observed.signed_distance + overlap) < 1e-4 * overlap
    return turns, place_b, observed.normal, right


def measure(grains, size_a, size_b, longer, pairs, overlap):
    """Return one row of COLUMNS as a dict."""
    rng = np.random.default_rng(1)
    sizes = sorted({size_a, size_b})
    hulls = [convex(g.vertices * [1, 1, longer] * size / g.sieve_size) for size in sizes for g in grains]
    index = rng.integers(len(grains), size=2 * pairs)
    index[0::2] += len(grains) * sizes.index(size_a)
    index[1::2] += len(grains) * sizes.index(size_b)
    turns, place_b, normal, right = touching_pairs(hulls, index, overlap, rng)
    rotation = Rotation.from_quat(turns, scalar_first=True).as_matrix()
    center = np.einsum("nij,nj->ni", rotation, np.array([hull.center for hull in hulls])[index])
    offset = place_b + center[1::2] - center[0::2]
    shapes, solids = table_of(tuple(hulls))[0], place_solids(tuple(hulls), index, rotation)
    depth, along = np.empty(pairs), np.empty((pairs, 3))
    find(shapes, solids, offset[:1], depth[:1], along[:1])
    start = time.process_time()
    find(shapes, solids, offset, depth, along)
    spent = time.process_time() - start
    share = depth[right] / overlap
    reported = right & (depth > 0.0)
    angle = np.arccos(np.clip((along * normal).sum(axis=1)[reported], -1.0, 1.0))
    return {
        "pairs": int(right.sum()),
        "size_a": size_a,
        "size_b": size_b,
        "longer": longer,
        "mean_L_over_S": longer * np.mean([g.L / g.S for g in grains]),
        "overlap": overlap,
        "lost": (share == 0.0).mean(),
        "short": (share < 0.99).mean(),
        "mean_share": share.mean(),
        "share_5_percent": np.quantile(share, 0.05),
        "angle_90_percent": np.quantile(angle, 0.9),
        "angle_99_percent": np.quantile(angle, 0.99),
        "us": 1e6 * spent / pairs,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=2000)
    parser.add_argument("--overlap", type=float, default=1e-7, help="[m]")
    options = parser.parse_args()
    grains = [decimate(grain, FACES) for grain in synthetic_grains(seed=1, n=GRAINS)]
    writer = csv.DictWriter(sys.stdout, ["kind", *COLUMNS], lineterminator="\n")
    writer.writeheader()
    for kind, (size_a, size_b, longer) in KINDS.items():
        row = measure(grains, size_a, size_b, longer, options.pairs, options.overlap)
        row = {key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()}
        writer.writerow({"kind": kind, **row})
        sys.stdout.flush()


if __name__ == "__main__":
    main()

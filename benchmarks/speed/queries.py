"""CPU time [µs] of a cold contact query in the compiled loop: hulls that touch, are apart, or overlap deeply.

    python -m benchmarks.speed.queries [--vertices 20 152 1300]

The hulls resemble pebbles and form 300 pairs at random orientations; the minimum of five times is printed. `query` is
the query of the distance to the last digits, with points. `search` is what a step needs: the facet, or a certain gap
(simcore.dem.contact.search.polyhedra.search_pair).
"""

import argparse
import time

import numpy as np

from simcore.compilation import kernel
from simcore.dem.contact.pair import pair_of
from simcore.dem.contact.query import place_solids, query_pairs, table_of
from simcore.dem.contact.search.polyhedra import search_pair
from simcore.dem.shapes.polyhedra import convex
from simcore.dem.state.bodies import rotation_matrix
from simcore.dem.vectors import direction_of, read

PAIRS = 300


@kernel
def search_pairs(shapes, solids, offset, distance):
    for k in range(len(offset)):
        i, j = 2 * k, 2 * k + 1
        a, b = shapes.vertex_start[solids.shape[i]], shapes.vertex_start[solids.shape[j]]
        pair = pair_of(solids, i, j, read(offset, k))
        distance[k] = search_pair(shapes, solids, pair, a, b, direction_of(pair.offset), 0.1).distance


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vertices", type=int, nargs="*", default=[20, 152, 1300])
    options = parser.parse_args()
    print("vertices,pairs,query_us,search_us")
    for n in options.vertices:
        for name, query_us, search_us in measure(n):
            print(f"{n},{name},{query_us:.2f},{search_us:.2f}", flush=True)


def measure(n_vertices):
    rng = np.random.default_rng(0)
    shapes = []
    for _ in range(10):
        points = rng.standard_normal((n_vertices, 3))
        shapes.append(convex(points / np.linalg.norm(points, axis=1, keepdims=True) * [1.0, 0.75, 0.5]))
    table, _ = table_of(tuple(shapes))
    turns = rng.standard_normal((2 * PAIRS, 4))
    rotation = rotation_matrix(turns / np.linalg.norm(turns, axis=1, keepdims=True))
    solids = place_solids(tuple(shapes), rng.integers(10, size=2 * PAIRS), rotation)
    unit = rng.standard_normal((PAIRS, 3))
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    out = np.empty(PAIRS), np.empty((PAIRS, 3)), np.empty((PAIRS, 3)), np.empty((PAIRS, 3))
    reach, wanted = np.full(PAIRS, 1.5), -2.0 * 10.0 ** rng.uniform(-4, -3, PAIRS)
    for _ in range(60):  # until they overlap by 1e-4 to 1e-3 of the pair's size
        query_pairs(table, solids, unit * reach[:, None], *out)
        reach -= (out[0] - wanted) / np.maximum((out[1] * unit).sum(axis=1), 0.3)
    for name, distance in (
        ("touching", reach), ("apart by 0.3", reach + 0.3), ("apart by 2", reach + 2.0),
        ("deep", 0.5 * reach), ("concentric", np.full(PAIRS, 1e-9)),
    ):  # fmt: skip
        offset = unit * distance[:, None]
        yield (
            name,
            least_time(lambda offset=offset: query_pairs(table, solids, offset, *out)),
            least_time(lambda offset=offset: search_pairs(table, solids, offset, out[0])),
        )


def least_time(run):
    """Return the minimum CPU time of five runs of ten rounds [µs per pair]."""
    run()
    times = []
    for _ in range(5):
        started = time.process_time()
        for _ in range(10):
            run()
        times.append(time.process_time() - started)
    return min(times) / 10 / PAIRS * 1e6


if __name__ == "__main__":
    main()

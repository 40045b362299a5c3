"""Errors of the contact query: random and adversarial pairs against exhaustive references.

    python -m benchmarks.correctness.exactness [--pairs 20000] [--family NAME ...] [--seed 1] [--size 20]

It prints one CSV row per family. All errors are the largest ones, relative to the pair's size, the sum of the radii:

    overlapping      share of the pairs that overlap
    depth            depth against that of simcore.verification.brute_force; 1 if a distance is not finite
    reference_above  how far the reference exceeds the query, which is no error of the query
    shown            distance against the bound that the normal shows
    points           point_b − point_a against distance × normal
    exchange         change of the distance when the two bodies are exchanged
    pairs_per_s      pairs per second of the query alone
"""

import argparse
import time

import numpy as np


def unit(x):
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def thin(rng, n):
    """Return scales (n, 3) of roundish bodies, plates and needles, with ratios of the axes down to 1:100."""
    scale = rng.uniform(0.5, 1.0, (n, 3))
    for k in range(n):
        if k % 3 == 1:
            scale[k, rng.integers(3)] *= 10.0 ** rng.uniform(-2, 0)
        elif k % 3 == 2:
            scale[k] *= 10.0 ** rng.uniform(-2, 0)
            scale[k, rng.integers(3)] = 1.0
    return scale


def cloud(rng, kind, n):
    points = rng.standard_normal((n, 3))
    if kind % 3 == 0:
        points = unit(points)
    elif kind % 3 == 1:
        points = rng.uniform(-1.0, 1.0, points.shape)
    return points / np.abs(points).max()


CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
PRISM = np.array([[np.cos(t), np.sin(t), z] for t in np.arange(6) * np.pi / 3 for z in (-1.0, 1.0)])
PYRAMID = np.array([[1, 1, 0], [1, -1, 0], [-1, 1, 0], [-1, -1, 0], [0, 0, 1.5]])
OCTAHEDRON = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.0]])
SOLIDS = (CUBE, PRISM, PYRAMID, OCTAHEDRON)


def nearly_flat(rng, noise):
    """Return the corners of a cube and points on its faces (32, 3), displaced by noise of this standard deviation."""
    points = rng.uniform(-1.0, 1.0, (24, 3))
    axis = rng.integers(3, size=24)
    points[np.arange(24), axis] = np.sign(points[np.arange(24), axis])
    points = np.vstack([CUBE, points])
    return points + noise * rng.standard_normal(points.shape)


def make_shapes(family, rng, count, size):
    """Return two lists of `count` shapes, for the bodies a and b. size: maximum number of vertices of a hull."""
    from simcore.dem.shapes.polyhedra import convex, ellipsoid, sphere

    def hulls(thinned):
        scale = thin(rng, count) if thinned else np.ones((count, 3))
        return [convex(cloud(rng, k, rng.integers(min(8, size), size + 1)) * scale[k]) for k in range(count)]

    def ellipsoids(thinned):
        scale = thin(rng, count) if thinned else rng.uniform(0.3, 1.0, (count, 3))
        return [ellipsoid(*s) for s in scale]

    def spheres():
        return [sphere(r) for r in 10.0 ** rng.uniform(-2, 0, count)]

    if family.startswith("hulls"):
        return hulls("thin" in family), hulls("thin" in family)
    if family.startswith("ellipsoids"):
        return ellipsoids("thin" in family), ellipsoids("thin" in family)
    if family == "aligned solids":
        shapes = [convex(SOLIDS[k % 4] * s) for k, s in enumerate(rng.choice([0.01, 0.5, 1.0], (count, 3)))]
        return shapes, shapes
    if family == "nearly flat":
        shapes = [convex(nearly_flat(rng, 10.0 ** rng.uniform(-15, -9))) for _ in range(count)]
        return shapes, shapes
    if family == "sphere hull":
        return spheres(), hulls(True)
    if family == "sphere ellipsoid":
        return spheres(), ellipsoids(True)
    if family == "hull ellipsoid":
        return hulls(False), ellipsoids(False)
    if family == "hull ellipsoid thin":
        return hulls(True), ellipsoids(True)
    if family == "solid ellipsoid aligned":
        return [convex(SOLIDS[k % 4] * s) for k, s in enumerate(thin(rng, count))], ellipsoids(True)
    raise ValueError(family)


FAMILIES = (
    "hulls", "hulls thin", "aligned solids", "nearly flat", "ellipsoids", "ellipsoids thin",
    "sphere hull", "sphere ellipsoid", "hull ellipsoid", "hull ellipsoid thin", "solid ellipsoid aligned",
)  # fmt: skip


def draw(family, rng, n, size=20, count=400):
    """Return n pairs: (shapes, index_a, poses_a, index_b, poses_b).

    One sixth of the pairs each is placed anywhere, grazing (by the query along its own normal), deep, nearly
    concentric, concentric, and with a ratio of sizes of up to 1:1000. All lengths together are scaled to 1e-6 to 1e3 m.
    A third of the pairs is 1e6 sizes away from the world's origin. size: maximum number of vertices of a hull. count:
    number of shapes.
    """
    from simcore.dem.contact.query import query_many
    from simcore.dem.shapes.polyhedra import Shape

    a, b = make_shapes(family, rng, min(count, n), size)
    factor = 10.0 ** rng.uniform(-6, 3)
    small = 10.0 ** rng.uniform(-3, 0)

    def scaled(shape, by):
        base = shape.base._replace(vertices=shape.base.vertices * by)
        center = tuple(c * by for c in shape.center)
        return Shape(shape.kind, base, tuple(s * by if len(base.vertices) == 0 else s for s in shape.scale),
                     center, shape.radius * by)  # fmt: skip

    shapes = tuple([scaled(s, factor) for s in a + b] + [scaled(s, factor * small) for s in b])
    index_a = rng.integers(len(a), size=n)
    kind = np.arange(n) % 6
    index_b = rng.integers(len(b), size=n) + np.where(kind == 5, len(a) + len(b), len(a))
    turns = [unit(rng.standard_normal((n, 4))) for _ in range(2)]
    if "aligned" in family:
        turns = [turns[0], turns[0].copy()]
        square = np.arange(n) % 5 == 0
        turns[1][square] = multiply(turns[0][square], np.array([np.sqrt(0.5), np.sqrt(0.5), 0, 0]))
    radius = np.array([s.radius for s in shapes])
    reach = radius[index_a] + radius[index_b]
    offset = unit(rng.standard_normal((n, 3))) * (reach * rng.uniform(0.0, 1.1, n))[:, None]
    if "aligned" in family:
        offset = turn(turns[0], rng.choice([0.0, 0.01, 0.02, 0.5, 1.0, 1.5, 2.0], (n, 3)) * factor)
    offset[kind == 2] *= 0.2
    offset[kind == 3] *= (10.0 ** rng.uniform(-12, -3, (kind == 3).sum()))[:, None]
    offset[kind == 4] = 0.0
    origin = rng.standard_normal((n, 3)) * reach[:, None] * (1e6 * (np.arange(n) % 3 == 0))[:, None]
    zero = np.zeros((n, 3))
    grazing = np.flatnonzero(kind == 1)
    if len(grazing):
        rows = grazing
        result = query_many(shapes, index_a[rows], (zero[rows], turns[0][rows]), index_b[rows],
                           (offset[rows], turns[1][rows]))  # fmt: skip
        wanted = 10.0 ** rng.uniform(-14, -2, len(rows)) * rng.choice([-1.0, 1.0], len(rows)) * reach[rows]
        offset[rows] += (wanted - result.signed_distance)[:, None] * result.normal
    return shapes, index_a, (origin, turns[0]), index_b, (origin + offset, turns[1])


def multiply(p, q):
    w, x, y, z = np.moveaxis(p, -1, 0)
    a, b, c, d = np.moveaxis(q, -1, 0)
    return np.stack(
        [w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c,
         w * c - x * d + y * a + z * b, w * d + x * c - y * b + z * a], axis=-1,
    )  # fmt: skip


def turn(q, v):
    from simcore.dem.state.bodies import rotation_matrix

    return np.einsum("nij,nj->ni", rotation_matrix(q), v)


def examine(pairs, exchange=True, reference=True):
    """Return a dict of the errors of a query of these pairs, (n,) relative to the pair's size, and its time `seconds`.

    depth: against the reference, nan for pairs that are apart. shown: of the signed distance against what the normal
    shows. points: of point_b − point_a against distance × normal; for a gap this bounds the distance from above, as
    `shown` does from below. exchange: of the distance when a and b are exchanged.
    """
    from simcore.dem.contact.query import place_solids, query_many, table_of
    from simcore.dem.state.bodies import rotation_matrix
    from simcore.verification import brute_force as brute

    shapes, index_a, (position_a, turn_a), index_b, (position_b, turn_b) = pairs
    started = time.perf_counter()
    result = query_many(shapes, index_a, (position_a, turn_a), index_b, (position_b, turn_b))
    seconds = time.perf_counter() - started
    table, _ = table_of(shapes)
    index = np.stack([index_a, index_b], axis=1).ravel()
    turns = np.stack([turn_a, turn_b], axis=1).reshape(-1, 4)
    rotation = rotation_matrix(turns / np.linalg.norm(turns, axis=1, keepdims=True))
    solids = place_solids(shapes, index, rotation)
    center = np.einsum("nij,nj->ni", rotation, np.array([s.center for s in shapes])[index])
    offset = (position_b - position_a) + (center[1::2] - center[0::2])
    size = solids.radius[0::2] + solids.radius[1::2]
    d, normal = result.signed_distance, result.normal
    errors = {"distance": d / size, "seconds": seconds}
    # World coordinates have the rounding error of their magnitude: 1e-10 sizes at a distance of 1e6 sizes.
    coarse = np.finfo(float).eps * np.maximum(np.abs(position_a).max(axis=1), np.abs(position_b).max(axis=1))
    errors["points"] = np.maximum(
        np.abs(result.point_b - result.point_a - d[:, None] * normal).max(axis=1) - 4.0 * coarse, 0.0
    ) / size  # fmt: skip
    errors["normal"] = np.abs(np.linalg.norm(normal, axis=1) - 1.0)
    errors["shown"] = np.abs(brute.shown_along(table, solids, offset, normal) - d) / size
    errors["depth"] = np.full(len(d), np.nan)
    if reference:
        apart = d > 0.0  # certain, because the normal shows the gap
        depth = brute.depths(table, solids, offset, apart, brute.spiral_directions())
        # Only a smaller depth of the reference is an error of the query, because the reference gives upper bounds, too.
        errors["depth"] = np.where(apart, np.nan, (-d - np.maximum(depth, 0.0)) / size)
        errors["reference"] = np.where(apart, np.nan, (depth + d) / size)
    if exchange:
        back = query_many(shapes, index_b, (position_b, turn_b), index_a, (position_a, turn_a))
        errors["exchange"] = np.abs(back.signed_distance - d) / size
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=20000, help="number of pairs of each family")
    parser.add_argument("--family", nargs="*", default=FAMILIES, choices=FAMILIES)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--size", type=int, default=20, help="maximum number of vertices of a hull")
    parser.add_argument("--chunk", type=int, default=5000)
    options = parser.parse_args()
    print("family,pairs,overlapping,depth,reference_above,shown,points,exchange,pairs_per_s", flush=True)
    for family in options.family:
        worst, total, overlapping, seconds = {}, 0, 0, 0.0
        for chunk, first in enumerate(range(0, options.pairs, options.chunk)):
            rng = np.random.default_rng([options.seed, chunk])
            pairs = draw(family, rng, min(options.chunk, options.pairs - first), options.size)
            errors = examine(pairs)
            total += len(errors["distance"])
            overlapping += int((errors["distance"] < 0.0).sum())
            seconds += errors["seconds"] if chunk else 0.0
            if not np.isfinite(errors["distance"]).all():
                worst["depth"] = 1.0
            for key in ("depth", "reference", "shown", "points", "exchange"):
                worst[key] = max(worst.get(key, 0.0), np.nanmax(errors[key], initial=0.0))
        # The first chunk compiles, and one chunk alone has no speed.
        rate = f"{(total - options.chunk) / seconds:.0f}" if seconds > 0.0 else ""
        figures = ",".join(f"{worst[key]:.1e}" for key in ("depth", "reference", "shown", "points", "exchange"))
        print(f"{family},{total},{overlapping / total:.2f},{figures},{rate}", flush=True)


if __name__ == "__main__":
    main()

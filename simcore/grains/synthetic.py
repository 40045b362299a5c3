"""Makes Rhine-like pebbles from a seed, for users without scans of grains.

The flatness and elongation of the pebbles have exactly the statistics of Rettinger et al. (2022). Their shape is a
block with random flat sides and worn edges, which distinguishes a pebble from an ellipsoid of the same form. The sizes
of the sides and the wear are such that sphericity and the share of surface in large facets are within the ranges of
CT-scanned gravel (scan_ranges.csv).
"""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from simcore.grains.form import axes_from_form, ellipsoid_sphericity
from simcore.grains.mesh import make_grain
from simcore.grains.scan_shapes import scan_ranges, shape_measures
from simcore.grains.sources import synthetic_names
from simcore.grains.spiral import spiral_directions

# Rettinger et al. (2022), Table 2 and text. ASSUME: the standard deviations are those of a sample (n - 1, ddof 1).
FLATNESS_MEAN, FLATNESS_STD = 0.647, 0.175
ELONGATION_MEAN, ELONGATION_STD = 0.682, 0.139
# ASSUME: the correlations with size in Rettinger et al. are with the logarithm of the sieve size.
CORRELATION = np.array([[1.0, -0.11, 0.23], [-0.11, 1.0, -0.089], [0.23, -0.089, 1.0]])  # log size, FL, EL
SIZE_BOUNDS = np.array([2.8, 4.0, 5.6, 8.0, 11.2, 16.0, 22.4, 31.5]) * 1e-3  # seven sieve classes [m]
FACE_RANGE = (220, 2620)

# If the ellipsoid of a form has a sphericity below this, no worn block of that form is within the ranges of the scans.
_ROUNDEST_MIN = 0.75
# Tolerances of the measures of decimated hulls: round-off in the vertices changes the collapse, and with it the
# sphericity by 0.001 and the share of surface in facets by 0.04.
_MARGIN = np.array([0, 0, 0, 0.002, 0.04])


def synthetic_grains(seed=1, n=63):
    """Make n pebbles (list of Grain), named G01... by increasing sieve size, the same for the same seed and n.

    FL and EL have the means, standard deviations (n - 1) and correlation of Rettinger et al. (2022) to round-off, are
    in (0.25, 1], and pass the Shapiro-Wilk test at 0.05. The correlations of log D with both are also those of
    Rettinger et al. The sizes are spread evenly over the seven sieve classes, the numbers of faces log-uniformly over
    FACE_RANGE.
    ValueError if n < 21, or if n is so large that no such sample is found (more than about 100).
    """
    if n < 21:
        raise ValueError(f"{n} synthetic grains are too few; at least 21 are needed, three in each sieve class")
    rng = np.random.default_rng([seed, n])
    D, flatness, elongation = _draw_forms(rng, n)
    faces = 2 * np.round(np.geomspace(*FACE_RANGE, n)[rng.permutation(n)] / 2).astype(int)
    ranges = scan_ranges()
    return [
        _draw_pebble(np.random.default_rng([seed, n, i]), name, *row, ranges)
        for i, (name, *row) in enumerate(zip(synthetic_names(n), faces, D, flatness, elongation, strict=True))
    ]


def _draw_forms(rng, n):
    """Draw D [m], increasing, FL and EL, each (n,), with exactly the statistics of Rettinger et al. (2022)."""
    from scipy.stats import shapiro  # imported here because it loads slowly and packings only read finished grains

    classes = np.sort(np.arange(n) % 7)
    logs = np.log2(SIZE_BOUNDS)
    colour = np.linalg.cholesky(CORRELATION)
    for _ in range(50_000):
        log_size = np.sort(logs[classes] + rng.random(n) * np.diff(logs)[classes])
        # Independent forms are drawn, more widely because their tails are cut; below they get the exact statistics.
        pairs = rng.normal([0.63, ELONGATION_MEAN], [1.3 * FLATNESS_STD, 1.3 * ELONGATION_STD], (20 * n, 2))
        pairs = pairs[np.all((pairs > 0.28) & (pairs < 0.99), axis=1)]
        pairs = pairs[_roundest(*pairs.T) > _ROUNDEST_MIN][:n]
        columns = np.column_stack([log_size, pairs])
        white, upper = np.linalg.qr(columns - columns.mean(0))
        scores = white * np.sign(np.diag(upper)) * np.sqrt(n - 1) @ colour.T
        flatness = FLATNESS_MEAN + FLATNESS_STD * scores[:, 1]
        elongation = ELONGATION_MEAN + ELONGATION_STD * scores[:, 2]
        forms = np.array([flatness, elongation])
        if not np.all((forms > 0.25) & (forms <= 1)) or _roundest(*forms).min() < _ROUNDEST_MIN:
            continue
        if min(shapiro(flatness).pvalue, shapiro(elongation).pvalue) > 0.05:
            return 2.0**log_size, flatness, elongation
    raise ValueError(
        f"no {n} synthetic forms have the statistics of Rettinger et al. (2022), because the tails of more than about "
        "100 normal forms leave (0.25, 1]; set grains.number to 100 or fewer, or give another grains.seed"
    )


def _roundest(flatness, elongation):
    return ellipsoid_sphericity(*axes_from_form(1.0, flatness, elongation))


def _draw_pebble(rng, name, faces, D, flatness, elongation, ranges):
    """Draw a pebble of this size and form until its shape is within the ranges of the scans."""
    L, I, S = axes_from_form(D, flatness, elongation)  # noqa: E741
    while True:
        block = make_grain(name, _worn_block(rng, faces // 2 + 2))
        if len(block.faces) != faces:  # a vertex is in the plane of others
            continue
        grain = block.scaled(np.array([S, I, L]) / [block.S, block.I, block.L])
        measured = shape_measures(grain)
        low, high = ranges.loc[measured.index, ["min", "max"]].T.to_numpy()
        if (measured - _MARGIN >= low).all() and (measured + _MARGIN <= high).all():
            return replace(grain, hull_ratio=1.0)  # the pebble is convex


def _worn_block(rng, n_points):
    """Return points (n, 3) on a strictly convex body, a block between random planes with rounded edges.

    Planes n_i.x = h_i bound the block, whose surface is r = 1 / max_i (n_i.u / h_i). If the p-norm replaces the
    maximum, the surface is convex and smooth: flat where one plane dominates, round where two meet, and rounder for a
    smaller p. The number and distances of the planes and p vary from pebble to pebble.
    """
    # ASSUME: with these ranges the shares of surface in facets are in the middle of those of the scans.
    n_planes = int(rng.integers(14, 27))
    normals = _scattered(rng, n_planes, 0.3)
    distances = rng.uniform(1 - 0.3, 1 + 0.3, n_planes)
    exponent = rng.uniform(10, 17)
    directions = _scattered(rng, n_points, 0.2)
    gauge = np.sum(np.maximum(directions @ normals.T / distances, 0) ** exponent, axis=1) ** (1 / exponent)
    return directions / gauge[:, None]


def _scattered(rng, n, jitter):
    """Return n random directions (n, 3), none close to another: a rotated spiral, moved by jitter times its spacing."""
    spiral = Rotation.random(rng=rng).apply(spiral_directions(n))
    moved = spiral + jitter * np.sqrt(4 * np.pi / n) * rng.normal(size=(n, 3))
    return moved / np.linalg.norm(moved, axis=1)[:, None]

"""Insertion of grains at random places and orientations above the bed, without contacts between them.

The zone of a batch begins `drop_height` above all inserted grains. Each grain has its own sequence of random places. Of
two grains that touch, the one with the later turn moves to its next place; this is repeated until no grains touch. With
placement "random" the turns are those of the ids, with "filled" the largest grain has the first: small grains find
places between large ones, so that a zone of mixed sizes can be dense. Every rank draws the whole batch from (seed, id),
so ranks, threads and interruptions do not change a bit.
"""

import numpy as np

RELEASE_STREAM = 3  # of the counter-based generator; others are used for size, insertion, kind (0 to 2) and quotas (4)
# ASSUME: volume fraction of the grains of a batch in its zone. Spheres no longer fit at 0.38, and long grains earlier;
# at 0.1 even ellipsoids with L/S = 6 fit after some tens of tries.
DILUTE = 0.1
MAX_TRIES = 10_000


def zone_height(reach, volumes, area: float, fraction: float = DILUTE) -> float:
    """Return the height [m] of the zone with this area [m²] in which grains are placed.

    reach (n,) [m]: bounding radii of the grains. volumes (n,) [m³]. fraction: their volume fraction in the zone.
    """
    return float(2.0 * np.max(reach) + np.sum(volumes) / (fraction * area))


def fitting_grains(reach, volumes, area: float, fraction: float, height: float) -> int:
    """Return how many of the grains, taken in their order, fill a zone of at most this height [m]; 0 if none fits.

    reach, volumes, area, fraction: as of zone_height.
    """
    heights = 2.0 * np.maximum.accumulate(reach) + np.cumsum(volumes) / (fraction * area)
    return int(np.searchsorted(heights, height, side="right"))


def check_reach(reach, width: float) -> None:
    """Raise ValueError if a grain, of these bounding radii [m], is wider than the domain [m]."""
    widest = float(np.max(reach))
    if 2.0 * widest >= width:
        raise ValueError(
            f"a grain is {2e3 * widest:.3g} mm wide and does not fit into a domain {1e3 * width:g} mm wide; raise "
            f"domain.width, or leave out such long grains"
        )


def release_places(ids, reach, height: float, domain, low: float, seed: int, touching, turns=None) -> np.ndarray:
    """Return centres (n, 3) [m] of the grains `ids` (n,), in increasing order, in the zone from `low` [m] upwards.

    reach (n,) [m]: radii of the bounding spheres. height [m]: of the zone. domain: of a Scene. touching(places (n, 3))
    -> (m, 2) indices of the grains that touch each other at these places. turns (n,): of two grains that touch, the one
    with the larger value moves; None takes the order of the ids. ValueError if there is no free place for a grain
    within MAX_TRIES, or if a grain is wider than the domain.
    """
    turns = np.arange(len(ids)) if turns is None else np.asarray(turns)
    ids, reach = np.asarray(ids, np.int64), np.asarray(reach, float)
    width, periodic = domain.width, domain.periodic
    check_reach(reach, width)
    # The id is the second word of the counter, which leaves 2^64 numbers between one grain and the next.
    streams = [
        np.random.Generator(np.random.Philox(key=[seed, RELEASE_STREAM], counter=[0, int(grain), 0, 0]))
        for grain in ids
    ]

    def next_place(k):
        for _ in range(MAX_TRIES):
            x, y, z = streams[k].random(3)
            place = width * x, width * y, low + reach[k] + (height - 2.0 * reach[k]) * z
            if periodic:
                return place
            x, y = place[0] - 0.5 * width, place[1] - 0.5 * width
            if np.hypot(x, y) + reach[k] < 0.5 * width:
                return x, y, place[2]
        raise ValueError(
            f"grain {ids[k]}, {2e3 * reach[k]:.3g} mm wide, cannot be placed without touching the wall of a cylinder "
            f"{1e3 * width:g} mm wide; raise domain.width"
        )

    places = np.array([next_place(k) for k in range(len(ids))]).reshape(-1, 3)
    for _ in range(MAX_TRIES):
        pairs = touching(places)
        moved = np.unique(np.where(turns[pairs[:, 0]] > turns[pairs[:, 1]], pairs[:, 0], pairs[:, 1]))
        if len(moved) == 0:
            return places
        places[moved] = [next_place(k) for k in moved]
    raise ValueError(
        f"there is no free place for grain {ids[moved[0]]}; lower generation.batch_grains or, with placement filled, "
        f"generation.solid_fraction, or raise domain.width"
    )


def layer_grains(reach, area: float) -> int:
    """Return the number of grains whose bounding squares cover the area [m²] once, at least 1: the default batch."""
    return max(int(area / (4.0 * np.mean(np.asarray(reach) ** 2))), 1)


def fall_time(height: float, velocity: float, gravity: float) -> float:
    """Return the time [s] to fall `height` [m] from the downward insertion velocity [m/s]. gravity: effective."""
    return float((np.sqrt(velocity**2 + 2.0 * gravity * height) - velocity) / gravity)

"""Grains born at random places and orientations above the bed, none touching another.

A batch is strewn over a zone that begins `drop_height` above all grains there are. Each grain goes through its own
random places: of two that touch the later goes on to its next, round after round, until none touch. A grain's places
belong to (seed, id) alone, and every rank draws the whole batch: ranks, threads and stops change no bit.
"""

import numpy as np

RELEASE_STREAM = 3  # of the counter-based generator; 0 to 2 are those of size, birth and kind
# ASSUME: share of the zone that the grains of a batch fill. Spheres find no more room at 0.38 and long grains earlier;
# at a tenth even ellipsoids of L/S = 6 find theirs in some tens of tries.
DILUTE = 0.1
MAX_TRIES = 10_000


def zone_height(reach, volumes, area: float) -> float:
    """Height [m] of the zone of that area [m²] over which grains are strewn.

    reach (n,) [m]: their bounding radii, volumes (n,) [m³].
    """
    return float(2.0 * np.max(reach) + np.sum(volumes) / (DILUTE * area))


def release_places(ids, reach, height: float, domain, low: float, seed: int, touching) -> np.ndarray:
    """Centres (n, 3) [m] of grains `ids` (n,), in increasing order, in the zone of that height [m] from `low` [m] up.

    reach (n,) [m]: radii of their bounding spheres. domain: of a Scene. touching(places (n, 3)) -> (m, 2) indices of
    the grains that touch each other there.
    ValueError where a grain finds no free place within MAX_TRIES, or is wider than the domain.
    """
    ids, reach = np.asarray(ids, np.int64), np.asarray(reach, float)
    width, periodic = domain.width, domain.periodic
    if 2.0 * reach.max() >= width:
        raise ValueError(
            f"a grain reaches {2e3 * reach.max():.3g} mm across and meets itself in a domain {1e3 * width:g} mm wide; "
            f"make domain.width larger"
        )
    # The second word of the counter: room for 2^64 numbers between one grain and the next.
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
            f"grain {ids[k]}, {2e3 * reach[k]:.3g} mm across, finds no place clear of the wall of a cylinder "
            f"{1e3 * width:g} mm wide; make domain.width larger"
        )

    places = np.array([next_place(k) for k in range(len(ids))]).reshape(-1, 3)
    for _ in range(MAX_TRIES):
        give_way = np.unique(np.max(touching(places), axis=1, initial=-1))
        if len(give_way) == 0:
            return places
        places[give_way] = [next_place(k) for k in give_way]
    raise ValueError(f"grain {ids[give_way[0]]} finds no free place; lower generation.batch_grains or widen the domain")


def layer_grains(reach, area: float) -> int:
    """Grains, at least one, whose bounding squares cover that area [m²] once: a batch where none is given."""
    return max(int(area / (4.0 * np.mean(np.asarray(reach) ** 2))), 1)


def fall_time(height: float, velocity: float, gravity: float) -> float:
    """Time [s] to fall `height` [m] from the downward velocity [m/s] at birth; gravity: effective."""
    return float((np.sqrt(velocity**2 + 2.0 * gravity * height) - velocity) / gravity)

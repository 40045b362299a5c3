"""Grains born at random places above the bed, one after the other, none touching another.

A batch is strewn over a zone that begins `drop_height` above all grains there are. Each grain in turn takes the first
of its own random places at which its bounding sphere is free, so that it may have any orientation. Its places belong
to (seed, id) alone, and every rank draws the whole batch: ranks, threads and stops change no bit.
"""

import numpy as np

RELEASE_STREAM = 3  # of the counter-based generator; 0 to 2 are those of size, birth and kind
# ASSUME: share of the zone that the bounding spheres of a batch take up, far from the 0.38 at which no other finds
# room: a grain needs few tries, and they meet seldom before they reach the bed.
DILUTE = 0.1
MOST_TRIES = 10_000


def zone_height(reach, area: float) -> float:
    """Height [m] of the zone of that area [m²] over which grains of bounding radii `reach` (n,) [m] are strewn."""
    reach = np.asarray(reach)
    return float(2.0 * reach.max() + (4.0 / 3.0 * np.pi * reach**3).sum() / (DILUTE * area))


def release_places(ids, reach, domain, low: float, seed: int) -> np.ndarray:
    """Centres (n, 3) [m] of grains `ids` (n,) in the zone from `low` [m] up, in the order of the ids.

    reach (n,) [m]: radii of their bounding spheres. domain: of a Scene.
    ValueError where a grain finds no free place within MOST_TRIES, or is wider than the domain.
    """
    ids, reach = np.asarray(ids, np.int64), np.asarray(reach, float)
    width, periodic = domain.width, domain.periodic
    if 2.0 * reach.max() >= width:
        raise ValueError(
            f"a grain reaches {2e3 * reach.max():.3g} mm across and meets itself in a domain {1e3 * width:g} mm wide; "
            f"make domain.width larger"
        )
    height = zone_height(reach, domain.area)
    places = np.empty((len(ids), 3))
    for k, (grain, r) in enumerate(zip(ids, reach, strict=True)):
        # The second word of the counter: room for 2^64 numbers between one grain and the next.
        numbers = np.random.Generator(np.random.Philox(key=[seed, RELEASE_STREAM], counter=[0, int(grain), 0, 0]))
        for _ in range(MOST_TRIES):
            x, y, z = numbers.random(3)
            place = np.array([width * x, width * y, low + r + (height - 2.0 * r) * z])
            if not periodic:
                place[:2] -= 0.5 * width
                if np.hypot(place[0], place[1]) + r >= 0.5 * width:
                    continue
            apart = places[:k] - place
            if periodic:
                apart[:, :2] -= width * np.round(apart[:, :2] / width)
            if ((apart**2).sum(axis=1) > (reach[:k] + r) ** 2).all():
                places[k] = place
                break
        else:
            raise ValueError(f"grain {grain} finds no free place; lower generation.batch_grains or widen the domain")
    return places


def layer_grains(reach, area: float) -> int:
    """Grains, at least one, whose bounding squares cover that area [m²] once: a batch where none is given."""
    return max(int(area / (4.0 * np.mean(np.asarray(reach) ** 2))), 1)


def fall_time(height: float, velocity: float, gravity: float) -> float:
    """Time [s] to fall `height` [m] from the downward velocity [m/s] at birth; gravity: effective."""
    return float((np.sqrt(velocity**2 + 2.0 * gravity * height) - velocity) / gravity)

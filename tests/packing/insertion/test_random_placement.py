"""Insertion at random places: no grain touches another, places follow from seed and id, and misfits are errors."""

import numpy as np
import pytest
from scipy import stats

from benchmarks.correctness.equality import load_grains
from simcore.dem.contact.query import query_many
from simcore.dem.shapes.polyhedra import convex, ellipsoid
from simcore.packing.insertion import random_placement as release
from simcore.packing.insertion.initial_states import initial_states
from simcore.packing.insertion.random_placement import DILUTE, fall_time, layer_grains, release_places, zone_height
from simcore.packing.process import Process
from simcore.scene.domain import Domain
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

BOX, CYLINDER = Domain("periodic", 0.05, 1.0), Domain("cylinder", 0.05, 1.0)
N = 300


@pytest.fixture(scope="module")
def reach():
    return np.random.default_rng(2).uniform(1e-3, 4e-3, N)


def near(reach, domain):
    """Return a function that returns the pairs (m, 2) of spheres of radius `reach` that touch at given places."""

    def touching(places):
        apart = places[:, None] - places[None]
        if domain.periodic:
            apart[..., :2] -= domain.width * np.round(apart[..., :2] / domain.width)
        meet = (apart**2).sum(axis=2) < (reach[:, None] + reach) ** 2
        return np.argwhere(np.triu(meet, 1))

    return touching


def strewn(ids, reach, domain, low, seed):
    height = zone_height(reach, 4.0 / 3.0 * np.pi * reach**3, domain.area)
    return release_places(ids, reach, height, domain, low, seed, near(reach, domain)), height


@pytest.mark.parametrize("domain", [BOX, CYLINDER], ids=["periodic", "cylinder"])
def test_no_two_overlap_and_all_lie_in_the_zone(domain, reach):
    places, height = strewn(np.arange(7, 7 + N), reach, domain, 0.2, seed=5)
    if domain.periodic:
        assert (places[:, :2] >= 0.0).all() and (places[:, :2] <= domain.width).all()
    else:
        assert (np.hypot(places[:, 0], places[:, 1]) + reach < 0.5 * domain.width).all()
    assert len(near(reach, domain)(places)) == 0
    assert (places[:, 2] - reach >= 0.2).all() and (places[:, 2] + reach <= 0.2 + height).all()
    # The spheres fill the share DILUTE of the zone, less the diameter of the largest grain.
    filled = 4.0 / 3.0 * np.pi * (reach**3).sum() / (domain.area * (height - 2.0 * reach.max()))
    assert filled == pytest.approx(DILUTE, rel=1e-12)


def test_of_two_that_touch_the_later_takes_its_next_place(reach):
    """The first place of the second grain is reported as taken: it takes its next place, and the first grain stays."""
    text = iter([np.array([[0, 1]]), np.zeros((0, 2), int)])
    free = release_places([3, 4], reach[:2], 0.3, BOX, 0.0, 5, lambda places: np.zeros((0, 2), int))
    moved = release_places([3, 4], reach[:2], 0.3, BOX, 0.0, 5, lambda places: next(text))
    assert (moved[0] == free[0]).all() and (moved[1] != free[1]).all()


def test_places_are_spread_evenly():
    """The grains are too small to touch each other; along z their centres fill the zone less one diameter."""
    r = np.full(2000, 1e-6)
    places, height = strewn(np.arange(2000), r, BOX, 0.0, seed=1)
    places[:, 2] -= r
    for k, length in enumerate((0.05, 0.05, height - 2.0 * r[0])):
        assert stats.kstest(places[:, k] / length, "uniform").pvalue > 1e-3


def test_places_belong_to_the_seed_and_the_id(reach):
    first, _ = strewn(np.arange(50), reach[:50], BOX, 0.2, seed=5)
    np.testing.assert_array_equal(first, strewn(np.arange(50), reach[:50], BOX, 0.2, seed=5)[0])
    assert not np.any(first == strewn(np.arange(50), reach[:50], BOX, 0.2, seed=6)[0])
    assert not np.any(first == strewn(np.arange(50, 100), reach[:50], BOX, 0.2, seed=5)[0])


@pytest.mark.parametrize("kind", ["ellipsoid", "polyhedron"])
def test_grains_of_a_batch_are_apart_by_the_exact_query(kind):
    """Grains are closer than bounding spheres allow, also through the sides of the box, and do not overlap."""
    form = {"choice": "ratios", "eta": 2.5, "zeta": 2.5} if kind == "ellipsoid" else {"choice": "random"}
    made = set_up(
        resolve(
            {
                "name": "release",
                "domain": {"type": "periodic", "width": "40 mm", "height": "0.5 m"},
                "shapes": {"kind": kind, **form},
                "faces": "original",
                "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
                "amount": {"grains": 120},
                "generation": {"placement": "random", "orientation": "random", "batch_grains": 120},
            }
        ),
        load_grains,
    )
    process = Process(made.scene, made.bases, made.draw, lambda line: None)
    process.insert_batch()
    bodies, drawn = process.bodies, made.draw(np.arange(120))
    states = initial_states(made.scene.generation, bodies.position, drawn.sieve_size, drawn.uniforms)
    assert (bodies.velocity == states.velocity).all()
    solids = [
        convex(made.bases[shape].vertices * scale) if len(made.bases[shape].vertices) else ellipsoid(*scale)
        for shape, scale in zip(bodies.shape, bodies.scale, strict=True)
    ]
    one, other = np.triu_indices(120, 1)
    offset = bodies.position[other] - bodies.position[one]
    offset[:, :2] -= 0.04 * np.round(offset[:, :2] / 0.04)
    close = np.linalg.norm(offset, axis=1) < bodies.radius[one] + bodies.radius[other]
    one, other, offset = one[close], other[close], offset[close]
    assert len(one) > 30  # bounding spheres that overlap
    turns = states.orientation
    found = query_many(solids, one, (np.zeros_like(offset), turns[one]), other, (offset, turns[other]))
    assert found.signed_distance.min() > 0.0


def test_grains_that_do_not_fit_are_an_error(monkeypatch, reach):
    with pytest.raises(ValueError, match="does not fit into a domain 50 mm wide"):
        strewn(np.arange(1), np.array([0.026]), BOX, 0.0, seed=1)
    with pytest.raises(ValueError, match="grain 0, 50 mm wide, cannot be placed without touching the wall"):
        strewn(np.arange(1), np.array([0.02499999]), CYLINDER, 0.0, seed=1)
    monkeypatch.setattr(release, "MAX_TRIES", 1)
    with pytest.raises(ValueError, match=r"no free place for grain \d+; lower generation.batch_grains"):
        strewn(np.arange(N), reach, BOX, 0.0, seed=1)


def test_a_layer_and_a_fall():
    assert layer_grains(np.full(5, 5e-3), 0.1**2) == 100 and layer_grains([1.0], 0.01) == 1
    time = fall_time(0.3, 0.4, 6.0)
    assert 0.4 * time + 3.0 * time**2 == pytest.approx(0.3, rel=1e-12)


def test_fewer_grains_than_a_layer_may_be_drawn_by_quota():
    """The height of a layer is estimated from a sample of the grains, which must not be larger than the packing."""
    made = set_up(
        resolve(
            {
                "domain": {"type": "periodic", "width": "60 mm", "height": "0.6 m"},
                "shapes": {"kind": "sphere"},
                "sizes": {"case": "U1", "draw": "quota"},
                "amount": {"grains": 60},
                "generation": {"placement": "random"},
            }
        ),
        load_grains,
    )
    process = Process(made.scene, made.bases, made.draw, lambda line: None)
    process.insert_batch()
    assert 0 < len(process.bodies.mass) <= 60

"""Births at random places: none overlaps, each belongs to (seed, id), and what does not fit is told."""

import numpy as np
import pytest
from scipy import stats

from simcore.dem import release
from simcore.dem.release import DILUTE, fall_time, layer_grains, release_places, zone_height
from simcore.dem.scene import Domain

BOX, CYLINDER = Domain("periodic", 0.05, 1.0), Domain("cylinder", 0.05, 1.0)
N = 300


@pytest.fixture(scope="module")
def reach():
    return np.random.default_rng(2).uniform(1e-3, 4e-3, N)


@pytest.mark.parametrize("domain", [BOX, CYLINDER], ids=["periodic", "cylinder"])
def test_no_two_overlap_and_all_lie_in_the_zone(domain, reach):
    places = release_places(np.arange(7, 7 + N), reach, domain, 0.2, seed=5)
    apart = places[:, None] - places[None]
    if domain.periodic:
        apart[..., :2] -= domain.width * np.round(apart[..., :2] / domain.width)
        assert (places[:, :2] >= 0.0).all() and (places[:, :2] <= domain.width).all()
    else:
        assert (np.hypot(places[:, 0], places[:, 1]) + reach < 0.5 * domain.width).all()
    distance = np.linalg.norm(apart, axis=2) + np.diag(np.full(N, np.inf))
    assert (distance > reach[:, None] + reach[None]).all()
    height = zone_height(reach, domain.area)
    assert (places[:, 2] - reach >= 0.2).all() and (places[:, 2] + reach <= 0.2 + height).all()
    # The spheres fill DILUTE of the zone but for what one grain stands out above its centre.
    filled = 4.0 / 3.0 * np.pi * (reach**3).sum() / (domain.area * (height - 2.0 * reach.max()))
    assert filled == pytest.approx(DILUTE, rel=1e-12)


def test_places_are_spread_evenly():
    """Grains too small to be in each other's way; along z as far as one does not stand out of the zone."""
    r = 1e-6
    places = release_places(np.arange(2000), np.full(2000, r), BOX, 0.0, seed=1)
    places[:, 2] -= r
    height = zone_height(np.full(2000, r), BOX.area) - 2.0 * r
    for k, length in enumerate((0.05, 0.05, height)):
        assert stats.kstest(places[:, k] / length, "uniform").pvalue > 1e-3


def test_places_belong_to_the_seed_and_the_id(reach):
    first = release_places(np.arange(50), reach[:50], BOX, 0.2, seed=5)
    np.testing.assert_array_equal(first, release_places(np.arange(50), reach[:50], BOX, 0.2, seed=5))
    assert not np.any(first == release_places(np.arange(50), reach[:50], BOX, 0.2, seed=6))
    assert not np.any(first == release_places(np.arange(50, 100), reach[:50], BOX, 0.2, seed=5))


def test_what_does_not_fit_is_told(monkeypatch, reach):
    with pytest.raises(ValueError, match="meets itself in a domain 50 mm wide"):
        release_places([0], [0.026], BOX, 0.0, seed=1)
    monkeypatch.setattr(release, "MOST_TRIES", 1)
    with pytest.raises(ValueError, match=r"grain \d+ finds no free place; lower generation.batch_grains"):
        release_places(np.arange(N), reach, BOX, 0.0, seed=1)


def test_a_layer_and_a_fall():
    assert layer_grains(np.full(5, 5e-3), 0.1**2) == 100 and layer_grains([1.0], 0.01) == 1
    time = fall_time(0.3, 0.4, 6.0)
    assert 0.4 * time + 3.0 * time**2 == pytest.approx(0.3, rel=1e-12)

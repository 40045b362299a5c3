"""Batches that fill a zone: dense, free of contacts, large grains first, and as few as the domain allows."""

import numpy as np
import pytest

from simcore.packing.insertion.batches import Pouring
from simcore.packing.insertion.random_placement import fitting_grains, release_places, zone_height
from simcore.packing.packed import PackingError
from simcore.scene.domain import Domain
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

BOX, CYLINDER = Domain("periodic", 0.06, 1.0), Domain("cylinder", 0.06, 1.0)
WIDE = {
    "domain": {"width": "60 mm", "height": "0.4 m"},
    "sizes": {"bounds": ["3 mm", "6 mm", "12 mm"], "mass_fractions": [0.5, 0.5], "draw": "quota"},
    "amount": {"grains": 800},
    "shapes": {"kind": "sphere"},
    "generation": {"placement": "filled"},
}


def pouring(**changes):
    """Return the Pouring of spheres of a wide sieve curve, and its scene."""
    setup = set_up(resolve({**WIDE, **changes}), load_grains=None)
    return Pouring(setup.scene, setup.bases, setup.draw), setup.scene


def overlapping(places, radius, width):
    """Return pairs (m, 2) of spheres that overlap in a box that is periodic with this width, or open for width 0."""
    apart = places[:, None] - places[None]
    if width:
        apart[..., :2] -= width * np.round(apart[..., :2] / width)
    return np.argwhere(np.triu((apart**2).sum(axis=2) < (radius[:, None] + radius) ** 2, 1))


def touching(drawn, places):
    return overlapping(places, drawn.scale[: len(places), 0], 0.06)


def test_one_batch_has_all_grains_where_they_fit_and_fills_its_zone():
    scheme, scene = pouring()
    batch = scheme.batch(0, 0.0, touching)
    radius = batch.drawn.scale[:, 0]
    assert len(batch.places) == scene.amount_grains == 800
    assert len(overlapping(batch.places, radius, 0.06)) == 0
    low = scene.generation.drop_height
    height = 2 * radius.max() + 4 / 3 * np.pi * (radius**3).sum() / (0.2 * 0.06**2)
    assert (batch.places[:, 2] - radius >= low).all() and (batch.places[:, 2] + radius <= low + height).all()
    # Each tenth of the zone has a tenth of the grains, but for chance.
    share = np.histogram(batch.places[:, 2], 10, (low, low + height))[0] / 800
    assert np.all(np.abs(share - 0.1) < 4 * np.sqrt(0.09 / 800))


def test_the_interval_is_the_time_to_fall():
    scheme, scene = pouring()
    batch = scheme.batch(0, 0.0, touching)
    distance = batch.places[:, 2].max()
    falling = 1.0 * batch.interval + 0.5 * scene.material.effective_gravity * batch.interval**2
    assert falling == pytest.approx(distance, rel=0.05)


def test_a_low_domain_takes_several_batches_of_consecutive_grains():
    scheme, scene = pouring(domain={"width": "60 mm", "height": "90 mm"})
    inserted, top = 0, 0.0
    batches = []
    while inserted < scene.amount_grains:
        assert scheme.has_space(inserted, top, None)
        batch = scheme.batch(inserted, top, touching)
        np.testing.assert_array_equal(
            batch.drawn.sieve_size, scheme.draw(np.arange(inserted, inserted + len(batch.places))).sieve_size
        )
        assert (batch.places[:, 2] + batch.drawn.scale[:, 0] <= 0.09).all()
        inserted += len(batch.places)
        batches.append(len(batch.places))
        top = 0.01
    assert 2 <= len(batches) <= 4 and sum(batches) == 800
    assert not scheme.has_space(batches[0], 0.07, None)


def test_a_mass_is_filled_up_to_its_last_grain():
    scheme, scene = pouring(amount={"mass": "0.2 kg"}, sizes={**WIDE["sizes"], "draw": "random"})
    batch = scheme.batch(0, 0.0, touching)
    mass = scene.material.density * np.cumsum(scheme.volumes(batch.drawn))
    assert mass[-1] >= 0.2 > mass[-2]


def test_the_smaller_of_two_grains_that_touch_moves():
    pairs = iter([np.array([[0, 1]]), np.zeros((0, 2), int)])
    reach = np.array([1e-3, 4e-3])
    free = release_places([3, 4], reach, 0.3, BOX, 0.0, 5, lambda places: np.zeros((0, 2), int))
    moved = release_places([3, 4], reach, 0.3, BOX, 0.0, 5, lambda places: next(pairs), turns=np.array([1, 0]))
    assert (moved[1] == free[1]).all() and (moved[0] != free[0]).all()


@pytest.mark.parametrize("domain", [BOX, CYLINDER], ids=["periodic", "cylinder"])
def test_mixed_sizes_find_places_at_a_third(domain):
    """Half of the volume is in spheres of three times the radius; in random order they would find no places."""
    radius = np.concatenate([np.full(12, 6e-3), np.full(324, 2e-3)])
    volumes = 4 / 3 * np.pi * radius**3
    turns = np.argsort(np.argsort(-radius, kind="stable"))
    height = zone_height(radius, volumes, domain.area, 0.33)
    width = domain.width if domain.periodic else 0.0
    places = release_places(
        np.arange(336), radius, height, domain, 0.0, 1, lambda places: overlapping(places, radius, width), turns
    )
    assert len(overlapping(places, radius, width)) == 0


def test_the_number_of_grains_that_fit_is_the_largest():
    rng = np.random.default_rng(2)
    reach = rng.uniform(1e-3, 5e-3, 200)
    volumes = reach**3
    for height in (0.005, 0.02, 0.05, 1.0):
        count = fitting_grains(reach, volumes, 1e-3, 0.2, height)
        assert count == 0 or zone_height(reach[:count], volumes[:count], 1e-3, 0.2) <= height
        assert count == 200 or zone_height(reach[: count + 1], volumes[: count + 1], 1e-3, 0.2) > height


def test_a_domain_without_space_for_a_grain_is_refused():
    scheme, _ = pouring(domain={"width": "60 mm", "height": "0.15 m"})
    with pytest.raises(PackingError, match=r"no grain can be inserted between 0\.1\d+ m and domain.height = 0.15 m"):
        scheme.batch(5, 0.14, touching)


@pytest.mark.parametrize(
    "generation, message",
    [
        ({"placement": "filled", "fill": "r22"}, 'placement "random" and "filled" work only with fill "bed"'),
        ({"placement": "filled", "batch_grains": 3}, "it has no effect unless placement is"),
        ({"placement": "lattice", "solid_fraction": 0.3}, "generation.solid_fraction"),
    ],
)
def test_keys_of_other_placements_are_refused(generation, message):
    with pytest.raises(ValueError, match=message):
        resolve({**WIDE, "generation": generation}, unused="refuse")

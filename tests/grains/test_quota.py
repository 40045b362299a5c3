"""Sizes and forms by quota represent their distribution, whatever the seed."""

import numpy as np
import pytest

from simcore.grains.beta_sizes import BetaSizes
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.quota import largest_remainder
from simcore.grains.sampling import ShapeChoice, quota_uniforms, sample_grains
from simcore.grains.sieve import SieveCurve, class_fractions, read_cases
from simcore.grains.synthetic import synthetic_grains
from simcore.paths import CONFIG
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

B50 = read_cases(CONFIG / "cases.tsv")["B50"].curve
FORMS = ShapeChoice(
    "ellipsoid", "form_distribution", flatness=0.6, elongation=0.7, flatness_std=0.1, elongation_std=0.12
)
SPHERES = ShapeChoice("sphere")


def draw(curve, number, seed, shapes=SPHERES, grains=()):
    """Return all grains of a packing, drawn by quota."""
    return sample_grains(np.arange(number), seed, curve, shapes, list(grains), quota_uniforms(curve, number, seed))


@pytest.mark.parametrize("shares", [[0.5, 0.3, 0.2], [1.0], [0.0, 0.97, 0.0, 0.03], [1 / 3] * 3])
@pytest.mark.parametrize("total", [0, 1, 7, 1000])
def test_the_largest_remainders_fill_up_to_the_total(shares, total):
    numbers = largest_remainder(shares, total)
    exact = np.array(shares) * total
    assert numbers.sum() == total and np.all(np.abs(numbers - exact) < 1)
    assert np.all(numbers[np.array(shares) == 0] == 0)
    up = numbers > exact
    if up.any() and (numbers < exact).any():
        assert (exact % 1)[up].min() >= (exact % 1)[numbers < exact].max()


@pytest.mark.parametrize("seed", [1, 2])
def test_each_class_has_its_number_of_grains_at_mid_quantiles(seed):
    number = 3000
    drawn = draw(B50, number, seed)
    index = B50.class_of(drawn.D)
    expected = largest_remainder(B50.number_fractions(), number)
    np.testing.assert_array_equal(np.bincount(index, minlength=len(expected)), expected)
    for k in np.flatnonzero(expected):
        low, high = np.log2(B50.bounds[k : k + 2])
        quantiles = np.sort((np.log2(drawn.D[index == k]) - low) / (high - low))
        np.testing.assert_allclose(quantiles, (np.arange(expected[k]) + 0.5) / expected[k], atol=1e-12)


def test_masses_of_the_classes_are_those_of_the_curve():
    drawn = draw(B50, 8000, 1)
    expected = B50.expected_fractions()
    # Each class deviates by at most one grain, and the total, to which shares refer, by at most the sum of these.
    grain = B50.class_means(3) / (8000 * B50.mean(3))
    assert np.all(np.abs(class_fractions(B50, drawn.D, drawn.volume) - expected) < grain + expected * grain.sum())
    by_chance = sample_grains(np.arange(8000), 1, B50, SPHERES, [])
    off_by_chance = np.abs(class_fractions(B50, by_chance.D, by_chance.volume) - expected)
    assert np.abs(class_fractions(B50, drawn.D, drawn.volume) - expected).max() < 0.3 * off_by_chance.max()


def test_seeds_differ_in_the_order_alone_and_the_order_is_random():
    one, two = draw(B50, 2000, 1), draw(B50, 2000, 2)
    np.testing.assert_allclose(np.sort(one.D), np.sort(two.D), rtol=1e-14)
    assert not np.array_equal(one.D, two.D)
    for sizes in (one.D, two.D):
        large = sizes > np.quantile(sizes, 0.9)
        # The mean place of the 200 largest among 2000 has a standard deviation of 0.29 / sqrt(200) = 0.02.
        assert abs(np.flatnonzero(large).mean() / 2000 - 0.5) < 4 * 0.02


def test_forms_represent_their_distribution_in_every_class():
    """The means are over m >= 100 grains; random ones scatter by the standard deviation over the root of m."""
    drawn = draw(B50, 4000, 3, FORMS)
    index = B50.class_of(drawn.D)
    for values, mean, std in ((drawn.S / drawn.I, 0.6, 0.1), (drawn.I / drawn.L, 0.7, 0.12)):
        for k in np.unique(index):
            inside = values[index == k]
            m = len(inside)
            if m >= 100:
                assert abs(inside.mean() - mean) < 0.2 * std / np.sqrt(m) + 0.003  # 0.003: limits 0.1 and 1
                assert inside.std() == pytest.approx(std, rel=0.06)
    # Flatness and elongation stay independent: four standard deviations of a correlation of 4000 pairs.
    assert abs(np.corrcoef(drawn.S / drawn.I, drawn.I / drawn.L)[0, 1]) < 4 / np.sqrt(4000)


def test_each_grain_of_a_set_is_taken_as_often():
    grains = synthetic_grains(seed=1, n=21)
    u1 = SieveCurve(np.array([5.6e-3, 8e-3]), np.array([1.0]))
    drawn = sample_grains(
        np.arange(210), 1, u1, ShapeChoice("polyhedron", "random"), grains, quota_uniforms(u1, 210, 1)
    )
    np.testing.assert_array_equal(np.bincount(drawn.shape, minlength=21), np.full(21, 10))


@pytest.mark.parametrize(
    "curve", [BetaSizes(4e-3, 0.5, 1.0, 2.0), OwnSizes(np.array([4e-3, 5e-3, 9e-3]))], ids=["beta", "own"]
)
def test_sizes_without_classes_are_one_class(curve):
    sizes = [
        np.sort(curve.sizes(quota_uniforms(curve, 300, seed)[:, [2 if isinstance(curve, OwnSizes) else 0]]))
        for seed in (1, 2)
    ]
    np.testing.assert_allclose(*sizes, rtol=1e-12)
    assert (sizes[0] ** 3).mean() == pytest.approx(curve.mean(3), rel=0.005)


def test_a_subset_of_ids_gets_the_same_grains():
    whole = draw(B50, 500, 4, FORMS)
    quota = quota_uniforms(B50, 500, 4)
    ids = np.array([7, 499, 3, 250])
    some = sample_grains(ids, 4, B50, FORMS, [], quota)
    for name in ("D", "L", "I", "S", "volume"):
        np.testing.assert_array_equal(getattr(some, name), getattr(whole, name)[ids])


@pytest.mark.parametrize("kind", ["sphere", "ellipsoid", "polyhedron"])
def test_a_mass_becomes_a_number_of_grains_with_about_this_mass(kind):
    raw = {
        "domain": {"width": "80 mm", "height": "0.5 m"},
        "sizes": {"case": "B50", "draw": "quota", "allow_few_top_grains": True},
        "amount": {"mass": "1.2 kg"},
        "shapes": {"kind": kind, **({} if kind == "sphere" else {"choice": "random"})},
    }
    specification = resolve(raw)
    setup = set_up(specification, load_grains=lambda group: synthetic_grains(seed=1, n=21))
    scene = setup.scene
    assert scene.amount_mass is None
    volume = setup.sample(np.arange(scene.amount_grains)).volume
    mass = scene.material.density * volume.sum()
    # Another number changes the largest remainders, and with them which class gets one grain more or less. The largest
    # grain has a mass of 0.04 kg.
    assert mass == pytest.approx(1.2, abs=0.025)

"""Beta-distributed volume over size: moments of shared references, and samples that have them."""

import numpy as np
import pytest
from scipy import stats

from simcore.grains.beta_sizes import BetaSizes
from simcore.grains.sampling import ShapeChoice, grain_uniforms, sample_grains, sample_sizes

# The keys are (exponent + 1, spread); the values are the means of r, r², r³ and std / mean for mid-range radius 1.
CHECKS = {
    (4, 0.5): (0.91089, 0.85726, 0.83239, 0.18220),
    (2, 0.5): (0.84025, 0.75000, 0.71006, 0.24958),
    (3, 0.8): (0.65551, 0.50775, 0.45340, 0.42624),
}
N = 100_000


@pytest.mark.parametrize("exponent, spread", CHECKS)
def test_moments_are_the_references(exponent, spread):
    sizes = BetaSizes(1.0, spread, exponent - 1, exponent - 1)
    first, second, third = (sizes.moment(power) for power in (1, 2, 3))
    found = first, second, third, np.sqrt(second - first**2) / first
    np.testing.assert_allclose(found, CHECKS[exponent, spread], atol=5e-6)  # five digits are given
    assert sizes.number_fractions() @ sizes.class_diameters**3 == pytest.approx(8.0 * third, rel=1e-12)
    # The samples are taken at the midpoints of N equal shares, so the error of their means is of order 1 / (24 N²).
    r = 0.5 * sizes.sizes(((np.arange(N) + 0.5) / N)[:, None])
    np.testing.assert_allclose([np.mean(r**power) for power in (1, 2, 3)], [first, second, third], rtol=2e-6)
    assert (r > 1.0 - spread).all() and (r < 1.0 + spread).all()


@pytest.mark.parametrize("alpha, beta", [(3.0, 3.0), (0.0, 0.0), (0.5, 4.0)])
def test_the_volume_is_beta_distributed(alpha, beta):
    """Drawn grains, each weighted by its volume, follow the distribution function."""
    sizes = BetaSizes(2e-3, 0.6, alpha, beta)
    r = 0.5 * sample_sizes(sizes, np.arange(N), seed=3)
    order = np.argsort(r)
    share = np.cumsum(r[order] ** 3) / np.sum(r**3)
    x = (r[order] - 0.8e-3) / (3.2e-3 - 0.8e-3)
    # The bound is Kolmogorov's at the level 1e-3 for the effective number of weighted grains.
    worth = np.sum(r**3) ** 2 / np.sum(r**6)
    assert np.abs(share - stats.beta.cdf(x, alpha + 1.0, beta + 1.0)).max() < 1.95 / np.sqrt(worth)


def test_sizes_belong_to_the_id_and_the_seed():
    sizes = BetaSizes(2e-3, 0.6, 3.0, 3.0)
    every = sample_sizes(sizes, np.arange(1000), seed=3)
    some = [999, 5, 17]
    np.testing.assert_array_equal(sample_sizes(sizes, some, seed=3), every[some])
    assert not np.any(sample_sizes(sizes, some, seed=4) == every[some])


def test_without_spread_all_are_equal():
    sizes = BetaSizes(2e-3, 0.0, 3.0, 3.0)
    assert (sizes.sizes(grain_uniforms(range(100), 1)) == 4e-3).all()
    assert sizes.moment(3) == pytest.approx(8e-9, rel=1e-12) and sizes.least == sizes.largest == 4e-3


def test_sizes_are_of_equal_volume_whatever_the_form():
    sizes, ids = BetaSizes(2e-3, 0.5, 3.0, 3.0), np.arange(500)
    spheres = sample_grains(ids, 3, sizes, ShapeChoice("sphere"), [])
    formed = ShapeChoice("ellipsoid", "ratios", eta=1.6, zeta=2.1, eta_std=0.3, zeta_std=0.5)
    ellipsoids = sample_grains(ids, 3, sizes, formed, [])
    np.testing.assert_allclose(ellipsoids.volume, spheres.volume, rtol=1e-12)
    np.testing.assert_allclose(np.cbrt(ellipsoids.scale.prod(axis=1)), 0.5 * sample_sizes(sizes, ids, 3), rtol=1e-12)
    np.testing.assert_allclose(ellipsoids.D, np.sqrt(0.5 * (ellipsoids.I**2 + ellipsoids.S**2)), rtol=1e-12)


@pytest.mark.parametrize("wrong", [(0.0, 0.5, 1, 1), (1.0, 1.0, 1, 1), (1.0, -0.1, 1, 1), (1.0, 0.5, -1, 1)])
def test_what_is_no_distribution_is_refused(wrong):
    with pytest.raises(ValueError, match="the spread from 0 to below 1"):
        BetaSizes(*wrong)

"""Variance factor of preferred azimuths, of beds with known correlations and of the committed rows."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binom

from benchmarks.studies.azimuths import LEVEL, RADII, alignment, axes_of, committed, directions
from tests.helpers.packings import make_packing

WIDTH, N, BEDS = 8.0, 400, 300


def made(seed, cluster):
    """Return a bed of N grains, in which `cluster` grains at almost the same place share an azimuth."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(0.0, 1.0, (N // cluster, 3)) * [WIDTH, WIDTH, 1000.0]  # so far apart that clusters do not mix
    doubled = np.exp(2j * np.pi * rng.uniform(size=N // cluster))
    places = np.repeat(places, cluster, axis=0) + rng.uniform(-0.3, 0.3, (N, 3))
    return places, np.repeat(doubled, cluster), WIDTH


@pytest.mark.parametrize("cluster", [1, 2])
def test_the_factor_is_the_number_of_grains_that_share_an_azimuth(cluster):
    """Means over beds are within four standard errors, and the corrected test has its level."""
    beds = pd.DataFrame([alignment(*made(seed, cluster)) for seed in range(BEDS)])
    for name, expected in (("n_R2", cluster), ("thirds", 0.0), *((f"near_{radius:g}", cluster) for radius in RADII)):
        assert beds[name].mean() == pytest.approx(expected, abs=4 * beds[name].std() / np.sqrt(BEDS)), name
    below = (beds["n_R2"] / cluster > -np.log(LEVEL)).sum()
    assert binom.ppf(1e-4, BEDS, LEVEL) <= below <= binom.ppf(1 - 1e-4, BEDS, LEVEL)
    # Without the factor the test of aligned grains rejects too often: exp(-n R²) < 0.05 with probability 0.05^(1/2).
    assert ((beds["n_R2"] > -np.log(LEVEL)).mean() > 0.15) == (cluster == 2)
    assert (np.abs(beds["pull"].mean()) < 4 / np.sqrt(BEDS)) == (cluster == 1)
    assert min(directions(beds["azimuth"].to_numpy())) > 1e-4


def test_pairs_across_the_box_count_and_other_pairs_do_not():
    places = np.array([[0.2, 1.0, 0.0], [WIDTH - 0.2, 1.0, 0.0], [4.0, 4.0, 0.0], [4.0, 4.0, 2.2]])
    values = alignment(places, np.array([1.0, 1.0, 1j, -1j]), WIDTH)
    assert values["near_1.5"] == pytest.approx(1.0 + 2.0 / 4) and values["near_2.5"] == pytest.approx(1.0)
    # Over all pairs the sum is the resultant itself.
    assert values["n_R2"] == pytest.approx(4 * 0.5**2)


def test_preferred_azimuths_along_the_walls_are_detected():
    azimuths = np.radians(np.repeat([2.0, 91.0, 179.0, 88.0], 6))
    one, walls = directions(azimuths)
    assert walls < 1e-6 < 0.9 < one
    assert directions(azimuths % 0.5)[0] < 1e-6


def test_azimuths_are_those_of_the_long_axes_in_diameters():
    half = np.sqrt(0.5)
    axes = np.tile([0.3, 0.4, 0.5], (300, 1))
    turned = np.tile([half, 0.0, half, 0.0], (300, 1))  # long axes along x
    rng = np.random.default_rng(1)
    packing = make_packing(rng.uniform(0, 1, (300, 3)) * [4.0, 4.0, 12.0], axes, turned, width=4.0)
    packing["volume"] = packing["volume"] * 3.0
    places, doubled, width = axes_of(packing, "long_axis")
    np.testing.assert_allclose(doubled, 1.0)
    assert width == pytest.approx(4.0 / np.cbrt(8 * 0.3 * 0.4 * 0.5 * 3.0)) and len(places) < 300


def test_committed_rows_have_the_documented_factors():
    table = committed(1.83).set_index(["direction", "fold"])
    assert table.loc[("long_axis", 2), ["rows", "below", "below_corrected"]].tolist() == [177, 36, 12]
    assert binom.ppf(0.005, 177, LEVEL) <= 12 <= binom.ppf(0.995, 177, LEVEL)
    documented = {
        ("long_axis", 2): 1.91,
        ("long_axis", 4): 1.29,
        ("contact_normal", 2): 1.17,
        ("contact_normal", 4): 0.98,
    }
    for key, factor in documented.items():
        assert table.loc[key, "c"] == pytest.approx(factor, abs=0.005), key

"""Trends over height are detected where they exist, and only there."""

import numpy as np
import pytest
from scipy.stats import kstest

from simcore.evaluation.height_trends import height_trends, long_axis_angle
from simcore.evaluation.porosity import bed_top, porosity_profile
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.rotations import random_orientations


def bed_of(seed, size_slope=0.0, n=400):
    rng = np.random.default_rng(seed)
    z = rng.uniform(0, 1, n)
    scale = rng.uniform(0.5, 1.0, (n, 3)) * 0.05 * (1 + size_slope * (z[:, None] - 0.5))
    scale.sort(axis=1)
    return make_packing(np.column_stack([rng.uniform(size=(n, 2)), z]), scale, random_orientations(n, seed))


def test_a_size_trend_is_found_with_its_strength():
    trends = height_trends(bed_of(1, size_slope=0.4), interval=(0.0, 1.0))
    size = trends.sel(quantity="D")
    assert float(size["p_value"]) < 1e-6 and float(size["spearman_r"]) > 0
    error = float(size["relative_change_std_error"])
    assert float(size["relative_change"]) == pytest.approx(0.4, abs=4 * error) and error < 0.05
    assert float(trends["D_mean"][-1]) > float(trends["D_mean"][0])


def test_without_trend_p_values_are_uniform():
    trends = [height_trends(bed_of(seed, n=60), (0.0, 1.0))["p_value"].values for seed in range(50)]
    assert kstest(np.ravel(trends), "uniform").pvalue > 1e-3


def test_layer_means_hold_all_grains():
    bed = bed_of(3)
    trends = height_trends(bed, (0.0, 1.0), n_layers=7)
    count = trends["grain_count"].values
    assert count.sum() == 400
    weighted = np.sum(count * trends["FL_mean"].values) / 400
    assert weighted == pytest.approx(float((bed["S"] / bed["I"]).mean()), rel=1e-12)
    inner = height_trends(bed, (0.25, 0.75))
    z = bed["position"].values[:, 2]
    assert inner.attrs["n_grains"] == np.sum((z >= 0.25) & (z <= 0.75))


def test_one_form_for_all_has_no_trend():
    bed = make_packing(
        np.column_stack([np.zeros((50, 2)), np.linspace(0, 1, 50)]),
        [[1e-2, 2e-2, 3e-2]] * 50,
        random_orientations(50, 1),
    )
    trends = height_trends(bed, (0.0, 1.0))
    assert np.isnan(trends["p_value"].sel(quantity=["D", "FL", "EL"])).all()
    assert np.isfinite(trends["p_value"].sel(quantity="angle"))


def test_grains_without_a_long_axis_have_no_angle():
    position = np.column_stack([np.zeros((50, 2)), np.linspace(0, 1, 50)])
    spheres = height_trends(make_packing(position, [[1e-2] * 3] * 50), (0.0, 1.0))
    assert spheres["angle_mean"].isnull().all() and spheres["p_value"].sel(quantity="angle").isnull()
    half = height_trends(
        make_packing(position, [[1e-2, 1e-2, 2e-2], [1e-2, 2e-2, 2e-2]] * 25, random_orientations(50, 1)), (0.0, 1.0)
    )
    long_ones = long_axis_angle(random_orientations(50, 1)[::2])
    assert half["angle_mean"].values @ [5, 5, 5, 5, 5] / 25 == pytest.approx(long_ones.mean(), rel=0.05)


def test_random_long_axes_have_a_mean_angle_of_one_radian():
    angle = long_axis_angle(random_orientations(20000, 5))
    assert angle.mean() == pytest.approx(1.0, abs=4 * angle.std() / np.sqrt(20000))
    half = np.sqrt(0.5)
    assert long_axis_angle([[1, 0, 0, 0], [half, half, 0, 0]]) == pytest.approx([0.0, np.pi / 2])


def test_default_interval_cuts_the_largest_size_off_both_ends():
    centres, width = sphere_lattice("sc", 4, 12)
    bed = make_packing(1e-2 * centres, 5e-3, width=1e-2 * width, domain="cylinder")
    trends = height_trends(bed)
    assert trends["z_bounds"].values.min() == pytest.approx(1e-2)
    assert trends["z_bounds"].values.max() == pytest.approx(bed_top(porosity_profile(bed)) - 1e-2)


def test_too_few_grains_are_refused():
    with pytest.raises(ValueError, match="too few for a trend"):
        height_trends(make_packing([[0, 0, 1]], 0.5), (0.0, 2.0))


def test_ellipsoids_whose_long_axis_is_not_their_own_z_are_refused():
    bed = bed_of(1)
    bed["scale"][7] = bed["scale"][7].values[::-1]
    with pytest.raises(ValueError, match="grain 7 has the semi-axes .* must increase from x to z"):
        height_trends(bed, interval=(0.0, 1.0))

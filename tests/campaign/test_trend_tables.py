"""Trends over height of the packings of a study, and their means."""

import json

import numpy as np
import pytest
import xarray as xr

from simcore.campaign.trend_tables import summarise_trends, tabulate_trends
from simcore.evaluation.height_trends import height_trends
from tests.helpers.packings import make_packing
from tests.helpers.rotations import random_orientations

ROW = {"packing": "p", "varied": {}}


def evaluation(seed, sorted_by_height=False, n=4000, turned=0, discs_above=1.0):
    """Return the trends over height that are stored for n grains of two sizes, isotropic, at random heights.

    turned: another seed of the orientations. discs_above: height above which the grains have no long axis.
    """
    rng = np.random.default_rng(seed)
    height = np.sort(rng.uniform(0.0, 1.0, n))
    scale = np.outer(rng.choice([0.004, 0.006], n), [0.5, 0.8, 1.0])
    if sorted_by_height:
        scale = scale[np.argsort(scale[:, 0])]
    scale[height > discs_above, 1] = scale[height > discs_above, 2]
    position = np.column_stack([rng.uniform(0.0, 0.1, (n, 2)), height])
    scene = json.dumps({"seed": seed, "sizes": {"case": "U3"}, "shapes": {"kind": "ellipsoid"}})
    packing = make_packing(position, scale, orientation=random_orientations(n, 10 * turned + seed), scene=scene)
    return height_trends(packing, (0.0, 1.0))


def test_mixed_grains_have_no_trend_and_point_anywhere():
    evaluations = [evaluation(seed) for seed in (1, 2)]
    trends = tabulate_trends("s", [ROW, ROW], evaluations)
    assert len(trends) == 2 * 4
    table = summarise_trends(trends).set_index("quantity")
    # With one form, flatness and elongation have no trend.
    assert list(table.index) == ["D", "angle"]
    assert (table.packings == 2).all() and (table.seeds == 2).all() and (table.grains == 8000).all()
    # Both numbers are standard normal and exceed four with a probability of about 1e-4.
    assert (table.spearman_z.abs() < 4.0).all()
    angle = table.loc["angle"]
    assert angle.isotropic == 1.0 and np.isnan(table.isotropic["D"])
    assert abs(angle["mean"] - 1.0) < 4.0 * angle.mean_std_error
    # The angle of random lines has the variance pi - 3.
    assert angle.mean_std_error == pytest.approx(np.sqrt((np.pi - 3.0) / 8000), rel=0.05)


def test_the_mean_angle_is_that_of_grains_with_a_long_axis():
    """Layers of discs alone have no mean angle, and discs do not add to the weight of the layer that they share."""
    data = evaluation(1, discs_above=0.35)
    trends = tabulate_trends("s", [ROW], [data]).set_index("quantity")
    counts, means = data.angle_count.values, data.angle_mean.values
    assert counts[0] > counts[1] > 0 == counts[2:].sum()
    assert trends.grains["angle"] == counts.sum() < trends.grains["D"] == 4000
    assert trends["mean"]["angle"] == pytest.approx((counts[:2] @ means[:2]) / counts.sum())


def test_grains_sorted_by_size_show():
    table = summarise_trends(tabulate_trends("s", [ROW], [evaluation(3, sorted_by_height=True)]))
    size = table.set_index("quantity").loc["D"]
    assert (size.study, size.case, size.kind) == ("s", "U3", "ellipsoid")
    # The lower half is small and the upper half large: the rank correlation of such a step is sqrt(3)/2 with ties.
    assert size.spearman_r == pytest.approx(np.sqrt(0.75), abs=0.01)
    assert size.spearman_z == pytest.approx(size.spearman_r * np.sqrt(3999))
    assert size.relative_change == pytest.approx(0.594, abs=0.03)


def test_packings_of_one_seed_share_their_sizes_but_not_how_their_grains_lie():
    """Sizes of one seed have the same random trend in each packing; more packings do not reduce the error."""
    evaluations = [evaluation(1, turned=turned) for turned in range(6)]
    one = summarise_trends(tabulate_trends("s", [ROW], evaluations[:1])).set_index("quantity")
    six = summarise_trends(tabulate_trends("s", [ROW] * 6, evaluations)).set_index("quantity")
    assert (six.packings == 6).all() and (six.seeds == 1).all()
    errors = ["relative_change_std_error", "mean_std_error"]
    for name in ("spearman_r", "spearman_z", "relative_change", "mean", *errors):
        assert six.loc["D", name] == pytest.approx(one.loc["D", name], rel=1e-12), name
    assert six.loc["angle", errors].to_numpy(float) == pytest.approx(
        one.loc["angle", errors].to_numpy(float) / np.sqrt(6.0), rel=0.05
    )
    # A second seed counts as much as the six packings of the first.
    other = evaluation(2)
    both = summarise_trends(tabulate_trends("s", [ROW] * 7, [*evaluations, other])).set_index("quantity")
    second = summarise_trends(tabulate_trends("s", [ROW], [other])).set_index("quantity")
    assert both.loc["D", "seeds"] == 2
    change = "relative_change"
    assert both.loc["D", change] == pytest.approx((one.loc["D", change] + second.loc["D", change]) / 2.0)
    squares = one.loc["D", errors] ** 2 + second.loc["D", errors] ** 2
    assert both.loc["D", errors].to_numpy(float) == pytest.approx(np.sqrt(squares.to_numpy(float)) / 2.0)


def test_a_bed_too_low_for_trends_has_no_row():
    trends = tabulate_trends("s", [ROW], [xr.Dataset(attrs={"height_trends": "left out: too few"})])
    assert trends.empty
    assert summarise_trends(trends).empty and "spearman_z" in summarise_trends(trends)

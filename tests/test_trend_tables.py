"""Trends over height of the packings of a study, and their means."""

import json

import numpy as np
import pytest
import xarray as xr

from simcore.segregation import height_trends
from simcore.trend_tables import summarise_trends, tabulate_trends

ROW = {"packing": "p", "varied": {}}


def evaluation(packings, seed, sorted_by_height=False, n=4000):
    """What simcore.evaluation keeps of the trends of n grains with two sizes, isotropic, at random heights."""
    rng = np.random.default_rng(seed)
    height = np.sort(rng.uniform(0.0, 1.0, n))
    scale = np.outer(rng.choice([0.004, 0.006], n), [0.5, 0.8, 1.0])
    if sorted_by_height:
        scale = scale[np.argsort(scale[:, 0])]
    position = np.column_stack([rng.uniform(0.0, 0.1, (n, 2)), height])
    scene = json.dumps({"sizes": {"case": "U3"}, "shapes": {"kind": "ellipsoid"}})
    packing = packings.make(position, scale, orientation=packings.orientations(n, seed), scene=scene)
    return height_trends(packing, (0.0, 1.0))


def test_mixed_grains_have_no_trend_and_point_anywhere(packings):
    evaluations = [evaluation(packings, seed) for seed in (1, 2)]
    trends = tabulate_trends("s", [ROW, ROW], evaluations)
    assert len(trends) == 2 * 4
    table = summarise_trends(trends).set_index("quantity")
    # One form: flatness and elongation have nothing to change.
    assert list(table.index) == ["D", "angle"]
    assert (table.packings == 2).all() and (table.grains == 8000).all()
    # Two independent normal numbers, both within four standard errors but for 1e-4.
    assert (table.spearman_z.abs() < 4.0).all()
    angle = table.loc["angle"]
    assert angle.isotropic == 1.0 and np.isnan(table.isotropic["D"])
    assert abs(angle["mean"] - 1.0) < 4.0 * angle.mean_std_error
    # The angle of random lines has the variance pi - 3.
    assert angle.mean_std_error == pytest.approx(np.sqrt((np.pi - 3.0) / 8000), rel=0.05)


def test_grains_sorted_by_size_show(packings):
    table = summarise_trends(tabulate_trends("s", [ROW], [evaluation(packings, 3, sorted_by_height=True)]))
    size = table.set_index("quantity").loc["D"]
    assert (size.study, size.case, size.kind) == ("s", "U3", "ellipsoid")
    # Half small below, half large above: with ties, r = sqrt(3)/2 of a two-valued step.
    assert size.spearman_r == pytest.approx(np.sqrt(0.75), abs=0.01)
    assert size.spearman_z == pytest.approx(size.spearman_r * np.sqrt(3999))
    assert size.relative_change > 0.3


def test_a_bed_too_low_for_trends_has_no_row():
    trends = tabulate_trends("s", [ROW], [xr.Dataset(attrs={"height_trends": "left out: too few"})])
    assert trends.empty
    assert summarise_trends(trends).empty and "spearman_z" in summarise_trends(trends)

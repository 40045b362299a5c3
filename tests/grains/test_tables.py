"""Tables about a set of grains, compared with numbers of Rettinger et al. (2022) and with plain numpy."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.form import FORM_FACTORS
from simcore.grains.mesh import coarsen
from simcore.grains.scan_shapes import ellipsoid_counterparts, shape_table
from simcore.grains.synthetic import synthetic_grains
from simcore.grains.tables import (
    decimation_summary,
    decimation_table,
    factor_correlations,
    form_statistics,
    form_table,
    principal_components,
    shape_comparison,
)


@pytest.fixture(scope="module")
def grains():
    return synthetic_grains()


@pytest.fixture(scope="module")
def table(grains):
    return form_table(grains)


def test_the_row_of_table_2(table):
    row = form_statistics(table).iloc[0]
    study = {"n_samples": 63, "mu_FL": 0.647, "sigma_FL": 0.175, "mu_EL": 0.682, "sigma_EL": 0.139}
    study |= {"r_FL_EL": -0.089, "r_size_FL": -0.11, "r_size_EL": 0.23}
    np.testing.assert_allclose(row[list(study)].astype(float), list(study.values()), rtol=1e-9)
    assert 2.8 < row.size_min_mm < 4 and 22.4 < row.size_max_mm < 31.5
    assert row.shapiro_p_FL > 0.05 and row.shapiro_p_EL > 0.05
    two = form_statistics(table.iloc[:2]).iloc[0]
    assert two.n_samples == 2 and np.isnan([two.shapiro_W_FL, two.r_FL_EL]).all() and two.sigma_FL > 0


def test_correlations_are_pearsons_and_agree_with_r22(table):
    correlations = factor_correlations(table)
    assert list(correlations.columns) == list(correlations.index) == list(FORM_FACTORS)
    np.testing.assert_allclose(correlations, np.corrcoef(table[list(FORM_FACTORS)].T), atol=1e-12)


def test_two_components_explain_the_factors_as_in_r22(table):
    components = principal_components(table)
    assert components.explained.sum() == pytest.approx(1)
    assert components.cumulative.iloc[1] > 0.95
    loadings = components[list(FORM_FACTORS)].to_numpy()
    np.testing.assert_allclose(loadings @ loadings.T, np.eye(13), atol=1e-10)
    # The eigenvalues of the correlation matrix give the same shares.
    eigenvalues = np.linalg.eigvalsh(factor_correlations(table))[::-1]
    np.testing.assert_allclose(components.explained, eigenvalues / 13, atol=1e-12)


def test_grains_with_undefined_factors_are_left_out(table):
    ball = table.iloc[[0]].assign(DRI=np.nan, OPI=np.inf)
    rest = table.iloc[1:]
    mixed = factor_correlations(pd.concat([rest, ball]))
    np.testing.assert_array_equal(mixed, factor_correlations(rest))


def test_decimation_changes(grains):
    some = grains[::9]
    table = decimation_table(some, targets=(300, 50))
    assert len(table) == 2 * len(some) and np.all(table.faces <= table.target)
    row = table.iloc[-1]
    coarse = coarsen(some[-1], 50)
    assert row.volume_change_percent == pytest.approx(100 * (coarse.volume / some[-1].volume - 1))
    summary = decimation_summary(table)
    assert list(summary.index) == [300, 50]
    # Rettinger et al. lost 0.2 % at 300 faces and 3.6 % at 50, for grains of the same face counts.
    assert -1 < summary.volume_change_percent[300] < 0
    assert -6 < summary.volume_change_percent[50] < summary.volume_change_percent[300]
    # The conventions require the form to change by less than 0.3 % at 300 faces, on average.
    assert abs(summary.flatness_change_percent[300]) < 0.3 and abs(summary.elongation_change_percent[300]) < 0.3


def test_pebbles_lie_within_the_scans_and_their_ellipsoids_do_not(grains):
    some = grains[::6]
    comparison = shape_comparison(shape_table(some))
    assert comparison.within.all()
    ellipsoids = ellipsoid_counterparts(some)
    for grain, ellipsoid in zip(some, ellipsoids, strict=True):
        assert (ellipsoid.L, ellipsoid.I, ellipsoid.S) == pytest.approx((grain.L, grain.I, grain.S), rel=1e-12)
        assert len(ellipsoid.faces) == len(grain.faces)
    assert not shape_comparison(shape_table(ellipsoids)).within.any()

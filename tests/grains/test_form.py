"""Form: closed forms of boxes and ellipsoids, and the 13 form factors, compared with hand-computed values."""

import warnings

import numpy as np
import pytest

from simcore.grains.form import (
    FORM_FACTORS,
    axes_from_form,
    features,
    form_factors,
    mass_equivalent_axes,
    sieve_size,
)


def test_axes_of_an_ellipsoid_come_back_sorted():
    semi_axes = np.array([2.0, 0.5, 1.0])
    assert mass_equivalent_axes(semi_axes**2 / 5) == pytest.approx((4.0, 2.0, 1.0), rel=1e-15)


def test_axes_follow_the_r22_formula_from_moments_of_inertia():
    second = np.array([0.3, 1.1, 0.7])
    inertia = second.sum() - second  # of unit mass
    semi = np.sqrt(5 * (inertia.sum() - 2 * inertia) / 2)
    assert mass_equivalent_axes(second) == pytest.approx(sorted(2 * semi, reverse=True), rel=1e-14)


def test_form_factors_of_a_4_2_1_grain_by_hand():
    expected = {
        "FL": 0.5,
        "EL": 0.5,
        "EQ": 0.25,
        "ASF": 1.0,
        "CSF": 1 / np.sqrt(8),
        "DRI": 2 / 3,
        "IFI": 2.5,
        "IRI": 0.75,
        "JFF": 1 / np.sqrt(7),
        "KIS": 0.5,
        "MPS": 0.5,
        "OPI": 20 / 3,
        "WFI": 3.0,
    }
    row = form_factors(4.0, 2.0, 1.0).iloc[0]
    assert list(row.index) == list(expected) == list(FORM_FACTORS)
    np.testing.assert_allclose(row.values, list(expected.values()), rtol=1e-14)


def test_form_factors_do_not_depend_on_size_and_inverses_are_inverses():
    rng = np.random.default_rng(1)
    S, I, L = np.sort(rng.uniform(1, 10, (3, 20)), axis=0)  # noqa: E741
    table = features(L, I, S)
    assert table.shape == (20, 26)
    np.testing.assert_allclose(features(1e-3 * L, 1e-3 * I, 1e-3 * S), table, rtol=1e-12)
    np.testing.assert_allclose(table.filter(like="_inv").values * table.iloc[:, :13].values, 1, rtol=1e-13)


def test_a_sphere_has_undefined_indices_and_gives_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        row = features(1.0, 1.0, 1.0).iloc[0]
        zero_opi = features(3.0, 2.0, 1.0).iloc[0]
    assert set(row.index[~np.isfinite(row)]) == {"DRI", "OPI", "DRI_inv", "OPI_inv"}
    assert np.isinf(zero_opi["OPI_inv"]) and zero_opi["OPI"] == 0


def test_axes_that_differ_by_rounding_are_equal():
    rng = np.random.default_rng(1)
    L, I, S = np.sort(1.0 + 1e-13 * rng.uniform(-1.0, 1.0, (20, 3)), axis=1).T[::-1]
    cubes, plates = features(L, I, S), features(L, I, 0.5 * S)
    assert cubes[["DRI", "OPI"]].isna().all(axis=None)
    assert (plates["DRI"] == 0.0).all() and np.isinf(plates["DRI_inv"]).all()
    assert plates["OPI"].to_numpy() == pytest.approx(-10.0, rel=1e-12)


@pytest.mark.parametrize("axes", [(1.0, 2.0, 1.0), (2.0, 1.0, 0.0), (2.0, np.nan, 1.0)])
def test_axes_out_of_order_are_refused(axes):
    with pytest.raises(ValueError, match="L >= I >= S > 0"):
        form_factors(*axes)


def test_axes_from_form_invert_form_and_sieve_size():
    L, I, S = axes_from_form(0.01, np.array([0.4, 1.0]), np.array([0.7, 1.0]))  # noqa: E741
    np.testing.assert_allclose(S / I, [0.4, 1.0], rtol=1e-14)
    np.testing.assert_allclose(I / L, [0.7, 1.0], rtol=1e-14)
    np.testing.assert_allclose(sieve_size(I, S), 0.01, rtol=1e-14)

"""The angle at which curves of several forms cross."""

import numpy as np
import pytest
import xarray as xr

from simcore.evaluation.crossing_angle import crossing_angle


def made(moments, scatter=0.0, seeds=4, seed=1):
    """Return a fabric whose P2, P4 and P6 have these means over seeds and this scatter."""
    rng = np.random.default_rng(seed)
    noise = scatter * rng.normal(size=(seeds, 3))
    values = np.asarray(moments) + noise - noise.mean(axis=0)
    return xr.Dataset(
        {"legendre_of_seed": (("seed", "direction", "order"), values[:, None])},
        {"order": [2, 4, 6], "direction": ["contact_normal"]},
    )


def curve(theta, moments):
    series = np.zeros(7)
    series[[0, 2, 4, 6]] = [1.0, *(np.array([5, 9, 13]) * moments)]
    return np.polynomial.legendre.legval(np.cos(theta), series)


def test_curves_of_one_term_cross_at_the_magic_angle():
    found = crossing_angle([made([p, 0.0, 0.0]) for p in (0.0, 0.05, 0.2)])
    assert np.degrees(found.angle) == pytest.approx(54.7356103172, abs=1e-9)
    assert found.std_error == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(found.slopes, [1, 0, 0], atol=1e-14)


def test_two_curves_cross_where_they_are_equal():
    first, second = np.array([0.03, 0.01, -0.004]), np.array([0.14, 0.03, 0.01])
    found = crossing_angle([made(first), made(second)])
    assert found.angle != pytest.approx(np.arccos(3**-0.5), abs=0.01)
    assert curve(found.angle, first) == pytest.approx(curve(found.angle, second), rel=1e-12)


def test_forms_on_a_line_cross_in_one_point():
    direction = np.array([1.0, 0.3, -0.05])
    forms = [np.array([0.01, -0.02, 0.005]) + s * direction for s in (0.0, 0.1, 0.15, 0.3)]
    found = crossing_angle([made(form) for form in forms])
    np.testing.assert_allclose(found.slopes, direction, rtol=1e-12)
    heights = [curve(found.angle, form) for form in forms]
    assert np.ptp(heights) < 1e-12


def test_the_stated_error_is_the_scatter_of_the_angle():
    """The scatter of 200 repetitions has a relative error of 1/√400, and the mean square error has a smaller one."""
    angles, errors = [], []
    for repetition in range(200):
        rng = np.random.default_rng(repetition)
        forms = []
        for mean in ([0.02, 0.0, 0.0], [0.15, 0.01, 0.0]):
            values = np.array(mean) + 0.01 * rng.normal(size=(6, 3))
            forms.append(made(np.zeros(3), seeds=6))
            forms[-1]["legendre_of_seed"][:, 0, :] = values
        found = crossing_angle(forms)
        angles.append(found.angle)
        errors.append(found.std_error)
    assert np.std(angles) == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=4 / np.sqrt(400))


def test_one_curve_and_equal_curves_are_refused():
    with pytest.raises(ValueError, match="at least two forms"):
        crossing_angle([made([0.1, 0, 0])])
    with pytest.raises(ValueError, match="the same in all fabrics"):
        crossing_angle([made([0.1, 0, 0]), made([0.1, 0.05, 0])])

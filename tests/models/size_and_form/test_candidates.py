"""The candidates for size and form: their limits, and what splitting a class, a form or a size changes."""

import numpy as np
import pytest

from simcore.grains.sieve import SieveCurve, read_cases
from simcore.models.packing_models.curves import LAWS, passing, split
from simcore.models.size_and_form.candidates import CANDIDATES, predict
from simcore.models.size_and_form.one_class import check_one_class
from simcore.models.size_and_form.skeletons import least_porosity
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY, by_form, by_looseness
from simcore.paths import CONFIG

CASES = {name: case.curve for name, case in read_cases(CONFIG / "cases.tsv").items()}
FORMS = (0.441, 0.682)
BINARY = SieveCurve(np.array([2.8, 4, 16, 22.4]) * 1e-3, [0.3, 0.0, 0.7], "binary")
WIDE_CLASSES = SieveCurve(np.array([2, 8, 32]) * 1e-3, [0.4, 0.6], "wide classes")
CURVES = {**CASES, "binary": BINARY, "wide classes": WIDE_CLASSES}
every_candidate = pytest.mark.parametrize("name", CANDIDATES)


def porosity(name, curve, one_class=0.342, parameters=None, forms=FORMS, **options):
    return predict(name, curve, one_class, parameters, forms, **options)


def far_values(name):
    """Return parameters away from their start values, within their bounds."""
    return {
        key: parameter.start + 0.4 * (parameter.high - parameter.start)
        for key, parameter in CANDIDATES[name].parameters.items()
        if key not in ("m_EQ", "m_EL")
    }


@every_candidate
@pytest.mark.parametrize("law", LAWS)
def test_one_class_keeps_the_one_class_porosity(name, law):
    for n1 in (0.25, 0.31, 0.342, 0.45, 0.55):
        for parameters in ({}, far_values(name)):
            assert porosity(name, CASES["U1"], n1, parameters, law=law) == pytest.approx(n1, abs=1e-9)
    # A narrower class counts as one class.
    narrow = SieveCurve([1e-3, 1.05e-3], [1.0])
    assert porosity(name, narrow, law=law) == pytest.approx(0.342, abs=1e-9)


@every_candidate
@pytest.mark.parametrize("law", LAWS)
def test_splitting_classes_changes_less_than_a_thousandth(name, law):
    for curve in CURVES.values():
        for n1, parameters in ((0.32, {}), (0.40, far_values(name))):
            before = porosity(name, curve, n1, parameters, law=law)
            for number in (2, 4, 8):
                assert abs(porosity(name, split(curve, number, law), n1, parameters, law=law) - before) < 1e-3


@every_candidate
def test_scale_and_empty_classes_change_nothing(name):
    for curve in CURVES.values():
        before = porosity(name, curve)
        larger = SieveCurve(37.0 * curve.bounds, curve.mass_fractions)
        assert porosity(name, larger) == pytest.approx(before, abs=1e-6)  # rods: rounding in equal gaps
        bounds = np.concatenate([[0.1 * curve.bounds[0]], curve.bounds, [9 * curve.bounds[-1]]])
        padded = SieveCurve(bounds, np.concatenate([[0.0], curve.mass_fractions, [0.0]]))
        assert porosity(name, padded) == pytest.approx(before, abs=1e-12)


@every_candidate
def test_every_curve_gives_a_porosity_up_to_the_one_class_porosity(name):
    """Random curves have up to nine classes of ratios 1.1 to 4, and looser grains give looser beds."""
    rng = np.random.default_rng(6)
    for _ in range(15):
        k = rng.integers(1, 10)
        curve = SieveCurve(1e-3 * np.cumprod([1, *rng.uniform(1.1, 4, k)]), rng.dirichlet(0.5 * np.ones(k)))
        n1 = np.array([[0.28], [0.33], [0.38], [0.45]])
        n = porosity(name, curve, n1)
        assert n.shape == (4,) and np.all(n > 0) and np.all(n <= n1[:, 0] + 1e-12)
        assert np.all(np.diff(n) > -2e-4), (n, curve)  # 8000 rods have noise


@every_candidate
def test_many_predictions_are_single_ones(name):
    n1 = np.array([[0.31], [0.36]])
    n = porosity(name, CASES["U7"], n1)
    single = [porosity(name, CASES["U7"], float(value)) for value in n1[:, 0]]
    np.testing.assert_allclose(n, single, atol=1e-12)


@every_candidate
def test_equal_forms_by_class_are_those_of_all_grains(name):
    by_class = np.full((1, 7), 0.36)
    forms = tuple(np.full((1, 7), value) for value in FORMS)
    same = porosity(name, CASES["B50"], by_class, forms=forms)
    np.testing.assert_allclose(same, porosity(name, CASES["B50"], 0.36), atol=1e-9)


@every_candidate
def test_form_by_class_lies_between_the_forms(name):
    """Coarse grains have one form and fine ones another, and the reverse."""
    low, high = porosity(name, BINARY, 0.32), porosity(name, BINARY, 0.40)
    for values in ([0.32, 0.36, 0.40], [0.40, 0.36, 0.32]):
        mixed = float(porosity(name, BINARY, np.array([values]))[0])
        assert low < mixed < high
    # The class without mass does not count.
    other = porosity(name, BINARY, np.array([[0.40, 0.25, 0.32]]))
    assert float(other[0]) == pytest.approx(mixed, abs=1e-12)


def slope(name, case, parameters):
    low, high = (porosity(name, CASES[case], n1, parameters) for n1 in (0.32, 0.38))
    return (high - low) / 0.06


def test_stretch_and_damping_lower_the_effect_of_form():
    """An independent program gave 0.97 and 0.88 for the linear model as published, 0.70 and 0.55 with kappa 0.7."""
    published, stretched = {"m0": 1.0, "kappa": 0.0}, {"m0": 1.0, "kappa": 0.7}
    np.testing.assert_allclose([slope("L", c, published) for c in ("U7", "B50")], [0.97, 0.88], atol=0.03)
    np.testing.assert_allclose([slope("L", c, stretched) for c in ("U7", "B50")], [0.70, 0.55], atol=0.03)
    for c in (0.0, 1.0, 1.5):
        X = 1 - porosity("D_F", CASES["B50"], REFERENCE_POROSITY) / REFERENCE_POROSITY
        assert slope("D_F", "B50", {"c": c}) == pytest.approx(1 - c * X, abs=1e-9)


def test_stretch_takes_the_coarser_grain_of_a_pair():
    """Loose coarse grains have wide pores; the looseness of fines in the pores of others does not count."""

    def effect(coarse, fine):
        n1 = np.array([[fine, 0.34, coarse]])
        with_stretch, without = (porosity("L", BINARY, n1, {"kappa": kappa}) for kappa in (1.0, 0.0))
        return float((with_stretch - without)[0])

    assert effect(coarse=0.40, fine=REFERENCE_POROSITY) < -0.01
    assert abs(effect(coarse=REFERENCE_POROSITY, fine=0.40)) < 4e-3  # from mixing within their own class


@pytest.mark.parametrize("name", [name for name in CANDIDATES if {"kappa", "c"} & set(far_values(name))])
def test_a_looser_process_is_not_taken_for_form(name):
    """For the Rhine's grains m is m0 in every process, and in damped candidates the curve alone sets the porosity."""
    parameters = far_values(name)
    fixed = {key: 0.0 for key in ("kappa", "c") if key in parameters}
    for n1 in (0.30, 0.342, 0.40):
        of_rhine = porosity(name, CASES["U7"], n1, parameters, reference=n1)
        expected = porosity(name, CASES["U7"], n1, parameters | fixed, reference=n1)
        assert of_rhine == pytest.approx(expected, abs=1e-12)


def test_stretch_rules_at_the_reference():
    assert by_looseness(REFERENCE_POROSITY, 0.93, 0.7) == pytest.approx(0.93)
    assert by_looseness(0.40, 1.0, 1.0) == pytest.approx((0.40 / 0.60) / (0.342 / 0.658))
    assert by_looseness(0.40, 1.0, 1.0, 0.36) == pytest.approx((0.40 / 0.60) / (0.36 / 0.64))
    assert by_form(*FORMS, 1.1, 0.3, -0.2) == pytest.approx(1.1)
    assert by_form(0.3, 0.682, 1.0, 0.1) == pytest.approx(1 + 0.1 * (1 / 0.3 - 1 / 0.441))
    with pytest.raises(ValueError, match="not positive"):
        by_form(0.1, 0.7, 1.0, -1.0)


def test_a_porosity_outside_0_and_1_is_refused(monkeypatch):
    wrong = CANDIDATES["L"]._replace(porosity=lambda *inputs, **parameters: np.array(-0.1))
    monkeypatch.setitem(CANDIDATES, "L", wrong)
    with pytest.raises(ValueError, match="binary: candidate L gives the porosity -0.1"):
        porosity("L", BINARY)


def least_by_hand(curve, one_class):
    """Return `least_porosity` by a fine search over the upper ends of the part that forms the bed."""
    V, width = 1 / (1 - one_class), 8 / 5.6
    tops = np.geomspace(curve.least, curve.largest * width, 20001)
    below, far_below = passing(curve, tops), passing(curve, tops / width)
    return 1 - 1 / np.max(1 - below + V * (below - far_below))


def test_full_pores_leave_the_porosity_of_the_coarse_grains():
    coarse = SieveCurve(np.array([2.8, 4, 22.4, 31.5]) * 1e-3, [0.15, 0.0, 0.85], "8 : 1")
    assert least_porosity(coarse, 0.36) == pytest.approx(1 - 1 / (0.15 * 0 + 0.85 / 0.64), abs=2e-3)
    for curve in (coarse, *CURVES.values()):
        for n1 in (0.25, 0.45):
            assert least_porosity(curve, n1) == pytest.approx(least_by_hand(curve, n1), abs=1e-4)
            assert least_porosity(split(curve, 4, "mass"), n1) == pytest.approx(least_porosity(curve, n1), abs=1e-12)
    # By class: only the coarse class has an effect.
    by_class = least_porosity(coarse, np.array([[0.3, 0.3, 0.36], [0.5, 0.5, 0.36]]))
    np.testing.assert_allclose(by_class, least_porosity(coarse, 0.36), atol=1e-12)


@every_candidate
def test_no_candidate_fills_pores_that_are_not_there(name):
    """Coarse grains of an open form leave pores; as many fine grains as there are cannot fill more than these."""
    for share in (0.8, 0.9, 0.95):
        for ratio in (4, 8):
            bounds = np.array([2.8, 4, 2.8 * ratio, 4 * ratio]) * 1e-3
            curve = SieveCurve(bounds, [1 - share, 0.0, share], f"{ratio} : 1")
            for n1 in (0.32, 0.36, 0.45):
                for parameters in ({}, far_values(name)):
                    assert porosity(name, curve, n1, parameters) >= least_porosity(curve, n1) - 1e-5


def test_what_cannot_be_predicted_is_refused():
    for name in CANDIDATES:
        with pytest.raises(ValueError, match="one-class porosity 0.65 is outside"):
            porosity(name, BINARY, 0.65)
    with pytest.raises(ValueError, match="candidate 'G' is unknown; the candidates are H, "):
        porosity("G", BINARY)
    with pytest.raises(ValueError, match="candidate L has no parameter 'K'"):
        porosity("L", BINARY, parameters={"K": 4.0})
    with pytest.raises(ValueError, match="2 values do not fit 3 classes"):
        porosity("H", BINARY, np.array([[0.3, 0.4]]))
    with pytest.raises(ValueError, match="needs the mean EQ and EL"):
        predict("H_form", BINARY, 0.342)
    assert check_one_class(0.3) == 0.3

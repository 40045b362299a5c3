"""Packing models of the literature at their limits, compared with numbers of an independent program.

That program gave errors on the gravels of Rettinger et al. (2022) to 0.001, with one size per class.
"""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.sieve import read_cases
from simcore.models.packing_models.compressible import compressible
from simcore.models.packing_models.linear import filling, linear, occupying
from simcore.models.packing_models.linear_mixture import linear_mixture
from simcore.models.packing_models.rods import rod_lengths, rods, solid_fraction
from simcore.paths import CONFIG, R22_TABLES

OTHERS = ("U3", "U5", "U7", "B30", "B50", "B70")


def many_rods(sizes, fractions, porosities):
    """Return porosities by the model of rods, which takes one mixture at a time, for arrays as the other models do."""
    sizes, fractions, porosities = np.broadcast_arrays(sizes, fractions, porosities)
    rows = [array.reshape(-1, array.shape[-1]) for array in (sizes, fractions, porosities)]
    n = [rods(d, y, p[0]) for d, y, p in zip(*rows, strict=True)]
    return np.array(n).reshape(sizes.shape[:-1])


MODELS = {
    "linear": linear,
    "linear mixture": linear_mixture,
    "compressible": lambda d, y, n: compressible(d, y, n, 4.75),
    "flat compressible": lambda d, y, n: compressible(d, y, n, 4.75, functions=(filling, occupying)),
    "rods": many_rods,
}
every_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


def random_mixtures(rng, count=20, classes=5):
    fractions = rng.dirichlet(np.ones(classes), count)
    return np.exp(rng.uniform(0, 3, (count, classes))), fractions, rng.uniform(0.3, 0.45, (count, 1))


@every_model
def test_one_class_keeps_its_porosity(model):
    n = np.array([[0.28], [0.342], [0.45]])
    np.testing.assert_allclose(model([3.0], np.ones((3, 1)), n), n[:, 0], atol=1e-12)
    # Classes of one size are one class.
    np.testing.assert_allclose(model([3.0, 3.0], [[0.2, 0.8]], n), n[:, 0], atol=1e-12)


@every_model
def test_permutation_scale_and_empty_classes_change_nothing(model):
    rng = np.random.default_rng(1)
    sizes, fractions, n = random_mixtures(rng)
    before = model(sizes, fractions, n)
    order = rng.permutation(sizes.shape[1])
    np.testing.assert_allclose(model(sizes[:, order], fractions[:, order], n), before, atol=1e-12)
    # The results of rods differ because rounding changes which of equal gaps is filled.
    np.testing.assert_allclose(model(1e-3 * sizes, fractions, n), before, atol=1e-6)
    for extra in (0.01, 4.0, 500.0):
        d = np.column_stack([sizes[:, :2], np.full(len(sizes), extra), sizes[:, 2:]])
        y = np.insert(fractions, 2, 0.0, axis=1)
        np.testing.assert_allclose(model(d, y, n), before, atol=1e-12)


def test_rods_take_one_mixture_and_one_porosity():
    with pytest.raises(ValueError, match=r"has the shape \(2,\); give one number for all classes"):
        rods([4.0, 1.0], [0.7, 0.3], [0.38, 0.38])
    with pytest.raises(ValueError, match=r"shape \(3, 2\), which is more than one mixture"):
        rods([4.0, 1.0], np.full((3, 2), 0.5), 0.38)


@every_model
def test_mixtures_of_one_porosity_are_denser_but_not_full(model):
    sizes, fractions, n = random_mixtures(np.random.default_rng(2), 100)
    mixed = model(sizes, fractions, n)
    assert np.all(mixed > 0.02) and np.all(mixed <= n[:, 0] + 1e-9)
    looser = model(sizes, fractions, n + 0.01)
    assert np.all(looser > mixed)


@pytest.mark.parametrize("model", [linear, MODELS["linear mixture"], many_rods], ids=["linear", "mixture", "rods"])
def test_furnas_limit_of_infinite_ratio(model):
    """V = max(y_c V_c, y_c + y_f V_f) is exact if fines only fill pores, or coarse grains only replace bulk fines."""
    y = np.linspace(0.05, 0.95, 19)
    n = 0.38
    V = 1 / (1 - n)
    exact = 1 - 1 / np.maximum(y * V, y + (1 - y) * V)
    # 8000 rods resolve a share of coarse rods of y / (y + (1 - y) R): the ratio is limited.
    R, tolerance = (200.0, 0.012) if model is many_rods else (1e6, 1e-5)
    np.testing.assert_allclose(model([R, 1.0], np.column_stack([y, 1 - y]), [n, n]), exact, atol=tolerance)


def test_furnas_limit_of_the_compressible_model_needs_large_k():
    y = np.linspace(0.05, 0.95, 19)
    V = 1 / 0.62
    exact = 1 - 1 / np.maximum(y * V, y + (1 - y) * V)
    both = np.column_stack([y, 1 - y])
    near = compressible([1e8, 1.0], both, [0.38, 0.38], 1e5)
    np.testing.assert_allclose(near, exact, atol=2e-3)
    assert np.all(compressible([1e8, 1.0], both, [0.38, 0.38], 4.0) > exact + 1e-3)


def test_large_k_is_the_linear_model():
    sizes, fractions, n = random_mixtures(np.random.default_rng(3))
    flat = compressible(sizes, fractions, n, 1e9, functions=(filling, occupying))
    np.testing.assert_allclose(flat, linear(sizes, fractions, n), atol=1e-5)


def test_the_compressible_model_solves_its_equation():
    """K = Σ (y_i/β_i) / (1/Φ - 1/γ_i) is checked with γ_i in de Larrard's own form, written with β, a and b."""
    sizes, fractions, n = random_mixtures(np.random.default_rng(4), 5, 4)
    for d, y, porosity in zip(sizes, fractions, n[:, 0], strict=True):
        K = 5.0
        beta = np.full(4, (1 - porosity) * (1 + K) / K)
        solid = 1 - float(compressible(d, y, porosity, K))
        total = 0.0
        for i in range(4):
            inverse = 1.0
            for j in range(4):
                if d[j] > d[i]:
                    b = 1 - (1 - d[i] / d[j]) ** 1.5
                    inverse -= (1 - beta[i] + b * beta[i] * (1 - 1 / beta[j])) * y[j]
                elif j != i:
                    a = np.sqrt(1 - (1 - d[j] / d[i]) ** 1.02)
                    inverse -= (1 - a * beta[i] / beta[j]) * y[j]
            total += y[i] / beta[i] / (1 / solid - inverse / beta[i])
        assert total == pytest.approx(K, rel=1e-8)


def test_splitting_a_class_of_one_size_changes_nothing():
    """The linear mixture model is left out, because its term in x_h - x_l is defined for two components."""
    sizes, fractions, n = random_mixtures(np.random.default_rng(5))
    halves = np.repeat(fractions, 2, axis=1) / 2
    for name, model in MODELS.items():
        if model is linear_mixture:
            continue
        same = model(np.repeat(sizes, 2, axis=1), halves, n)
        np.testing.assert_allclose(same, model(sizes, fractions, n), atol=1e-9, err_msg=name)


def gravels():
    table = pd.read_csv(R22_TABLES / "table3_cases.csv").set_index("case")["n_exp"]
    curves = {name: case.curve for name, case in read_cases(CONFIG / "cases.tsv").items()}
    return curves, table


def of_gravels(model, n1, names=OTHERS):
    curves, _ = gravels()
    predicted = []
    for name in names:
        curve = curves[name]
        held = curve.mass_fractions > 0
        sizes = np.sqrt(curve.bounds[1:] * curve.bounds[:-1])[held]
        predicted.append(float(model(sizes, curve.mass_fractions[held], np.full(held.sum(), n1))))
    return np.array(predicted)


@pytest.mark.parametrize(
    "model, errors, rms",
    [
        (linear, [-0.002, -0.008, 0.001, -0.005, -0.007, 0.009], 0.0060),
        (linear_mixture, [0.005, -0.001, -0.001, 0.006, -0.021, -0.010], 0.0101),
        (lambda *c: compressible(*c, 4.1), None, 0.0126),
        (lambda *c: compressible(*c, 4.75), None, 0.0148),
        (lambda *c: compressible(*c, 9.0), None, 0.0231),
    ],
    ids=["linear", "linear mixture", "K 4.1", "K 4.75", "K 9"],
)
def test_errors_on_the_measured_gravels_are_those_of_the_independent_program(model, errors, rms):
    _, measured = gravels()
    difference = of_gravels(model, measured["U1"]) - measured[list(OTHERS)].to_numpy()
    assert np.sqrt(np.mean(difference**2)) == pytest.approx(rms, abs=6e-5)
    if errors:
        np.testing.assert_allclose(difference, errors, atol=6e-4)


@pytest.mark.parametrize(
    "model, expected",
    [
        (linear, [0.288, 0.256]),
        (linear_mixture, [0.286, 0.241]),
        (lambda *c: compressible(*c, 9.0), [0.262, 0.232]),
        (many_rods, [0.281, 0.250]),
    ],
    ids=["linear", "linear mixture", "K 9", "rods"],
)
def test_periodic_beds_of_the_independent_program(model, expected):
    """The one-class porosity is 0.342. The program's rods had classes of some width, unlike one size per class."""
    tolerance = 2.5e-3 if model is many_rods else 1.1e-3
    np.testing.assert_allclose(of_gravels(model, 0.342, ("U7", "B50")), expected, atol=tolerance)


@pytest.mark.parametrize(
    "R, expected",
    [
        (2, [0.318, 0.307, 0.320, 0.306]),
        (4, [0.233, 0.234, 0.247, 0.244]),
        (8, [0.184, 0.182, 0.182, 0.208]),
        (16, [0.160, 0.155, 0.155, 0.190]),
    ],
)
def test_densest_binary_spheres_of_the_independent_program(R, expected):
    """The columns are rods, linear, linear mixture and flat compressible at K = 9; the one-class porosity is 0.3565."""
    y = np.arange(0.5, 0.901, 0.05)
    shares = np.column_stack([y, 1 - y])
    models = [many_rods, linear, linear_mixture, lambda *c: compressible(*c, 9.0, functions=(filling, occupying))]
    least = [model([float(R), 1.0], shares, np.full(2, 0.3565)).min() for model in models]
    np.testing.assert_allclose(least, expected, atol=1.1e-3)


def test_rods_of_equal_spheres():
    """According to Farr and Groot, f = 0.7654 gives the solid fraction 0.6435."""
    lengths = rod_lengths(np.ones(1), np.ones(1), 20000)
    assert solid_fraction(lengths, 0.7654) == pytest.approx(0.6435, abs=5e-5)
    assert np.all(np.diff(lengths) <= 0)
    # The density 2 L of rods of D = 1 has the mean 2/3 and the mean square 1/2.
    assert lengths.mean() == pytest.approx(2 / 3, abs=1e-6) and (lengths**2).mean() == pytest.approx(0.5, abs=1e-6)


def test_rods_place_as_a_slow_search_does():
    """The slow search takes the largest gap of a list."""
    lengths = rod_lengths(np.array([1.0, 3.0, 8.0]), np.array([0.3, 0.3, 0.4]), 300)
    f, gaps = 0.8, [0.8 * lengths[0]]
    for length in lengths[1:]:
        gap = gaps.pop(int(np.argmax(gaps)))
        gaps += [f * length, max(gap - (1 + f) * length, f * length)]
    assert solid_fraction(lengths, f) == pytest.approx(lengths.sum() / (lengths.sum() + sum(gaps)), rel=1e-12)


def test_rods_of_a_mixture_follow_their_law():
    """The share of rods longer than L is that of random lines through the spheres, weighted by number times D²."""
    sizes, fractions = np.array([1.0, 2.0]), np.array([0.25, 0.75])
    lengths = rod_lengths(sizes, fractions, 200_000)
    met = fractions / sizes
    met = met / met.sum()
    for L in (0.3, 0.9, 1.5):
        exact = np.sum(met * np.maximum(0, 1 - (L / sizes) ** 2))
        assert np.mean(lengths > L) == pytest.approx(exact, abs=1e-5)


def test_functions_of_the_ratio_at_their_ends():
    for function in (filling, occupying):
        assert function(0.0) == 1.0 and function(1.0) == 0.0
        assert abs(function(1.0 - 1e-6)) < 1e-9  # flat at equal sizes
        assert np.all(np.diff(function(np.linspace(0, 1, 101))) <= 0)


@pytest.mark.parametrize(
    "arguments, reason",
    [
        (([1.0, 2.0], [0.5, 0.4], 0.4), "sum to 0.9"),
        (([1.0, 2.0], [1.5, -0.5], 0.4), "-0.5 is no volume fraction"),
        (([1.0, -2.0], [0.5, 0.5], 0.4), "-2 is no size"),
        (([1.0, np.nan], [0.5, 0.5], 0.4), "no size"),
        (([1.0, 2.0], [0.5, 0.5], 1.4), "one-class porosity 1.4"),
        (([1.0, 2.0], [0.5, 0.3, 0.2], 0.4), "do not broadcast"),
        (([], [], 0.4), "no class"),
    ],
)
def test_bad_classes_are_refused(arguments, reason):
    for model in (linear, linear_mixture, MODELS["compressible"], rods):
        with pytest.raises(ValueError, match=reason):
            model(*arguments)


def test_unsuitable_compaction_indices_are_refused():
    with pytest.raises(ValueError, match="not positive"):
        compressible([1.0], [1.0], 0.4, -1.0)
    # W = K / (1 + K) / (1 - n) is 1 at K = (1 - n) / n = 1.5.
    with pytest.raises(ValueError, match="virtual density above 1"):
        compressible([1.0], [1.0], 0.4, 1.49)
    assert compressible([1.0], [1.0], 0.4, 1.51) == pytest.approx(0.4)
    with pytest.raises(ValueError, match="no distance between rods"):
        rods([1.0], [1.0], 0.02)

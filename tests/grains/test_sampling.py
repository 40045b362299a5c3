"""Random sizes, forms and shapes depend on the grain's id and follow the stated distributions."""

import numpy as np
import pytest
from scipy import stats

from simcore.grains.mesh import make_grain
from simcore.grains.sampling import (
    FORM_RANGE,
    FormsBelow,
    ShapeChoice,
    grain_uniforms,
    quota_uniforms,
    sample_grains,
    sample_sizes,
    with_volume_factors,
)
from simcore.grains.sieve import SieveCurve
from tests.helpers.few_spheres import set_up_few_spheres

CURVE = SieveCurve([4e-3, 8e-3, 11.2e-3, 16e-3], [0.2, 0.5, 0.3])
IDS = np.arange(20000)
MIXTURE = {"flatness": 0.4, "flatness_std": 0.2, "elongation": 0.8, "elongation_std": 0.1}


@pytest.fixture(scope="module")
def grains():
    rng = np.random.default_rng(11)
    return [make_grain(f"g{i}", rng.normal(size=(60, 3)) * [1e-3, 2e-3, (2 + i) * 1e-3]) for i in range(4)]


def test_numbers_belong_to_the_id():
    numbers = grain_uniforms(IDS, seed=4)
    some = [17, 3, 19999, 3]
    np.testing.assert_array_equal(grain_uniforms(some, seed=4), numbers[some])
    assert not np.any(numbers == grain_uniforms(IDS, seed=5))
    assert not np.any(numbers == grain_uniforms(IDS, seed=4, stream=1))
    assert np.all((numbers > 0) & (numbers < 1))
    assert grain_uniforms([], seed=4).shape == (0, 8)


def test_numbers_are_uniform_and_uncorrelated():
    numbers = grain_uniforms(IDS, seed=4)
    # Eight columns are tested at once, so the level 1e-3 is divided by 8.
    assert min(stats.kstest(column, "uniform").pvalue for column in numbers.T) > 1e-3 / 8
    correlation = np.corrcoef(np.hstack([numbers[:-1], numbers[1:]]).T) - np.eye(16)
    assert np.abs(correlation).max() < 5 / np.sqrt(len(IDS))


def test_sizes_follow_number_fractions_and_are_log_uniform_inside_a_class():
    D = sample_sizes(CURVE, IDS, seed=1)
    counts = np.histogram(D, CURVE.bounds)[0]
    assert counts.sum() == len(IDS)
    assert stats.chisquare(counts, CURVE.number_fractions() * len(IDS)).pvalue > 1e-3
    inside = np.log2(D[D < 8e-3] / 4e-3)
    assert stats.kstest(inside, "uniform").pvalue > 1e-3


def test_empty_classes_stay_empty():
    D = sample_sizes(SieveCurve([1e-3, 2e-3, 4e-3, 8e-3, 16e-3], [0, 0.5, 0, 0.5]), IDS, seed=2)
    assert not np.any((D < 2e-3) | ((D > 4e-3) & (D < 8e-3)))


@pytest.mark.parametrize(
    "shapes",
    [
        ShapeChoice(),
        ShapeChoice("polyhedron", "one", grain="g2"),
        ShapeChoice("ellipsoid", "one", grain="g2"),
        ShapeChoice("ellipsoid", "random"),
        ShapeChoice("ellipsoid", "form", flatness=0.5, elongation=0.7),
        ShapeChoice("polyhedron", "form_distribution", **MIXTURE),
        ShapeChoice("ellipsoid", "form_distribution", **MIXTURE),
        ShapeChoice("sphere"),
    ],
    ids=lambda s: f"{s.kind}-{s.choice}",
)
def test_scaled_base_has_the_stated_axes_volume_and_size(shapes, grains):
    sample = sample_grains(np.arange(200), 3, CURVE, shapes, grains)
    np.testing.assert_allclose(np.sqrt((sample.S**2 + sample.I**2) / 2), sample.D, rtol=1e-13)
    np.testing.assert_array_equal(sample.D, sample_sizes(CURVE, np.arange(200), 3))
    for i in (0, 57, 199):
        if shapes.kind == "polyhedron":
            body = grains[sample.shape[i]].scaled(sample.scale[i])
            axes, volume = (body.S, body.I, body.L), body.volume
        else:
            assert sample.shape[i] == 0
            axes, volume = 2 * sample.scale[i], 4 / 3 * np.pi * sample.scale[i].prod()
        assert axes == pytest.approx((sample.S[i], sample.I[i], sample.L[i]), rel=1e-12)
        assert volume == pytest.approx(sample.volume[i], rel=1e-12)
    subset = sample_grains([9, 4], 3, CURVE, shapes, grains)
    np.testing.assert_array_equal(subset.scale, sample.scale[[9, 4]])
    np.testing.assert_array_equal(subset.shape, sample.shape[[9, 4]])


def test_one_shape_is_scaled_uniformly_and_random_ones_equally_often(grains):
    one = sample_grains(IDS, 3, CURVE, ShapeChoice("polyhedron", "one", grain="g2"), grains)
    assert np.all(one.shape == 2) and np.all(one.scale == one.scale[:, :1])
    random = sample_grains(IDS, 3, CURVE, ShapeChoice(), grains)
    assert stats.chisquare(np.bincount(random.shape, minlength=4)).pvalue > 1e-3
    assert abs(stats.pearsonr(random.shape, random.D).statistic) < 4 / np.sqrt(len(IDS))


def test_a_mixture_of_kinds_has_the_grains_of_meshes_some_as_their_ellipsoids(grains):
    mesh = sample_grains(IDS, 3, CURVE, ShapeChoice(), grains)
    mixed = sample_grains(IDS, 3, CURVE, ShapeChoice("mixed", ellipsoid_share=0.3), grains)
    smooth = mixed.shape == 4
    assert stats.binomtest(int(smooth.sum()), len(IDS), 0.3).pvalue > 1e-3
    for name in ("L", "I", "S", "D"):
        np.testing.assert_array_equal(getattr(mixed, name), getattr(mesh, name))
    for name in ("shape", "scale", "volume"):
        np.testing.assert_array_equal(getattr(mixed, name)[~smooth], getattr(mesh, name)[~smooth])
    axes = np.stack([mixed.S, mixed.I, mixed.L], axis=1)[smooth]
    np.testing.assert_array_equal(mixed.scale[smooth], axes / 2)
    np.testing.assert_allclose(mixed.volume[smooth], np.pi / 6 * axes.prod(axis=1), rtol=1e-14)
    # Ellipsoids are chosen independently of size and shape, and a larger share only adds to them.
    for values in (mesh.D, mesh.shape):
        assert abs(stats.pearsonr(smooth, values).statistic) < 4 / np.sqrt(len(IDS))
    more = sample_grains(IDS, 3, CURVE, ShapeChoice("mixed", ellipsoid_share=0.6), grains)
    assert (more.shape[smooth] == 4).all()
    some = sample_grains([9, 4], 3, CURVE, ShapeChoice("mixed", ellipsoid_share=0.3), grains)
    np.testing.assert_array_equal(some.scale, mixed.scale[[9, 4]])


def test_form_distribution_is_the_redrawn_normal(grains):
    sample = sample_grains(IDS, 3, CURVE, ShapeChoice("ellipsoid", "form_distribution", **MIXTURE), grains)
    for values, mean, std in [(sample.S / sample.I, 0.4, 0.2), (sample.I / sample.L, 0.8, 0.1)]:
        limits = (np.array(FORM_RANGE) - mean) / std
        assert values.min() >= FORM_RANGE[0] - 1e-12 and values.max() <= FORM_RANGE[1] + 1e-12
        assert stats.kstest(values, stats.truncnorm(*limits, loc=mean, scale=std).cdf).pvalue > 1e-3
    correlation = stats.pearsonr(sample.S / sample.I, sample.I / sample.L).statistic
    assert abs(correlation) < 4 / np.sqrt(len(IDS))


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ({"kind": "cube"}, "kind 'cube'"),
        ({"choice": "best"}, "choice 'best'"),
        ({"choice": "one"}, "needs `grain`"),
        ({"choice": "form", "flatness": 0.5, "elongation": 0.5}, "only with kind ellipsoid"),
        ({"kind": "ellipsoid", "choice": "form", "flatness": 1.5, "elongation": 0.5}, "flatness is 1.5"),
        ({"choice": "form_distribution", "flatness": 0.5, "elongation": 0.5}, "flatness_std"),
        ({"kind": "mixed"}, "needs `ellipsoid_share` from 0 to 1"),
        ({"kind": "mixed", "ellipsoid_share": 1.1}, "it is 1.1"),
        ({"ellipsoid_share": 0.5}, "no effect with kind polyhedron"),
        ({"kind": "mixed", "ellipsoid_share": 0.5, "choice": "form"}, "only with kind ellipsoid"),
    ],
)
def test_impossible_choices_are_refused(arguments, reason):
    with pytest.raises(ValueError, match=reason):
        ShapeChoice(**arguments)


def test_unknown_grain_and_empty_set_are_refused(grains):
    with pytest.raises(ValueError, match="no grain 'G99'.*g0, g1, g2, g3"):
        sample_grains([0], 1, CURVE, ShapeChoice("polyhedron", "one", grain="G99"), grains)
    with pytest.raises(ValueError, match="it is empty"):
        sample_grains([0], 1, CURVE, ShapeChoice(), [])


def test_forms_by_size_are_the_distributions_of_each_range_of_size(grains):
    fine, coarse = FormsBelow(8e-3, 0.8, 0.05, 0.7, 0.1), FormsBelow(np.inf, 0.4, 0.1, 0.5, 0.0)
    by_size = sample_grains(IDS, 3, CURVE, ShapeChoice("polyhedron", "form_by_size", by_size=(fine, coarse)), grains)
    is_fine = by_size.D < 8e-3
    assert 0.1 < is_fine.mean() < 0.9
    for forms, chosen in ((fine, is_fine), (coarse, ~is_fine)):
        values = dict(zip(("flatness", "flatness_std", "elongation", "elongation_std"), forms[1:], strict=True))
        alone = sample_grains(IDS, 3, CURVE, ShapeChoice("polyhedron", "form_distribution", **values), grains)
        np.testing.assert_array_equal(by_size.scale[chosen], alone.scale[chosen])


@pytest.mark.parametrize("kind", ["polyhedron", "ellipsoid"])
def test_forms_by_size_have_the_sieve_curve_that_is_specified(grains, kind):
    """Long grains have more volume at one sieve size. One limit is inside a class, where it divides the mean of D³."""
    fine, coarse = FormsBelow(10e-3, 0.8, 0.05, 0.9, 0.1), FormsBelow(np.inf, 0.4, 0.15, 0.5, 0.1)
    shapes = ShapeChoice(kind, "form_by_size", by_size=(fine, coarse))

    def shares(curve):
        drawn = sample_grains(IDS, 3, curve, shapes, grains, quota_uniforms(curve, len(IDS), 3))
        mass = np.bincount(curve.class_of(drawn.D), drawn.volume, minlength=3)
        return mass / mass.sum()

    corrected = with_volume_factors(CURVE, shapes)
    assert np.abs(shares(CURVE) - CURVE.mass_fractions).max() > 0.05
    # Shapes and forms are random within their strata, and the volume is a product of them.
    np.testing.assert_allclose(shares(corrected), CURVE.mass_fractions, atol=2e-3)
    np.testing.assert_allclose(corrected.expected_fractions(), CURVE.mass_fractions, rtol=1e-12)
    assert with_volume_factors(CURVE, ShapeChoice()) is CURVE


@pytest.mark.parametrize(
    "below, reason",
    [
        ((8e-3, 16e-3), "the last element is for all coarser grains"),
        ((8e-3, 4e-3, np.inf), "order them from fine to coarse"),
        ((), "the last element is for all coarser grains"),
    ],
)
def test_wrong_ranges_of_size_are_refused(below, reason):
    with pytest.raises(ValueError, match=reason):
        ShapeChoice(choice="form_by_size", by_size=tuple(FormsBelow(end, 0.5, 0.1, 0.5, 0.1) for end in below))


def test_a_range_of_size_without_grains_is_noted():
    def notes(*ends):
        form = {key: {"mean": 0.6, "std": 0.1} for key in ("flatness", "elongation")}
        by_size = [{"below": end, **form} for end in ends] + [form]
        return set_up_few_spheres(shapes={"kind": "ellipsoid", "choice": "form_by_size", "by_size": by_size}).notes

    assert notes("7 mm") == ()
    (note,) = notes("50 mm")
    assert note.startswith(
        "shapes.by_size[1] has no effect, because the sieve sizes of the grains are from 5.6 to 8 mm"
    )
    assert [note[:17] for note in notes("1 mm", "7 mm", "8 mm")] == ["shapes.by_size[0]", "shapes.by_size[3]"]


def test_a_wrong_form_of_a_range_of_size_is_named():
    forms = (FormsBelow(8e-3, 0.5, 0.1, 0.5, 0.1), FormsBelow(np.inf, 0.5, 0.1, 1.5, 0.1))
    with pytest.raises(ValueError, match=r"shapes.by_size\[1\]: elongation is 1.5; give a value from 0.1 to 1.0"):
        ShapeChoice(choice="form_by_size", by_size=forms)


def test_ratios_of_axes_are_given_ones_or_normals_above_one():
    """The mean of a normal redrawn above 1 is mean + std φ(c) / (1 - Φ(c)), c = (1 - mean) / std."""
    fixed = sample_grains(IDS[:50], 4, CURVE, ShapeChoice("ellipsoid", "ratios", eta=1.6, zeta=2.0), [])
    np.testing.assert_allclose(fixed.L / fixed.I, 1.6, rtol=1e-12)
    np.testing.assert_allclose(fixed.I / fixed.S, 2.0, rtol=1e-12)
    np.testing.assert_allclose(fixed.D, sample_sizes(CURVE, IDS[:50], 4), rtol=1e-12)
    spread = ShapeChoice("ellipsoid", "ratios", eta=1.2, zeta=2.0, eta_std=0.3, zeta_std=0.2)
    drawn = sample_grains(IDS, 4, CURVE, spread, [])
    eta, zeta = drawn.L / drawn.I, drawn.I / drawn.S
    assert eta.min() >= 1.0 - 1e-12 and zeta.min() >= 1.0 - 1e-12
    for found, mean, std in ((eta, 1.2, 0.3), (zeta, 2.0, 0.2)):
        expected = stats.truncnorm((1.0 - mean) / std, np.inf, mean, std)
        assert found.mean() == pytest.approx(expected.mean(), abs=4.0 * expected.std() / np.sqrt(len(IDS)))
        assert found.std() == pytest.approx(expected.std(), rel=4.0 * np.sqrt(1.0 / len(IDS)))
    assert abs(np.corrcoef(eta, zeta)[0, 1]) < 4.0 / np.sqrt(len(IDS))


@pytest.mark.parametrize(
    "wrong, said",
    [
        ({"kind": "polyhedron", "eta": 1.6, "zeta": 1.6}, "only with kind ellipsoid"),
        ({"kind": "ellipsoid", "eta": 0.9, "zeta": 1.6}, "eta is 0.9; give a value from 1 to 10"),
        ({"kind": "ellipsoid", "eta": 1.6}, "zeta is None; give a value"),
        ({"kind": "ellipsoid", "eta": 1.6, "zeta": 1.6, "eta_std": -1.0}, "eta_std is -1.0; it must not be negative"),
    ],
)
def test_ratios_that_are_none_are_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        ShapeChoice(choice="ratios", **wrong)

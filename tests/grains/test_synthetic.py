"""Synthetic pebbles: exact statistics of their form, sizes in the sieve classes, and shapes like those of scans."""

import numpy as np
import pandas as pd
import pytest
import trimesh
from scipy.stats import shapiro

from simcore.grains.mesh import decimate, make_grain
from simcore.grains.scan_shapes import scan_ranges, shape_measures
from simcore.grains.synthetic import SIZE_BOUNDS, synthetic_grains


@pytest.fixture(scope="module")
def grains():
    return synthetic_grains()


@pytest.fixture(scope="module")
def anew(grains):
    """Return the same grains hulled and aligned again from their vertices; nothing is taken from the generator."""
    return [make_grain(grain.name, grain.vertices) for grain in grains]


def test_form_statistics_are_those_of_r22(anew):
    flatness = np.array([grain.flatness for grain in anew])
    elongation = np.array([grain.elongation for grain in anew])
    log_size = np.log([grain.sieve_size for grain in anew])
    statistics = [flatness.mean(), flatness.std(ddof=1), elongation.mean(), elongation.std(ddof=1)]
    # Eigenvalues of 3x3 moments have errors of a few eps, times a condition number of about 10.
    np.testing.assert_allclose(statistics, [0.647, 0.175, 0.682, 0.139], rtol=1e-12)
    correlation = np.corrcoef([log_size, flatness, elongation])
    np.testing.assert_allclose(correlation[[0, 0, 1], [1, 2, 2]], [-0.11, 0.23, -0.089], atol=1e-12)
    for form in (flatness, elongation):
        assert form.min() > 0.25 and form.max() <= 1
        assert shapiro(form).pvalue > 0.05


def test_nine_grains_lie_in_each_sieve_class(anew):
    sizes = np.array([grain.sieve_size for grain in anew])
    assert list(np.histogram(sizes, SIZE_BOUNDS)[0]) == [9] * 7
    assert np.all(np.diff(sizes) > 0)
    assert [grain.name for grain in anew] == [f"G{i:02}" for i in range(1, 64)]


def test_face_counts_spread_log_uniformly(grains, anew):
    faces = np.sort([len(grain.faces) for grain in grains])
    assert (faces[0], faces[-1]) == (220, 2620)
    np.testing.assert_allclose(np.log(faces), np.linspace(np.log(220), np.log(2620), 63), atol=1 / 220)
    assert [len(grain.faces) for grain in anew] == [len(grain.faces) for grain in grains]


def test_shapes_lie_within_those_of_the_scans(anew):
    measured = pd.DataFrame([shape_measures(grain) for grain in anew])
    ranges = scan_ranges()
    for measure in ("sphericity", "facet_share", "sphericity_300", "facet_share_300", "relative_sphericity"):
        # The table is rounded to four digits.
        assert measured[measure].min() >= ranges.loc[measure, "min"] - 1e-4, measure
        assert measured[measure].max() <= ranges.loc[measure, "max"] + 1e-4, measure
    # Shapes are also in the middle of the range: the mean is within one standard deviation of the mean of the scans.
    distance = (measured.mean() - ranges["mean"]) / ranges["std"]
    assert distance[["facet_share_300", "relative_sphericity"]].abs().max() < 1


def test_ellipsoids_and_other_smooth_bodies_would_not_pass():
    ranges = scan_ranges()
    sphere = trimesh.creation.icosphere(3)
    for exponent in (2.0, 3.0):  # ellipsoid, superellipsoid
        directions = sphere.vertices
        points = directions / np.sum(np.abs(directions) ** exponent, axis=1)[:, None] ** (1 / exponent)
        grain = make_grain("smooth", points * [0.5, 0.75, 1.0])
        assert decimate(grain, 300).facet_share < ranges.loc["facet_share_300", "min"]


def test_same_seed_same_grains_other_seed_others(grains):
    again = synthetic_grains()
    other = synthetic_grains(seed=2)
    for first, second, third in zip(grains, again, other, strict=True):
        np.testing.assert_array_equal(first.vertices, second.vertices)
        assert first.sieve_size != third.sieve_size
    assert np.mean([g.flatness for g in other]) == pytest.approx(0.647, rel=1e-12)


def test_grains_are_not_mirror_images_of_themselves(grains):
    # Centrally symmetric bodies, whose support widths agree on both sides, would pack differently.
    for grain in grains:
        reach = np.abs(grain.vertices.max(0) + grain.vertices.min(0)) / np.ptp(grain.vertices, axis=0)
        assert reach.max() > 0.01


def test_too_few_grains_are_refused():
    with pytest.raises(ValueError, match="at least 21"):
        synthetic_grains(n=20)

"""Solid volume between planes, compared with closed forms, numerical integration and exact sums."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import Rotation

from simcore.evaluation.slicing import slab_volumes, vertical_extent
from tests.helpers.packings import make_packing
from tests.helpers.polyhedra import CUBE
from tests.helpers.rotations import random_orientations

EPS = np.finfo(float).eps


def tilted_cube(size, orientation, z=0.0):
    return make_packing([[0, 0, z]], size, [orientation], vertices=CUBE)


@pytest.mark.parametrize("slices", [1, 7, 60])
def test_slices_of_a_sphere_sum_to_its_volume(slices):
    sphere = make_packing([[0, 0, 0.3]], 3.7e-3)
    volumes = slab_volumes(sphere, 0.3 + np.linspace(-4e-3, 4e-3, slices + 1))
    assert volumes.sum() == pytest.approx(4 / 3 * np.pi * 3.7e-3**3, rel=1e-15 + slices * EPS)


def test_sphere_cap_has_its_closed_form():
    r, h = 2e-3, 0.7e-3
    volumes = slab_volumes(make_packing([[0, 0, 0]], r), [-1.0, -r + h])
    assert volumes[0] == pytest.approx(np.pi * h**2 * (r - h / 3), rel=8 * EPS)


@pytest.mark.parametrize("seed", range(4))
def test_tilted_ellipsoid_agrees_with_its_cross_sections(seed):
    semi_axes = np.array([1.0, 2.0, 3.5])
    orientation = random_orientations(1, seed)
    ellipsoid = make_packing([[0, 0, 0]], semi_axes[None], orientation)
    # The area of the section of x^T A x <= 1 at height z follows from the 2 x 2 block and its Schur complement.
    R = Rotation.from_quat(orientation[0], scalar_first=True).as_matrix()
    A = R @ np.diag(semi_axes**-2.0) @ R.T
    block = A[:2, :2]
    schur = A[2, 2] - A[:2, 2] @ np.linalg.solve(block, A[:2, 2])

    def section(z):
        return np.pi * max(1.0 - schur * z * z, 0.0) / np.sqrt(np.linalg.det(block))

    edges = np.linspace(-1.0, 0.8, 5)
    expected = [quad(section, a, b, points=[])[0] for a, b in zip(edges[:-1], edges[1:], strict=True)]
    np.testing.assert_allclose(slab_volumes(ellipsoid, edges, "exact"), expected, rtol=1e-10)
    low, high = vertical_extent(ellipsoid, "exact")
    assert high[0] == pytest.approx(1 / np.sqrt(schur), rel=1e-12)
    assert low[0] == pytest.approx(-1 / np.sqrt(schur), rel=1e-12)


def test_cube_on_its_corner_has_the_corner_pyramid():
    corner = Rotation.align_vectors([[0, 0, 1]], [[1, 1, 1]])[0].as_quat(scalar_first=True)
    cube = tilted_cube(1.0, corner)
    h = 0.3  # below the first neighbouring corners the section is a triangle: volume sqrt(3) h^3 / 2
    volumes = slab_volumes(cube, [-2.0, -np.sqrt(3) / 2 + h, 0.0, 2.0], "exact")
    assert volumes[0] == pytest.approx(np.sqrt(3) / 2 * h**3, rel=1e-13)
    assert volumes[:2].sum() == pytest.approx(0.5, rel=1e-13)


def test_upright_cube_is_cut_at_its_faces():
    cube = tilted_cube(2.0, [1, 0, 0, 0], z=5.0)
    volumes = slab_volumes(cube, [0.0, 4.0, 4.5, 6.0, 7.0], "exact")
    np.testing.assert_allclose(volumes, [0.0, 2.0, 6.0, 0.0], rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_polyhedron_agrees_with_clipping(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(40, 3))
    vertices = points[ConvexHull(points).vertices]
    vertices -= vertices.mean(axis=0)
    orientation = random_orientations(1, seed)
    grain = make_packing([[0, 0, 0]], [[1.0, 0.6, 1.4]], orientation, vertices=vertices)
    world = Rotation.from_quat(orientation[0], scalar_first=True).apply(vertices * [1.0, 0.6, 1.4])
    hull = ConvexHull(world)
    edges = np.linspace(world[:, 2].min() - 0.1, world[:, 2].max() + 0.1, 6)
    expected = []
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        planes = np.vstack([hull.equations, [0, 0, -1, a], [0, 0, 1, -b]])
        inner = world.mean(axis=0).copy()
        spread = np.linspace(0.02, 0.98, 25)[:, None]
        candidates = np.vstack([inner + spread * (v - inner) for v in world])
        inner = candidates[np.argmin((candidates @ planes[:, :3].T + planes[:, 3]).max(axis=1))]
        expected.append(ConvexHull(HalfspaceIntersection(planes, inner).intersections).volume)
    volumes = slab_volumes(grain, edges, "exact")
    np.testing.assert_allclose(volumes, expected, rtol=1e-9)
    # The slices sum to the volume, up to the rounding error of as many terms as there are faces.
    assert volumes.sum() == pytest.approx(hull.volume, rel=len(hull.simplices) * EPS)


def test_both_methods_hold_the_same_volume_and_add_over_grains():
    rng = np.random.default_rng(1)
    position = rng.uniform(0.2, 0.8, (30, 3))
    bed = make_packing(position, rng.uniform(0.01, 0.1, (30, 3)), random_orientations(30, 2), CUBE)
    edges = np.linspace(0.0, 1.0, 40)
    for method in ("spheres", "exact"):
        per_grain = slab_volumes(bed, edges, method, per_grain=True)
        np.testing.assert_allclose(per_grain.sum(axis=1), bed["volume"].values, rtol=1e-12)
        np.testing.assert_allclose(per_grain.sum(axis=0), slab_volumes(bed, edges, method), rtol=1e-12)
    assert not np.allclose(slab_volumes(bed, edges, "exact"), slab_volumes(bed, edges, "spheres"), rtol=1e-3)


def test_exact_slicing_of_spheres_equals_the_method_for_spheres():
    bed = make_packing([[0, 0, 1], [0, 0, 2]], [0.5, 0.7], random_orientations(2, 0))
    edges = np.linspace(0, 3, 17)
    np.testing.assert_allclose(slab_volumes(bed, edges, "exact"), slab_volumes(bed, edges), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(("edges", "method"), [([0.0], "spheres"), ([1.0, 0.0], "spheres"), ([0.0, 1.0], "voxels")])
def test_bad_input_is_refused(edges, method):
    with pytest.raises(ValueError, match="edges|voxels"):
        slab_volumes(make_packing([[0, 0, 0]], 1.0), edges, method)

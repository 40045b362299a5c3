"""Areas of the grains' surfaces: closed forms, sums over slabs, and meshes of ellipsoids."""

import numpy as np
import pytest
import trimesh

from simcore.evaluation.slicing import slab_volumes
from simcore.export.surfaces import ellipsoid_areas, surface_areas, surfaces
from simcore.pores.surface import areas_between, specific_surface
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.polyhedra import CUBE
from tests.helpers.random_beds import KINDS, strew
from tests.helpers.rotations import random_orientations


@pytest.mark.parametrize(("axes", "error"), [((1, 3, 10), 1e-8), ((1, 10, 10), 1e-8), ((1, 100, 100), 1e-4)])
def test_two_parts_of_an_ellipsoid_have_its_area(axes, error):
    half = 1e-4 * np.array([axes], float)
    for turn in random_orientations(20, 3):
        bed = make_packing([[0.5, 0.5, 0.5]], half, [turn], width=1.0)
        parts = areas_between(bed, 0.0, 0.5002) + areas_between(bed, 0.5002, 1.0)
        np.testing.assert_allclose(parts, ellipsoid_areas(half), rtol=error)


def test_spheroids_have_the_areas_of_their_closed_forms():
    a, c = 2.0, 5.0
    e = np.sqrt(1.0 - (a / c) ** 2)
    prolate = 2.0 * np.pi * a * a * (1.0 + c / (a * e) * np.arcsin(e))
    oblate = 2.0 * np.pi * c * c * (1.0 + (1.0 - e * e) / e * np.arctanh(e))
    areas = ellipsoid_areas([[a, a, c], [c, a, c], [a, a, a]])
    np.testing.assert_allclose(areas, [prolate, oblate, 4.0 * np.pi * a * a], rtol=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_slabs_add_up_to_the_whole_surface(kind):
    """The sum is exact to round-off, also for ellipsoids: zones are integrated, whole areas are elliptic integrals."""
    bed = strew(kind, 12, 3)
    edges = np.linspace(-0.01, 0.07, 24)
    slabs = sum(areas_between(bed, low, high) for low, high in zip(edges[:-1], edges[1:], strict=True))
    np.testing.assert_allclose(slabs, areas_between(bed, edges[0], edges[-1]), rtol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_whole_surfaces_are_those_of_the_meshes(kind):
    """Meshes of polyhedra are exact; those of ellipsoids have an error of 0.2 %."""
    bed = strew(kind, 6, 1)
    meshes = [trimesh.Trimesh(each.vertices, each.faces, process=False) for each in surfaces(bed, divisions=4)]
    np.testing.assert_allclose(surface_areas(bed), [mesh.area for mesh in meshes], rtol=2e-3)
    np.testing.assert_allclose(areas_between(bed, -1.0, 1.0), surface_areas(bed), rtol=1e-12)


def test_the_zone_of_a_flat_ellipsoid_is_that_of_points_on_it():
    """Points on the unit sphere are weighted with the area element; 4 standard errors of 200 000 points are allowed."""
    half, turn = np.array([1e-3, 3e-3, 8e-3]), np.array([[0.5, 0.5, -0.1, 0.7]])
    bed = make_packing([[0.0, 0.0, 0.01]], half[None], turn / np.linalg.norm(turn))
    u = np.random.default_rng(2).normal(size=(200_000, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    w, x, y, z = (turn / np.linalg.norm(turn))[0]
    third_row = np.array([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)])
    height = 0.01 + u @ (third_row * half)
    element = 4.0 * np.pi * half.prod() * np.linalg.norm(u / half, axis=1)
    inside = element * ((height > 0.009) & (height < 0.0125))
    error = inside.std() / np.sqrt(len(u))
    assert areas_between(bed, 0.009, 0.0125)[0] == pytest.approx(inside.mean(), abs=4.0 * error)


def test_a_zone_of_a_sphere_is_that_of_its_cylinder():
    bed = make_packing([[0.0, 0.0, 0.01]], 4e-3)
    assert areas_between(bed, 0.007, 0.0113)[0] == pytest.approx(2.0 * np.pi * 4e-3 * 0.0043, rel=1e-14)


def test_an_upright_cube_has_its_sides_and_the_lids_between_the_planes():
    bed = make_packing([[0.0, 0.0, 0.01]], [[8e-3, 6e-3, 4e-3]], vertices=CUBE)
    width, depth, height = np.ptp(CUBE, axis=0) * [8e-3, 6e-3, 4e-3]
    sides = 2.0 * (width + depth)
    assert areas_between(bed, 0.009, 0.010)[0] == pytest.approx(sides * 1e-3, rel=1e-12)
    expected = sides * height / 2.0 + width * depth
    assert areas_between(bed, 0.010, 0.05)[0] == pytest.approx(expected, rel=1e-12)


def test_spheres_of_one_size_have_six_over_their_diameter():
    """The planes pass through the contacts; then a mean over planes at all heights of a period is taken."""
    centres, width = sphere_lattice("sc", 2, 5)
    bed = make_packing(8e-3 * centres, 4e-3, width=8e-3 * width)
    assert specific_surface(bed, 8e-3, 24e-3) == pytest.approx(6.0 / 8e-3, rel=1e-12)
    starts = 8e-3 * (1.0 + np.arange(16) / 16.0)
    area = sum(areas_between(bed, z, z + 12e-3).sum() for z in starts)
    volume = sum(slab_volumes(bed, [z, z + 12e-3], "exact")[0] for z in starts)
    assert area / volume == pytest.approx(6.0 / 8e-3, rel=1e-12)


def test_planes_in_the_wrong_order_and_empty_slabs_are_refused():
    bed = make_packing([[0.0, 0.0, 0.01]], 4e-3)
    with pytest.raises(ValueError, match="in this order"):
        areas_between(bed, 0.02, 0.01)
    with pytest.raises(ValueError, match="no grain is between"):
        specific_surface(bed, 0.02, 0.03)

"""Inserted grains: lattice sites, no overlaps, positions inside the domain, velocities."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist, squareform

from simcore.dem.shapes.polyhedra import collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.packing.insertion.batches import extents
from simcore.packing.insertion.initial_states import initial_states, occupy_sites
from simcore.scene.domain import Domain, lattice_sites
from simcore.scene.scene import Generation
from simcore.scene.shapes import Draw
from tests.helpers.contact_pairs import ALL_FIELDS, update_ellipsoids, update_polyhedra
from tests.helpers.polyhedra import make_pebble

BOX, CYLINDER = Domain("periodic", 0.1, 0.3), Domain("cylinder", 0.1, 0.3)


def test_the_lattice_in_a_cylinder_is_close_packed_with_nearest_distance_h():
    h = 0.012
    sites = lattice_sites(CYLINDER, h, 0.05, 0.2)
    distance = squareform(pdist(sites))
    np.fill_diagonal(distance, np.inf)
    assert distance.min() == pytest.approx(h, rel=1e-12)
    inner = (np.hypot(sites[:, 0], sites[:, 1]) < 0.025) & (np.abs(sites[:, 2] - 0.125) < 0.05)
    assert inner.sum() > 20
    assert ((distance[inner] < 1.0001 * h).sum(axis=1) == 12).all()
    assert (np.hypot(sites[:, 0], sites[:, 1]) <= 0.05 - 0.5 * h).all()
    assert (np.diff(sites[:, 2]) >= 0.0).all()
    assert sites[:, 2].min() >= 0.05 and sites[:, 2].max() <= 0.2


@pytest.mark.parametrize("h", [0.007, 0.012, 0.03, 0.09, 0.2])
def test_the_lattice_in_a_periodic_box_is_never_closer_than_h(h):
    sites = lattice_sites(BOX, h, 0.0, max(3.0 * h, 0.04))
    offset = sites[None] - sites[:, None]
    offset[..., :2] -= 0.1 * np.round(offset[..., :2] / 0.1)
    distance = np.linalg.norm(offset, axis=-1)
    np.fill_diagonal(distance, np.inf)
    if h < 0.1:  # the width of the box: at larger distances, a site is nearer to its own image
        assert distance.min() >= h * (1.0 - 1e-12)
    assert len(np.unique(np.round(sites, 9), axis=0)) == len(sites)
    assert ((sites[:, :2] >= 0.0) & (sites[:, :2] <= 0.2)).all()


@pytest.mark.parametrize("domain", [BOX, CYLINDER], ids=["periodic", "cylinder"])
def test_a_stretched_lattice_has_fewer_sites_by_the_product_of_the_factors(domain):
    whole, stretched = (lattice_sites(domain, 0.004, 0.0, 0.4, *stretch) for stretch in ((), (0.8, 2.5)))
    assert len(stretched) / len(whole) == pytest.approx(1 / (0.8 * 2.5), rel=0.05)
    layers = [np.unique(sites[:, 2]) for sites in (whole, stretched)]
    np.testing.assert_allclose(np.diff(layers[1]), 2.5 * np.diff(layers[0])[: len(layers[1]) - 1], rtol=1e-9)
    rows = [
        np.sort(sites[(sites[:, 2] == 0.0) & np.isclose(sites[:, 1], sites[0, 1]), 0]) for sites in (whole, stretched)
    ]
    assert np.diff(rows[1]).mean() == pytest.approx(0.8 * np.diff(rows[0]).mean(), rel=0.02)
    np.testing.assert_array_equal(whole, lattice_sites(domain, 0.004, 0.0, 0.4, 1.0, 1.0))


def corners(base, scale, rotation):
    """Return surface points of a grain relative to its centre."""
    if len(base.vertices):
        return (base.vertices * scale) @ rotation.T
    u = np.random.default_rng(0).standard_normal((400, 3))
    return (u / np.linalg.norm(u, axis=1, keepdims=True) * scale) @ rotation.T


@pytest.mark.parametrize("domain", [BOX, CYLINDER], ids=["periodic", "cylinder"])
@pytest.mark.parametrize("orientation", ["upright", "random"])
@pytest.mark.parametrize("kind", ["ellipsoid", "polyhedron"])
def test_no_overlap_at_birth(domain, orientation, kind):
    rng = np.random.default_rng(1)
    bases = [unit_sphere()] if kind == "ellipsoid" else [make_pebble(k, 20, (0.5, 0.75, 1.0)) for k in range(3)]
    n = 1500
    size = np.exp(rng.uniform(np.log(0.002), np.log(0.016), n))  # 1 : 8
    scale = size[:, None] * [0.5, 0.75, 1.0] if kind == "ellipsoid" else np.repeat(size[:, None], 3, axis=1)
    drawn = Draw(rng.integers(0, len(bases), n), scale, 2.0 * size, rng.uniform(size=(n, 8)))
    reach, half_height = extents(bases, drawn, orientation == "random")
    sites = lattice_sites(domain, 0.012, 0.05, 0.3)
    taken = occupy_sites(sites, reach, half_height, domain)
    count = len(taken)
    assert count > 100
    assert (np.diff(taken) > 0).all()
    generation = Generation(0.012, "bed", 0.01, -1.0, 0.1, 0.1, orientation)
    states = initial_states(generation, sites[taken], drawn.sieve_size[:count], drawn.uniforms[:count])
    np.testing.assert_allclose(np.linalg.norm(states.orientation, axis=1), 1.0, atol=1e-14)
    still = np.zeros((count, 3))
    bodies = make_bodies(
        bases, drawn.shape[:count], scale[:count], states.position, states.orientation, still, still, 1.0
    )
    width = domain.width if domain.periodic else 0.0
    shapes = collect_shapes(bases)
    contacts = list_candidates(bodies, shapes, Box(width), 0.0025, ALL_FIELDS).contacts
    assert len(contacts.body_a) > 0 or orientation == "random", "no pair was listed, so that the test shows nothing"
    if kind == "ellipsoid":
        update_ellipsoids(None, bodies, contacts, width)
    else:
        update_polyhedra(shapes, bodies, contacts, width)
    assert contacts.touching.sum() == 0
    for i in range(count):
        points = states.position[i] + corners(bases[drawn.shape[i]], scale[i], bodies.rotation[i])
        assert points[:, 2].min() > 0.0
        if not domain.periodic:
            assert np.hypot(points[:, 0], points[:, 1]).max() < 0.5 * domain.width


def test_velocities_and_orientations_of_the_newborn():
    n = 20000
    uniforms = np.random.default_rng(2).uniform(size=(n, 8))
    size = np.full(n, 0.005)
    generation = Generation(0.01, "bed", 0.01, -1.0, 0.1, 0.1, "random")
    states = initial_states(generation, np.zeros((n, 3)), size, uniforms)
    assert (states.velocity[:, 2] == -1.0).all()
    for values, limit in ((states.velocity[:, :2], 0.1), (states.angular_velocity, 0.1 / 0.005)):
        assert np.abs(values).max() <= limit
        # Uniform values have mean 0 and variance limit²/3; both are tested to 5 standard errors.
        assert np.abs(values.mean(axis=0)).max() < 5.0 * limit / np.sqrt(3 * n)
        assert np.abs(values.var(axis=0) / (limit**2 / 3.0) - 1.0).max() < 5.0 * np.sqrt(0.8 / n)
    # Uniform rotations have E[q q^T] = I / 4; the standard error of an entry is below 0.25/√n.
    q = states.orientation
    np.testing.assert_allclose(q.T @ q / n, 0.25 * np.eye(4), atol=5 * 0.25 / np.sqrt(n))

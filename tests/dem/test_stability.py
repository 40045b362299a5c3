"""Limits of the time step, compared with eigenvalues of whole systems, which are assembled here by loops."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem.forces.spring_dashpot import contact_law
from simcore.dem.shapes.polyhedra import ELLIPSOID, SPHERE, Base, unit_sphere
from simcore.dem.spread_contacts import _mean_over_surface, estimate_steps
from simcore.dem.stability import (
    Load,
    body_steps,
    contact_load,
    contact_time,
    minimum_steps_per_contact_time,
    steps_needed,
    stiffest_body,
)
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.features import Features
from simcore.grains.mesh import make_grain

T_C = 1e-3
STUDY = contact_law(0.1, T_C, 0.22, 0.5)
# Least steps per contact time of a mode of s contacts, by Jury's conditions for semi-implicit Euler
MODES = {
    (0.1, 1): 3.414, (0.1, 2): 5.893, (0.1, 4): 10.637, (0.1, 12): 29.190, (0.1, 20): 47.644,
    (0.3, 2): 3.870, (0.3, 12): 16.505, (0.5, 2): 3.071, (0.5, 12): 11.112, (0.9, 2): 2.331, (0.9, 20): 8.161,
}  # fmt: skip
# Least steps of a sphere held by z heavy ones that stick to it: translation, rotation
HELD = {4: (10.19, 15.78), 6: (14.65, 23.00), 8: (19.09, 30.21), 12: (27.95, 44.60)}
DIRECTIONS = {
    4: [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)],
    6: [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
    8: [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    12: [v for x in (-1, 1) for y in (-1, 1) for v in ((x, y, 0), (x, 0, y), (0, x, y))],
}


def near_of(pairs, normals, points, walls=(), images=None):
    """Return contacts and walls with the fields that the stability check reads; walls: (body, normal, point)."""
    pairs = np.array(pairs, np.int64).reshape(-1, 2)
    count = len(pairs)
    contacts = SimpleNamespace(
        body_a=pairs[:, 0],
        body_b=pairs[:, 1],
        touching=np.ones(count, np.uint8),
        direction=np.array(normals, float).reshape(-1, 3),
        point=np.array(points, float).reshape(-1, 3),
        image=np.zeros((0, 2), np.int32) if images is None else np.array(images),
        spread=np.zeros((0, 6)),
    )
    return contacts, SimpleNamespace(
        body=np.array([w[0] for w in walls], np.int64),
        touching=np.ones(len(walls), np.uint8),
        normal=np.array([w[1] for w in walls], float).reshape(-1, 3),
        point=np.array([w[2] for w in walls], float).reshape(-1, 3),
        spread=np.zeros((0, 6)),
    )


def spheres(position, radius, density=1.0):
    position = np.array(position, float)
    n = len(position)
    still, upright = np.zeros((n, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    scale = np.repeat(np.broadcast_to(radius, n)[:, None], 3, axis=1)
    return make_bodies(
        [unit_sphere()],
        np.zeros(n, int),
        scale,
        position,
        upright,
        still,
        still,
        density,
        features=Features(SPHERE, True),
    )


def touching_spheres(position, radius, reach=1.0, width=None):
    """Return pairs of spheres closer than reach times the sum of their radii, and the images (k, 3) in a cube.

    Contacts have no image along z, so the images are returned separately.
    """
    pairs, normals, points, images = [], [], [], []
    shifts = [(0, 0, 0)] if width is None else np.stack(np.meshgrid(*[(-1, 0, 1)] * 3), -1).reshape(-1, 3)
    for a in range(len(position)):
        for b in range(a + 1, len(position)):
            for shift in shifts:
                offset = position[b] - position[a] + np.array(shift) * (width or 0.0)
                distance = np.linalg.norm(offset)
                if distance < reach * (radius[a] + radius[b]):
                    pairs.append((a, b))
                    normals.append(offset / distance)
                    points.append(normals[-1] * radius[a])
                    images.append(shift)
    return near_of(pairs, normals, points), np.array(images)


def whole_system(bodies, near, load, images=None, width=0.0):
    """Return the matrix (6n, 6n) of all bodies, M^-1/2 (h² K + 2 h D) M^-1/2; each contact couples two bodies.

    load: Load, or a function that returns the Load of the contact of bodies a and b.
    """
    n = len(bodies.mass)
    contacts, walls = near
    matrix = np.zeros((6 * n, 6 * n))
    rotation = bodies.rotation if len(bodies.rotation) else np.tile(np.eye(3), (n, 1, 1))

    def feel(i, arm):
        skew = np.array([[0, arm[2], -arm[1]], [-arm[2], 0, arm[0]], [arm[1], -arm[0], 0]])  # ω × r = skew ω
        row = np.zeros((3, 6 * n))
        row[:, 6 * i : 6 * i + 3] = np.eye(3) / np.sqrt(bodies.mass[i])
        row[:, 6 * i + 3 : 6 * i + 6] = skew @ rotation[i] / np.sqrt(bodies.inertia[i])
        return row

    for k in range(len(contacts.body_a)):
        a, b, normal = contacts.body_a[k], contacts.body_b[k], contacts.direction[k]
        offset = bodies.position[b] - bodies.position[a] + (0.0 if images is None else images[k] * width)
        rows = feel(b, contacts.point[k] - offset) - feel(a, contacts.point[k])
        mass = bodies.mass[a] * bodies.mass[b] / (bodies.mass[a] + bodies.mass[b])
        along, of_pair = np.outer(normal, normal), load(a, b) if callable(load) else load
        matrix += mass * rows.T @ (of_pair.normal * along + of_pair.tangential * (np.eye(3) - along)) @ rows
    for i, normal, arm in zip(walls.body, walls.normal, walls.point, strict=True):
        rows, along = feel(i, arm), np.outer(normal, normal)
        matrix += bodies.mass[i] * rows.T @ (load.normal * along + load.tangential * (np.eye(3) - along)) @ rows
    return matrix


def random_heap(seed, n=8):
    """Return positions and radii of spheres of sizes 1 to 4, drawn together until many touch."""
    rng = np.random.default_rng(seed)
    radius = rng.uniform(1.0, 4.0, n)
    position = rng.uniform(-4.0, 4.0, (n, 3))
    for _ in range(300):
        for a in range(n):
            for b in range(n):
                offset = position[b] - position[a]
                distance = np.linalg.norm(offset)
                if a != b and distance < radius[a] + radius[b]:
                    position[b] += 0.5 * (radius[a] + radius[b] - distance) * offset / distance
        position *= 0.995
    return position, radius


@pytest.mark.parametrize("restitution, s", MODES)
def test_modes_of_some_contacts(restitution, s):
    law = contact_law(restitution, T_C, 0.22, 0.0)
    assert contact_time(law) == pytest.approx(T_C, rel=1e-12)
    assert steps_needed(law, False, lambda load: s * load.normal) == pytest.approx(MODES[restitution, s], abs=6e-4)


def test_a_pinched_grain_is_what_the_scene_refuses():
    """The limits before and during a run use the same dashpot."""
    for restitution in (0.1, 0.5, 0.9):
        law = contact_law(restitution, T_C, 0.22, 0.0)
        needed = steps_needed(law, False, lambda load: 2.0 * load.normal)
        assert needed == pytest.approx(minimum_steps_per_contact_time(law), rel=1e-9)


@pytest.mark.parametrize("z", HELD)
def test_a_light_sphere_among_heavy_ones(z):
    normals = np.array(DIRECTIONS[z], float)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    bodies = spheres(np.vstack([[0, 0, 0], 2.0 * normals]), 1.0)
    bodies.mass[1:] *= 1e9
    bodies.inertia[1:] *= 1e9
    near = near_of([(0, k + 1) for k in range(z)], normals, normals)
    found = stiffest_body(bodies, near, 0.0, contact_load(STUDY, T_C / 40))
    assert (found.body, found.contacts) == (0, z)
    translation, rotation = HELD[z]
    assert body_steps(bodies, near, 0.0, STUDY, True, 0) == pytest.approx(rotation, abs=0.006)
    # Without friction nothing resists the rotation, and z / 3 normals resist motion in each direction.
    law = STUDY._replace(friction=0.0)
    s = steps_needed(law, False, lambda load: z / 3.0 * load.normal)
    assert body_steps(bodies, near, 0.0, law, False, 0) == pytest.approx(s, rel=1e-9)
    assert s < translation < rotation
    # An implicit dashpot is weaker for a body of more effective contacts, which weigh heavy neighbours more.
    bodies = bodies._replace(effective_contacts=np.full(z + 1, 1.9 * z))
    s = steps_needed(law, False, lambda load: z / 3.0 * load.normal, 1.9 * z)
    assert body_steps(bodies, near, 0.0, law, False, 0, implicit=True) == pytest.approx(s, rel=1e-9)
    assert s < 0.99 * steps_needed(law, False, lambda load: z / 3.0 * load.normal, z)


def test_an_estimate_of_spheres_and_of_longer_grains():
    """For spheres of any sizes it is that of twelve heavy neighbours in the table. Longer grains have longer arms."""
    sphere, shape = [unit_sphere()], np.zeros(50, int)
    scale = np.geomspace(1e-3, 1.0, 50)[:, None] * np.ones(3)
    estimate = estimate_steps(STUDY, True, sphere, shape, scale)
    assert estimate.cautious == pytest.approx(HELD[12][1], abs=0.02)
    assert estimate.expected == pytest.approx(0.75 * HELD[12][1], rel=0.02)  # nearly in proportion to the contacts
    scale[30] *= [0.5, 0.75, 1.0]
    assert estimate_steps(STUDY, True, sphere, shape, scale).cautious > estimate.cautious
    free = estimate_steps(STUDY, False, sphere, shape[:1], scale[:1])
    assert free.cautious == pytest.approx(steps_needed(STUDY, False, lambda load: 4.0 * load.normal), rel=1e-3)


def hull_base(points):
    """Return the base of the convex hull of points (n, 3)."""
    grain = make_grain("grain", np.asarray(points, float))
    return Base(grain.name, grain.vertices, grain.faces, grain.volume, grain.second_moments)


TETRAHEDRON = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]


def test_contacts_at_corners_are_those_of_few_corners():
    """The estimate of a tetrahedron agrees with random contacts, half of them at corners and half on the faces."""
    base, rng = hull_base(TETRAHEDRON), np.random.default_rng(1)
    arm = 1.0 / np.sqrt(base.second_moments.sum() - base.second_moments)
    corners = base.vertices[base.faces]
    matrix, n = np.zeros((6, 6)), 20_000
    load = Load(1.0, 0.7, 0.0)
    for k in range(n):
        face = corners[rng.integers(len(corners))]  # all are equally large
        point = face[rng.integers(3)] if k % 2 else rng.dirichlet(np.ones(3)) @ face
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        normal /= np.linalg.norm(normal)
        rows = np.hstack([np.eye(3), np.cross(point, np.eye(3)) * arm])
        along = np.outer(normal, normal)
        matrix += rows.T @ (load.normal * along + load.tangential * (np.eye(3) - along)) @ rows / n
    normal, tangential = _mean_over_surface(base, np.ones(3))
    expected = np.linalg.eigvalsh(load.normal * normal + load.tangential * tangential)[-1]
    assert expected == pytest.approx(np.linalg.eigvalsh(matrix)[-1], rel=0.03)


def test_estimates_of_grains_with_few_corners_are_above_what_their_beds_needed():
    """Tetrahedra and splinters of five corners needed 52 to 63 steps. Round polyhedra need as many as spheres."""
    splinter = [[0, 0, 0], [9, 0, 0.4], [8, 3, 0], [1, 4, 0.3], [4, 2, 2.5]]
    for points in (TETRAHEDRON, splinter):
        estimate = estimate_steps(STUDY, True, [hull_base(points)], [0], np.ones((1, 3)))
        assert estimate.expected > 63.0 and estimate.cautious > 1.35 * 63.0
    ball = np.random.default_rng(2).standard_normal((200, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    many = estimate_steps(STUDY, True, [hull_base(ball)], [0], np.ones((1, 3)))
    sphere = estimate_steps(STUDY, True, [unit_sphere()], [0], np.ones((1, 3)))
    assert many.expected == pytest.approx(sphere.expected, rel=0.03)


def test_the_end_of_a_rod_is_four_contacts():
    """m r² / I of a thin box about its middle is 3: a contact at its end weighs 1 + 3."""
    length, thin = 1.0, 1e-4
    moments = np.array([thin**2, thin**2, length**2]) / 12.0
    rod = Base("rod", np.zeros((0, 3)), np.zeros((0, 3), np.int64), thin**2 * length, moments)
    turned = Rotation.from_euler("xyz", [0.3, -0.8, 0.5])
    still = np.zeros((1, 3))
    orientation = turned.as_quat(scalar_first=True)[None]
    bodies = make_bodies(
        [rod], [0], np.ones((1, 3)), still, orientation, still, still, 1.0, features=Features(ELLIPSOID, True)
    )
    normal, end = turned.apply([1.0, 0.0, 0.0]), turned.apply([0.0, 0.0, 0.5 * length])
    near = near_of([], [], [], walls=[(0, normal, end)])
    assert stiffest_body(bodies, near, 0.0, Load(1.0, 0.0, 0.0)).load == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize("certain", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_bodies_alone_bound_the_whole_heap(seed, certain):
    """Fixed neighbours give a lower bound, shares an upper one; both are within a factor of two here."""
    position, radius = random_heap(seed)
    bodies = spheres(position, radius)
    near, _ = touching_spheres(position, radius, reach=1.1)
    assert len(near[0].body_a) > 8
    load = contact_load(STUDY, T_C / 40)
    whole = np.linalg.eigvalsh(whole_system(bodies, near, load))[-1]
    alone = stiffest_body(bodies, near, 0.0, load, certain).load
    if certain:
        assert 0.5 * whole <= alone * (1.0 + 1e-12) and alone <= whole * (1.0 + 1e-12)
    else:
        assert whole <= alone * (1.0 + 1e-12) and alone <= 2.0 * whole


@pytest.mark.parametrize("seed", range(5))
def test_the_stiffest_body_with_implicit_dashpots_has_those_of_its_own_contacts(seed):
    """The dashpot of a pair follows from the effective contacts of both; a diagonal block has its neighbours fixed."""
    position, radius = random_heap(seed)
    number = np.random.default_rng(seed).uniform(0.5, 9.0, len(radius))
    bodies = spheres(position, radius)._replace(effective_contacts=number)
    near, _ = touching_spheres(position, radius, reach=1.1)

    def loads(dt):
        whole = whole_system(bodies, near, lambda a, b: contact_load(STUDY, dt, True, max(1.0, number[a], number[b])))
        return [np.linalg.eigvalsh(whole[k : k + 6, k : k + 6])[-1] for k in range(0, len(whole), 6)]

    dt = T_C / 10
    found = stiffest_body(bodies, near, 0.0, lambda effective: contact_load(STUDY, dt, True, effective))
    assert (found.body, found.load) == (np.argmax(loads(dt)), pytest.approx(max(loads(dt)), rel=1e-12))
    for body in range(len(radius)):
        steps = body_steps(bodies, near, 0.0, STUDY, True, body, implicit=True)
        assert loads(T_C / steps)[body] == pytest.approx(4.0, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_the_step_turns_unstable_where_the_largest_load_is_four(seed):
    """The limit is that of a step's spectral radius; tangential dashpots are not proportional to springs."""
    position, radius = random_heap(seed)
    bodies = spheres(position, radius)
    near, _ = touching_spheres(position, radius, reach=1.1)
    steps = steps_needed(STUDY, True, lambda load: np.linalg.eigvalsh(whole_system(bodies, near, load))[-1])
    spring = whole_system(bodies, near, Load(STUDY.stiffness, STUDY.tangential * STUDY.stiffness, 0.0))
    dashpot = whole_system(bodies, near, Load(STUDY.damping, STUDY.root_tangential * STUDY.damping, 0.0))
    eye = np.eye(len(spring))
    for factor in (0.999, 1.001):
        h = factor * T_C / steps
        velocity = np.hstack([-h * spring, eye - h * dashpot])
        step = np.vstack([np.hstack([eye, 0.0 * eye]) + h * velocity, velocity])
        beyond = np.abs(np.linalg.eigvals(step)).max() > 1.0 + 1e-6  # contacts leave some motions free: |λ| = 1
        assert beyond == (factor > 1.0)


def test_the_shares_are_exact_in_the_densest_packing():
    """In a frictionless FCC packing the mode at the zone boundary has the load of four contacts."""
    edge = 2.0 * np.sqrt(2.0)
    corner = np.stack(np.meshgrid(*[np.arange(2)] * 3), -1).reshape(-1, 1, 3)
    basis = 0.5 * np.array([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]])
    position = edge * (corner + basis).reshape(-1, 3)
    near, images = touching_spheres(position, np.ones(32), reach=1.01, width=2.0 * edge)
    assert len(near[0].body_a) == 32 * 6
    bodies = spheres(position, 1.0)
    only_normal = Load(1.0, 0.0, 0.0)
    whole = np.linalg.eigvalsh(whole_system(bodies, near, only_normal, images, 2.0 * edge))[-1]
    assert whole == pytest.approx(4.0, rel=1e-12)
    # A third of twelve contacts resists motion in each direction, with whole or half weight. Arms of zero cause no
    # rotation.
    bodies.position[:] = 0.0
    near[0].point[:] = 0.0
    for certain, load in ((False, 4.0), (True, 2.0)):
        assert stiffest_body(bodies, near, 0.0, only_normal, certain).load == pytest.approx(load, rel=1e-12)


def test_a_patch_resists_what_turns_about_it():
    """On a square patch of side 2 c a dashpot with c² / 3 resists rocking, and a spring with 2 c² / 3 twisting."""
    c = 0.5
    box = Base("box", np.zeros((0, 3)), np.zeros((0, 3), np.int64), 8.0 * c**3, np.full(3, c**2 / 3.0))
    still, upright = np.zeros((1, 3)), [[1.0, 0.0, 0.0, 0.0]]
    bodies = make_bodies(
        [box], [0], np.ones((1, 3)), still, upright, still, still, 1.0, features=Features(ELLIPSOID, True)
    )
    contacts, walls = near_of([], [], [], walls=[(0, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))])
    contacts.spread, walls.spread = np.zeros((0, 6)), np.array([[c**2 / 3, c**2 / 3, 0, 0, 0, 0]])
    # I / m = 2 c² / 3: rocking weighs half the dashpot, twisting as much as the tangential load.
    for load, expected in ((Load(0.0, 0.0, 1.0), 0.5), (Load(0.0, 1.0, 0.0), 1.0)):
        found = stiffest_body(bodies, (contacts, walls), 0.0, load).load
        assert found == pytest.approx(expected, rel=1e-12)


def test_nothing_touches():
    bodies = spheres([[0.0, 0.0, 0.0]], 1.0)
    found = stiffest_body(bodies, near_of([], [], []), 0.0, contact_load(STUDY, 1e-5))
    assert found == (-1, 0, 0.0)

"""Bodies, contacts and walls: structures of arrays with all state on which later steps depend.

Bodies are sorted by id. On a single rank the id is the index. On several ranks each rank stores the bodies that it
moves and, among them, ghosts: copies of the bodies of other ranks that they may touch. Centres are not wrapped into the
periodic box; each pair has an integer image instead, so that its relative position is the same on every rank.
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.shapes.polyhedra import POLYHEDRON, SPHERE, Base

FLOOR, CYLINDER = 0, 1  # walls, as Walls.wall numbers them


class Bodies(NamedTuple):
    """n bodies. Derived fields follow from others and are stored so that a step computes them once.

    Fields marked with a kind are empty, (0, ...), in scenes of other kinds. Scenes of mixed kinds have all fields, but
    the form matrix of polyhedra is not updated there.
    """

    id: np.ndarray  # (n,) int64, in the whole packing
    own: np.ndarray  # (k,) int64, rows of the bodies that this rank moves; the others are ghosts
    shape: np.ndarray  # (n,) int64, index of the base shape
    scale: np.ndarray  # (n, 3)
    position: np.ndarray  # (n, 3) [m], not wrapped
    orientation: np.ndarray  # (n, 4) unit quaternion (w, x, y, z), body to world; not for spheres
    velocity: np.ndarray  # (n, 3) [m/s]
    angular_momentum: np.ndarray  # (n, 3) [kg m²/s], world axes
    mass: np.ndarray  # (n,) [kg]
    inertia: np.ndarray  # (n, 3) [kg m²], principal
    radius: np.ndarray  # (n,) [m], of the bounding sphere about the centre
    turned: np.ndarray  # (n,) [m], upper bound of the path of any point by rotation since the start; not for spheres
    margin: np.ndarray  # (n,) [m], distance that points of the body may move before the next listing
    listed_position: np.ndarray  # (n, 3) [m], position at the last listing
    listed_turned: np.ndarray  # (n,) [m], `turned` at the last listing; not for spheres
    rotation: np.ndarray  # (n, 3, 3), derived: matrix of the orientation; not for spheres
    angular_velocity: np.ndarray  # (n, 3) [1/s], derived, world axes
    form_matrix: np.ndarray  # (n, 6) [m²], derived: R diag(s²) Rᵀ as xx, yy, zz, xy, xz, yz; of ellipsoids
    net_force: np.ndarray  # (n, 3) [N], output: of contacts and gravity, without shaking
    # (n,), remembered: contacts of the last step, weighted by how much each moves this body; implicit dashpot
    effective_contacts: np.ndarray

    @property
    def ghosts(self) -> np.ndarray:
        """Rows (n − k,) of the bodies that other ranks move."""
        return np.flatnonzero(~self.moves_here)

    @property
    def moves_here(self) -> np.ndarray:
        """Whether this rank moves each body, (n,) bool."""
        here = np.zeros(len(self.mass), np.bool_)
        here[self.own] = True
        return here


class Contacts(NamedTuple):
    """Candidate pairs in the order of their key (a, b, image), a < b or a = b with a positive image.

    Remembered fields are results of the last step that the next step reuses. Output fields are results of the last step
    of a call of `advance` that did all its steps (simcore.dem.step.step), and 0 of pairs that are apart; of spheres the
    same holds for `direction`. Fields marked with a feature are empty in scenes without it.
    `facet` of two polyhedra is the facet of the Minkowski difference along the normal if the pair touches, and the
    simplex nearest to the origin if it is apart. For a polyhedron and an ellipsoid it is the corner, edge or face a0 a1
    a2 of the polyhedron. For polyhedra that touch, `apart_at` and `safe_until` give the range of motion within which no
    other facet can have become the nearest.
    """

    body_a: np.ndarray  # (m,) int32
    body_b: np.ndarray  # (m,) int32
    image: np.ndarray  # (m, 2) int32: the partner is body b shifted by image × width; periodic
    touching: np.ndarray  # (m,) uint8
    pending: np.ndarray  # (m,) uint8, within a step: a search must follow the check; not for spheres
    direction: np.ndarray  # (m, 3), remembered: last normal or separating direction; zero if there is none
    facet: np.ndarray  # (m, 6) int32, remembered: vertices a0 a1 a2 b0 b1 b2, -1 for none; polyhedra, mixed
    apart_at: np.ndarray  # (m, 3) [m], remembered: relative position at the last certain gap; not for spheres
    safe_until: np.ndarray  # (m,) [m], remembered: apart while |moved since apart_at| + turned_a + turned_b is below
    spring: np.ndarray  # (m, 3) [m], remembered: tangential spring; friction
    twist: np.ndarray  # (m,), remembered: angle of the torsional spring of a patch about its normal; patch, friction
    stuck: np.ndarray  # (m,) uint8, remembered: whether the contact stuck in the last step; preloaded
    overlap: np.ndarray  # (m,) [m], output; of a pair apart remembered: minus the gap of the last search
    point: np.ndarray  # (m, 3) [m], output: contact point relative to the centre of a
    spread: np.ndarray  # (m, 6) [m²], output: second moments xx yy zz xy xz yz of the patch, 0 for a point; patch
    force: np.ndarray  # (m, 3) [N], output: on b; a gets the opposite
    torque_a: np.ndarray  # (m, 3) [N m], output
    torque_b: np.ndarray  # (m, 3) [N m], output
    incident_start: np.ndarray  # (n + 1,) int64: contacts of body i, in order of (partner, image)
    incident: np.ndarray  # (2 m,) int32: 2 × contact, + 1 where the body is b


class Walls(NamedTuple):
    """Bodies near a wall, in order of (body, wall); the fields correspond to those of Contacts."""

    body: np.ndarray  # (w,) int32
    wall: np.ndarray  # (w,) int32: FLOOR or CYLINDER
    touching: np.ndarray  # (w,) uint8
    vertex: np.ndarray  # (w,) int32, remembered: vertex that was lowest, from which the climb to the floor starts
    spring: np.ndarray  # (w, 3) [m], remembered; friction
    twist: np.ndarray  # (w,), remembered; patch with friction
    stuck: np.ndarray  # (w,) uint8, remembered; preloaded
    overlap: np.ndarray  # (w,) [m], output
    normal: np.ndarray  # (w, 3), output: from the wall into the body
    point: np.ndarray  # (w, 3) [m], output: contact point relative to the centre of the body
    spread: np.ndarray  # (w, 6) [m²], output; patch
    force: np.ndarray  # (w, 3) [N], output: on the body
    torque: np.ndarray  # (w, 3) [N m], output
    start: np.ndarray  # (n + 1,) int64: walls of body i


def make_bodies(
    bases: list[Base], shape, scale, position, orientation, velocity, angular_velocity, density, *, features=None
) -> Bodies:
    """Return new bodies of the given density [kg/m³]; `turned` is zero.

    shape (n,), scale (n, 3), position (n, 3), orientation (n, 4), velocity (n, 3), angular_velocity (n, 3), SI.
    features: of the scene; fields that it does not need stay empty. None: all fields.
    """
    shape = np.asarray(shape, np.int64)
    # The arrays are copied to C order, because another layout is another type, for which the step would be compiled.
    scale, position, orientation, velocity, angular_velocity = (
        np.array(field, np.float64, order="C") for field in (scale, position, orientation, velocity, angular_velocity)
    )
    n = len(shape)
    base_volume = np.array([base.volume for base in bases])
    base_moments = np.array([base.second_moments for base in bases]).reshape(-1, 3)
    mass = density * base_volume[shape] * scale.prod(axis=1)
    moments = mass[:, None] * base_moments[shape] * scale**2
    orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
    bodies = Bodies(
        id=np.arange(n),
        own=np.arange(n),
        shape=shape,
        scale=scale,
        position=position,
        orientation=orientation,
        velocity=velocity,
        angular_momentum=np.zeros((n, 3)),
        mass=mass,
        inertia=moments.sum(axis=1, keepdims=True) - moments,
        radius=_bounding_radius(bases, shape, scale),
        turned=np.zeros(n),
        margin=np.zeros(n),
        listed_position=position.copy(),
        listed_turned=np.zeros(n),
        rotation=rotation_matrix(orientation),
        angular_velocity=angular_velocity,
        form_matrix=np.zeros((n, 6)),
        net_force=np.zeros((n, 3)),
        effective_contacts=np.zeros(n),
    )
    spin = np.einsum("nji,nj->ni", bodies.rotation, bodies.angular_velocity)
    bodies.angular_momentum[:] = np.einsum("nij,nj->ni", bodies.rotation, bodies.inertia * spin)
    full = np.einsum("nij,nj,nkj->nik", bodies.rotation, scale**2, bodies.rotation)
    bodies.form_matrix[:] = full[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    if features is None:
        return bodies
    if not features.implicit:
        bodies = without(bodies, "effective_contacts")
    if features.kind == SPHERE:
        return without(bodies, "orientation", "turned", "listed_turned", "rotation", "form_matrix")
    if features.kind == POLYHEDRON:
        return without(bodies, "form_matrix")
    return bodies


def without(group, *names):
    """Return a copy of a NamedTuple of arrays without the rows of the named ones; the compiled types stay the same."""
    return group._replace(**{name: getattr(group, name)[:0].copy() for name in names})


def join_bodies(bodies: Bodies, added: Bodies) -> Bodies:
    """Return `bodies` followed by `added`, whose ids must be higher; this rank moves all of them."""
    both = Bodies(*(np.concatenate(fields) for fields in zip(bodies, added, strict=True)))
    return both._replace(own=np.arange(len(both.mass)))


def rotation_matrix(orientation) -> np.ndarray:
    """Return the matrices (n, 3, 3), body to world, of unit quaternions (n, 4)."""
    w, x, y, z = np.asarray(orientation).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.ascontiguousarray(np.moveaxis(np.array(rows), -1, 0))


def _bounding_radius(bases: list[Base], shape: np.ndarray, scale: np.ndarray) -> np.ndarray:
    radius = scale.max(axis=1)
    for index, base in enumerate(bases):
        rows = np.flatnonzero(shape == index)
        if len(base.vertices):
            for row in rows:
                radius[row] = np.sqrt(((base.vertices * scale[row]) ** 2).sum(axis=1).max())
    return radius

"""Stability limits of the time step: for a grain in its contacts, for a whole bed, and an estimate for a scene.

Semi-implicit Euler, v' = v − h (K x + D v), x' = x + h v', per unit of mass, is central differences with the mass
I − h D / 2 and a dashpot in the middle of the step. It loses energy in every mode as long as 4 − (h² K + 2 h D) is
positive definite; when an eigenvalue vanishes, its mode alternates from step to step. A system is therefore stable
while the largest eigenvalue of h² K + 2 h D is below 4, whether or not K and D have the same modes. The load of a
contact is its part of that matrix: for one direction m_eff (h² k + 2 h d).

For a body between fixed neighbours the matrix has six rows, and its largest eigenvalue is at most that of the whole bed
(interlacing). Beyond the limit of such a body the bed is certainly unstable while its contacts stick. For all bodies
together, |u_a − u_b|² <= (1 + t) |u_a|² + (1 + 1/t) |u_b|² divides each contact between its two bodies; with
t = √(m_a / m_b) this is exact for two equal bodies and for the densest packing of equal spheres, and at most 1.21 times
too large for two others. Below the limit of every body with such shares, the bed is certainly stable.

The contacts of a bed are those of one moment. Slipping contacts are treated as if their springs still acted, and the
effect of the rotation of a patch on its depth is left out.
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.forces.spring_dashpot import ContactLaw, explicit_dashpot, implicit_dashpot, implicit_law
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.shapes.polyhedra import Base
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs

LARGEST_LOAD = 4.0  # eigenvalue at which a mode alternates undamped
BODIES_EXAMINED = 32  # number of bodies whose eigenvalues are computed; they are selected by the sums of eigenvalues
# Number of contacts, each as stiff as one with a wall, spread over the surface of the stiffest grain: at most about six
# among fixed neighbours. ASSUME: 1.5 times as many in a bed, where neighbours move too, and at most twice as many.
# Measurements: docs/explanation/stability.md, "Contacts of the stiffest grain".
EXPECTED_CONTACTS, CAUTIOUS_CONTACTS = 9, 12
# With the probability AT_CORNERS a contact of a polyhedron with at most POINTED corners is at a corner, otherwise
# anywhere on its faces. From BLUNT corners on, all contacts are spread over the faces. Measurements:
# docs/explanation/stability.md, "Grains of few corners".
AT_CORNERS, POINTED, BLUNT = 0.5, 8, 24
SAMPLE = 200  # maximum number of grains whose form enters the estimate
DIRECTIONS = 256  # points on the surface of an ellipsoid


class Load(NamedTuple):
    """The part of a contact in h² K + 2 h D, per effective mass."""

    normal: float
    tangential: float  # 0 without friction
    rocking: float  # of a patch, per area; rocking has a dashpot and no spring of its own
    sliding: float = 0.0  # along the tangent, of a friction that has a dashpot and no spring


class Stiffest(NamedTuple):
    """The body with the largest load."""

    body: int
    contacts: int
    load: float  # its largest eigenvalue; stable below LARGEST_LOAD


class Estimate(NamedTuple):
    """Minimum steps per contact time of a scene, from the form of its grains and the contact law.

    With fewer steps than `expected`, the stiffest grains are likely to vibrate: they gain energy until contacts slip or
    open, and the bed may not come to rest. Between the two values, which include the 40 explicit steps of Rettinger et
    al. (2022), a mode may be unstable if a small grain is held by many neighbours that are heavier or move against it.
    Such modes are rare and short, because few grains fit so well; friction and damping remove the energy that they
    gain.
    """

    expected: float
    cautious: float


def contact_load(law: ContactLaw, dt: float, friction: bool = True, effective_contacts: float | None = None) -> Load:
    """Return the load of a contact at a time step [s]; no other function depends on how a dashpot enters the step.

    law: the continuous one. effective_contacts: with an implicit dashpot, the effective contacts of the body, or of
    each of several bodies (n,), for which the loads are arrays; None with an explicit dashpot.
    """
    if effective_contacts is not None:
        law = implicit_law(law, dt)
    normal, across = (
        explicit_dashpot.py_func(law)
        if effective_contacts is None
        else implicit_dashpot.py_func(law, np.maximum(effective_contacts, 1.0))
    )
    spring, dashpot = law.stiffness * dt**2, 2.0 * normal * dt
    along = law.tangential * spring + 2.0 * across * dt if friction else 0.0
    return Load(spring + dashpot, along, dashpot, 2.0 * law.sliding * dt)


def contact_time(law: ContactLaw) -> float:
    """Return the contact time [s] of the law."""
    return float(2.0 * np.pi / np.sqrt(4.0 * law.stiffness - law.damping**2))


def minimum_steps_per_contact_time(law: ContactLaw, implicit: bool = False, **mode: float) -> float:
    """Return the steps per contact time at which a mode is just stable; arguments as in longest_stable_step."""
    return contact_time(law) / longest_stable_step(law, implicit, **mode)


def longest_stable_step(
    law: ContactLaw, implicit: bool, contacts: float = 2.0, normal: float | None = None, tangential: float = 0.0
) -> float:
    """Return the time step [s] at which semi-implicit Euler is just stable for a mode of a grain.

    law: the continuous one. contacts: number of contacts of the grain; ValueError if less than 1.
    normal, tangential: number of springs of each kind that act on the mode, per effective mass. None: all contacts lie
    on one line; a grain pinched between two others, which occurs in any bed, has two of them. A sphere evenly
    surrounded by z fixed spheres has z / 3 and 2 z / 3 in translation, 0 and 5 z / 3 in rotation.

    With stiffness K and damping D of the mode its motion is u' = -K x - D u, x' = u, and semi-implicit Euler is stable
    if 4 - 2 D h - K h² > 0 (Jury's conditions). For s contacts along a line the limit with an explicit dashpot is
    h = (√(γ² + 4 ω² / s) - γ) / ω². With an implicit one it is the positive root of
    (4 + 2 (s - 1) γ h) (1 + γ h / 2) = s ω² h² (1 + (s - 1/2) γ h), which is h = 2 / ω for s = 1.
    """
    from scipy.optimize import brentq  # imported here because it loads slowly and finished packings do not need it

    if contacts < 1.0:
        raise ValueError(f"A mode needs at least one contact, but contacts is {contacts:g}.")
    normal = contacts if normal is None else normal

    def margin(h):
        at_step = implicit_law(law, h) if implicit else law
        dashpots = implicit_dashpot.py_func(at_step, contacts) if implicit else explicit_dashpot.py_func(law)
        stiffness = (normal + tangential * at_step.tangential) * at_step.stiffness
        return 4.0 - 2.0 * h * (normal * dashpots[0] + tangential * dashpots[1]) - h * h * stiffness

    # The margin decreases monotonically with h, because both h D and h² K grow.
    beyond = 1.0 / np.sqrt(law.stiffness)
    while margin(beyond) > 0.0:
        beyond *= 2.0
    return float(brentq(margin, 0.0, beyond, xtol=1e-12 * beyond))


def steps_needed(
    law: ContactLaw, friction: bool, load_at, effective_contacts: float | None = None, time: float | None = None
) -> float:
    """Return the minimum steps per contact time at which load_at(Load) is at most LARGEST_LOAD.

    load_at: must grow with each field of Load. law, effective_contacts: as in contact_load. time [s]: used instead of
    the contact time of the law.
    """
    time = contact_time(law) if time is None else time
    few, many = 1e-3, 1.0
    while load_at(contact_load(law, time / many, friction, effective_contacts)) > LARGEST_LOAD:
        few, many = many, 2.0 * many
    for _ in range(50):
        steps = 0.5 * (few + many)
        if load_at(contact_load(law, time / steps, friction, effective_contacts)) > LARGEST_LOAD:
            few = steps
        else:
            many = steps
    return many


def stiffest_body(
    bodies: Bodies,
    candidates: CandidatePairs,
    width: float,
    load: Load,
    certain: bool = True,
    ranks=ONE_RANK,
    stiffness_factor=None,
) -> Stiffest:
    """Find the body (its id) with the largest load in its present contacts; body −1 if nothing touches.

    width [m]: of the periodic box. certain: True: neighbours are fixed, and the load is a lower bound for that of the
    whole bed; False: shares of the contacts make it an upper bound. Only the BODIES_EXAMINED bodies with the largest
    sums of eigenvalues, that is with many contacts or long lever arms, are evaluated.
    stiffness_factor(mass, mass of the partner, overlap), each (k,) -> (k,): factor on the springs and dashpots of
    contacts relative to `load`; the mass of a wall is inf. None: the factor is 1.
    """
    grips = _grips(bodies, candidates, width, certain, stiffness_factor)
    traces, contacts = _traces(bodies, grips, load), np.bincount(grips.body, minlength=len(bodies.mass))
    touching = bodies.own[contacts[bodies.own] > 0]
    rows = touching[np.argsort(-traces[touching], kind="stable")[:BODIES_EXAMINED]]
    # The selection is made over all ranks, so that it does not depend on how the bodies are distributed.
    best = sorted(ranks.all([(-traces[row], bodies.id[row]) for row in rows]))[:BODIES_EXAMINED]
    ids = {id_ for _, id_ in best}
    rows = np.array([row for row in rows if bodies.id[row] in ids], np.int64)
    loads = np.linalg.eigvalsh(_matrices(bodies, grips, load, rows))[:, -1]
    largest_load, body, contacts = ranks.largest(loads, bodies.id[rows], contacts[rows])
    return Stiffest(body, int(contacts or 0), max(largest_load, 0.0))


def body_steps(
    bodies: Bodies,
    candidates: CandidatePairs,
    width: float,
    law: ContactLaw,
    friction: bool,
    body: int,
    *,
    certain: bool = True,
    implicit: bool = False,
    ranks=ONE_RANK,
    stiffness_factor=None,
    time: float | None = None,
) -> float:
    """Return the minimum steps per contact time of one body (its id) in its present contacts; see `stiffest_body`.

    law: as in contact_load. implicit: whether dashpots are implicit; the bodies then have their effective contacts.
    time: as in steps_needed.
    """
    rows = np.flatnonzero(bodies.id[bodies.own] == body)
    needed = []
    for row in bodies.own[rows]:
        grips = _grips(bodies, candidates, width, certain, stiffness_factor)
        effective_contacts = bodies.effective_contacts[row] if implicit else None
        needed.append(_steps_of_row(bodies, grips, law, friction, row, effective_contacts, time))
    return float(ranks.maximum([max(needed, default=0.0)])[0])


def _steps_of_row(bodies, grips, law, friction, row, effective_contacts, time):
    """Return the minimum steps per contact time of the body in this row."""
    # The matrix is linear in the load.
    parts = [_matrices(bodies, grips, Load(*unit), np.array([row]))[0] for unit in np.eye(len(Load._fields))]

    def load_at(load):
        return np.linalg.eigvalsh(sum(value * part for value, part in zip(load, parts, strict=True)))[-1]

    return steps_needed(law, friction, load_at, effective_contacts, time)


def estimate_steps(
    law: ContactLaw, friction: bool, bases: list[Base], shape, scale, time: float | None = None
) -> Estimate:
    """Estimate the minimum steps per contact time of a bed of grains of shape (n,) and scale (n, 3).

    With explicit dashpots; simcore.dem.random_contacts is for implicit ones. The estimate is the largest over the forms
    of the grains, with EXPECTED_CONTACTS and CAUTIOUS_CONTACTS, which are more than fit around a grain. Contacts are
    equally probable on every part of the surface of a grain. time: as in steps_needed.
    """
    sample = np.unique(np.linspace(0, len(shape) - 1, min(SAMPLE, len(shape))).astype(int))
    parts = [_mean_over_surface(bases[shape[i]], scale[i]) for i in sample]
    normal, tangential = (np.array([part[k] for part in parts]) for k in range(2))

    def load_at(load):
        across = load.tangential + load.sliding
        return np.linalg.eigvalsh(load.normal * normal + across * tangential)[:, -1].max()

    return Estimate(
        *(
            steps_needed(law, friction, lambda load, count=count: count * load_at(load), time=time)
            for count in (EXPECTED_CONTACTS, CAUTIOUS_CONTACTS)
        )
    )


def _mean_over_surface(base, scale):
    """Return the mean normal and tangential part (6, 6) of a contact over the surface of a grain, per unit of load.

    Contacts of a polyhedron with few corners are mostly at its corners: each contact of two polyhedra is at a corner,
    or at an edge, of one of them.
    """
    moments = base.second_moments * scale**2
    if not len(base.vertices):
        return _mean_contact(*ellipsoid_surface(scale), moments)
    corners = (base.vertices * scale)[base.faces]
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(n, axis=1)
    n = n / area[:, None]
    at_faces = _mean_contact(corners.mean(axis=1), n, area, moments)
    pointed = pointedness(base)
    if pointed == 0.0:
        return at_faces
    normals, areas = np.tile(n, (3, 1)), np.tile(area, 3)
    at_corners = _mean_contact(np.concatenate(np.moveaxis(corners, 1, 0)), normals, areas, moments)
    # The midpoints of the edges integrate a quadratic function over a triangle exactly.
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    on_faces = _mean_contact(np.concatenate(np.moveaxis(middles, 1, 0)), normals, areas, moments)
    return tuple(
        (1.0 - pointed) * blunt + pointed * (AT_CORNERS * sharp + (1.0 - AT_CORNERS) * flat)
        for blunt, sharp, flat in zip(at_faces, at_corners, on_faces, strict=True)
    )


def pointedness(base: Base) -> float:
    """Return the weight of contacts at corners: 1 for a polyhedron of at most POINTED corners, 0 from BLUNT corners."""
    return float(np.clip((BLUNT - len(base.vertices)) / (BLUNT - POINTED), 0.0, 1.0))


def ellipsoid_surface(scale):
    """Return points (n, 3), normals (n, 3) and weights (n,) on the surface of an ellipsoid."""
    k = np.arange(DIRECTIONS) + 0.5
    z, angle = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    n = np.column_stack([np.sqrt(1.0 - z**2) * np.cos(angle), np.sqrt(1.0 - z**2) * np.sin(angle), z])
    height = np.linalg.norm(scale * n, axis=1)
    # The weight is the area per solid angle of normals, the inverse Gaussian curvature, up to a constant factor.
    return scale**2 * n / height[:, None], n, height**-4.0


def _mean_contact(point, n, weight, moments):
    """Return the weighted mean of the normal and tangential parts (6, 6) of contacts at points (k, 3) with normals n.

    n (k, 3), weight (k,); moments (3,): mean second moments of the grain.
    """
    weight, rows = weight / weight.sum(), contact_motion(point, moments)
    along = np.einsum("nk,nkj->nj", n, rows)
    normal = np.einsum("n,ni,nj->ij", weight, along, along)
    return normal, np.einsum("n,nki,nkj->ij", weight, rows, rows) - normal


def contact_motion(point, moments):
    """Return the motion (k, 3, 6) of points (k, 3) by each of the six motions of a grain, in units of its mass.

    moments (3,): mean second moments of the grain.
    """
    arm = 1.0 / np.sqrt(moments.sum() - moments)  # inverse root of the inertia per mass
    eye = np.broadcast_to(np.eye(3), (len(point), 3, 3))
    return np.concatenate([eye, np.cross(point[:, None, :], eye) * arm], axis=2)


class _Grips(NamedTuple):
    """Touching contacts and walls, one row for each body that takes part; a contact of two bodies has two rows."""

    body: np.ndarray  # (k,)
    share: np.ndarray  # (k,) of the load of the contact, in units of the mass of the body
    normal: np.ndarray  # (k, 3), unit vectors
    arm: np.ndarray  # (k, 3) [m], from the centre of the body to the contact point
    stiffness_factor: (
        np.ndarray
    )  # (k,) factor on springs and dashpots relative to the load; not on the viscous friction
    spread: np.ndarray  # (k, 6) [m²], or (0, 6)


def _grips(bodies, candidates, width, certain, stiffness_factor=None):
    """Return the grips of all touching contacts and walls; arguments as in stiffest_body."""
    contacts, walls = candidates
    p, w = np.flatnonzero(contacts.touching), np.flatnonzero(walls.touching)
    a, b = contacts.body_a[p], contacts.body_b[p]
    offset = bodies.position[b] - bodies.position[a]
    if len(contacts.image):
        offset[:, :2] += width * contacts.image[p]
    ratio = bodies.mass[a] / bodies.mass[b]
    share_a, share_b = 1.0 / (1.0 + ratio), ratio / (1.0 + ratio)
    if not certain:
        share_a, share_b = share_a * (1.0 + np.sqrt(ratio)), share_b * (1.0 + np.sqrt(1.0 / ratio))
    factor, wall_factor = np.ones(len(p)), np.ones(len(w))
    if stiffness_factor is not None:
        factor = stiffness_factor(bodies.mass[a], bodies.mass[b], contacts.overlap[p])
        wall_factor = stiffness_factor(bodies.mass[walls.body[w]], np.full(len(w), np.inf), walls.overlap[w])
    patches = len(contacts.spread) > 0 or len(walls.spread) > 0
    return _Grips(
        np.concatenate([a, b, walls.body[w]]),
        np.concatenate([share_a, share_b, np.ones(len(w))]),
        np.concatenate([contacts.direction[p], contacts.direction[p], walls.normal[w]]),
        np.concatenate([contacts.point[p], contacts.point[p] - offset, walls.point[w]]),
        np.concatenate([factor, factor, wall_factor]),
        np.concatenate([contacts.spread[p], contacts.spread[p], walls.spread[w]]) if patches else np.zeros((0, 6)),
    )


def _matrices(bodies, grips, load, selected):
    """Return the matrices (k, 6, 6) of the bodies in `selected` (k,), in their own axes and in units of their mass."""
    place = np.full(len(bodies.mass), -1)
    place[selected] = np.arange(len(selected))
    kept = np.flatnonzero(place[grips.body] >= 0)
    body = grips.body[kept]
    rows = np.zeros((len(kept), 3, 6))  # motion of the contact point along x, y, z by each of the six motions
    rows[:, :, :3] = np.eye(3)
    rows[:, :, 3:] = np.cross(grips.arm[kept, None, :], np.eye(3))
    turns = np.zeros((len(kept), 3, 6))  # rotation of the body about x, y, z by each of the six motions
    turns[:, :, 3:] = np.eye(3)
    inverse = np.sqrt(bodies.mass[body, None] / bodies.inertia[body])
    for motion in (rows, turns):
        if len(bodies.rotation):
            motion[:, :, 3:] = motion[:, :, 3:] @ bodies.rotation[body]
        motion[:, :, 3:] *= inverse[:, None, :]
    n = grips.normal[kept]
    along = np.einsum("kx,ky->kxy", n, n)
    across = np.eye(3) - along
    factor = grips.stiffness_factor[kept, None, None]
    added = _quadratic(rows, factor * (load.normal * along + load.tangential * across) + load.sliding * across)
    if len(grips.spread):
        moments = grips.spread[kept][:, [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
        moment = np.trace(moments, axis1=1, axis2=2)[:, None, None]
        # A rotation about u moves the patch by (u × x) · n. Its moments are tr C − C in the plane and tr C about n.
        rocking = load.rocking * (moment * across - moments) + load.tangential * moment * along
        added += _quadratic(turns, factor * rocking)
    matrices = np.zeros((len(selected), 6, 6))
    np.add.at(matrices, place[body], grips.share[kept, None, None] * added)
    return matrices


def _quadratic(rows, weights):
    """Return rowsᵀ weights rows for each grip, (k, 6, 6)."""
    return rows.transpose(0, 2, 1) @ weights @ rows


def _traces(bodies, grips, load):
    """Return a low estimate (n,) of the sum of the eigenvalues of the matrix of each body; patches are left out."""
    body = grips.body
    moments = bodies.inertia.sum(axis=1) / 3.0
    arms = (grips.arm**2).sum(axis=1) * bodies.mass[body] / moments[body]
    across = grips.stiffness_factor * load.tangential + load.sliding
    total = grips.stiffness_factor * load.normal + 2.0 * across
    return np.bincount(body, grips.share * (total + across * 2.0 * arms), minlength=len(bodies.mass))

"""Stability limits of the time step: for a grain in its contacts, and for a whole bed.

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

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from simcore.dem.forces.spring_dashpot import ContactLaw, explicit_dashpot, implicit_dashpot, implicit_law
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs

LARGEST_LOAD = 4.0  # eigenvalue at which a mode alternates undamped
BODIES_EXAMINED = 32  # number of bodies whose eigenvalues are computed; they are selected by the sums of eigenvalues


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
    load: Load | Callable[[np.ndarray], Load],
    certain: bool = True,
    ranks=ONE_RANK,
    stiffness_factor=None,
) -> Stiffest:
    """Find the body (its id) with the largest load in its present contacts; body −1 if nothing touches.

    width [m]: of the periodic box. load: of every contact; with an implicit dashpot a function of the effective
    contacts (k,) of each contact, which returns a Load of arrays (k,). certain: True: neighbours are fixed, and the
    load is a lower bound for that of the whole bed; False: shares of the contacts make it an upper bound. Only the
    BODIES_EXAMINED bodies with the largest sums of eigenvalues, that is with many contacts or long lever arms, are
    evaluated.
    stiffness_factor(mass, mass of the partner, overlap), each (k,) -> (k,): factor on the springs and dashpots of
    contacts relative to `load`; the mass of a wall is inf. None: the factor is 1.
    """
    grips = _grips(bodies, candidates, width, certain, stiffness_factor)
    load = load(grips.effective_contacts) if callable(load) else load
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
    needed = 0.0
    for row in bodies.own[bodies.id[bodies.own] == body]:
        grips = _grips(bodies, candidates, width, certain, stiffness_factor)
        kept = grips.body == row
        grips = _Grips(*(values[kept] if len(values) else values for values in grips))
        needed = _steps_of_row(bodies, grips, law, friction, row, implicit, time)
    return float(ranks.maximum([needed])[0])


def _steps_of_row(bodies, grips, law, friction, row, implicit, time):
    """Return the minimum steps per contact time of the body in this row. grips: its own."""

    def load_at(load):
        return np.linalg.eigvalsh(_matrices(bodies, grips, load, np.array([row]))[0])[-1]

    return steps_needed(law, friction, load_at, grips.effective_contacts if implicit else None, time)


class _Grips(NamedTuple):
    """Touching contacts and walls, one row for each body that takes part; a contact of two bodies has two rows."""

    body: np.ndarray  # (k,)
    share: np.ndarray  # (k,) of the load of the contact, in units of the mass of the body
    normal: np.ndarray  # (k, 3), unit vectors
    arm: np.ndarray  # (k, 3) [m], from the centre of the body to the contact point
    stiffness_factor: (
        np.ndarray
    )  # (k,) factor on springs and dashpots relative to the load; not on the viscous friction
    effective_contacts: np.ndarray  # (k,) the larger value of the two bodies; or (0,) with an explicit dashpot
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
    effective = bodies.effective_contacts
    if len(effective):
        of_pair = np.maximum(effective[a], effective[b])
        effective = np.concatenate([of_pair, of_pair, effective[walls.body[w]]])
    return _Grips(
        np.concatenate([a, b, walls.body[w]]),
        np.concatenate([share_a, share_b, np.ones(len(w))]),
        np.concatenate([contacts.direction[p], contacts.direction[p], walls.normal[w]]),
        np.concatenate([contacts.point[p], contacts.point[p] - offset, walls.point[w]]),
        np.concatenate([factor, factor, wall_factor]),
        effective,
        np.concatenate([contacts.spread[p], contacts.spread[p], walls.spread[w]]) if patches else np.zeros((0, 6)),
    )


def _matrices(bodies, grips, load, selected):
    """Return the matrices (k, 6, 6) of the bodies in `selected` (k,), in their own axes and in units of their mass.

    load: a Load of numbers, or of arrays with a value for each grip.
    """
    place = np.full(len(bodies.mass), -1)
    place[selected] = np.arange(len(selected))
    kept = np.flatnonzero(place[grips.body] >= 0)
    body = grips.body[kept]
    load = Load(*(np.broadcast_to(value, len(grips.body))[kept, None, None] for value in load))
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
    """Return a rough estimate (n,) of the sum of the eigenvalues of the matrix of each body, without patches.

    It has the mean of the moments of inertia of a body, and serves only to select bodies.
    """
    body = grips.body
    moments = bodies.inertia.sum(axis=1) / 3.0
    arms = (grips.arm**2).sum(axis=1) * bodies.mass[body] / moments[body]
    across = grips.stiffness_factor * load.tangential + load.sliding
    total = grips.stiffness_factor * load.normal + 2.0 * across
    return np.bincount(body, grips.share * (total + across * 2.0 * arms), minlength=len(bodies.mass))

"""How long a time step may be: of a grain in its contacts, of a whole bed, and what a scene can be expected to need.

Semi-implicit Euler, v' = v − h (K x + D v), x' = x + h v', per unit of mass, is central differences with the mass
I − h D / 2 and a dashpot in the middle of the step; it loses energy in every mode as long as 4 − (h² K + 2 h D) is
positive definite, and with the first eigenvalue that vanishes a mode alternates from step to step. So a system is
stable while the largest eigenvalue of h² K + 2 h D is below 4, whether or not K and D have the same modes. What one
contact adds to that matrix is called its load: for one direction m_eff (h² k + 2 h d).

Of a body held by neighbours that stand still the matrix has six rows, and its largest eigenvalue is at most that of
the whole bed (interlacing): beyond its limit the bed is unstable for certain, while its contacts stick. For all
bodies together, |u_a − u_b|² <= (1 + t) |u_a|² + (1 + 1/t) |u_b|² shares each contact out to its two bodies; with
t = √(m_a / m_b) that is exact for two bodies, and for the densest packing of equal spheres. Below the limit of every
body with such shares, the bed is stable for certain.

Where forces are known the contacts are those of a moment: springs of what slips, and what the turn of a patch does to
its depth, are not told apart.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from simcore.dem.forces.spring_dashpot import ContactLaw, explicit_dashpot, implicit_dashpot, implicit_law
from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.dem.shapes.hulls import Base
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs

LARGEST_LOAD = 4.0  # eigenvalue at which a mode alternates undamped
LOOKED_AT = 32  # bodies whose eigenvalues are found, of all; the others are taken by the sums of theirs
# Contacts, each as stiff as one with a wall, all over the surface of the stiffest grain. Twelve equals fit about a
# sphere and weigh half of that each; heavier neighbours weigh more and fewer fit (six at 2.4 times the size, four at
# 4.4), so that by itself no sphere has more than about six. Bodies move against each other, which counts up to twice:
# ASSUME: 1.5 times in a bed. At rest whole beds of equal spheres, of spheres of 2.8 to 16 mm and of ellipsoids needed
# 27.5, 25.0 and 28.3 steps, 1.34, 1.22 and 1.29 times those of their stiffest grain by itself, where 33.8, 33.8 and
# 34.3 are expected.
EXPECTED_CONTACTS, CAUTIOUS_CONTACTS = 9, 12
# Contacts of a hull with at most POINTED corners are at a corner with this chance, else anywhere on its faces: a corner
# of one of two polyhedra meets a face of the other. Corners of a hull with BLUNT ones and more are blunt: they differ
# little from its faces. Measured needs of such beds: docs/accuracy.md, "Grains of few corners".
AT_CORNERS, POINTED, BLUNT = 0.5, 8, 24
SAMPLE = 200  # grains whose form is looked at before a run
DIRECTIONS = 256


class Load(NamedTuple):
    """What a contact adds to h² K + 2 h D per effective mass."""

    normal: float
    tangential: float  # 0 without friction
    rocking: float  # of a patch, per area: rocking has a dashpot and no spring of its own
    sliding: float = 0.0  # along the tangent, of a friction that has a dashpot and no spring


class Stiffest(NamedTuple):
    """The body nearest to its limit, or beyond it."""

    body: int
    contacts: int
    load: float  # its largest eigenvalue; stable below LARGEST_LOAD


class Estimate(NamedTuple):
    """Least steps per contact time of a scene, from the form of its grains and the contact law.

    With fewer than expected, grains that have many contacts are likely to jitter in them: they take up energy until
    contacts slip or part, and the bed may not come to rest. Between the two, where the study's 40 steps lie, such
    modes are unstable in principle: a small grain held by many that are heavier or move against it. They are rare and
    short, since grains that fit so well are, and what energy they take up friction and damping take out.
    """

    expected: float  # for EXPECTED_CONTACTS
    cautious: float  # for CAUTIOUS_CONTACTS, more than fit


def contact_load(law: ContactLaw, dt: float, friction: bool = True, effective_contacts: float | None = None) -> Load:
    """Load of a contact at a time step [s]. The one place that knows how a dashpot enters the step.

    law: the continuous one. effective_contacts: with an implicit dashpot, the contacts of the body; None with an
    explicit one.
    """
    if effective_contacts is not None:
        law = implicit_law(law, dt)
    normal, across = (
        explicit_dashpot.py_func(law)
        if effective_contacts is None
        else implicit_dashpot.py_func(law, max(effective_contacts, 1.0))
    )
    spring, dashpot = law.stiffness * dt**2, 2.0 * normal * dt
    along = law.tangential * spring + 2.0 * across * dt if friction else 0.0
    return Load(spring + dashpot, along, dashpot, 2.0 * law.sliding * dt)


def contact_time(law: ContactLaw) -> float:
    """Contact time [s] of the law."""
    return float(2.0 * np.pi / np.sqrt(4.0 * law.stiffness - law.damping**2))


def minimum_steps_per_contact_time(law: ContactLaw, implicit: bool = False, **mode: float) -> float:
    """Steps per contact time at which a mode is just stable; for law, implicit and mode see longest_stable_step."""
    return contact_time(law) / longest_stable_step(law, implicit, **mode)


def longest_stable_step(
    law: ContactLaw, implicit: bool, contacts: float = 2.0, normal: float | None = None, tangential: float = 0.0
) -> float:
    """Time step [s] at which semi-implicit Euler is just stable for a mode of a grain.

    law: the continuous one. contacts: of the grain, at least 1. normal, tangential: how many springs of each kind act
    on the mode, per effective mass; None: all contacts along one line, of which a grain pinched between two, as it
    occurs in any bed, has two. A sphere among z fixed ones that surround it evenly has z / 3 and 2 z / 3 when it moves,
    0 and 5 z / 3 when it turns.

    With stiffness K and damping D of the mode its motion is u' = -K x - D u, x' = u, and semi-implicit Euler is stable
    where 4 - 2 D h - K h² > 0 (Jury's conditions). For s contacts along a line that is, with an explicit dashpot, up to
    h = (√(γ² + 4 ω² / s) - γ) / ω²; with an implicit one, up to the positive root of
    (4 + 2 (s - 1) γ h) (1 + γ h / 2) = s ω² h² (1 + (s - 1/2) γ h): h = 2 / ω for s = 1.
    """
    if contacts < 1.0:
        raise ValueError(f"contacts: {contacts:g}, but a mode needs at least 1")
    normal = contacts if normal is None else normal

    def margin(h):
        at_step = implicit_law(law, h) if implicit else law
        dashpots = implicit_dashpot.py_func(at_step, contacts) if implicit else explicit_dashpot.py_func(law)
        stiffness = (normal + tangential * at_step.tangential) * at_step.stiffness
        return 4.0 - 2.0 * h * (normal * dashpots[0] + tangential * dashpots[1]) - h * h * stiffness

    # The margin falls with h all the way: both h D and h² K grow.
    beyond = 1.0 / np.sqrt(law.stiffness)
    while margin(beyond) > 0.0:
        beyond *= 2.0
    return float(brentq(margin, 0.0, beyond, xtol=1e-12 * beyond))


def steps_needed(
    law: ContactLaw, friction: bool, load_at, effective_contacts: float | None = None, time: float | None = None
) -> float:
    """Least steps per contact time at which load_at(Load) stays below LARGEST_LOAD; it grows with each of Load.

    law, effective_contacts: as of contact_load. time [s]: in place of the law's contact time.
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
    firmness=None,
) -> Stiffest:
    """The body (its id) of the largest load in its present contacts; body −1 where nothing touches.

    width [m]: of the periodic box. certain: with neighbours that stand still, a lower bound of the whole bed's; else
    with shares that make it an upper bound. Looked for among the LOOKED_AT bodies that many or far contacts hold.
    firmness(mass, partner's, overlap), each (k,) -> (k,): springs and dashpots of contacts over those of `load`, the
    mass of a wall being inf; None: all have those of `load`.
    """
    grips = _grips(bodies, candidates, width, certain, firmness)
    traces, contacts = _traces(bodies, grips, load), np.bincount(grips.body, minlength=len(bodies.mass))
    held = bodies.own[contacts[bodies.own] > 0]
    some = held[np.argsort(-traces[held], kind="stable")[:LOOKED_AT]]
    # Those of all ranks compete, so that the choice does not depend on who has which.
    best = sorted(ranks.all([(-traces[row], bodies.id[row]) for row in some]))[:LOOKED_AT]
    ids = {id_ for _, id_ in best}
    some = np.array([row for row in some if bodies.id[row] in ids], np.int64)
    loads = np.linalg.eigvalsh(_matrices(bodies, grips, load, some))[:, -1]
    load_, body, contacts = ranks.largest(loads, bodies.id[some], contacts[some])
    return Stiffest(body, int(contacts or 0), max(load_, 0.0))


def body_steps(
    bodies: Bodies,
    candidates: CandidatePairs,
    width: float,
    law: ContactLaw,
    friction: bool,
    body: int,
    *,
    certain: bool = True,
    effective_contacts: float | None = None,
    ranks=ONE_RANK,
    firmness=None,
    time: float | None = None,
) -> float:
    """Least steps per contact time that one body (its id) needs in its present contacts, see `stiffest_body`.

    law, effective_contacts: as of contact_load. time: as of steps_needed.
    """
    rows = np.flatnonzero(bodies.id[bodies.own] == body)
    needed = []
    for row in bodies.own[rows]:
        grips = _grips(bodies, candidates, width, certain, firmness)
        needed.append(_steps_of_row(bodies, grips, law, friction, row, effective_contacts, time))
    return float(ranks.maximum([max(needed, default=0.0)])[0])


def _steps_of_row(bodies, grips, law, friction, row, effective_contacts, time):
    # The matrix is linear in the load.
    parts = [_matrices(bodies, grips, Load(*unit), np.array([row]))[0] for unit in np.eye(len(Load._fields))]

    def load_at(load):
        return np.linalg.eigvalsh(sum(value * part for value, part in zip(load, parts, strict=True)))[-1]

    return steps_needed(law, friction, load_at, effective_contacts, time)


def estimate_steps(
    law: ContactLaw, friction: bool, bases: list[Base], shape, scale, implicit: bool = False, time: float | None = None
) -> Estimate:
    """Estimate for a bed of grains of shape (n,) and scale (n, 3): that of its form with the largest lever arms.

    A contact is as likely on each part of a grain's surface. time: as of steps_needed.
    """
    some = np.unique(np.linspace(0, len(shape) - 1, min(SAMPLE, len(shape))).astype(int))
    parts = [_all_over(bases[shape[i]], scale[i]) for i in some]
    normal, tangential = (np.array([part[k] for part in parts]) for k in range(2))

    def load_at(load):
        across = load.tangential + load.sliding
        return np.linalg.eigvalsh(load.normal * normal + across * tangential)[:, -1].max()

    return Estimate(
        *(
            steps_needed(
                law, friction, lambda load, count=count: count * load_at(load), count if implicit else None, time
            )
            for count in (EXPECTED_CONTACTS, CAUTIOUS_CONTACTS)
        )
    )


def _all_over(base, scale):
    """Mean of the normal and of the tangential part (6, 6) of a contact over the surface, per unit of load.

    A hull of few corners is held at these, as each contact of two polyhedra is at a corner, or at an edge, of one.
    """
    moments = base.second_moments * scale**2
    if not len(base.vertices):
        return _mean_contact(*_ellipsoid_surface(scale), moments)
    corners = (base.vertices * scale)[base.faces]
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(n, axis=1)
    n = n / area[:, None]
    at_faces = _mean_contact(corners.mean(axis=1), n, area, moments)
    pointed = np.clip((BLUNT - len(base.vertices)) / (BLUNT - POINTED), 0.0, 1.0)
    if pointed == 0.0:
        return at_faces
    normals, areas = np.tile(n, (3, 1)), np.tile(area, 3)
    at_corners = _mean_contact(np.concatenate(np.moveaxis(corners, 1, 0)), normals, areas, moments)
    # Middles of edges integrate what is quadratic in the place over a triangle exactly.
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    on_faces = _mean_contact(np.concatenate(np.moveaxis(middles, 1, 0)), normals, areas, moments)
    return tuple(
        (1.0 - pointed) * blunt + pointed * (AT_CORNERS * sharp + (1.0 - AT_CORNERS) * flat)
        for blunt, sharp, flat in zip(at_faces, at_corners, on_faces, strict=True)
    )


def _ellipsoid_surface(scale):
    """Points (n, 3), normals (n, 3) and weights (n,) on the surface of an ellipsoid."""
    k = np.arange(DIRECTIONS) + 0.5
    z, angle = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    n = np.column_stack([np.sqrt(1.0 - z**2) * np.cos(angle), np.sqrt(1.0 - z**2) * np.sin(angle), z])
    height = np.linalg.norm(scale * n, axis=1)
    # Area seen along n, the inverse of the Gaussian curvature, less a constant.
    return scale**2 * n / height[:, None], n, height**-4.0


def _mean_contact(point, n, weight, moments):
    """Weighted mean of the normal and of the tangential part (6, 6) of contacts at points (k, 3), normals n (k, 3)."""
    weight = weight / weight.sum()
    arm = 1.0 / np.sqrt(moments.sum() - moments)  # of the inertia per mass
    eye = np.broadcast_to(np.eye(3), (len(n), 3, 3))
    rows = np.concatenate([eye, np.cross(point[:, None, :], eye) * arm], axis=2)
    along = np.einsum("nk,nkj->nj", n, rows)
    normal = np.einsum("n,ni,nj->ij", weight, along, along)
    return normal, np.einsum("n,nki,nkj->ij", weight, rows, rows) - normal


class _Grips(NamedTuple):
    """Touching contacts, each once for every body it holds; rows of the two vectors are unit vectors and arms."""

    body: np.ndarray  # (k,)
    share: np.ndarray  # (k,) of the contact's load, in units of the body's mass
    normal: np.ndarray  # (k, 3)
    arm: np.ndarray  # (k, 3) [m], from the body's centre
    firmness: np.ndarray  # (k,) of its springs and dashpots, in units of the load; not of what slides
    spread: np.ndarray  # (k, 6) [m²], or (0, 6)


def _grips(bodies, candidates, width, certain, firmness=None):
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
    firm, firm_wall = np.ones(len(p)), np.ones(len(w))
    if firmness is not None:
        firm = firmness(bodies.mass[a], bodies.mass[b], contacts.overlap[p])
        firm_wall = firmness(bodies.mass[walls.body[w]], np.full(len(w), np.inf), walls.overlap[w])
    patches = len(contacts.spread) > 0 or len(walls.spread) > 0
    return _Grips(
        np.concatenate([a, b, walls.body[w]]),
        np.concatenate([share_a, share_b, np.ones(len(w))]),
        np.concatenate([contacts.direction[p], contacts.direction[p], walls.normal[w]]),
        np.concatenate([contacts.point[p], contacts.point[p] - offset, walls.point[w]]),
        np.concatenate([firm, firm, firm_wall]),
        np.concatenate([contacts.spread[p], contacts.spread[p], walls.spread[w]]) if patches else np.zeros((0, 6)),
    )


def _matrices(bodies, grips, load, some):
    """Matrices (len(some), 6, 6) of some bodies, in their own axes and units of their mass."""
    place = np.full(len(bodies.mass), -1)
    place[some] = np.arange(len(some))
    kept = np.flatnonzero(place[grips.body] >= 0)
    body = grips.body[kept]
    rows = np.zeros((len(kept), 3, 6))  # what a contact feels of its body's motion along x, y, z
    rows[:, :, :3] = np.eye(3)
    rows[:, :, 3:] = np.cross(grips.arm[kept, None, :], np.eye(3))
    turns = np.zeros((len(kept), 3, 6))  # and of its turning about x, y, z
    turns[:, :, 3:] = np.eye(3)
    inverse = np.sqrt(bodies.mass[body, None] / bodies.inertia[body])
    for each in (rows, turns):
        if len(bodies.rotation):
            each[:, :, 3:] = each[:, :, 3:] @ bodies.rotation[body]
        each[:, :, 3:] *= inverse[:, None, :]
    n = grips.normal[kept]
    along = np.einsum("kx,ky->kxy", n, n)
    across = np.eye(3) - along
    firm = grips.firmness[kept, None, None]
    added = _quadratic(rows, firm * (load.normal * along + load.tangential * across) + load.sliding * across)
    if len(grips.spread):
        moments = grips.spread[kept][:, [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
        moment = np.trace(moments, axis1=1, axis2=2)[:, None, None]
        # Turning about u moves the patch by (u × x) · n: tr C − C in its plane, as the polar moment tr C about n.
        rocking = load.rocking * (moment * across - moments) + load.tangential * moment * along
        added += _quadratic(turns, firm * rocking)
    matrices = np.zeros((len(some), 6, 6))
    np.add.at(matrices, place[body], grips.share[kept, None, None] * added)
    return matrices


def _quadratic(rows, weights):
    return rows.transpose(0, 2, 1) @ weights @ rows


def _traces(bodies, grips, load):
    """Sums (n,) of the eigenvalues of each body's matrix, at least; patches are left out."""
    body = grips.body
    moments = bodies.inertia.sum(axis=1) / 3.0
    arms = (grips.arm**2).sum(axis=1) * bodies.mass[body] / moments[body]
    across = grips.firmness * load.tangential + load.sliding
    total = grips.firmness * load.normal + 2.0 * across
    return np.bincount(body, grips.share * (total + across * 2.0 * arms), minlength=len(bodies.mass))

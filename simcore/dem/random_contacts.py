"""Estimate of the minimum steps per contact time of a bed with implicit dashpots, from grains in random contacts.

An implicit dashpot is divided by the effective contacts of its grains, so that many contacts add little load. The limit
of such a bed is set by where the contacts are: a contact at the end of a long or flat grain also turns the grain, which
makes its load larger by a factor of 1 + m r² / I, up to five. The mean over the surface, which serves for explicit
dashpots (simcore.dem.spread_contacts), hides this. Here grains of the scene have random sets of contacts, and
the estimate is the number of steps that the stiffest grain of a bed needs.

The mass of the neighbour enters twice. A light grain bears the whole stiffness of a contact with a heavy one, which
hardly moves, but only half of that of a contact with its like. Fewer heavy neighbours fit around it.

The resistance of patches to rocking and twisting is left out, because whole beds need the same steps without it
(docs/explanation/stability.md, "Expected steps").
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.forces.spring_dashpot import ContactLaw
from simcore.dem.shapes.polyhedra import Base
from simcore.dem.spread_contacts import (
    AT_CORNERS,
    SAMPLE,
    Estimate,
    contact_motion,
    ellipsoid_surface,
    pointedness,
)
from simcore.dem.stability import contact_load, contact_time, steps_needed

# Twelve equal spheres fit around a sphere. ASSUME: a neighbour of any size takes the room of the solid angle that it
# covers, and each place is taken with the probability TAKEN, which gives five contacts among equal grains. Settled beds
# of pebbles, plates and rods had means of 4.1 to 6.0.
PLACES, TAKEN = 12, 5.0 / 12.0
MAX_PLACES = 24  # a limit for stones among pebbles, whose many contacts have small loads
# Share of the bound on the motion of the neighbours (simcore.dem.stability) that enters `expected`; with 0 they are
# fixed, and 1 is the bound, which enters `cautious`. ASSUME: 0.25. The estimate is then about what whole beds need
# (docs/explanation/stability.md, "Expected steps").
MOVING = 0.25
STIFFEST = 200  # the estimate is for the stiffest of so many grains, or of all if there are fewer
SETS = 10_000  # random sets of contacts
# Only the sets with the largest loads at KEPT_AT steps per contact time are evaluated at other steps: KEPT times as
# many as may be unstable.
KEPT, KEPT_AT = 4, 10.0


class _Sets(NamedTuple):
    """Random sets of contacts, a row each; the matrices are per unit of load and of the mass of the grain."""

    normal: np.ndarray  # (k, 6, 6)
    tangential: np.ndarray  # (k, 6, 6)
    effective_contacts: np.ndarray  # (k,)


def estimate_implicit_steps(
    law: ContactLaw, friction: bool, bases: list[Base], shape, scale, number: float = np.inf
) -> Estimate:
    """Estimate the minimum steps per contact time of a bed of grains of shape (n,) and scale (n, 3) [m].

    law: the continuous one. number: of all grains in the bed. Equal arguments give equal estimates.
    """
    unstable = round(SETS / min(max(number, 2.0), STIFFEST))
    return Estimate(
        *(_steps(law, friction, sets, unstable) for sets in _random_sets(bases, shape, scale, (MOVING, 1.0)))
    )


def _steps(law, friction, sets, unstable):
    """Return the steps per contact time at which this number of the sets is unstable."""
    load = contact_load(law, contact_time(law) / KEPT_AT, friction, sets.effective_contacts)
    order = np.argsort(-_largest_eigenvalues(load, sets), kind="stable")
    kept = _Sets(*(values[order[: KEPT * unstable]] for values in sets))

    def load_at(load):
        return np.sort(_largest_eigenvalues(load, kept))[-unstable]

    return steps_needed(law, friction, load_at, kept.effective_contacts)


def _largest_eigenvalues(load, sets):
    """Return the largest eigenvalue (k,) of each set. load: a Load of arrays (k,)."""
    across = load.tangential + load.sliding
    along = np.asarray(load.normal)
    return np.linalg.eigvalsh(along[:, None, None] * sets.normal + across[:, None, None] * sets.tangential)[:, -1]


def _random_sets(bases, shape, scale, moving) -> list[_Sets]:
    """Return the same random sets of contacts for each value of `moving`, in place of MOVING.

    At most SAMPLE grains get such contacts; their neighbours are drawn from all grains.
    """
    rng = np.random.default_rng(0)
    volume = np.array([base.volume for base in bases])[shape] * np.prod(scale, axis=1)
    radius = np.cbrt(volume)  # only ratios are used
    sample = np.unique(np.linspace(0, len(shape) - 1, min(SAMPLE, len(shape))).astype(int))
    of_sample = np.array_split(np.arange(SETS), len(sample))
    parts = [[] for _ in moving]
    for grain, sets in zip(sample, of_sample, strict=True):
        # The number of neighbours of a size on a grain is proportional to the area of the sphere of their centres.
        chance = (radius[grain] + radius) ** 2
        chance /= chance.sum()
        room = _covered(0.5) / (chance @ _covered(radius / (radius + radius[grain])))
        places = min(round(PLACES * room), MAX_PLACES)
        contacts = np.maximum(rng.binomial(places, TAKEN, len(sets)), 1)
        total = int(contacts.sum())
        neighbor = rng.choice(len(shape), total, p=chance)
        mass_ratio, radius_ratio = volume[grain] / volume[neighbor], radius[grain] / radius[neighbor]
        weight = (1.0 + radius_ratio) / (1.0 + mass_ratio)  # as in simcore.dem.step.motion.count_effective_contacts
        normal, tangential = _contacts(bases[shape[grain]], scale[grain], total, rng)
        start = np.concatenate([[0], np.cumsum(contacts)[:-1]])
        effective = np.maximum(np.add.reduceat(weight, start), 1.0)
        for part, beta in zip(parts, moving, strict=True):
            share = ((1.0 + beta * np.sqrt(mass_ratio)) / (1.0 + mass_ratio))[:, None, None]
            part.append((np.add.reduceat(share * normal, start), np.add.reduceat(share * tangential, start), effective))
    return [_Sets(*(np.concatenate(values) for values in zip(*part, strict=True))) for part in parts]


def _covered(sine):
    """Return the share of a sphere within the angle of this sine from an axis."""
    return 0.5 * (1.0 - np.sqrt(1.0 - sine**2))


def _contacts(base, scale, count, rng):
    """Return the normal and tangential matrices (count, 6, 6) of contacts at random points of a grain."""
    if len(base.vertices):
        corners = (base.vertices * scale)[base.faces]
        n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(n, axis=1)
        face = rng.choice(len(area), count, p=area / area.sum())
        within = rng.dirichlet(np.ones(3), count)
        at_corner = rng.random(count) < pointedness(base) * AT_CORNERS
        within[at_corner] = np.eye(3)[rng.integers(3, size=int(at_corner.sum()))]
        point, n = np.einsum("kc,kcx->kx", within, corners[face]), (n / area[:, None])[face]
    else:
        point, n, weight = ellipsoid_surface(scale)
        chosen = rng.choice(len(weight), count, p=weight / weight.sum())
        point, n = point[chosen], n[chosen]
    rows = contact_motion(point, base.second_moments * scale**2)
    along = np.einsum("kx,kxj->kj", n, rows)
    normal = along[:, :, None] * along[:, None, :]
    return normal, rows.transpose(0, 2, 1) @ rows - normal

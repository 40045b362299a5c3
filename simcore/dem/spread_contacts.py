"""Estimate of the minimum steps per contact time of a bed with explicit dashpots, from contacts spread over its grains.

The load of a grain is that of a number of contacts that are spread evenly over its surface, so that the estimate does
not depend on where its contacts are. With implicit dashpots these places matter: simcore.dem.random_contacts.
"""

from typing import NamedTuple

import numpy as np

from simcore.dem.forces.spring_dashpot import ContactLaw
from simcore.dem.shapes.polyhedra import Base
from simcore.dem.stability import steps_needed

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


class Estimate(NamedTuple):
    """Minimum steps per contact time of a scene, from the form of its grains and the contact law.

    With fewer steps than `expected`, the stiffest grains are likely to vibrate: they gain energy until contacts slip or
    open, and the bed may not come to rest. With a number between the two values a mode may be unstable if a small grain
    is held by many neighbours that are heavier or move against it. Such modes are rare and short, because few grains
    fit so well; friction and damping remove the energy that they gain.
    """

    expected: float
    cautious: float


def estimate_steps(
    law: ContactLaw, friction: bool, bases: list[Base], shape, scale, time: float | None = None
) -> Estimate:
    """Estimate the minimum steps per contact time of a bed of grains of shape (n,) and scale (n, 3).

    The estimate is the largest over the forms of the grains, for EXPECTED_CONTACTS and CAUTIOUS_CONTACTS contacts, each
    as stiff as one with a wall. Contacts are equally probable on every part of the surface of a grain, except for
    polyhedra of few corners. time: as in steps_needed.
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

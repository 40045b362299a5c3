"""Convex hull against ellipsoid: by the common normal, from what the last step found or from nothing.

The smooth body makes the contact a point that moves continuously, also where it rolls from a face over an edge: there
is no patch. The ellipsoid's point along the normal is where they touch; the hull's is known less well on flat faces.

A pair remembers its normal and the hull's support vertex (first in its facet), from where the climb goes on. A gap is
concave in n and has one maximum. A maximum that is an overlap below the ellipsoid's rolling radius is the global one
(`deep` says why), so a new contact needs no search as long as it is shallow; a deeper one is searched at every step.

Either body of a pair may be the hull: seen from a hull that is body b, offset and normal change their sign.
"""

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.deep import least_of_mixed, rolling_radius, unit
from simcore.dem.contact.ellipsoid_climb import image
from simcore.dem.contact.gap import STILL_GAP, remember_apart
from simcore.dem.contact.mixed_climb import climb_feature
from simcore.dem.shapes import base_direction, climb_from_hint, is_hull

ENOUGH_GAP = 0.02  # of the pair's size: a step need not know a wider gap to the last digit


@routine
def search_normal(shapes, bodies, i, j, rx, ry, rz, size, enough):
    """Global maximum of f from nothing, hull i and ellipsoid j: (f, normal i to j (3), point of the hull (3), vertex).

    A gap f > enough ends the search early. The point is from the hull's centre.
    """
    nx, ny, nz = unit(rx, ry, rz)
    v = climb_from_hint(shapes, bodies.shape[i], *base_direction(bodies, i, nx, ny, nz))
    value, nx, ny, nz, converged, x, y, z, v = climb_feature(
        shapes, bodies, i, j, rx, ry, rz, size, v, nx, ny, nz, enough
    )
    certain = rolling_radius(bodies.form_matrix, bodies.rotation, j)
    if value > enough or (converged and value >= -certain):
        return value, nx, ny, nz, x, y, z, v
    return least_of_mixed(
        shapes, bodies, bodies.form_matrix, i, j, rx, ry, rz, size, certain, v, value, nx, ny, nz
    )  # fmt: skip


@leaf
def recheck(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from its memory: (known, overlap [m], normal a to b (3), contact point relative to a (3)).

    The pair is apart where the overlap is not positive. Known is False for a pair without memory, for an overlap that
    need not be the least, and where the climb did not converge: then the pair has to be searched.
    """
    v = contacts.facet[p, 0]
    if v < 0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    size = bodies.radius[i] + bodies.radius[j]
    nx, ny, nz = contacts.direction[p, 0], contacts.direction[p, 1], contacts.direction[p, 2]
    # A direction that still shows much of the gap searched last needs no better one; a contact needs the best.
    enough = np.inf if contacts.touching[p] != 0 else -STILL_GAP * contacts.overlap[p]
    k, e = i, j
    swapped = not is_hull(shapes, bodies, i)
    if swapped:
        k, e = j, i
        rx, ry, rz, nx, ny, nz = -rx, -ry, -rz, -nx, -ny, -nz
    value, nx, ny, nz, converged, _, _, _, v = climb_feature(
        shapes, bodies, k, e, rx, ry, rz, size, v, nx, ny, nz, enough
    )
    known = value > 0.0 or (converged and value >= -rolling_radius(bodies.form_matrix, bodies.rotation, e))
    searched = contacts.overlap[p]
    overlap, nx, ny, nz, x, y, z = _conclude(bodies, contacts, p, i, j, e, swapped, rx, ry, rz, value, nx, ny, nz, v)
    if value > enough:
        overlap = min(overlap, searched)
    return known, overlap, nx, ny, nz, x, y, z


@routine
def search_contact(shapes, bodies, contacts, p, i, j, rx, ry, rz):
    """Near pair p from nothing: (overlap [m], normal a to b (3), contact point relative to a (3))."""
    size = bodies.radius[i] + bodies.radius[j]
    k, e = i, j
    swapped = not is_hull(shapes, bodies, i)
    if swapped:
        k, e = j, i
        rx, ry, rz = -rx, -ry, -rz
    value, nx, ny, nz, _, _, _, v = search_normal(shapes, bodies, k, e, rx, ry, rz, size, ENOUGH_GAP * size)
    return _conclude(bodies, contacts, p, i, j, e, swapped, rx, ry, rz, value, nx, ny, nz, v)


@leaf
def _conclude(bodies, contacts, p, i, j, e, swapped, rx, ry, rz, value, nx, ny, nz, v):
    """Overlap, normal and point from f at its maximum; r and n are seen from the hull. A gap is remembered."""
    contacts.facet[p, 0] = v
    x, y, z = image(bodies.form_matrix, e, nx, ny, nz)
    height = np.sqrt(nx * x + ny * y + nz * z)
    # From the hull's centre to the middle between the ellipsoid's point and the hull's, below it by the overlap
    x, y, z = rx - x / height - 0.5 * value * nx, ry - y / height - 0.5 * value * ny, rz - z / height - 0.5 * value * nz
    if swapped:
        x, y, z = x - rx, y - ry, z - rz
        rx, ry, rz, nx, ny, nz = -rx, -ry, -rz, -nx, -ny, -nz
    if value >= 0.0:
        remember_apart(bodies, contacts, p, i, j, rx, ry, rz, value)
    return -value, nx, ny, nz, x, y, z

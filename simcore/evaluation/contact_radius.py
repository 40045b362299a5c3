"""Positions of contacts on the grains: distances of contact points from the grain's centre.

The radial distribution of contacts is the density of rho = |contact point - centre of mass| / r over all contacts of a
grain, where r is the radius of the sphere of the grain's volume. For spheres it is a peak at 1; for ellipsoids it
extends from c/r on the flat sides to a/r at the tips. It mainly shows the form of the grain. For comparison there is
the density of the surface of the same grains, which evenly spread contacts would have: where the density of contacts is
higher, that part of the surface is preferred.
"""

import numpy as np

from simcore.grains.form import equal_volume_diameter

# All packings share one grid of bins, so that their densities can be averaged; 1, the value of spheres, is the middle
# of a bin.
BIN_WIDTH = 0.05
_QUADRATURE = 4096  # points on an octant
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_SUBDIVISION = 4  # parts of each edge of a polyhedron's triangles


def contact_radii(packing, contacts, second):
    """Return rho of ends of contacts, (k,).

    contacts (k,): indices of the contacts; second (k,) bool: whether the end is that of the contact's second body.
    """
    image = packing["contact_image"].values[contacts] * second[:, None]
    grains = packing["contact_body"].values[contacts, second.astype(int)]
    arm = packing["contact_point"].values[contacts] - packing["position"].values[grains]
    arm[:, :2] -= image * (packing.attrs["domain_width"] if packing.attrs["domain_shape"] == "periodic" else 0.0)
    return np.linalg.norm(arm, axis=1) / equal_volume_radius(packing)[grains]


def equal_volume_radius(packing):
    """Return the radius of the sphere of each grain's volume, (n,) [m]."""
    return 0.5 * equal_volume_diameter(packing["volume"].values)


def radius_bins(largest):
    """Return the edges (k + 1,) and middles (k,) of bins from half a bin width up to at least `largest`."""
    middles = BIN_WIDTH * np.arange(1, max(int(np.ceil(largest / BIN_WIDTH - 0.5)), 1) + 1)
    return np.append(middles - 0.5 * BIN_WIDTH, middles[-1] + 0.5 * BIN_WIDTH), middles


def largest_radius(packing, grains):
    """Return an upper bound of rho on the surfaces of these grains, indices (n,)."""
    reach = np.ones(packing.sizes["shape"])
    for shape in np.flatnonzero(packing["shape_kind"].values.astype(str) == "convex"):
        reach[shape] = np.linalg.norm(_vertices(packing, shape), axis=1).max()
    reach = reach[packing["shape"].values[grains]] * packing["scale"].values[grains].max(axis=1)
    return (reach / equal_volume_radius(packing)[grains]).max(initial=0.0)


def surface_radii(packing, grains, weights, edges):
    """Return the density over rho of the surface of the grains, (k,); the area of a grain does not affect its weight.

    grains (n,): indices; weights (n,), such as their numbers of contacts; edges (k + 1,) as in radius_bins.
    """
    relative = packing["scale"].values[grains] / equal_volume_radius(packing)[grains, None]
    forms = np.column_stack([packing["shape"].values[grains], np.round(relative, 9)])
    forms, form = np.unique(forms, axis=0, return_inverse=True)
    share = np.bincount(form.ravel(), weights, len(forms))
    kinds = packing["shape_kind"].values.astype(str)
    density = np.zeros(len(edges) - 1)
    for (shape, *scale), weight in zip(forms, share, strict=True):
        if weight == 0.0:
            continue
        shape, scale = int(shape), np.array(scale)
        points, areas = _ellipsoid(scale) if kinds[shape] == "sphere" else _polyhedron(packing, shape, scale)
        count, _ = np.histogram(np.linalg.norm(points, axis=1), edges, weights=areas)
        density += weight * count / areas.sum()
    return density / share.sum() / np.diff(edges) if share.sum() > 0.0 else np.full(len(edges) - 1, np.nan)


def _ellipsoid(semi_axes):
    """Return points (m, 3) on an octant of an ellipsoid's surface, and the area that each represents, (m,)."""
    # All points have different heights: on a spheroid points of one height have one distance from the centre.
    k = np.arange(_QUADRATURE)
    height, phi = (k + 0.5) / _QUADRATURE, 0.5 * np.pi * (k * _GOLDEN % 1.0)
    across = np.sqrt(1.0 - height**2)
    unit = np.stack([across * np.cos(phi), across * np.sin(phi), height], axis=-1)
    # The map to the ellipsoid multiplies an area element of the unit sphere with normal u by (a b c) |u / (a, b, c)|.
    return unit * semi_axes, np.linalg.norm(unit / semi_axes, axis=1)


def _polyhedron(packing, shape, scale):
    """Return points (m, 3) on the faces of a scaled polyhedron, and the area that each represents, (m,)."""
    start, number = (int(packing[f"shape_face_{name}"].values[shape]) for name in ("start", "count"))
    corners = (_vertices(packing, shape) * scale)[packing["shape_faces"].values[start : start + number]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    centres = _centres_of_parts()
    points = np.einsum("pc,fcx->fpx", centres, corners).reshape(-1, 3)
    return points, np.repeat(area / len(centres), len(centres))


def _vertices(packing, shape):
    """Return the vertices of a base polyhedron, (m, 3) [m]."""
    start, number = (int(packing[f"shape_vertex_{name}"].values[shape]) for name in ("start", "count"))
    return packing["shape_vertices"].values[start : start + number]


def _centres_of_parts():
    """Return the barycentric coordinates (s², 3) of the centres of the s² equal parts of a triangle."""
    s = _SUBDIVISION
    upright = [(i + 1 / 3, j + 1 / 3) for i in range(s) for j in range(s - i)]
    turned = [(i + 2 / 3, j + 2 / 3) for i in range(s) for j in range(s - i - 1)]
    first, second = np.array(upright + turned).T / s
    return np.column_stack([first, second, 1.0 - first - second])

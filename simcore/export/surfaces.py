"""Surfaces of the grains as closed triangle meshes, whole or cut at the sides of the periodic box."""

from typing import NamedTuple

import numpy as np
import trimesh
from scipy.spatial import QhullError
from scipy.special import elliprg

from simcore.export.placement import is_polyhedron, places, rotations, shape_part

# An icosahedron whose triangles are divided in four twice has 320 faces. Scaled to the volume of the sphere, its
# surface is between 0.6 % of the radius inside and 1.2 % outside.
DIVISIONS = 2
MOST_DIVISIONS = 5
# Least share of a grain's volume that is exported as a piece, far below the error of 1e-6 that volumes may have.
LEAST_PIECE = 1e-9


class Surface(NamedTuple):
    """The closed surface of one grain, or of one piece of it."""

    grain: int  # index of the grain
    vertices: np.ndarray  # (n, 3) [m]
    faces: np.ndarray  # (m, 3), outward


def base_mesh(packing, shape, divisions=DIVISIONS):
    """Return (vertices (n, 3), outward faces (m, 3)) of base shape number `shape`.

    The unit sphere becomes a polyhedron of 20 · 4^divisions faces with the volume of the sphere, so that volumes of
    ellipsoids are exact. ValueError if divisions is not 0 to MOST_DIVISIONS.
    """
    if not 0 <= divisions <= MOST_DIVISIONS:
        raise ValueError(f"divisions: {divisions} is not possible; give 0 to {MOST_DIVISIONS}")
    if str(packing["shape_kind"].values[shape]) == "convex":
        return shape_part(packing, "vertex", shape), shape_part(packing, "face", shape)
    sphere = trimesh.creation.icosphere(subdivisions=divisions)
    return np.array(sphere.vertices) * np.cbrt(4.0 / 3.0 * np.pi / sphere.volume), np.array(sphere.faces)


def surfaces(packing, periodic="leave", divisions=DIVISIONS):
    """Yield the Surface of each grain, its images or pieces. periodic: see simcore.export.placement."""
    where = places(packing, periodic)
    shape, scale, position = (packing[name].values for name in ("shape", "scale", "position"))
    meshes = {int(s): base_mesh(packing, s, divisions) for s in np.unique(shape)}
    to_world = rotations(packing)
    for g, shift in zip(where.grain, where.shift, strict=True):
        vertices, faces = meshes[int(shape[g])]
        world = (vertices * scale[g]) @ to_world[g].T + (position[g] + shift)
        if where.sides is not None:
            world, faces = cut_convex(world, faces, where.sides)
        if len(faces):
            yield Surface(int(g), world, faces)


def cut_convex(vertices, faces, width):
    """Return the part of a convex polyhedron with 0 <= x <= width and 0 <= y <= width: (vertices, outward faces).

    vertices (n, 3) [m], faces (m, 3). Both results are empty if less than LEAST_PIECE of the volume is inside.
    """
    # trimesh merges vertices that are nearer than 1e-8, whatever the unit, so that grains are cut at a size of 1.
    extent = np.ptp(vertices, axis=0).max()
    vertices, width = vertices / extent, width / extent
    volume = trimesh.Trimesh(vertices, faces, process=False).volume
    for axis in (0, 1):
        for side, sign in ((0.0, 1.0), (width, -1.0)):
            inside = sign * (vertices[:, axis] - side)  # [m], distance from the plane inwards
            if inside.min(initial=0.0) >= 0.0:
                continue
            ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
            a, b = ends[(inside[ends[:, 0]] > 0.0) & (inside[ends[:, 1]] < 0.0)].T
            share = (inside[a] / (inside[a] - inside[b]))[:, None]
            crossings = vertices[a] + share * (vertices[b] - vertices[a])
            crossings[:, axis] = side
            try:
                piece = trimesh.convex.convex_hull(np.concatenate([vertices[inside >= 0.0], crossings]))
            except (QhullError, ValueError, ZeroDivisionError):  # nothing is inside, or a sliver without volume
                return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
            vertices, faces = np.array(piece.vertices), np.array(piece.faces)
            if not piece.volume > LEAST_PIECE * volume:
                return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    return vertices * extent, faces


def ellipsoid_areas(half_axes):
    """Return the areas of ellipsoids, (n,) [m²]; half_axes: (n, 3) [m].

    The area is 4 π R_G(a² b², a² c², b² c²) with Carlson's symmetric elliptic integral R_G of the second kind (DLMF
    19.33.1).
    """
    a, b, c = np.square(np.asarray(half_axes, float)).T
    return 4.0 * np.pi * elliprg(a * b, a * c, b * c)


def surface_areas(packing):
    """Return the area of each grain's surface, (n,) [m²]."""
    scale, shape = packing["scale"].values, packing["shape"].values
    areas = ellipsoid_areas(scale)
    for g in np.flatnonzero(is_polyhedron(packing)):
        corners = (shape_part(packing, "vertex", shape[g]) * scale[g])[shape_part(packing, "face", shape[g])]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas[g] = 0.5 * np.linalg.norm(normals, axis=1).sum()
    return areas

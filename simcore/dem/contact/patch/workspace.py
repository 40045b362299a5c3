r"""Workspace of patches: working memory for each thread, so that a step allocates nothing.

      o---o            mark, stamp   the current walk over a polyhedron has visited vertex v if mark[v] == stamp
     /|\ / \           stack         vertices whose neighbours the walk has yet to visit
    o-o-*---o          faces         triangles of a and of b that take part, with their planes
     \|/ \ /           polygon       two polygons: a face before and after a cut by a plane
      o---o            height        heights of the corners of a polygon above that plane
                       bound         corners of a small polytope that contains the overlap
    o visited  * top

Lengths are in metres. Coordinates of faces, planes, polygons and bounds are along the axes of the patch (axes.py),
relative to the centre of body a.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf
from simcore.dem.shapes.polyhedra import Shapes
from simcore.dem.vectors import Vec


class Workspace(NamedTuple):
    """Arrays whose first index is the thread."""

    mark: np.ndarray  # (threads, vertices) int64
    stamp: np.ndarray  # (threads,) int64
    stack: np.ndarray  # (threads, vertices) int64
    faces: np.ndarray  # (threads, 2, faces, 3, 3): corners, of a and of b
    planes: np.ndarray  # (threads, 2, faces, 4): of these faces; n · x + d > 0 outside the body
    polygon: np.ndarray  # (threads, 2, faces + 3, 3)
    height: np.ndarray  # (threads, faces + 3)
    bound: np.ndarray  # (threads, vertices + 1, 3)


def make_workspace(shapes: Shapes, n_threads: int) -> Workspace:
    """Return a workspace for the largest polyhedron of the scene; without polyhedra its arrays have no rows."""
    counts = np.diff(shapes.vertex_start)
    n = int(counts.max(initial=0))
    threads = n_threads if n else 0
    return Workspace(
        mark=np.zeros((threads, n), np.int64),
        stamp=np.zeros(threads, np.int64),
        stack=np.zeros((threads, n), np.int64),
        faces=np.zeros((threads, 2, 2 * n, 3, 3)),
        planes=np.zeros((threads, 2, 2 * n, 4)),
        polygon=np.zeros((threads, 2, 2 * n + 3, 3)),
        height=np.zeros((threads, 2 * n + 3)),
        bound=np.zeros((threads, n + 1, 3)),
    )


@leaf
def start_walk(workspace, thread, vertex, first):
    """Begin a walk over a polyhedron at a vertex; return the stamp of the walk. first: first vertex of the base."""
    workspace.stamp[thread] += 1
    stamp = workspace.stamp[thread]
    workspace.mark[thread, vertex - first] = stamp
    workspace.stack[thread, 0] = vertex
    return stamp


@leaf
def read_face(workspace, t, side, face, corner):
    """Return a corner of a face of thread t."""
    faces = workspace.faces
    return Vec(faces[t, side, face, corner, 0], faces[t, side, face, corner, 1], faces[t, side, face, corner, 2])


@leaf
def write_face(workspace, t, side, face, corner, v):
    """Store a corner of a face of thread t."""
    faces = workspace.faces
    faces[t, side, face, corner, 0], faces[t, side, face, corner, 1], faces[t, side, face, corner, 2] = v.x, v.y, v.z


@leaf
def read_polygon(workspace, t, number, corner):
    """Return a corner of one of the two polygons of thread t."""
    polygon = workspace.polygon
    return Vec(polygon[t, number, corner, 0], polygon[t, number, corner, 1], polygon[t, number, corner, 2])


@leaf
def write_polygon(workspace, t, number, corner, v):
    """Store a corner of one of the two polygons of thread t."""
    polygon = workspace.polygon
    polygon[t, number, corner, 0], polygon[t, number, corner, 1], polygon[t, number, corner, 2] = v.x, v.y, v.z


@leaf
def read_bound(workspace, t, corner):
    """Return a corner of the bound of thread t."""
    bound = workspace.bound
    return Vec(bound[t, corner, 0], bound[t, corner, 1], bound[t, corner, 2])


@leaf
def write_bound(workspace, t, corner, x, y, z):
    """Store a corner of the bound of thread t."""
    bound = workspace.bound
    bound[t, corner, 0], bound[t, corner, 1], bound[t, corner, 2] = x, y, z

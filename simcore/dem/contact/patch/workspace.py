r"""Workspace of patches: working memory for each thread, so that a step allocates nothing.

      o---o            mark, stamp   the current walk over a polyhedron has visited vertex v if mark[v] == stamp
     /|\ / \           stack         vertices whose neighbours the walk has yet to visit
    o-o-*---o          faces         triangles of a and of b that take part
     \|/ \ /           planes        of these triangles
      o---o            polygon       two polygons: a face before and after a cut by a plane
                       corner, edge  a polytope that planes cut (polytope.py): its corners before and after a cut
    o visited  * top   height        heights of the corners of a polygon or polytope above a plane

Lengths are in metres. Coordinates of faces, planes, polygons and polytopes are along the axes of the patch (axes.py),
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
    height: np.ndarray  # (threads, corners)
    corner: np.ndarray  # (threads, 2, corners, 3)
    renumbered: np.ndarray  # (threads, corners) int64: number of a corner after a cut, -1 if it is cut off
    edge: np.ndarray  # (threads, edges, 4) int64: first and second corner, left and right face
    way_out: np.ndarray  # (threads, faces of a polytope) int64: corner where a cut leaves a face; -1 between two cuts
    way_in: np.ndarray  # the same: corner where it comes back
    reference: np.ndarray  # the same: corner from which the face is divided into triangles, -1 if there is none yet


def make_workspace(shapes: Shapes, n_threads: int) -> Workspace:
    """Return a workspace for the largest polyhedron of the scene; without polyhedra its arrays have no rows."""
    counts = np.diff(shapes.vertex_start)
    n = int(counts.max(initial=0))
    threads = n_threads if n else 0
    # Faces of a polytope: those of both bodies and of the pyramid. It has at most 3 m edges, and m new ones in a cut.
    m = 5 * n + 4
    return Workspace(
        mark=np.zeros((threads, n), np.int64),
        stamp=np.zeros(threads, np.int64),
        stack=np.zeros((threads, n), np.int64),
        faces=np.zeros((threads, 2, 2 * n, 3, 3)),
        planes=np.zeros((threads, 2, 2 * n, 4)),
        polygon=np.zeros((threads, 2, 2 * n + 3, 3)),
        height=np.zeros((threads, 2 * m)),
        corner=np.zeros((threads, 2, 2 * m, 3)),
        renumbered=np.zeros((threads, 2 * m), np.int64),
        edge=np.zeros((threads, 4 * m, 4), np.int64),
        way_out=np.full((threads, m), -1, np.int64),
        way_in=np.full((threads, m), -1, np.int64),
        reference=np.zeros((threads, m), np.int64),
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
def read_corner(workspace, t, number, k):
    """Return corner k of a polytope of thread t; number: of the array."""
    corner = workspace.corner
    return Vec(corner[t, number, k, 0], corner[t, number, k, 1], corner[t, number, k, 2])


@leaf
def write_corner(workspace, t, number, k, v):
    """Store corner k of a polytope of thread t."""
    corner = workspace.corner
    corner[t, number, k, 0], corner[t, number, k, 1], corner[t, number, k, 2] = v.x, v.y, v.z

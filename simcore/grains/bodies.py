"""The separate bodies of one file: which there are in a mesh, and which of them become grains."""

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

BODIES = ("one", "split", "largest", "joined")
# A body of less than this share of the largest in its file may be noise.
_NOISE = 0.01


@dataclass(frozen=True, eq=False)
class Body:
    """Points (n, 3) whose hull is a body's, its volume (nan where only points are known), and notes as of Grain."""

    points: np.ndarray
    volume: float = np.nan
    notes: tuple[str, ...] = ()


def select_bodies(bodies, choice, unit):
    """The bodies of one file or label that become grains, largest first.

    bodies: list of Body, not empty, lengths in `unit`. choice: "one" refuses several, "split" takes each, "largest"
    the largest, "joined" the hull of all. ValueError with the number of bodies and their volumes.
    """
    if len(bodies) == 1:
        return bodies
    bodies = sorted(bodies, key=lambda body: -body.volume)
    volumes = [body.volume for body in bodies]
    volumes_text = _listed(volumes, unit)
    if choice == "one":
        raise ValueError(
            f"it has {len(bodies)} separate bodies, of {volumes_text}; a grain is one body: delete what is no grain (a "
            "turntable, noise), or set `grains.bodies` to split (each becomes a grain), largest (the others are left "
            "out) or joined (the hull of all is one grain)"
        )
    if choice == "joined":
        notes = tuple(dict.fromkeys(note for body in bodies for note in body.notes))
        joined = f"is the hull of {len(bodies)} bodies, of {volumes_text}"
        return [Body(np.concatenate([body.points for body in bodies]), sum(volumes), (joined, *notes))]
    if choice == "largest":
        note = f"is the largest of {len(bodies)} bodies in its file, of {volumes_text}; the others were left out"
        return [Body(bodies[0].points, volumes[0], (note, *bodies[0].notes))]
    return [
        body if body.volume >= _NOISE * volumes[0] else _with_note(body, body.volume / volumes[0]) for body in bodies
    ]


def _with_note(body, share):
    note = f"has {100 * share:.2g} % of the volume of the largest body in its file; if it is noise, delete it"
    return Body(body.points, body.volume, (note, *body.notes))


def _listed(volumes, unit):
    shown = ", ".join(f"{float(f'{volume:.3g}'):g}" for volume in volumes[:5])
    return f"{shown}{f' and {len(volumes) - 5} smaller ones' if len(volumes) > 5 else ''} {unit}³"


def mesh_bodies(vertices, faces):
    """The bodies (list of Body) of a mesh, after checking that its triangles enclose them from outside.

    vertices (n, 3), faces (m, 3). Vertices at one place are one; triangles that share a vertex belong to one body, so
    that a scan that touches itself stays one. What lies within a body, as the wall of a cavity, belongs to it.
    ValueError if the mesh is flat, open or inverted.
    """
    size = np.ptp(vertices[faces.ravel()], axis=0).max() or 1.0
    centred = (vertices - vertices.mean(0)) / size
    thickness = np.linalg.svd(centred - centred.mean(0), compute_uv=False)[-1] / np.sqrt(len(centred))
    if thickness < 1e-6:
        raise ValueError("the mesh is flat: all its vertices lie in one plane")
    closed = trimesh.Trimesh(centred, faces, process=False)
    closed.merge_vertices(merge_tex=True, merge_norm=True)  # STL repeats the corners of every triangle
    labels = _components(len(closed.vertices), closed.faces)[closed.faces[:, 0]]
    kept = closed.nondegenerate_faces()
    closed.update_faces(kept)
    if not closed.is_watertight:
        raise ValueError("the mesh is open: an edge has not exactly two faces; close its holes" + _pieces(labels))
    inverted = "the mesh is inverted: faces are wound inwards, all or some; turn them outwards"
    if not closed.is_winding_consistent:
        raise ValueError(inverted)
    groups = _whole_bodies(np.asarray(closed.vertices), np.asarray(closed.faces), labels[kept])
    wrong = sum(volume <= 0 for _, volume in groups)
    if wrong or not groups:
        raise ValueError(inverted + (f" ({wrong} of its {len(groups)} bodies)" if len(groups) > 1 else ""))
    if len(groups) == 1:
        return [Body(vertices[np.unique(faces)], groups[0][1] * size**3)]
    return [Body(vertices[np.unique(faces[np.isin(labels, own)])], volume * size**3) for own, volume in groups]


def _components(count, faces):
    """Number of its connected component of each of `count` vertices."""
    pairs = np.concatenate([faces[:, :2], faces[:, 1:]])
    graph = coo_array((np.ones(len(pairs), bool), pairs.T), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def _pieces(labels):
    number = len(np.unique(labels))
    return f" (it has {number} separate pieces; delete what is no grain)" if number > 1 else ""


def _whole_bodies(vertices, faces, labels):
    """[(labels of the components, volume)] of each body: an outer component and all that lie within it.

    Inward-wound components are walls of cavities, whose volume is taken off; what else lies within is solid already.
    A component that lies in none is a body of its own, whatever its volume.
    """
    order = np.argsort(labels, kind="stable")
    names, starts = np.unique(labels[order], return_index=True)
    parts = [(name, vertices[part]) for name, part in zip(names, np.split(faces[order], starts[1:]), strict=True)]
    outer = []
    for name, corners in sorted(parts, key=lambda part: -np.prod(np.ptp(part[1], axis=(0, 1)))):
        volume = _signed_volume(corners)
        around = next((body for body in outer if _lies_within(corners, body["corners"])), None)
        if around is None:
            outer.append({"labels": [name], "corners": corners, "volume": volume})
        else:
            around["labels"].append(name)
            around["volume"] += min(volume, 0.0)
    return [(body["labels"], body["volume"]) for body in outer]


def _signed_volume(corners):
    """Volume within triangles (m, 3, 3), negative where they are wound inwards."""
    a, b, c = np.moveaxis(corners - corners.mean(axis=(0, 1)), 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def _lies_within(corners, around):
    """Whether a closed surface lies within another, by points on it: surfaces that cross are bodies of their own."""
    low, high = around.min(axis=(0, 1)), around.max(axis=(0, 1))
    points = corners.reshape(-1, 3)
    if np.any(points < low) or np.any(points > high):
        return False
    ends = np.concatenate([points.argmin(axis=0), points.argmax(axis=0)])
    some = np.concatenate([points[:: -(-len(points) // 50)], points[ends]])
    return all(_is_inside(point, around) for point in some)


def _is_inside(point, corners):
    """Whether a point (3,) lies inside a closed surface of triangles (m, 3, 3), by the solid angle it fills there."""
    a, b, c = np.moveaxis(corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(edge, axis=1) for edge in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = la * lb * lc + np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la
    below += np.einsum("ij,ij->i", c, a) * lb
    return abs(np.arctan2(triple, below).sum()) > np.pi  # half of the solid angle: 2 pi inside, 0 outside

"""Separate bodies in one file: finds those of a mesh and selects the bodies that become grains."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

BODIES = ("one", "split", "largest", "joined")
# A body with less than this share of the volume of the largest one in its file may be noise.
_NOISE = 0.01


@dataclass(frozen=True, eq=False)
class Body:
    """A body in a file of grains.

    points: (n, 3), their hull is the body's hull; volume: nan if it is unknown, as of points; notes: as in Grain.
    """

    points: np.ndarray
    volume: float = np.nan
    notes: tuple[str, ...] = ()


def select_bodies(bodies, choice, unit):
    """Return the bodies of one file or label that become grains, largest first.

    bodies: list of Body, not empty, lengths in `unit`. choice: "one" refuses several bodies with a ValueError that
    names their number and volumes; "split" returns all, "largest" the largest one, "joined" one body of all points. Its
    volume is unknown if bodies may overlap.
    """
    if len(bodies) == 1:
        return bodies
    bodies = sorted(bodies, key=lambda body: -body.volume)
    volumes = [body.volume for body in bodies]
    volumes_text = _format_volumes(volumes, unit)
    if choice == "one":
        raise ValueError(
            f"it has {len(bodies)} separate bodies, of {volumes_text}, but a grain is one body; delete the bodies that "
            "are not grains (a turntable, noise), or set `grains.bodies` to split (each becomes a grain), largest (the "
            "others are left out) or joined (the hull of all is one grain)"
        )
    if choice == "joined":
        notes = tuple(dict.fromkeys(note for body in bodies for note in body.notes))
        joined = f"is the hull of {len(bodies)} bodies, of {volumes_text}"
        volume = np.nan if _may_overlap(bodies) else sum(volumes)
        return [Body(np.concatenate([body.points for body in bodies]), volume, (joined, *notes))]
    if choice == "largest":
        note = f"is the largest of {len(bodies)} bodies in its file, of {volumes_text}; the others were left out"
        return [Body(bodies[0].points, volumes[0], (note, *bodies[0].notes))]
    return [with_share(body, body.volume / volumes[0], "body in its file") for body in bodies]


def _may_overlap(bodies):
    """Return whether the bounding boxes of two bodies overlap."""
    low = np.array([body.points.min(axis=0) for body in bodies])
    high = np.array([body.points.max(axis=0) for body in bodies])
    meet = np.all((low[:, None] < high[None]) & (low[None] < high[:, None]), axis=-1)
    return bool(meet.sum() > len(bodies))


def with_share(body, share, largest):
    """Return a Body, with a note if its share of the volume of the `largest` one is so small that it may be noise."""
    if share >= _NOISE:
        return body
    note = f"has {100 * share:.2g} % of the volume of the largest {largest}; if it is noise, delete it"
    return Body(body.points, body.volume, (note, *body.notes))


def _format_volumes(volumes, unit):
    largest = ", ".join(f"{float(f'{volume:.3g}'):g}" for volume in volumes[:5])
    return f"{largest}{f' and {len(volumes) - 5} smaller ones' if len(volumes) > 5 else ''} {unit}³"


def mesh_bodies(vertices, faces):
    """Return the bodies of a mesh as a list of Body; ValueError if the mesh is flat, open or inverted.

    vertices (n, 3), faces (m, 3), outward. Vertices at the same place are merged. Triangles that share a vertex belong
    to one body, so a scan whose surface touches itself remains one body. A surface inside a body, such as the wall of a
    cavity, belongs to that body.
    """
    import trimesh  # imported here because it loads slowly and most commands read no mesh

    used, corners = np.unique(faces, return_inverse=True)  # a file may have vertices without a face, at any place
    size = np.ptp(vertices[used], axis=0).max() or 1.0
    centred = (vertices[used] - vertices[used].mean(0)) / size
    thickness = np.linalg.svd(centred - centred.mean(0), compute_uv=False)[-1] / np.sqrt(len(centred))
    if thickness < 1e-6:
        raise ValueError("the mesh is flat: all its vertices are in one plane; export a closed surface")
    closed = trimesh.Trimesh(centred, corners.reshape(faces.shape), process=False)
    closed.merge_vertices(merge_tex=True, merge_norm=True)  # STL repeats the corners of every triangle
    labels = _components(len(closed.vertices), closed.faces)[closed.faces[:, 0]]
    closed, kept = _without_degenerate_faces(closed)
    if not closed.is_watertight:
        raise ValueError(_describe_open(closed.edges_unique_inverse, labels))
    inverted = "the mesh is inverted: some or all faces are wound inwards; turn them outwards"
    if not closed.is_winding_consistent:
        raise ValueError(inverted)
    groups = _whole_bodies(np.asarray(closed.vertices), np.asarray(closed.faces), labels[kept])
    n_inverted = sum(volume <= 0 for _, volume in groups)
    if n_inverted or not groups:
        raise ValueError(inverted + (f" ({n_inverted} of its {len(groups)} bodies)" if len(groups) > 1 else ""))
    if len(groups) == 1:
        return [Body(vertices[np.unique(faces)], groups[0][1] * size**3)]
    return [Body(vertices[np.unique(faces[np.isin(labels, own)])], volume * size**3) for own, volume in groups]


def _components(count, faces):
    """Return the number of the connected component of each of `count` vertices, (count,)."""
    pairs = np.concatenate([faces[:, :2], faces[:, 1:]])
    graph = coo_array((np.ones(len(pairs), bool), pairs.T), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def _without_degenerate_faces(mesh):
    """Return the mesh without faces that have two equal corners, and which faces are kept.

    A triangle of area 0 may be what closes a mesh at a corner on the edge of another face; it is left out only if the
    mesh is not closed with it.
    """
    corners = np.sort(mesh.faces, axis=1)
    kept = np.all(corners[:, 1:] != corners[:, :-1], axis=1)
    closed = mesh.copy()
    closed.update_faces(kept)
    if not closed.is_watertight:
        kept = mesh.nondegenerate_faces()
        mesh.update_faces(kept)
        return mesh, kept
    return closed, kept


def _describe_open(edges, labels):
    """Return the message on a mesh that is not closed. edges: index of the edge of each side of a face."""
    faces = np.bincount(edges)
    single, many = int(np.sum(faces == 1)), int(np.sum(faces > 2))
    pieces = len(np.unique(labels))
    if pieces > len(labels) // 2:
        return (
            f"the mesh is open: its {len(labels)} faces are {pieces} separate pieces, because corners at the same "
            "place have different coordinates; merge close vertices before it is exported"
        )
    text = f"the mesh is open: {single} edges have only one face; close its holes" if single else ""
    if many:
        text += "; and " if text else "the mesh is not the surface of bodies: "
        text += (
            f"{many} edges have more than two faces; remove double or inner faces, and separate bodies that touch "
            "along an edge"
        )
    return text + (f" (it has {pieces} separate pieces; delete those that are not grains)" if pieces > 1 else "")


def _whole_bodies(vertices, faces, labels):
    """Group components into bodies and return [(labels of the components, volume)].

    A body is an outer component with all components inside it. Components inside it that are wound inwards are walls of
    cavities, and their volume is subtracted; the others are inside the solid and add nothing. A component inside no
    other one is a body, whatever its volume.
    """
    order = np.argsort(labels, kind="stable")
    names, starts = np.unique(labels[order], return_index=True)
    parts = [(name, vertices[part]) for name, part in zip(names, np.split(faces[order], starts[1:]), strict=True)]
    outer = []
    for name, corners in sorted(parts, key=lambda part: -np.prod(np.ptp(part[1], axis=(0, 1)))):
        volume = _signed_volume(corners)
        enclosing = next((body for body in outer if _is_within(corners, body["corners"])), None)
        if enclosing is None:
            outer.append({"labels": [name], "corners": corners, "volume": volume})
        else:
            enclosing["labels"].append(name)
            enclosing["volume"] += min(volume, 0.0)
    return [(body["labels"], body["volume"]) for body in outer]


def _signed_volume(corners):
    """Return the volume enclosed by triangles (m, 3, 3), negative if they are wound inwards."""
    a, b, c = np.moveaxis(corners - corners.mean(axis=(0, 1)), 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def _is_within(corners, enclosing):
    """Return whether a closed surface is inside another, by its outermost points; of two that cross, neither is."""
    low, high = enclosing.min(axis=(0, 1)), enclosing.max(axis=(0, 1))
    points = corners.reshape(-1, 3)
    if np.any(points < low) or np.any(points > high):
        return False
    ends = np.unique(np.concatenate([points.argmin(axis=0), points.argmax(axis=0)]))
    return all(_is_inside(point, enclosing) for point in points[ends])


def _is_inside(point, corners):
    """Return whether a point (3,) is inside a closed surface of triangles (m, 3, 3), by the surface's solid angle."""
    a, b, c = np.moveaxis(corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(edge, axis=1) for edge in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    denominator = la * lb * lc + np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la
    denominator += np.einsum("ij,ij->i", c, a) * lb
    return abs(np.arctan2(triple, denominator).sum()) > np.pi  # half of the solid angle: 2 pi inside, 0 outside

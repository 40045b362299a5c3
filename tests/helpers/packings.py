"""Packings made from arrays, with the layout of a packing's file, and lattices of spheres."""

import numpy as np
import xarray as xr
from scipy.spatial import ConvexHull

from tests.helpers.polyhedra import hull_faces


def make_packing(
    position,
    scale,
    orientation=None,
    vertices=None,
    width=0.1,
    domain="periodic",
    contacts=None,
    images=None,
    largest=None,
    **attrs,
):
    """Return a packing Dataset of one shape: unit spheres times scale or, with vertices (n, 3), convex polyhedra.

    position (n, 3), scale (n,) or (n, 3) [m]; orientation (n, 4), upright if None; contacts: list of body pairs; images
    (k, 2): of their second body, 0 if None. Contacts push with 1 N along the line of centres, or downwards at walls.
    Their points are on this line, at the first body's largest scale from its centre.
    """
    position = np.atleast_2d(np.asarray(position, float))
    n = len(position)
    scale = np.asarray(scale, float)
    scale = np.broadcast_to(scale if scale.ndim == 2 else scale.reshape(-1, 1), (n, 3)).copy()
    if orientation is None:
        orientation = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    convex = vertices is not None
    base = np.asarray(vertices, float) if convex else np.zeros((0, 3))
    faces = hull_faces(base) if convex else np.zeros((0, 3), int)
    volume = scale.prod(axis=1) * (ConvexHull(base).volume if convex else 4.0 / 3.0 * np.pi)
    axes = np.sort(2.0 * scale, axis=1)
    short, middle, long_axis = axes.T
    pairs = np.array([] if contacts is None else contacts, int).reshape(-1, 2)
    images = np.zeros_like(pairs) if images is None else np.asarray(images, int).reshape(-1, 2)
    normal, point = contact_geometry(position, scale, pairs, images, width)
    return xr.Dataset(
        {
            "position": (("grain", "xyz"), position),
            "orientation": (("grain", "wxyz"), np.atleast_2d(orientation)),
            "scale": (("grain", "xyz"), scale),
            "shape": ("grain", np.zeros(n, int)),
            "L": ("grain", long_axis),
            "I": ("grain", middle),
            "S": ("grain", short),
            "D": ("grain", np.sqrt(0.5 * (short**2 + middle**2))),
            "volume": ("grain", volume),
            "shape_kind": ("shape", np.array(["convex" if convex else "sphere"])),
            "shape_vertex_start": ("shape", [0]),
            "shape_vertex_count": ("shape", [len(base)]),
            "shape_vertices": (("vertex", "xyz"), base),
            "shape_face_start": ("shape", [0]),
            "shape_face_count": ("shape", [len(faces)]),
            "shape_faces": (("face", "corner"), faces),
            "contact_body": (("contact", "pair"), pairs),
            "contact_image": (("contact", "horizontal"), images),
            "contact_normal": (("contact", "xyz"), normal),
            "contact_point": (("contact", "xyz"), point),
            "contact_overlap": ("contact", np.full(len(pairs), 1e-8)),
            "contact_force": (("contact", "xyz"), normal.copy()),
        },
        attrs={
            "domain_shape": domain,
            "domain_width": width,
            "largest_sieve_size": float(2.0 * scale.max(initial=0.0)) if largest is None else largest,
            **attrs,
        },
    )


def contact_geometry(position, scale, pairs, images, width):
    """Return normals and points (k, 3) of contacts of spheres; normals are downwards without a line of centres."""
    first, second = pairs.T
    branch = position[np.maximum(second, 0)] - position[first]
    branch[:, :2] += images * width
    branch[second < 0] = [0.0, 0.0, -1.0]
    branch[~branch.any(axis=1)] = [0.0, 0.0, -1.0]
    normal = branch / np.linalg.norm(branch, axis=1, keepdims=True)
    return normal, position[first] + normal * scale[first].max(axis=1, initial=0.0)[:, None]


def touching_pairs(centres, width, diameter=1.0):
    """Return pairs (k, 2) of equal spheres that touch in a periodic box, and the images (k, 2) of the second."""
    pairs, images = [], []
    for image in np.ndindex(3, 3):
        shift = np.array([*image, 1.0]) - 1.0
        distance = np.linalg.norm(centres[None] + shift * width - centres[:, None], axis=2)
        a, b = np.nonzero(distance < diameter * (1.0 + 1e-9))
        keep = (a < b) | ((a == b) & (tuple(shift[:2]) > (0.0, 0.0)))
        pairs.append(np.column_stack([a, b])[keep])
        images.append(np.tile(shift[:2].astype(int), (keep.sum(), 1)))
    return np.concatenate(pairs), np.concatenate(images)


def sphere_lattice(kind, cells, layers):
    """Return centres (n, 3) of touching unit-diameter spheres on a cubic lattice, and the periodic box's width."""
    basis = {
        "sc": [[0, 0, 0]],
        "bcc": [[0, 0, 0], [0.5, 0.5, 0.5]],
        "fcc": [[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]],
    }[kind]
    edge = {"sc": 1.0, "bcc": 2.0 / np.sqrt(3.0), "fcc": np.sqrt(2.0)}[kind]
    cell = np.stack(np.meshgrid(np.arange(cells), np.arange(cells), np.arange(layers), indexing="ij"), -1)
    centres = edge * (cell.reshape(-1, 1, 3) + np.array(basis)).reshape(-1, 3)
    return centres + [0.0, 0.0, 0.5], cells * edge

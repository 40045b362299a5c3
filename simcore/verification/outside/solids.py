"""The five Platonic solids as meshes."""

import numpy as np
from scipy.spatial import ConvexHull

_GOLDEN = 0.5 * (1.0 + np.sqrt(5.0))
SOLIDS = ("tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron")


def solid_mesh(name: str, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 3) about their centre, and outward triangles (m, 3), of the solid with edge length `edge`."""
    vertices = _vertices(name)
    distances = np.linalg.norm(vertices[1:] - vertices[0], axis=1)
    vertices = vertices * edge / distances.min()
    hull = ConvexHull(vertices)
    a, b, c = vertices[hull.simplices.T]
    inward = (np.cross(b - a, c - a) * a).sum(axis=1) < 0.0
    return vertices, np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def write_solid(path, name: str, edge: float) -> None:
    """Write the solid as an OBJ file, in the unit of `edge`."""
    vertices, faces = solid_mesh(name, edge)
    lines = ["v {:.9f} {:.9f} {:.9f}".format(*vertex) for vertex in vertices]
    lines += ["f {} {} {}".format(*face) for face in faces + 1]
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


def _vertices(name):
    signs = np.array([-1.0, 1.0])
    cube = np.stack(np.meshgrid(signs, signs, signs), axis=-1).reshape(-1, 3)
    if name == "cube":
        return cube
    if name == "tetrahedron":
        return cube[cube.prod(axis=1) > 0.0]
    if name == "octahedron":
        return np.concatenate([np.eye(3), -np.eye(3)])
    if name == "icosahedron":
        return _cyclic(1.0, _GOLDEN)
    if name == "dodecahedron":
        return np.concatenate([cube, _cyclic(1.0 / _GOLDEN, _GOLDEN)])
    raise ValueError(f"{name!r} is not a Platonic solid; choose one of {', '.join(SOLIDS)}")


def _cyclic(a, b):
    """Return (0, ±a, ±b) and its cyclic permutations, (12, 3)."""
    corners = np.array([[0.0, i * a, j * b] for i in (-1.0, 1.0) for j in (-1.0, 1.0)])
    return np.concatenate([np.roll(corners, shift, axis=1) for shift in range(3)])

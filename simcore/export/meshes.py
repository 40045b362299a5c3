"""Surfaces for Blender, browsers and 3D printers: .glb, .stl and .ply, written by trimesh."""

import numpy as np
import trimesh

from simcore.export.placement import places, rotations
from simcore.export.surfaces import DIVISIONS, base_mesh, surfaces
from simcore.writing import whole_file

# From dark slate to sand, the colours of the pictures of packings. Size classes share them.
COLORS = np.array(
    [[47, 72, 88, 255], [95, 127, 134, 255], [169, 166, 140, 255], [224, 191, 134, 255], [247, 234, 208, 255]], np.uint8
)
INSTANCE_DIVISIONS = 3  # of spheres in files that store each shape once
GLB_AXES = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)  # glTF has y upwards, not z


def write_glb(path, packing, periodic="leave", divisions=None):
    """Write a scene with one node per grain, coloured by sieve size, whose height is glTF's y; lengths in metres.

    Whole grains are instances: the file stores each base shape once per colour, and for each grain only its place. Cut
    grains are meshes of their own. Nodes are named grain_12, further images and pieces of it grain_12_1, ...; their
    `extras` have the grain's number and D, L, I, S [m]. periodic: see simcore.export.placement; divisions: of the
    spheres (simcore.export.surfaces), None: INSTANCE_DIVISIONS for instances, DIVISIONS otherwise.
    """
    scene, names = trimesh.Scene(), _Names()
    color = _size_classes(packing["D"].values)
    scene.graph.update(frame_to="packing", matrix=GLB_AXES)
    if periodic == "cut" and packing.attrs["domain_shape"] == "periodic":
        for grain, vertices, faces in surfaces(packing, periodic, DIVISIONS if divisions is None else divisions):
            origin = packing["position"].values[grain]
            mesh = _mesh(vertices - origin, faces, color[grain])
            matrix = np.eye(4)
            matrix[:3, 3] = origin
            name = names.next(grain)
            _add(scene, packing, grain, name, matrix, mesh, f"mesh_{name}")
    else:
        shape, scale, to_world = packing["shape"].values, packing["scale"].values, rotations(packing)
        where = places(packing, periodic)
        for grain, shift in zip(where.grain, where.shift, strict=True):
            base = f"shape_{shape[grain]}_{color[grain]}"
            mesh = None
            if base not in scene.geometry:
                fine = INSTANCE_DIVISIONS if divisions is None else divisions
                mesh = _mesh(*base_mesh(packing, shape[grain], fine), color[grain])
            matrix = np.eye(4)
            matrix[:3, :3] = to_world[grain] * scale[grain]
            matrix[:3, 3] = packing["position"].values[grain] + shift
            _add(scene, packing, grain, names.next(grain), matrix, mesh, base)
    with whole_file(path) as part:
        part.write_bytes(scene.export(file_type="glb"))


def write_triangles(path, packing, periodic="leave", divisions=None):
    """Write one mesh of all grains, as .stl or .ply by the suffix of the path; lengths in metres.

    Both formats store single precision, to 6e-8 of the largest coordinate. A .ply has the number of the grain and its
    sieve size [m] on each face.
    """
    vertices, faces, of_grain, n = [], [], [], 0
    for grain, points, triangles in surfaces(packing, periodic, DIVISIONS if divisions is None else divisions):
        vertices.append(points)
        faces.append(triangles + n)
        of_grain.append(np.full(len(triangles), grain))
        n += len(points)
    mesh = trimesh.Trimesh(np.concatenate(vertices), np.concatenate(faces), process=False)
    if path.suffix.lower() == ".ply":
        grain = np.concatenate(of_grain)
        mesh.face_attributes["grain"] = grain.astype(np.int32)
        mesh.face_attributes["D"] = packing["D"].values[grain].astype(np.float32)
    with whole_file(path) as part:
        part.write_bytes(mesh.export(file_type=path.suffix.lower()[1:]))


class _Names:
    """Gives each node of a grain a name of its own."""

    def __init__(self):
        self.used = {}

    def next(self, grain):
        count = self.used[grain] = self.used.get(grain, -1) + 1
        return f"grain_{grain}" + (f"_{count}" if count else "")


def _add(scene, packing, grain, name, matrix, mesh, geometry):
    """Add a node for a grain, and its geometry unless the scene already has it (mesh is None)."""
    numbers = {key: float(packing[key].values[grain]) for key in ("D", "L", "I", "S")}
    if mesh is not None:
        scene.geometry[geometry] = mesh
    scene.graph.update(
        frame_to=name, frame_from="packing", matrix=matrix, geometry=geometry, metadata={"grain": int(grain), **numbers}
    )


def _mesh(vertices, faces, color):
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    material = trimesh.visual.material.PBRMaterial(
        baseColorFactor=COLORS[color], metallicFactor=0.0, roughnessFactor=0.9
    )
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    return mesh


def _size_classes(sizes):
    """Return for each grain which of the colours its sieve size has, (n,); the classes are equally wide in log D."""
    low, high = np.log([sizes.min(), sizes.max()])
    share = (np.log(sizes) - low) / (high - low) if high - low > 1e-9 else np.full(len(sizes), 0.5)
    return np.minimum((share * len(COLORS)).astype(int), len(COLORS) - 1)

"""Measured grains from files: meshes, point clouds, voxel masks and spherical-harmonic coefficients."""

from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import trimesh

from simcore.grains.mesh import make_grain
from simcore.grains.polyhedron import volume_moments
from simcore.grains.spherical_harmonics import read_coefficients, surface_points
from simcore.grains.voxels import mask_surface

UNITS = {"m": 1.0, "mm": 1e-3}
# Sieve sizes [m] that a grain may have. Sizes from 2 to 50 mm in the wrong one of the two units fall outside.
SIZE_RANGE = (5e-5, 2.0)

_MESHES = (".stl", ".ply", ".obj", ".off")
_POINTS = (".xyz", ".csv")
_COEFFICIENTS = (".txt", ".dat")
_ARRAYS = (".npy", ".npz")
_KNOWN = (*_MESHES, *_POINTS, *_COEFFICIENTS, *_ARRAYS)


def read_grain(path, unit, spacing=None):
    """The Grain of one file, named as the file.

    path: .stl .ply .obj .off mesh (closed, outward faces); .xyz .csv points on or in the grain, one x y z a
    line; .npy points (n, 3), or a voxel mask (nx, ny, nz); .npz with `mask` and, unless given here, `spacing`;
    .txt .dat spherical-harmonic coefficients.
    unit: "m" or "mm", of the file's lengths and of spacing, the edge of a voxel, a number or three.
    ValueError names the file, what is wrong and how to mend it.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"grain file {path} does not exist: correct the path")
    if unit not in UNITS:
        raise ValueError(f"{path}: its unit is {unit!r}: state `unit` as one of {', '.join(UNITS)}")
    suffix = path.suffix.lower()
    if suffix not in _KNOWN:
        raise ValueError(f"{path}: unknown extension {suffix!r}: known are {' '.join(_KNOWN)}")
    try:
        points = _read_points(path, suffix, spacing)
    except (OSError, KeyError, ValueError) as error:
        message = str(error)
        raise ValueError(message if str(path) in message else f"{path}: {message}") from None
    name = path.name.removesuffix(path.suffix).removesuffix(".sh")
    try:
        grain = make_grain(name, points * UNITS[unit])
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    low, high = SIZE_RANGE
    if not low <= grain.sieve_size <= high:
        raise ValueError(
            f"{path}: the grain has a sieve size of {grain.sieve_size * 1e3:.3g} mm, outside {low * 1e3:g} to "
            f"{high * 1e3:g} mm: is `unit` {unit!r} right?"
        )
    return grain


def read_grain_files(source, unit, spacing=None):
    """All grains of source: one path, a list of paths, or a folder; a folder gives its grain files by name.

    Of a folder's .txt and .dat files only those that are named as coefficients (*.sh.txt, *anm*.dat) count.
    """
    paths = [Path(p) for p in ([source] if isinstance(source, str | Path) else source)]
    files = [file for path in paths for file in (_folder_files(path) if path.is_dir() else [path])]
    grains = [read_grain(file, unit, spacing) for file in files]
    names = [grain.name for grain in grains]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"two grain files are named {twice[0]!r}: rename one, grains are known by their name")
    return grains


def _folder_files(folder):
    files = sorted(
        file
        for file in folder.iterdir()
        if file.suffix.lower() in _KNOWN
        and (file.suffix.lower() not in _COEFFICIENTS or file.name.endswith(".sh.txt") or "anm" in file.name)
    )
    if not files:
        raise ValueError(f"folder {folder} holds no grain files ({' '.join(_KNOWN)}): correct the path")
    return files


def _read_points(path, suffix, spacing):
    if suffix in _MESHES:
        return _read_mesh(path)
    if suffix in _COEFFICIENTS:
        return surface_points(read_coefficients(path))
    if suffix in _POINTS:
        return _read_table(path, "," if suffix == ".csv" else None)
    try:
        data = np.load(path, allow_pickle=False)
    except (ValueError, EOFError, BadZipFile):
        raise ValueError("is no file of NumPy arrays: write it with numpy.save or numpy.savez") from None
    if suffix == ".npz":
        mask, spacing = data["mask"], data["spacing"] if spacing is None else spacing
    elif data.ndim == 3:
        mask = data
    else:
        return data
    if spacing is None:
        raise ValueError("a voxel mask needs `spacing`, the edge of a voxel")
    return mask_surface(mask, spacing)


def _read_table(path, delimiter):
    """x, y, z of each line (n, 3); lines that start with # and one header line are skipped."""
    lines = [line for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    try:
        [float(cell) for cell in (lines[0].split(delimiter) if lines else [])]
    except ValueError:
        lines = lines[1:]
    if not lines:
        raise ValueError("holds no points")
    return np.loadtxt(lines, delimiter=delimiter, ndmin=2)[:, :3]


def _read_mesh(path):
    """Vertices (n, 3) of a mesh file, after checking that its triangles enclose a body from outside."""
    try:
        mesh = trimesh.load(path, force="mesh", process=False)
    except Exception as error:  # the parsers of trimesh raise whatever they stumble over
        raise ValueError(f"cannot be read as a mesh: {error}") from None
    vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces)
    if len(faces) == 0:
        raise ValueError("the mesh is empty: it holds no faces")
    if not np.isfinite(vertices).all():
        raise ValueError("the mesh has vertices with NaN or infinite coordinates: export it again")
    size = np.ptp(vertices[faces.ravel()], axis=0).max() or 1.0
    centred = (vertices - vertices.mean(0)) / size
    thickness = np.linalg.svd(centred - centred.mean(0), compute_uv=False)[-1] / np.sqrt(len(centred))
    if thickness < 1e-6:
        raise ValueError("the mesh is flat: all its vertices lie in one plane")
    closed = trimesh.Trimesh(centred, faces, process=False)
    closed.merge_vertices(merge_tex=True, merge_norm=True)  # STL repeats the corners of every triangle
    closed.update_faces(closed.nondegenerate_faces())
    if not closed.is_watertight:
        raise ValueError("the mesh is open: an edge has not exactly two faces; close its holes")
    volume = volume_moments(closed.vertices, closed.faces)[0] if closed.is_winding_consistent else -1.0
    if volume <= 0:
        raise ValueError("the mesh is inverted: faces are wound inwards, all or some; turn them outwards")
    return vertices[np.unique(faces)]

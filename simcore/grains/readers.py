"""Measured grains from files: meshes, point clouds, voxel images and spherical-harmonic coefficients."""

from pathlib import Path

import numpy as np

from simcore.grains.bodies import BODIES, Body, mesh_bodies, select_bodies
from simcore.grains.mesh import make_grain
from simcore.grains.mesh_files import read_mesh
from simcore.grains.point_tables import how_to_use_forms, read_points, refuse_forms
from simcore.grains.spherical_harmonics import radius, read_coefficients, sampled_directions
from simcore.grains.voxels import image_bodies

UNITS = {"m": 1.0, "mm": 1e-3}
# Sieve sizes [m] that a grain may have. Sizes from 2 to 50 mm in the wrong one of the two units fall outside.
SIZE_RANGE = (5e-5, 2.0)

_MESHES = (".stl", ".ply", ".obj", ".off")
_POINTS = (".xyz", ".csv")
_COEFFICIENTS = (".txt", ".dat")
_ARRAYS = (".npy", ".npz")
_KNOWN = (*_MESHES, *_POINTS, *_COEFFICIENTS, *_ARRAYS)
_SHEETS = (".xlsx", ".xls", ".ods", ".tsv")
_APPLE_DOUBLE = b"\x00\x05\x16\x07"  # first bytes of the files `._name` that macOS writes beside others
# Coordinates of a body this many times its size from the origin, rounded to more than this share of it, are refused.
_FAR, _COARSE = 100.0, 2e-3
_LARGEST = 1e12  # above any length; its powers do not overflow


def read_grain(path, unit, spacing=None):
    """The one Grain of a file; arguments and errors as of read_grains_of."""
    grains = read_grains_of(path, unit, spacing)
    if len(grains) > 1:
        raise ValueError(f"{path}: it has {len(grains)} grains, one label each: read it with read_grain_files")
    return grains[0]


def read_grains_of(path, unit, spacing=None, bodies="one"):
    """The Grains of one file (list): one named as the file, or several, `name_1` and so on.

    path: .stl .ply .obj .off mesh (closed, outward faces; .ply .obj .off without faces are points); .xyz .csv points
    on or in the grain, see simcore.grains.point_tables; .npy points (n, 3), or a voxel image (nx, ny, nz): a mask, or
    labels, of which each is a grain `name_label`; .npz with `mask` and, unless given here, `spacing`; .txt .dat
    spherical-harmonic coefficients.
    unit: "m" or "mm", of the file's lengths and of spacing, the edge of a voxel, a number or three. bodies: what
    becomes of several bodies in a file or label, see simcore.grains.bodies.select_bodies.
    ValueError names the file, what is wrong and how to mend it.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"grain file {path} does not exist: correct the path")
    if unit not in UNITS:
        raise ValueError(f"{path}: its unit is {unit!r}: state `unit` as one of {', '.join(UNITS)}")
    if bodies not in BODIES:
        raise ValueError(f"grains.bodies: {bodies!r} is unknown: use {', '.join(BODIES)}")
    try:
        groups = _read_groups(path, unit, spacing)
        groups = [(label, _selected(label, group, bodies, unit)) for label, group in groups]
    except (OSError, KeyError, ValueError) as error:
        message = str(error)
        raise ValueError(message if str(path) in message else f"{path}: {message}") from None
    name = path.name.removesuffix(path.suffix).removesuffix(".sh")
    grains = []
    for label, group in groups:
        own = f"{name}_{label}" if label else name
        names = [f"{own}_{i + 1}" for i in range(len(group))] if len(group) > 1 else [own]
        grains += [_make(path, *pair, unit) for pair in zip(names, group, strict=True)]
    return grains


def _selected(label, group, bodies, unit):
    try:
        return select_bodies(group, bodies, unit)
    except ValueError as error:
        raise ValueError(f"label {label}: {error}" if label else str(error)) from None


def _make(path, name, body, unit):
    try:
        grain = make_grain(name, body.points * UNITS[unit], body.volume * UNITS[unit] ** 3, body.notes)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    low, high = SIZE_RANGE
    if not low <= grain.sieve_size <= high:
        raise ValueError(
            f"{path}: the grain has a sieve size of {grain.sieve_size * 1e3:.3g} mm, outside {low * 1e3:g} to "
            f"{high * 1e3:g} mm: is `unit` {unit!r} right?"
        )
    return grain


def read_grain_files(source, unit, spacing=None, bodies="one"):
    """All grains of source: one path, a list of paths, or a folder; a folder gives its grain files by name.

    What a folder has besides, grain_files lists. Arguments and errors as of read_grains_of.
    """
    grains = [grain for file in grain_files(source)[0] for grain in read_grains_of(file, unit, spacing, bodies)]
    names = [grain.name for grain in grains]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"two grain files are named {twice[0]!r}: rename one, grains are known by their name")
    return grains


def grain_files(source):
    """Files (list of Path) of source, as of read_grain_files, and of its folders what is left out: {Path: reason}.

    ValueError if a folder has no grain files.
    """
    files, left_out = [], {}
    for path in [Path(p) for p in ([source] if isinstance(source, str | Path) else source)]:
        if not path.is_dir():
            files.append(path)
            continue
        reasons = {file: _reason_to_leave_out(file) for file in sorted(path.iterdir())}
        there = [file for file, reason in reasons.items() if reason is None]
        left_out |= {file: reason for file, reason in reasons.items() if reason is not None}
        if not there:
            others = "; ".join(f"{file.name}: {reason}" for file, reason in list(reasons.items())[:5])
            raise ValueError(
                f"folder {path} holds no grain files ({' '.join(_KNOWN)}): correct the path"
                + (f"; left out are {others}" if others else "")
            )
        files += there
    return files, left_out


def _reason_to_leave_out(file):
    """Why a file of a folder is no grain, None if it is one."""
    suffix = file.suffix.lower()
    if file.is_dir():
        return "it is a folder; files of grains lie in the given folder itself"
    if file.name.startswith("."):
        return "it is hidden, as what macOS writes beside the files"
    if suffix not in _KNOWN:
        return f"its extension {suffix!r} is none of files of grains"
    if suffix in _COEFFICIENTS and not (file.name.endswith(".sh.txt") or "anm" in file.name):
        return "it is not named as coefficients are, *.sh.txt or *anm*.dat"
    if suffix in _POINTS:
        try:
            refuse_forms(file)
        except ValueError:
            return "it is a table of axes or forms, not of points"
    return None


def _read_groups(path, unit, spacing):
    """[(label, bodies)] of a file, lengths in its unit; the label is "" where there are none."""
    suffix = path.suffix.lower()
    with path.open("rb") as file:
        if file.read(4) == _APPLE_DOUBLE:
            raise ValueError("it was written by macOS beside another file and has no grain: delete it")
    if suffix in _SHEETS:
        raise ValueError(
            f"extension {suffix!r}: points are read from {' or '.join(_POINTS)}; a table of axes is no grain, "
            + how_to_use_forms(path)
        )
    if suffix not in _KNOWN:
        raise ValueError(f"unknown extension {suffix!r}: known are {' '.join(_KNOWN)}")
    if suffix in _ARRAYS:
        return _array_groups(path, unit, spacing)
    if suffix in _POINTS:
        points, unused = read_points(path, unit)
        note = (f"was read from the columns x, y, z; not used: {', '.join(unused)}",) if unused else ()
        return [("", [_cloud(points, unit, note)])]
    if suffix in _COEFFICIENTS:
        refuse_forms(path)
        return [("", [_star_body(read_coefficients(path))])]
    vertices, faces = read_mesh(path)
    if not np.isfinite(vertices).all():
        raise ValueError("the mesh has vertices with NaN or infinite coordinates: export it again")
    if len(faces) == 0:
        if len(vertices) == 0:
            raise ValueError("the mesh is empty: it holds no faces")
        return [("", [_cloud(vertices, unit, ("has no faces; its vertices were read as points",))])]
    _check_precision(vertices[np.unique(faces)], unit)
    return [("", mesh_bodies(vertices, faces))]


def _cloud(points, unit, notes=()):
    _check_precision(points, unit)
    return Body(points, notes=notes)


def _star_body(coefficients):
    """Body of a surface given by its radius; the mean of r³ over even directions is that of the ball of its volume."""
    directions = sampled_directions(coefficients)
    r = radius(coefficients, directions)
    return Body(r[:, None] * directions, 4 / 3 * np.pi * float(np.mean(r**3)))


def _array_groups(path, unit, spacing):
    try:
        data = np.load(path, allow_pickle=False)
        if path.suffix.lower() == ".npz":
            with data as archive:
                data = dict(archive)
    except OSError:
        raise
    except Exception:  # the parsers of numpy and zipfile raise whatever they stumble over
        raise ValueError("is no file of NumPy arrays: write it with numpy.save or numpy.savez") from None
    if isinstance(data, dict):
        missing = [key for key in ("mask", "spacing") if key not in data and (key == "mask" or spacing is None)]
        if missing:
            raise ValueError(f"it has no array {', '.join(missing)}, but {', '.join(data)}: name the arrays so")
        return image_bodies(data["mask"], data["spacing"] if spacing is None else spacing)
    if data.ndim == 3:
        if spacing is None:
            raise ValueError("a voxel mask needs `spacing`, the edge of a voxel")
        return image_bodies(data, spacing)
    if data.ndim != 2 or data.shape[1] != 3 or data.dtype.kind not in "uif":
        raise ValueError(
            f"an array {data.shape} of {data.dtype} is neither points with 3 coordinates, (n, 3), nor a voxel image of "
            "three dimensions"
        )
    return [("", [_cloud(data.astype(float), unit)])]


def _check_precision(points, unit):
    """ValueError if the points lie so far from the origin that their coordinates are rounded too coarsely."""
    finite = points[np.isfinite(points).all(axis=1)]
    if len(finite) == 0:
        return
    distance = np.abs(finite).max(axis=0)
    if distance.max() > _LARGEST:
        raise ValueError(f"coordinates of {distance.max():.3g} {unit} are no lengths: correct or export them again")
    size = np.ptp(finite, axis=0).max()
    for axis in np.flatnonzero(distance > _FAR * size):
        step = _rounding(finite[:, axis])
        if step > _COARSE * size:
            raise ValueError(
                f"its coordinates {'xyz'[axis]} are up to {distance[axis]:.6g} {unit} from the origin and rounded to "
                f"{step:.2g} {unit}, too coarse for a body {size:.3g} {unit} across: they are too far from the origin "
                "for their precision; shift them there before they are written"
            )


def _rounding(values):
    """To what the values are rounded: to so many decimals, or to single precision, whichever is coarser."""
    largest = np.abs(values).max()
    decimals = next((d for d in range(10) if np.abs(values - np.round(values, d)).max() <= 4e-16 * largest), 10)
    single = float(np.spacing(np.float32(largest))) if np.all(values == values.astype(np.float32)) else 0.0
    return max(10.0**-decimals, single)

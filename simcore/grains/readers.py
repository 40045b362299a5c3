"""Reads measured grains from files: meshes, point clouds, voxel images and spherical-harmonic coefficients."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from simcore.grains.bodies import BODIES, Body, mesh_bodies, select_bodies
from simcore.grains.mesh import make_grain
from simcore.grains.mesh_files import read_mesh
from simcore.grains.point_tables import how_to_use_forms, read_points, refuse_forms
from simcore.grains.spherical_harmonics import cut_at, radius, read_coefficients, sampled_directions
from simcore.grains.voxels import image_bodies

UNITS = {"m": 1.0, "mm": 1e-3}
SHOWN_ERRORS = 5  # files of which a message describes the faults
# Sieve sizes [m] that a grain may have. Sizes from 2 to 50 mm are outside if the other unit is given by mistake.
SIZE_RANGE = (5e-5, 2.0)
FINE = 5e-4  # [m]; a finer grain may be a cobble in metres whose unit is given as mm

_MESHES = (".stl", ".ply", ".obj", ".off")
_POINTS = (".xyz", ".csv")
_COEFFICIENTS = (".txt", ".dat")
_ARRAYS = (".npy", ".npz")
_EXTENSIONS = (*_MESHES, *_POINTS, *_COEFFICIENTS, *_ARRAYS)
_SHEETS = (".xlsx", ".xls", ".ods", ".tsv")
_APPLE_DOUBLE = b"\x00\x05\x16\x07"  # first bytes of the files `._name` that macOS writes next to others
# Coordinates are refused if they are this many times the body's size from the origin and rounded to more than this
# share of its size.
_FAR, _COARSE = 100.0, 2e-3
_LARGEST = 1e12  # larger than any length, but its powers do not overflow


def read_grain(path, unit, spacing=None):
    """Read the only Grain of a file; arguments and errors as in read_grains_of."""
    grains = read_grains_of(path, unit, spacing)
    if len(grains) > 1:
        raise ValueError(f"{path}: it has {len(grains)} grains, one for each label; read it with read_grain_files")
    return grains[0]


def read_grains_of(path, unit, spacing=None, bodies="one", degree=None):
    """Read the list of Grain of one file; one grain has the file's name, several are called `name_1` and so on.

    path: one of these files
    - .stl .ply .obj .off: closed mesh with outward faces; .ply .obj .off without faces are points;
    - .xyz .csv: points on or in the grain, see simcore.grains.point_tables;
    - .npy: points (n, 3), or a voxel image (nx, ny, nz), which is a mask, or labels that each are a grain `name_label`;
    - .npz: a voxel image `mask` and its own `spacing`, which is used instead of the one given here;
    - .txt .dat: spherical-harmonic coefficients.
    unit: "m" or "mm", of the lengths in the file and of spacing; spacing: edge of a voxel, a number or three; bodies:
    treatment of several bodies in a file or label, see simcore.grains.bodies.select_bodies; degree: highest harmonic
    degree that is used of coefficients, None for all.
    ValueError names the file, the fault and the remedy.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"the grain file {path} does not exist; correct the path")
    if unit not in UNITS:
        raise ValueError(f"{path}: its unit is {unit!r}; state `unit` as one of {', '.join(UNITS)}")
    if bodies not in BODIES:
        raise ValueError(f"grains.bodies: {bodies!r} is unknown; use one of {', '.join(BODIES)}")
    try:
        groups = _read_groups(path, unit, spacing, degree)
        groups = [(label, _select(label, group, bodies, unit)) for label, group in groups]
    except (OSError, KeyError, ValueError) as error:
        message = str(error)
        raise ValueError(message if str(path) in message else f"{path}: {message}") from None
    name = file_name(path)
    grains = []
    for label, group in groups:
        base = f"{name}_{label}" if label else name
        names = [f"{base}_{i + 1}" for i in range(len(group))] if len(group) > 1 else [base]
        grains += [_make(path, *pair, unit) for pair in zip(names, group, strict=True)]
    return grains


def _select(label, group, bodies, unit):
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
            f"{path}: the grain {name} has a sieve size of {grain.sieve_size * 1e3:.3g} mm, outside {low * 1e3:g} to "
            f"{high * 1e3:g} mm; check that `unit` {unit!r} is right"
        )
    if unit == "mm" and grain.sieve_size < FINE:
        note = f"a sieve size below {FINE * 1e3:g} mm; if these are cobbles, the unit of the files is m instead of mm"
        return replace(grain, notes=(*grain.notes, note))
    return grain


def read_grain_files(source, unit, spacing=None, bodies="one", degree=None, names=None):
    """Read all grains of source: one path, a list of paths, or a folder, whose grain files are read in order of name.

    names: names of the files that are read, without extension, in the order of the grains; None for all. grain_files
    lists the other files of a folder. Other arguments and errors as in read_grains_of.
    """
    files = select_files(grain_files(source)[0], names)
    grains, errors = [], []
    for file in files:
        try:
            grains += read_grains_of(file, unit, spacing, bodies, degree)
        except ValueError as error:
            errors.append(str(error))
    if errors:
        more = f"; {len(errors) - SHOWN_ERRORS} more files have errors" if len(errors) > SHOWN_ERRORS else ""
        raise ValueError("; ".join(errors[:SHOWN_ERRORS]) + more)
    names = [grain.name for grain in grains]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"two grains are named {twice[0]!r}, but names must be unique; rename one of the files")
    return grains


def grain_files(source):
    """Return the grain files of source, list of Path, and the files of its folders that are left out, {Path: reason}.

    source: as in read_grain_files. ValueError if a folder has no grain files.
    """
    files, left_out = [], {}
    for path in [Path(p) for p in ([source] if isinstance(source, str | Path) else source)]:
        if not path.is_dir():
            files.append(path)
            continue
        reasons = {file: _reason_to_leave_out(file) for file in sorted(path.iterdir())}
        usable = [file for file, reason in reasons.items() if reason is None]
        left_out |= {file: reason for file, reason in reasons.items() if reason is not None}
        if not usable:
            others = "; ".join(f"{file.name}: {reason}" for file, reason in list(reasons.items())[:5])
            raise ValueError(
                f"the folder {path} contains no grain files ({' '.join(_EXTENSIONS)}); correct the path"
                + (f"; left out are {others}" if others else "")
            )
        files += usable
    return files, left_out


def select_files(files, names):
    """Return the files (list of Path) with these names, without extension, in the order of names; all if it is None.

    ValueError if a name is given twice, or is not the name of a file.
    """
    if names is None:
        return files
    by_name = {}
    for file in files:
        by_name.setdefault(file_name(file), []).append(file)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"grains.names: {twice[0]!r} is listed twice; remove one")
    unknown = [name for name in names if name not in by_name]
    if unknown:
        first = ", ".join(list(by_name)[:5]) + (", ..." if len(by_name) > 5 else "")
        raise ValueError(
            f"grains.names: grains.source has no file {unknown[0]!r}, and {len(unknown)} of {len(names)} names are "
            f"missing; its {len(files)} files of grains are {first}; correct the names, or set grains.names to null to "
            "read all files"
        )
    return [file for name in names for file in by_name[name]]


def file_name(path):
    """Return the name of a file of grains without its extension; the grain in it has this name."""
    name = path.name.removesuffix(path.suffix)
    return name[:-3] if name.lower().endswith(".sh") else name


def _reason_to_leave_out(file):
    """Return the reason why a file of a folder is not a grain, or None if it is one."""
    suffix = file.suffix.lower()
    if file.is_dir():
        return "it is a folder; only files directly in the given folder are read"
    if file.name.startswith("."):
        return "it is hidden, like the files that macOS writes next to others"
    if suffix not in _EXTENSIONS:
        return f"its extension {suffix!r} is not that of a file of grains"
    if suffix in _COEFFICIENTS and not (file.name.lower().endswith(".sh.txt") or "anm" in file.name.lower()):
        return "its name is not that of coefficients, *.sh.txt or *anm*.dat"
    if suffix in _POINTS:
        try:
            refuse_forms(file)
        except ValueError:
            return "it is a table of axes or forms, not of points"
    return None


def _read_groups(path, unit, spacing, degree):
    """Read a file and return [(label, bodies)], lengths in its unit; the label is "" if there are no labels."""
    suffix = path.suffix.lower()
    with path.open("rb") as file:
        if file.read(4) == _APPLE_DOUBLE:
            raise ValueError("macOS wrote this file next to another one, and it contains no grain; delete it")
    if suffix in _SHEETS:
        raise ValueError(
            f"points cannot be read from the extension {suffix!r}, only from {' or '.join(_POINTS)}; if it is a table "
            "of axes, " + how_to_use_forms(path)
        )
    if suffix not in _EXTENSIONS:
        raise ValueError(f"unknown extension {suffix!r}; files of grains have one of {' '.join(_EXTENSIONS)}")
    if degree is not None and suffix not in _COEFFICIENTS:
        raise ValueError("grains.degree is for coefficients of spherical harmonics; set it to null for this file")
    if suffix in _ARRAYS:
        return _array_groups(path, unit, spacing)
    if suffix in _POINTS:
        points, unused = read_points(path, unit)
        note = (f"was read from the columns x, y, z; not used: {', '.join(unused)}",) if unused else ()
        return [("", [_cloud(points, unit, note)])]
    if suffix in _COEFFICIENTS:
        refuse_forms(path)
        return [("", [_star_body(cut_at(read_coefficients(path), degree))])]
    vertices, faces = read_mesh(path)
    if not np.isfinite(vertices).all():
        raise ValueError("the mesh has vertices with NaN or infinite coordinates; export it again")
    if len(faces) == 0:
        if len(vertices) == 0:
            raise ValueError("the mesh is empty: it has neither vertices nor faces; export it again")
        return [("", [_cloud(vertices, unit, ("has no faces; its vertices were read as points",))])]
    _check_precision(vertices[np.unique(faces)], unit)
    return [("", mesh_bodies(vertices, faces))]


def _cloud(points, unit, notes=()):
    _check_precision(points, unit)
    return Body(points, notes=notes)


def _star_body(coefficients):
    """Return the Body of a surface given by its radius; its volume is 4/3 pi times the mean of r³ over the sphere."""
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
    except Exception:  # the parsers of numpy and zipfile can raise any exception
        raise ValueError("this is not a file of NumPy arrays; write it with numpy.save or numpy.savez") from None
    if isinstance(data, dict):
        missing = [key for key in ("mask", "spacing") if key not in data and (key == "mask" or spacing is None)]
        if missing:
            raise ValueError(
                f"it has no array {', '.join(missing)}, but {', '.join(data)}; name the arrays `mask` and `spacing`"
            )
        return image_bodies(data["mask"], _own_spacing(data["spacing"]) if "spacing" in data else spacing)
    if data.ndim == 3:
        if spacing is None:
            raise ValueError("a voxel image needs `spacing`, the edge of a voxel; set `grains.voxel_spacing`")
        return image_bodies(data, spacing)
    if data.ndim != 2 or data.shape[1] != 3 or data.dtype.kind not in "uif":
        raise ValueError(
            f"an array {data.shape} of {data.dtype} is neither points with 3 coordinates, (n, 3), nor a voxel image of "
            "three dimensions; write one of these"
        )
    return [("", [_cloud(data.astype(float), unit)])]


def _own_spacing(spacing):
    """Return the spacing of an .npz file, an array with one number or (3,); ValueError if it is something else."""
    if spacing.dtype.kind not in "uif" or spacing.shape not in ((), (1,), (3,)):
        raise ValueError(
            f"its array `spacing` has the shape {spacing.shape} and the type {spacing.dtype}; give one number or "
            "three, the edges of a voxel in the unit of `grains.unit`"
        )
    return spacing


def _check_precision(points, unit):
    """Raise ValueError if the points are so far from the origin that their coordinates are rounded too coarsely."""
    finite = points[np.isfinite(points).all(axis=1)]
    if len(finite) == 0:
        return
    distance = np.abs(finite).max(axis=0)
    if distance.max() > _LARGEST:
        raise ValueError(f"coordinates of {distance.max():.3g} {unit} are too large for lengths; export them again")
    size = np.ptp(finite, axis=0).max()
    for axis in np.flatnonzero(distance > _FAR * size):
        step = _rounding(finite[:, axis])
        if step > _COARSE * size:
            raise ValueError(
                f"its coordinates {'xyz'[axis]} are up to {distance[axis]:.6g} {unit} from the origin and rounded to "
                f"{step:.2g} {unit}, too coarse for a body {size:.3g} {unit} across; they are too far from the origin "
                "for their precision; shift them to the origin before they are written"
            )


def _rounding(values):
    """Return the step to which the values are rounded, the coarser one of their decimals and single precision."""
    largest = np.abs(values).max()
    decimals = next((d for d in range(10) if np.abs(values - np.round(values, d)).max() <= 4e-16 * largest), 10)
    single = float(np.spacing(np.float32(largest))) if np.all(values == values.astype(np.float32)) else 0.0
    return max(10.0**-decimals, single)

"""The netCDF file of a packing (CF conventions): positions, shapes, contacts and provenance."""

import functools
import json
import os
from pathlib import Path

import numpy as np
import xarray as xr
from filelock import lock_descriptor

from simcore.compilation import source_digest
from simcore.dem.state.touching_contacts import touching_contacts
from simcore.grains.sieve import SieveCurve, class_fractions
from simcore.packing.file_content import DATASET, check_content
from simcore.packing.packed import DAMPING, GENERATING, SHAKING, Packed
from simcore.provenance.code_name import code_name
from simcore.provenance.version import VERSION
from simcore.scene.scene import Scene
from simcore.scene.shapes import Base
from simcore.writing import whole_file

RENAMED = {"mass_fraction_asked": "mass_fraction_specified"}  # variables of files of Scree 0.1


def packing_dataset(
    scene: Scene, bases: list[Base], packed: Packed, sample, specification: dict, curve=None, **attributes
):
    """Return a packing as an xarray Dataset, with all that is needed to evaluate it and to trace how it was made.

    sample: the GrainSample of all its grains. specification: the resolved one from which `scene` was made. curve: of
    its sizes; for a SieveCurve the file stores the specified and the drawn mass fractions. attributes: further ones,
    such as cpu_seconds. Centres are wrapped into the periodic box, and the images of contacts are adjusted to this.
    """
    bodies = packed.bodies
    width = scene.domain.width if scene.domain.periodic else 0.0
    shift = np.zeros((len(bodies.mass), 2), np.int64)
    if scene.domain.periodic:
        shift[:] = np.floor(bodies.position[:, :2] / width)
    position = bodies.position.copy()
    position[:, :2] -= shift * width
    # A centre just below 0 is rounded to the width.
    beyond = scene.domain.periodic & (position[:, :2] >= width)
    position[:, :2][beyond] = 0.0
    shift += beyond
    # Spheres have no orientation.
    orientation = bodies.orientation if len(bodies.orientation) else np.tile([1.0, 0.0, 0.0, 0.0], (len(shift), 1))
    grain, xyz = "grain", ("grain", "xyz")
    data = {
        "position": (xyz, position, _m("centre of mass")),
        "orientation": (("grain", "wxyz"), orientation, _one("unit quaternion, body to world")),
        "scale": (xyz, bodies.scale, _one("factor on the base shape along its axes; semi-axes [m] of a unit sphere")),
        "shape": (grain, bodies.shape, _one("index of the base shape")),
        "velocity": (xyz, bodies.velocity, {"units": "m s-1", "long_name": "velocity of the centre"}),
        "L": (grain, sample.L, _m("longest axis of the mass-equivalent ellipsoid")),
        "I": (grain, sample.I, _m("intermediate axis of the mass-equivalent ellipsoid")),
        "S": (grain, sample.S, _m("shortest axis of the mass-equivalent ellipsoid")),
        "D": (grain, sample.D, _m("sieve size")),
        "volume": (grain, sample.volume, {"units": "m3", "long_name": "volume"}),
    }
    data |= _sieve_variables(curve, sample) if isinstance(curve, SieveCurve) else {}
    data |= _shape_variables(bases) | _contact_variables(packed, shift, width) | _history_variables(packed)
    observed = packed.observation
    attrs = {
        "Conventions": "CF-1.11",
        "title": f"Packing {scene.name}",
        "source": f"Scree {VERSION}",
        "code_version": code_version(),
        "scene": json.dumps(specification, sort_keys=True),
        "seed": scene.seed,
        "domain_shape": scene.domain.type,
        "domain_width": scene.domain.width,
        "domain_height": scene.domain.height,
        "density": scene.material.density,
        "fluid_density": scene.material.fluid_density,
        "gravity": scene.material.gravity,
        "converged": 1,
        "steps": packed.steps,
        "time": packed.time,
        "last_insertion": packed.last_insertion,
        "max_speed": observed.max_speed,
        "unbalanced_force": observed.unbalanced_force,
        "kinetic_energy": observed.kinetic_energy,
        "mean_overlap_in_diameters": packed.mean_overlap,
        **_stability_attributes(packed.stability),
        **attributes,
    }
    return xr.Dataset(data, attrs=attrs)


def _stability_attributes(stability):
    """Return attributes that compare the time step with its limits; a margin below 1 exceeds the limit."""
    if stability is None:
        return {}
    return {
        "steps_per_contact_time": stability.steps,
        "stability_margin_expected": stability.steps / stability.expected.expected,
        "stability_margin_cautious": stability.steps / stability.expected.cautious,
        "stability_margin_sampled": stability.steps / stability.needed if stability.needed > 0.0 else np.inf,
        "stiffest_grain": stability.grain,
        "stiffest_grain_contacts": stability.contacts,
        "deepest_overlap_in_half_thicknesses": stability.deepest,
    }


def write_packing(path, packing: xr.Dataset) -> None:
    """Write a packing, a Dataset as from `pack` or `read_packing`, to a netCDF file, whole or not at all.

    ValueError if it is not a whole packing, or if `path` has the name of a specification (.yaml); OSError if the file
    cannot be written.
    """
    path = check_path("write_packing", path)
    if path.suffix in (".yaml", ".yml"):
        raise ValueError(f"{path} has the name of a specification; give the packing a name that ends in .nc.")
    check_content("write_packing: the Dataset", check_dataset("write_packing", packing), DATASET)
    write_dataset(path, packing)


def write_dataset(path, dataset: xr.Dataset) -> None:
    """Write any Dataset to a netCDF file, whole or not at all. OSError if the file cannot be written."""
    with whole_file(path) as part:
        dataset.to_netcdf(part, engine="netcdf4")


def read_packing(path) -> xr.Dataset:
    """Return the packing, read into memory. ValueError if the file is missing, in use or not a whole packing."""
    path = check_path("read_packing", path)
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file. Make it with `scree pack SPEC.yaml {path}`.")
    if path.suffix in (".yaml", ".yml"):
        raise ValueError(f"{path} is a specification. Pack it first: `scree pack {path} {path.with_suffix('.nc')}`.")
    try:
        with xr.open_dataset(path, engine="netcdf4") as packing:
            packing.load()
    except (OSError, RuntimeError, ValueError) as error:
        if _is_in_use(path):
            raise ValueError(
                f"{path} is in use by another program, which writes to it or keeps it open. Wait until that program "
                "has ended, or close the file there."
            ) from None
        raise ValueError(f"{path} cannot be read as netCDF ({error}). It may be truncated; make it again.") from None
    check_content(path, packing)
    return packing.rename({old: new for old, new in RENAMED.items() if old in packing})


def takes_paths(function, name):
    """Return a function of a packing that takes the path of a packing's file instead, too. name: for its errors."""

    @functools.wraps(function)
    def of_packing(packing, *arguments, **options):
        if isinstance(packing, str | os.PathLike):
            packing = read_packing(packing)
        else:
            check_content(f"{name}: the Dataset", check_dataset(name, packing), DATASET)
        return function(packing, *arguments, **options)

    return of_packing


def check_dataset(caller, packing):
    """Return `packing`; ValueError, which names the caller, unless it is a Dataset."""
    if not isinstance(packing, xr.Dataset):
        raise ValueError(
            f"{caller}: the packing is of the type {type(packing).__name__}; give the path of a file that `scree pack` "
            "wrote, or a Dataset of read_packing."
        )
    return packing


def check_path(caller, path):
    """Return a path as Path; ValueError, which names the caller, if it is something else."""
    if not isinstance(path, str | os.PathLike):
        raise ValueError(f"{caller}: the path is of the type {type(path).__name__}; give the name of a file first.")
    return Path(path)


def _is_in_use(path):
    """Return whether another process has locked the file, as the HDF5 library does while it writes."""
    try:
        with path.open("rb") as file:
            return not lock_descriptor(file.fileno(), blocking=False)
    except OSError:  # no permission, or a file system without locks
        return False


# Attributes in which two runs of one packing may differ: they describe how it was run.
RUN_ATTRIBUTES = ("threads", "ranks", "cpu_seconds", "wall_seconds")


def differences(first: xr.Dataset, second: xr.Dataset) -> list[str]:
    """Return what differs, bit by bit, between two packings except for RUN_ATTRIBUTES; empty if nothing differs."""
    lines = []
    for name in sorted({*first.variables, *second.variables}, key=str):
        a, b = (packing.variables.get(name) for packing in (first, second))
        if a is None or b is None:
            lines.append(f"{name} is in only one of them")
        elif a.shape != b.shape:
            lines.append(f"{name}: {a.shape} and {b.shape}")
        elif a.dtype.kind in "OU":
            lines += [name] if list(a.values.ravel()) != list(b.values.ravel()) else []
        elif a.dtype != b.dtype or a.values.tobytes() != b.values.tobytes():
            lines.append(f"{name}: {np.sum(a.values != b.values)} of {a.size} numbers")
    for name in sorted({*first.attrs, *second.attrs} - set(RUN_ATTRIBUTES)):
        if not np.array_equal(first.attrs.get(name), second.attrs.get(name)):
            lines.append(f"attribute {name}: {first.attrs.get(name)} and {second.attrs.get(name)}")
    return lines


@functools.cache
def code_version() -> str:
    """Return the version, the digest of the compiled sources and, in a git checkout, the commit ("+": files changed).

    The first call fixes the result. It is made before a run starts, so that the result names the code that ran even if
    files are changed in the meantime.
    """
    return code_name(source_digest())


def _m(long_name):
    return {"units": "m", "long_name": long_name}


def _one(long_name):
    return {"units": "1", "long_name": long_name}


def _sieve_variables(curve, sample):
    """Return the classes of a SieveCurve, with the specified mass fractions and those of the grains of the packing."""
    specified, drawn = "specified share of the mass in the class", "share of the mass of the packed grains in the class"
    bounds = np.column_stack([curve.bounds[:-1], curve.bounds[1:]])
    return {
        "sieve_bounds": (("sieve_class", "bound"), bounds, _m("lower and upper sieve size of the class")),
        "mass_fraction_specified": ("sieve_class", curve.mass_fractions, _one(specified)),
        "mass_fraction_drawn": ("sieve_class", class_fractions(curve, sample.D, sample.volume), _one(drawn)),
    }


def _shape_variables(bases):
    vertices, faces = [base.vertices for base in bases], [base.faces for base in bases]
    starts = {}
    for name, plural, arrays in (("vertex", "vertices", vertices), ("face", "faces", faces)):
        counts = np.array([len(array) for array in arrays])
        starts[f"shape_{name}_start"] = ("shape", np.cumsum(counts) - counts, _one(f"first {name} of the base shape"))
        starts[f"shape_{name}_count"] = ("shape", counts, _one(f"number of {plural} of the base shape"))
    kinds = ["convex" if len(array) else "sphere" for array in vertices]
    return starts | {
        "shape_name": ("shape", [base.name for base in bases]),
        "shape_kind": ("shape", kinds, {"long_name": "unit sphere or convex polyhedron"}),
        "shape_vertices": (
            ("vertex", "xyz"),
            np.concatenate(vertices),
            _m("vertices of the polyhedra, principal axes"),
        ),
        "shape_faces": (
            ("face", "corner"),
            np.concatenate(faces).reshape(-1, 3).astype(np.int64),
            _one("corners, outward, counted from the shape's first vertex"),
        ),
    }


def _contact_variables(packed, shift, width):
    """Return the contacts between grains in the order of their key, then those with walls in the order of grains."""
    found = touching_contacts(packed.bodies, packed.candidates)
    first, second = found.body.T
    # Wrapping shifts the centres of both bodies, so the image changes by the difference of their shifts.
    other = shift[np.maximum(second, 0)]  # a wall has a negative number
    image = found.image + np.where(second[:, None] >= 0, other - shift[first], 0)
    point = found.point.copy()
    point[:, :2] -= shift[first] * width
    vector = ("contact", "xyz")
    return {
        "contact_body": (("contact", "pair"), found.body, _one("grains; second: -1 floor, -2 cylinder")),
        "contact_image": (("contact", "horizontal"), image, _one("periods added to the second")),
        "contact_normal": (vector, found.normal, _one("unit normal, first to second body")),
        "contact_point": (vector, point, _m("point where the force acts")),
        "contact_overlap": ("contact", found.overlap, _m("overlap")),
        "contact_force": (vector, found.force, {"units": "N", "long_name": "force on the second body"}),
    }


def _history_variables(packed):
    """Return the Observation of every check as time series."""
    phases = [GENERATING, SHAKING, DAMPING]
    series = {
        "kinetic_energy": "J",
        "max_speed": "m s-1",
        "mean_height": "m",
        "mean_overlap": "m",
        "unbalanced_force": "1",
        "coordination": "1",
    }
    history = {
        "history_time": ("check", [time for time, _, _ in packed.checks], {"units": "s", "long_name": "time"}),
        "history_phase": (
            "check",
            [phases.index(phase) for _, phase, _ in packed.checks],
            {"units": "1", "flag_values": [0, 1, 2], "flag_meanings": " ".join(phases)},
        ),
    }
    for name, units in series.items():
        values = [getattr(observed, name) for _, _, observed in packed.checks]
        history[f"history_{name}"] = ("check", values, {"units": units, "long_name": name.replace("_", " ")})
    return history

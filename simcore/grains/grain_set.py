# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Set of grains in one netCDF file: ragged arrays of vertices and faces, and one row of measures per grain."""

from pathlib import Path

import numpy as np
import xarray as xr

from simcore.grains.mesh import Grain
from simcore.writing import whole_file

_MEASURES = {
    "L": ("m", "longest axis of the mass-equivalent ellipsoid"),
    "I": ("m", "intermediate axis of the mass-equivalent ellipsoid"),
    "S": ("m", "shortest axis of the mass-equivalent ellipsoid"),
    "volume": ("m3", "volume of the convex hull"),
    "sieve_size": ("m", "sieve size D = sqrt((S² + I²) / 2)"),
    "flatness": ("1", "flatness S/I"),
    "elongation": ("1", "elongation I/L"),
    "sphericity": ("1", "surface of the sphere of equal volume over the surface (Wadell)"),
    "hull_ratio": ("1", "volume of the convex hull over the volume of the measured body"),
}


def grain_dataset(grains, **attributes):
    """Return the grains as an xarray Dataset with the dimensions grain, vertex, face, xyz (3), corner (3).

    The vertices of grain i are vertices[vertex_start[i] : vertex_start[i] + vertex_count[i]] [m]. Its faces are stored
    in the same way, with indices that count from its own first vertex. attributes: further attributes of the Dataset.
    ValueError if there is no grain, or if two have the same name.
    """
    names = [grain.name for grain in grains]
    if not grains or len(set(names)) < len(names):
        raise ValueError(f"a grain set needs at least one grain and unique names; its names are {names}")
    data = {
        "vertices": (("vertex", "xyz"), np.concatenate([g.vertices for g in grains]), {"units": "m"}),
        "faces": (("face", "corner"), np.concatenate([g.faces for g in grains]).astype(np.int32)),
        "second_moments": (
            ("grain", "xyz"),
            np.stack([g.second_moments for g in grains]),
            {"units": "m2", "long_name": "mean of x², y², z² over the volume"},
        ),
    }
    for kind, arrays in (("vertex", [g.vertices for g in grains]), ("face", [g.faces for g in grains])):
        counts = np.array([len(a) for a in arrays])
        data[f"{kind}_count"] = ("grain", counts)
        data[f"{kind}_start"] = ("grain", np.cumsum(counts) - counts)
    for measure, (units, long_name) in _MEASURES.items():
        values = np.array([getattr(g, measure) for g in grains])
        data[measure] = ("grain", values, {"units": units, "long_name": long_name})
    data["notes"] = ("grain", np.array(["\n".join(g.notes) for g in grains], object), {"long_name": "how it was read"})
    frame = "centre of mass at the origin, principal axes S, I, L along x, y, z"
    return xr.Dataset(data, {"grain": names, "xyz": list("xyz")}, {"frame": frame, **attributes})


def write_grains(path, grains, **attributes):
    """Write the Dataset of grain_dataset to path; the file has a temporary name until it is complete."""
    with whole_file(path) as part:
        grain_dataset(grains, **attributes).to_netcdf(part, engine="netcdf4")


def read_grains(path):
    """Read the list of Grain that write_grains wrote; ValueError if the file is missing or is not a grain set."""
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"the grain set {path} does not exist; write it with write_grains, or correct the path")
    try:
        with xr.open_dataset(path, engine="netcdf4") as file:
            data = file.load()
        columns = [data[name].values for name in ("L", "I", "S", "volume", "second_moments")]
        ratios, notes = _ratios_and_notes(data)
        meshes = [_ragged(data, "vertex", "vertices"), _ragged(data, "face", "faces")]
    except (OSError, KeyError) as error:
        raise ValueError(
            f"{path} cannot be read as a grain set ({error}); give a file that write_grains wrote, or make it again"
        ) from None
    rows = zip(data.grain.values, *meshes, *columns, ratios, notes, strict=True)
    return [
        Grain(
            str(name), vertices, faces.astype(np.int64), float(volume), moments, float(L), float(I), float(S), *reading
        )
        for name, vertices, faces, L, I, S, volume, moments, *reading in rows
    ]


def read_attribute(path, name):
    """Return the attribute `name` of the grain set at path, or None if it has no such attribute."""
    with xr.open_dataset(path, engine="netcdf4") as data:
        return data.attrs.get(name)


def _ratios_and_notes(data):
    """Return hull ratio and notes of each grain; sets from versions without them have nan and no notes."""
    n = len(data.grain)
    ratios = data["hull_ratio"].values.tolist() if "hull_ratio" in data else [np.nan] * n
    notes = [tuple(str(text).splitlines()) for text in data["notes"].values] if "notes" in data else [()] * n
    return ratios, notes


def _ragged(data, kind, variable):
    counts = data[f"{kind}_count"].values
    return np.split(data[variable].values, np.cumsum(counts)[:-1])

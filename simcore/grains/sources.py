"""The grains behind the group `grains` of a specification: synthetic, from files, or a set prepared before."""

import functools
import hashlib
import json
import re
from pathlib import Path

from simcore.grains.grain_set import read_grains
from simcore.grains.readers import UNITS, read_grain_files
from simcore.grains.synthetic import synthetic_grains


def source_files(grains):
    """Paths of the files or folders behind the resolved group `grains`; none if they are synthetic."""
    source = grains["source"]
    if source == "synthetic":
        return []
    return [source] if isinstance(source, str) else list(source)


def source_name(source):
    """Name of the grains of `source`: "synthetic", or the last part of their path, of several the first's."""
    first = source if isinstance(source, str) else source[0]
    return Path(first).name


def set_name(grains):
    """Name of the grain set of the resolved group `grains`, for a folder: its source's, and a digest of its content.

    The digest is of what decides the grains: number and seed of synthetic ones; unit, voxel spacing and the content of
    all files of others (hidden files of a folder do not count). So no two sets share a name, and files that were
    changed make another set.
    """
    return _set_name(json.dumps(grains, sort_keys=True))


@functools.cache
def _set_name(text):
    grains = json.loads(text)
    files = [Path(path) for path in source_files(grains)]
    decisive = ("unit", "voxel_spacing") if files else ("number", "seed")
    content = hashlib.sha256(json.dumps([grains[key] for key in decisive]).encode())
    for path in files:
        inside = sorted(path.iterdir()) if path.is_dir() else [path]
        for file in inside:
            if file.is_file() and not (path.is_dir() and file.name.startswith(".")):
                content.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
    name = re.sub(r"[^A-Za-z0-9_.+-]", "", source_name(grains["source"])) or "grains"
    return f"{name}_{content.hexdigest()[:8]}"


def check_source(grains):
    """ValueError if a file of the grains does not exist, or its unit is not stated."""
    for path in source_files(grains):
        if not Path(path).exists():
            raise ValueError(f"grains.source: '{path}' does not exist; give a file or folder, or synthetic")
        if grains["unit"] is None and Path(path).suffix != ".nc":
            raise ValueError("grains.unit is missing; say in which unit the files of grains are, m or mm")


def needs_grains(shapes):
    """Whether the resolved group `shapes` takes its forms from grains: meshes, and ellipsoids of their forms."""
    return shapes["kind"] in ("mesh", "mixed") or (
        shapes["kind"] == "ellipsoid" and shapes["choice"] in ("one", "random")
    )


def load_grains(grains):
    """List of Grain of the resolved group `grains` of a specification; ValueError names what is wrong where."""
    check_source(grains)
    files = source_files(grains)
    if not files:
        return synthetic_grains(seed=grains["seed"], n=grains["number"])
    if Path(files[0]).suffix == ".nc":
        if len(files) > 1:
            raise ValueError("grains.source: give one prepared grain set (.nc), not several")
        return read_grains(files[0])
    spacing = grains["voxel_spacing"]
    return read_grain_files(files, grains["unit"], None if spacing is None else spacing / UNITS[grains["unit"]])

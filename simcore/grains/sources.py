"""The grains behind the group `grains` of a specification: synthetic, from files, or a set prepared before."""

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

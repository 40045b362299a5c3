"""Writes a packing to a file for another program; the suffix selects the format."""

from pathlib import Path

from simcore.export.meshes import write_glb, write_triangles
from simcore.export.network import write_edges, write_graphml
from simcore.export.paraview import write_solids, write_surfaces
from simcore.export.placement import PERIODIC, is_polyhedron
from simcore.export.voxels import write_voxels

OF_SURFACES = {
    ".glb": write_glb,
    ".stl": write_triangles,
    ".ply": write_triangles,
    ".vtu": write_solids,
    ".vtp": write_surfaces,
}
OF_VOXELS = (".npz", ".tif", ".vti")
OF_NETWORKS = {".graphml": write_graphml, ".csv": write_edges}
SUFFIXES = (*OF_SURFACES, *OF_NETWORKS, *OF_VOXELS)


def known_suffix(path) -> str:
    """Return the suffix of a path in lower case. ValueError if it is not one of SUFFIXES."""
    suffix = Path(path).suffix
    if suffix.lower() not in SUFFIXES:
        raise ValueError(f"{path}: the suffix {suffix!r} is unknown; give one of {', '.join(SUFFIXES)}")
    return suffix.lower()


def export(packing, path, periodic=None, voxel=None, divisions=None) -> list[Path]:
    """Write a packing to `path` and return the paths of the written files.

    packing: Dataset of read_packing. The suffix is one of SUFFIXES. periodic: see simcore.export.placement; None: "cut"
    for voxels, "leave" otherwise. voxel [m]: edge of a voxel, see simcore.export.voxels. divisions: how fine spheres
    and ellipsoids are, see simcore.export.surfaces. ValueError for an unknown suffix, an option that the format or
    the packing does not use, an empty packing, or a library that is not installed.
    """
    path = Path(path)
    suffix = known_suffix(path)
    if not packing.sizes["grain"]:
        raise ValueError("export: the packing contains no grain; check its amount and its log")
    if periodic is not None and periodic not in PERIODIC:
        raise ValueError(f"periodic: {periodic!r} is unknown; choose one of {', '.join(PERIODIC)}")
    unused = {
        "--periodic": periodic is not None and suffix in OF_NETWORKS,
        "--voxel": voxel is not None and suffix not in OF_VOXELS,
        "--divisions": divisions is not None and suffix not in OF_SURFACES,
    }
    for option, given in unused.items():
        if given:
            raise ValueError(f"{option} has no effect on a {suffix} file; leave it out")
    if periodic is not None and packing.attrs["domain_shape"] != "periodic":
        raise ValueError("--periodic has no effect on a packing in a cylinder; leave it out")
    if divisions is not None and is_polyhedron(packing).all():
        raise ValueError("--divisions has no effect on a packing of polyhedra; leave it out")
    path.parent.mkdir(parents=True, exist_ok=True)
    if suffix in OF_VOXELS:
        return write_voxels(path, packing, voxel, periodic or "cut")
    if suffix in OF_NETWORKS:
        OF_NETWORKS[suffix](path, packing)
        return [path]
    return OF_SURFACES[suffix](path, packing, periodic or "leave", divisions) or [path]

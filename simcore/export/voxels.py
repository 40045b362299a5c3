"""Voxels of a packing: for each voxel the grain that its centre is in (.npz, .tif, .vti).

Error of the volume. A voxel counts as a whole if its centre is in the grain. For a grain of surface A that lies at
random to the grid of spacing h, the volume V_h of its voxels has the mean V and, by Poisson summation over the
reciprocal lattice, the variance  Σ_{k≠0} |F(k/h)|², F the Fourier transform of the grain's indicator function. Averaged
over orientations, |F(ξ)|² is the transform of the covariogram V − A r/4 + ..., and its decay at large ξ is that of
−A r/4, A/(8 π³ ξ⁴). So

    var V_h = A h⁴ Σ_{k≠0} |k|⁻⁴ / (8 π³) = 0.0666 A h⁴,

with Epstein's sum over the cubic lattice, 16.5323. Grains are independent, so that the variances of a bed add.
"""

from typing import NamedTuple

import numpy as np

from simcore.export.libraries import library
from simcore.export.paraview import save_vtk
from simcore.export.placement import is_polyhedron, places, rotations, shape_part
from simcore.export.surfaces import surface_areas
from simcore.writing import whole_file

GRID_VARIANCE = 16.5323 / (8.0 * np.pi**3)
VOXELS_PER_SIZE, VOXELS_PER_GRAIN = 20, 4  # default least number along the median sieve size and the smallest axis
MOST_VOXELS = 1_000_000_000
PORE = 0


class Voxels(NamedTuple):
    """A grid of voxels; the centre of voxel (i, j, k) is origin + (i + 1/2, j + 1/2, k + 1/2) · spacing."""

    labels: np.ndarray  # (nx, ny, nz): number of the grain + 1, or PORE
    spacing: np.ndarray  # (3,) [m]
    origin: np.ndarray  # (3,) [m], lower corner of the grid
    volume_error: float  # [m³], standard error of the solid volume by the finite voxels

    @property
    def porosity(self) -> float:
        """Share of the voxels that are pores, over the whole grid."""
        return 1.0 - np.count_nonzero(self.labels) / self.labels.size


def default_edge(packing) -> float:
    """Return the edge of a voxel [m] where none is given: small enough for the median sieve size and every grain.

    The median is that by number, which small grains determine, as they do the edge that is needed.
    """
    smallest = float(packing["S"].values.min())
    return min(float(np.median(packing["D"].values)) / VOXELS_PER_SIZE, smallest / VOXELS_PER_GRAIN)


def voxels(packing, size=None, periodic="cut", level=None):
    """Return the Voxels of a packing.

    size [m]: edge of a voxel; None: default_edge. The grid reaches from the floor to the highest grain. With
    periodic="cut" it is exactly one period wide and continues on its opposite side; the spacing along x and y is then
    the width over a whole number, the nearest to `size`. Otherwise it contains all grains, with their images if
    periodic="copy", and in a cylinder its cross-section. Where two grains overlap, the later one counts. level: (height
    [m] of a plane between two layers, thickness [m] of a layer); None: the lower end of the bed, and `size`. ValueError
    if the size is not positive, exceeds the smallest grain, or makes more than MOST_VOXELS.
    """
    smallest = float(packing["S"].values.min())
    if size is None:
        size = default_edge(packing)
    if not 0.0 < size <= smallest:
        raise ValueError(
            f"voxels: the edge of {1e3 * size:g} mm must be more than 0 and at most the smallest axis of a grain, "
            f"{1e3 * smallest:.3g} mm; choose another --voxel"
        )
    where, solids = places(packing, periodic), _Solids(packing)
    low, high = solids.extents(where)
    spacing, origin, end = np.full(3, size), np.append(low.min(axis=0)[:2], min(low[:, 2].min(), 0.0)), high.max(axis=0)
    if packing.attrs["domain_shape"] == "cylinder":
        radius = 0.5 * float(packing.attrs["domain_width"])
        origin[:2], end[:2] = np.minimum(origin[:2], -radius), np.maximum(end[:2], radius)
    if level is not None:
        spacing[2] = level[1]
        origin[2] = level[0] - np.ceil((level[0] - origin[2]) / spacing[2] - 1e-9) * spacing[2]
    counts = np.ceil((end - origin) / spacing).astype(int)
    if where.sides is not None:
        counts[:2] = max(round(where.sides / size), 1)
        spacing[:2], origin[:2] = where.sides / counts[0], 0.0
    if counts.prod(dtype=float) > MOST_VOXELS:
        raise ValueError(
            f"voxels: {counts[0]} × {counts[1]} × {counts[2]} voxels of {1e3 * size:g} mm are more than "
            f"{MOST_VOXELS:,}; choose a larger --voxel"
        )
    labels = np.zeros(counts, np.uint16 if packing.sizes["grain"] < 65535 else np.uint32)
    for m, grain in enumerate(where.grain):
        first = np.maximum(np.floor((low[m] - origin) / spacing).astype(int), 0)
        last = np.minimum(np.ceil((high[m] - origin) / spacing).astype(int), counts)
        if (first >= last).any():
            continue
        centres = [o + (np.arange(a, b) + 0.5) * s for o, a, b, s in zip(origin, first, last, spacing, strict=True)]
        block = labels[tuple(slice(a, b) for a, b in zip(first, last, strict=True))]
        block[solids.contains(grain, where.shift[m], centres)] = grain + 1
    # The formula is for cubes; the spacings along x and z differ by less than one part in twice the number of voxels.
    area = surface_areas(packing)[where.grain if where.sides is None else slice(None)].sum()
    return Voxels(labels, spacing, origin, float(np.sqrt(GRID_VARIANCE * area * spacing.prod() ** (4.0 / 3.0))))


class _Solids:
    """The inside of the grains: a quadric for spheres and ellipsoids, half-spaces for polyhedra."""

    def __init__(self, packing):
        self.packing, self.to_world = packing, rotations(packing)
        self.position, self.scale = packing["position"].values, packing["scale"].values
        self.polyhedron, self.shape = is_polyhedron(packing), packing["shape"].values

    def extents(self, where):
        """Return the least and greatest coordinates of the grains at these Places, two arrays (m, 3) [m]."""
        half = np.linalg.norm(self.to_world * self.scale[:, None, :], axis=2)
        low, high = self.position - half, self.position + half
        for g in np.flatnonzero(self.polyhedron):
            points = self._corners(g, self.position[g])
            low[g], high[g] = points.min(axis=0), points.max(axis=0)
        return low[where.grain] + where.shift, high[where.grain] + where.shift

    def contains(self, grain, shift, centres):
        """Return whether points are in a grain, (nx, ny, nz) bool; centres: their x, y and z, three arrays [m]."""
        x, y, z = np.ix_(*(axis - c for axis, c in zip(centres, self.position[grain] + shift, strict=True)))
        if not self.polyhedron[grain]:
            turned = self.to_world[grain] / self.scale[grain]
            return sum((r[0] * x + r[1] * y + r[2] * z) ** 2 for r in turned.T) <= 1.0
        points = self._corners(grain, np.zeros(3))
        corners = points[shape_part(self.packing, "face", self.shape[grain])]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        # On each vertical line of voxels the grain is an interval: above the faces that look down and below those that
        # look up. It is not on the line if the line is outside an upright face.
        slack = np.sum(normals * corners[:, 0], axis=1) - normals[:, 0] * x - normals[:, 1] * y  # (nx, ny, faces)
        down, up = normals[:, 2] < 0.0, normals[:, 2] > 0.0
        low = (slack[..., down] / normals[down, 2]).max(axis=-1, keepdims=True)
        high = (slack[..., up] / normals[up, 2]).min(axis=-1, keepdims=True)
        beside = (slack[..., ~(down | up)] < 0.0).any(axis=-1, keepdims=True)
        return (z >= low) & (z <= high) & ~beside

    def _corners(self, grain, centre):
        base = shape_part(self.packing, "vertex", self.shape[grain])
        return (base * self.scale[grain]) @ self.to_world[grain].T + centre


def outside_cylinder(packing, grid):
    """Return whether the voxels of a layer of a grid are outside the domain, (nx, ny) bool, by their centres."""
    if packing.attrs["domain_shape"] != "cylinder":
        return np.zeros(grid.labels.shape[:2], bool)
    x, y = (grid.origin[i] + (np.arange(grid.labels.shape[i]) + 0.5) * grid.spacing[i] for i in (0, 1))
    return x[:, None] ** 2 + y**2 > (0.5 * float(packing.attrs["domain_width"])) ** 2


def write_voxels(path, packing, size=None, periodic="cut"):
    """Write the voxels with their spacing; see `voxels`. The value of a voxel is 0 in a pore, else its grain + 1.

    A voxel without a grain whose centre is outside a cylinder has the largest value of its type, 65535 or 4294967295.

    .npz: arrays labels (nx, ny, nz), spacing (3,), origin (3,) [m] and volume_error [m³]. .tif: pages along z, rows
    along y, for ImageJ with the spacing in millimetres. .vti: cell data `label` for ParaView.
    """
    grid = voxels(packing, size, periodic)
    outside = outside_cylinder(packing, grid)[:, :, None] & (grid.labels == PORE)
    grid.labels[outside] = np.iinfo(grid.labels.dtype).max
    suffix = path.suffix.lower()
    if suffix == ".npz":
        with whole_file(path) as part, part.open("wb") as file:
            np.savez_compressed(file, **grid._asdict())
    elif suffix == ".tif":
        _write_tif(path, grid)
    else:
        pyvista = library("pyvista", f"{path.suffix} for ParaView")
        image = pyvista.ImageData(
            dimensions=np.array(grid.labels.shape) + 1, spacing=tuple(grid.spacing), origin=tuple(grid.origin)
        )
        image.cell_data["label"] = grid.labels.ravel(order="F")
        save_vtk(image, path)
    return [path]


def _write_tif(path, grid):
    tifffile = library("tifffile", ".tif")
    if grid.labels.dtype != np.uint16:
        raise ValueError(f"{path}: an ImageJ file numbers at most 65534 grains; write .npz or .vti")
    x, y, z = 1e3 * grid.spacing
    with whole_file(path) as part:
        tifffile.imwrite(
            part,
            grid.labels.transpose(2, 1, 0),
            imagej=True,
            compression="zlib",
            resolution=(1.0 / x, 1.0 / y),
            metadata={"axes": "ZYX", "spacing": z, "unit": "mm"},
        )

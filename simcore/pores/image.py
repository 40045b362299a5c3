"""Voxels of the part of a bed in which its porosity is evaluated."""

from typing import NamedTuple

import numpy as np

from simcore.evaluation.porosity import domain_area
from simcore.export.voxels import PORE, default_edge, voxels

# Largest number by default. PoreSpy and the diffusion take seconds per million voxels.
MOST_VOXELS = 8_000_000


class PoreImage(NamedTuple):
    """Voxels between two heights; the sides x and y are periodic, or all voxels outside the cylinder are solid."""

    pores: np.ndarray  # (nx, ny, nz) bool
    spacing: np.ndarray  # (3,) [m]; the spacing along z is that of the request
    periodic: bool  # along x and y
    area: float  # [m²], horizontal area of the domain
    first: int  # number of the first layer that counts; layers below it only surround the others
    last: int  # number after that of the last layer that counts

    @property
    def inside(self) -> np.ndarray:
        """The layers that count, (nx, ny, last - first) bool."""
        return self.pores[:, :, self.first : self.last]

    @property
    def height(self) -> float:
        """Height of the layers that count [m]."""
        return (self.last - self.first) * float(self.spacing[2])

    @property
    def porosity(self) -> float:
        """Volume of the pore voxels over that of the domain."""
        return np.count_nonzero(self.inside) * float(self.spacing.prod()) / (self.area * self.height)


def voxel_sizes(packing, low, high, voxel=None):
    """Return the edges (coarse, fine) of the voxels of two images; the coarse is twice the fine [m].

    voxel [m]: the fine edge. None: half of the default edge of an export, which is a twentieth of the median sieve
    size or a quarter of the smallest axis; it is larger if the image would have more than MOST_VOXELS voxels.
    ValueError if the coarse edge exceeds the smallest axis of a grain.
    """
    smallest = float(packing["S"].values.min())
    if voxel is not None and 2.0 * voxel > smallest:
        raise ValueError(
            f"--voxel: {1e3 * voxel:g} mm is more than half of the smallest axis of a grain, {1e3 * smallest:.3g} mm; "
            "voxels of twice this edge are used as well; choose another --voxel"
        )
    if voxel is None:
        voxel = max(0.5 * default_edge(packing), float(np.cbrt(domain_area(packing) * (high - low) / MOST_VOXELS)))
    return 2.0 * voxel, voxel


def pore_image(packing, low, high, size, margin=0.0):
    """Return the PoreImage between z = low and z = high with voxels of edge `size` [m].

    A layer counts if its middle is between the heights. margin [m]: height of the layers below and above that are
    added where the bed has them, for methods that look at the surroundings of a pore. ValueError as in
    simcore.export.voxels, or if fewer than two layers are between the heights.
    """
    grid = voxels(packing, size, "cut")
    nz = grid.labels.shape[2]
    middle = grid.origin[2] + (np.arange(nz) + 0.5) * grid.spacing[2]
    counted = np.flatnonzero((middle > low) & (middle < high))
    if len(counted) < 2:
        raise ValueError(
            f"pores: fewer than two layers of voxels of {1e3 * size:.3g} mm are between {1e3 * low:.1f} mm and "
            f"{1e3 * high:.1f} mm; choose a smaller --voxel or --cut"
        )
    extra = int(np.ceil(margin / grid.spacing[2]))
    start, stop = max(counted[0] - extra, 0), min(counted[-1] + 1 + extra, nz)
    pores = grid.labels[:, :, start:stop] == PORE
    periodic = packing.attrs["domain_shape"] == "periodic"
    if not periodic:
        x, y = (grid.origin[i] + (np.arange(pores.shape[i]) + 0.5) * grid.spacing[i] for i in (0, 1))
        radius = 0.5 * float(packing.attrs["domain_width"])
        pores &= (x[:, None] ** 2 + y**2 <= radius**2)[:, :, None]
    return PoreImage(
        pores, grid.spacing, periodic, domain_area(packing), int(counted[0] - start), int(counted[-1] + 1 - start)
    )

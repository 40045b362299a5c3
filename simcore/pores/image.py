"""Voxels of the part of a bed in which its porosity is evaluated."""

from typing import NamedTuple

import numpy as np

from simcore.evaluation.porosity import domain_area
from simcore.export.voxels import PORE, default_edge, outside_cylinder, voxels
from simcore.scene.quantity import rounded_down

# Largest number of fine voxels unless their edge is given; PoreSpy and the diffusion take seconds per million voxels.
DEFAULT_MOST = 8_000_000


class TooManyVoxels(ValueError):
    """The smallest grain of a bed needs more voxels than are computed unless their edge is given."""


class PoreImage(NamedTuple):
    """Voxels between two heights; the sides x and y are periodic, or all voxels outside the cylinder are solid."""

    pores: np.ndarray  # (nx, ny, nz) bool
    spacing: np.ndarray  # (3,) [m]; the spacing along z is that of the request
    periodic: bool  # along x and y
    area: float  # [m²], horizontal area of the domain; of a cylinder, of the voxels in it
    lowest: int  # number of the lowest layer that counts; layers below it only surround the others
    end: int  # number after that of the highest layer that counts
    volume_error: float = 0.0  # [m³], standard error of the solid volume in these layers by the finite voxels
    area_error: float = 0.0  # [m²], of the voxels in a cylinder against its area

    @property
    def inside(self) -> np.ndarray:
        """The layers that count, (nx, ny, end - lowest) bool."""
        return self.pores[:, :, self.lowest : self.end]

    @property
    def height(self) -> float:
        """Height of the layers that count [m]."""
        return (self.end - self.lowest) * float(self.spacing[2])

    @property
    def porosity_error(self) -> float:
        """Standard error of `porosity` by the finite voxels; at a wall there are only pores."""
        at_wall = (1.0 - self.porosity) * self.area_error / self.area
        return float(np.hypot(self.volume_error / (self.area * self.height), at_wall))

    @property
    def porosity(self) -> float:
        """Volume of the pore voxels over that of the domain."""
        return np.count_nonzero(self.inside) * float(self.spacing.prod()) / (self.area * self.height)


def voxel_sizes(packing, low, high, voxel=None):
    """Return the edges (coarse, fine) of the voxels of two images; the coarse is twice the fine [m].

    voxel [m]: the fine edge. None: half of the default edge of an export, see simcore.export.voxels.default_edge. It
    is larger if the fine image would have more than DEFAULT_MOST voxels. The coarse edge must not exceed the smallest
    axis of a grain: ValueError if `voxel` is too large for it, TooManyVoxels if DEFAULT_MOST voxels are.
    """
    smallest = float(packing["S"].values.min())
    if voxel is not None and 2.0 * voxel > smallest:
        raise ValueError(
            f"--voxel: {1e3 * voxel:g} mm is more than half of the smallest axis of a grain, {1e3 * smallest:.3g} mm; "
            "voxels of twice this edge are used as well; choose another --voxel"
        )
    if voxel is None:
        volume = domain_area(packing) * (high - low)
        voxel = max(0.5 * default_edge(packing), float(np.cbrt(volume / DEFAULT_MOST)))
        if 2.0 * voxel > smallest:
            largest = 1e-3 * rounded_down(0.5e3 * smallest)
            raise TooManyVoxels(
                f"the smallest grain, {1e3 * smallest:.3g} mm thick, needs {1e-6 * volume / largest**3:.3g} million "
                f"voxels, which take long; to compute them, give --voxel '{1e3 * largest:g} mm'"
            )
    return 2.0 * voxel, voxel


def pore_image(packing, low, high, size, margin=0.0):
    """Return the PoreImage between z = low and z = high with voxels of edge `size` [m].

    The heights are planes between layers; the spacing along z is the nearest to `size` for which this is so. margin
    [m]: height of the layers below and above that are added where the bed has them, for methods that look at the
    surroundings of a pore. ValueError as in simcore.export.voxels, or if fewer than two layers are between the heights.
    """
    layers = round((high - low) / size)
    if layers < 2:
        raise ValueError(
            f"pores: fewer than two layers of voxels of {1e3 * size:.3g} mm are between {1e3 * low:.1f} mm and "
            f"{1e3 * high:.1f} mm; choose a smaller --voxel or --cut"
        )
    grid = voxels(packing, size, "cut", (low, (high - low) / layers))
    nz = grid.labels.shape[2]
    middle = grid.origin[2] + (np.arange(nz) + 0.5) * grid.spacing[2]
    counted = np.flatnonzero((middle > low) & (middle < high))
    extra = int(np.ceil(margin / grid.spacing[2] - 1e-9))
    start, stop = max(counted[0] - extra, 0), min(counted[-1] + 1 + extra, nz)
    pores = grid.labels[:, :, start:stop] == PORE
    inside = ~outside_cylinder(packing, grid)
    pores &= inside[:, :, None]
    area = np.count_nonzero(inside) * float(grid.spacing[:2].prod())
    # The variance of the volume is in proportion to the surface, and this nearly to the volume.
    share = np.count_nonzero(grid.labels[:, :, counted] != PORE) / max(np.count_nonzero(grid.labels != PORE), 1)
    return PoreImage(
        pores, grid.spacing, packing.attrs["domain_shape"] == "periodic", area, int(counted[0] - start),
        int(counted[-1] + 1 - start), grid.volume_error * float(np.sqrt(share)), abs(area - domain_area(packing)),
    )  # fmt: skip

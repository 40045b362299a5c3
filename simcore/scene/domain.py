"""Domain of a packing, and the lattice on which grains are inserted.

The module works without numba, because plans count lattice sites as well (simcore.packing.cost).
"""

from dataclasses import dataclass

import numpy as np

MAX_SITES = 50_000_000  # of a lattice; more do not fit into the memory


@dataclass(frozen=True)
class Domain:
    """Horizontally periodic box of period `width` [m], or upright cylinder of that diameter; its floor is at z = 0."""

    type: str
    width: float
    height: float

    @property
    def periodic(self) -> bool:
        """Whether the domain is a box that is periodic in x and y."""
        return self.type == "periodic"

    @property
    def area(self) -> float:
        """Area of the floor [m²]."""
        return self.width**2 if self.periodic else 0.25 * np.pi * self.width**2


def lattice_sites(
    domain: Domain, spacing: float, low: float, high: float, stretch_x: float = 1.0, stretch_z: float = 1.0
) -> np.ndarray:
    """Return the sites (n, 3) of a hexagonal close-packed lattice with low <= z < high, from below; rows are along x.

    stretch_x, stretch_z: factors of all distances along x and z. In a periodic box the lattice is also stretched
    horizontally to fit the period. In a cylinder, sites farther than width/2 − spacing/2 from the axis are left out; if
    no site remains in any layer, the sites are on the axis. ValueError if there are more than about MAX_SITES.
    """
    volume = stretch_x * stretch_z * spacing**3 / np.sqrt(2.0)  # of a site
    if domain.width**2 * (high - low) / volume > MAX_SITES:
        raise ValueError(
            f"domain: a lattice with a spacing of {1e3 * spacing:.3g} mm has more than {MAX_SITES:,} places in a "
            f"width of {domain.width:g} m and a height of {domain.height:g} m; correct the units of domain.width and "
            "domain.height"
        )
    layers = np.arange(low, high, stretch_z * spacing * np.sqrt(6.0) / 3.0)
    sites = _hexagonal_sites(domain, spacing, stretch_x, layers)
    # Layers repeat after two, so a cylinder without a site in two layers is too narrow for any site.
    if domain.periodic or len(sites) or len(_hexagonal_sites(domain, spacing, stretch_x, np.zeros(2))):
        return sites
    return np.column_stack([np.zeros(len(layers)), np.zeros(len(layers)), layers])


def _hexagonal_sites(domain: Domain, spacing: float, stretch_x: float, layers: np.ndarray) -> np.ndarray:
    """Return the sites (n, 3) of a lattice with layers at these heights (k,)."""
    if domain.periodic:
        nx = max(int(domain.width / (stretch_x * spacing)), 1)
        ny = max(2 * int(domain.width / (spacing * np.sqrt(3.0))), 1)
        dx, dy = domain.width / nx, domain.width / ny
        origin = np.array([0.5 * dx, 0.5 * dy])
    else:
        nx = int(np.ceil(domain.width / (stretch_x * spacing))) + 1
        ny = int(np.ceil(domain.width / (spacing * np.sqrt(0.75)))) + 1
        dx, dy = stretch_x * spacing, spacing * np.sqrt(0.75)
        origin = -0.5 * np.array([(nx - 1) * dx, (ny - 1) * dy])
    layer, row, column = np.meshgrid(np.arange(len(layers)), np.arange(ny), np.arange(nx), indexing="ij")
    x = origin[0] + dx * (column + 0.5 * ((row + layer) % 2))
    y = origin[1] + dy * (row + (layer % 2) / 3.0)
    sites = np.stack([x, y, layers[layer]], axis=-1).reshape(-1, 3)
    if not domain.periodic:
        sites = sites[np.hypot(sites[:, 0], sites[:, 1]) <= 0.5 * (domain.width - spacing)]
    return sites

"""Everything that `scree pores` prints of a packing's pore space, as a dict of numbers in SI units."""

import importlib.util

import numpy as np

from simcore.evaluation.interval import median_size
from simcore.evaluation.porosity import bulk_porosity
from simcore.pores import kozeny_carman
from simcore.pores.diffusion import extrapolated, tortuosity
from simcore.pores.image import pore_image, voxel_sizes
from simcore.pores.network import network_permeability
from simcore.pores.pore_sizes import PERCENTILES, percentile, pore_sizes
from simcore.pores.surface import specific_surface

LIBRARIES = ("porespy", "openpnm")


def missing_libraries():
    """Return the names of the libraries of the extra `pores` that are not installed, a list."""
    return [name for name in LIBRARIES if importlib.util.find_spec(name) is None]


def bulk_pores(packing, cut=None):
    """Return what follows from porosity and surface of the grains alone, without voxels, a dict.

    packing: Dataset of read_packing; cut [m]: as in simcore.evaluation.porosity.bulk_porosity, whose method "exact"
    gives porosity and interval. Keys, with lengths in metres: see docs/how_to/pores.md.
    """
    bulk = bulk_porosity(packing, method="exact", cut=cut)
    n, low, high = (float(bulk[name]) for name in ("n", "z_lower", "z_upper"))
    surface = specific_surface(packing, low, high)
    permeability = kozeny_carman.permeability(n, surface)
    return {
        "porosity": n,
        "porosity_sampling_error": float(bulk["n_std_error"]),
        "z_lower": low,
        "z_upper": high,
        "specific_surface": surface,
        "surface_per_bed_volume": surface * (1.0 - n),
        "kozeny_carman_permeability": permeability,
        "kozeny_carman_conductivity": kozeny_carman.conductivity(permeability),
        "kozeny_carman_spread": kozeny_carman.SPREAD,
        "darcy_gradient": kozeny_carman.darcy_limit(n, surface),
    }


def voxel_pores(packing, low, high, voxel=None, network=True):
    """Return what is computed on voxels between z = low and z = high, (dict, sizes).

    voxel [m]: edge of the fine voxels, see simcore.pores.image.voxel_sizes. network: whether to compute the pore sizes
    and the pore network, which need the extra `pores`. Each value is that on the fine voxels, and NAME_resolution its
    difference from that on voxels twice as large; for the porosity it is at least the standard error by the finite
    voxels. The tortuosity is extrapolated from both, by this difference. sizes: (diameters, shares) on the fine voxels,
    or None. TooManyVoxels as in voxel_sizes.
    """
    least = {}  # errors on the fine voxels that a small difference does not show
    margin = median_size(packing["D"].values, packing["volume"].values)
    edges = voxel_sizes(packing, low, high, voxel)
    results = []
    for edge in edges:
        image = pore_image(packing, low, high, edge, margin if network else 0.0)
        values = {"voxel_porosity": image.porosity, "tortuosity": tortuosity(image)}
        least = {"voxel_porosity": image.porosity_error}
        sizes = None
        if network:
            permeability = network_permeability(image, margin)
            values["network_permeability"] = permeability
            values["network_conductivity"] = kozeny_carman.conductivity(permeability)
            sizes = pore_sizes(image, margin)
            values |= {f"pore_diameter_d{p}": percentile(*sizes, p) for p in PERCENTILES}
        results.append(values)
    coarse, fine = results
    numbers = {"voxel_coarse": edges[0], "voxel_fine": edges[1]}
    for name, value in fine.items():
        numbers[name] = value
        difference = abs(value - coarse[name]) if np.isfinite(value) else np.inf
        numbers[f"{name}_resolution"] = max(difference, least.get(name, 0.0))
    numbers["tortuosity"] = extrapolated(coarse["tortuosity"], fine["tortuosity"])
    if numbers["tortuosity"] < 1.0:
        raise ValueError(
            f"the voxels of {edges[1] * 1e3:g} mm are too large for the tortuosity, which is "
            f"{coarse['tortuosity']:.3g} on voxels of twice this edge and {fine['tortuosity']:.3g} on these; choose a "
            "smaller --voxel"
        )
    return numbers, sizes

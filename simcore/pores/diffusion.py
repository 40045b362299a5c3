"""Tortuosity of the pore space along z, from steady diffusion between its lower and its upper end.

The concentration is 1 below the lowest layer of voxels and 0 above the highest, grains are impermeable, and x and y are
periodic in a periodic box. The flux between two neighbouring pore voxels is their difference over the spacing. With the
effective coefficient D_eff of the bed and D of the free water,

    tortuosity = n / (D_eff / D),

so that n / tortuosity is also the ratio of electric conductivities. It is 1 for straight pores along z.

The error by the steps of the voxels' surface is proportional to their edge: for a simple cubic lattice of touching
spheres it halves with the edge, from 10 % at 20 voxels a diameter. `extrapolated` removes this term.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import cg

# Relative residual of the conjugate gradients.
RESIDUAL = 1e-7
MOST_ITERATIONS = 20_000


def tortuosity(image):
    """Return the tortuosity of a PoreImage along z; inf if no path of pores connects its ends.

    ValueError if the iteration does not converge.
    """
    share = effective_diffusion(image)
    return image.porosity / share if share > 0.0 else np.inf


def extrapolated(coarse, fine):
    """Return the value for voxels of edge 0 from those on voxels of twice the edge, `coarse`, and of the edge, `fine`.

    The error is taken to be proportional to the edge. Returns `fine` if one of them is not finite.
    """
    return 2.0 * fine - coarse if np.isfinite(coarse) and np.isfinite(fine) else fine


def effective_diffusion(image):
    """Return D_eff / D of a PoreImage along z, see `tortuosity`."""
    (hx, hy, hz), n = image.spacing, np.count_nonzero(image.inside)
    first, second, conductance, below, above = _links(image)
    pairs = sparse.coo_array((conductance, (first, second)), (n, n))
    part = connected_components(pairs, directed=False)[1]
    on_path = np.isin(part, np.intersect1d(part[below], part[above]))
    if not on_path.any():
        return 0.0
    to_end = 2.0 * hx * hy / hz  # from the middle of a voxel to its face
    source, diagonal = np.zeros(n), np.bincount(first, conductance, n) + np.bincount(second, conductance, n)
    source[below] = to_end
    diagonal[below] += to_end
    diagonal[above] += to_end
    matrix = (sparse.diags_array(diagonal) - pairs - pairs.T).tocsr()
    nz = image.inside.shape[2]
    start = np.broadcast_to(1.0 - (np.arange(nz) + 0.5) / nz, image.inside.shape)[image.inside]
    if not on_path.all():
        matrix, source, start = matrix[on_path][:, on_path], source[on_path], start[on_path]
        diagonal = diagonal[on_path]
    inverse = sparse.diags_array(1.0 / diagonal)
    solution, status = cg(matrix, source, start, rtol=RESIDUAL, maxiter=MOST_ITERATIONS, M=inverse)
    if status:
        raise ValueError(
            f"tortuosity: the iteration has not converged after {MOST_ITERATIONS} steps; choose a larger --voxel"
        )
    values = np.full(n, np.nan)
    values[on_path] = solution
    inflow, outflow = to_end * np.nansum(1.0 - values[below]), to_end * np.nansum(values[above])
    return float(0.5 * (inflow + outflow) * image.height / image.area)


def _links(image):
    """Return neighbouring pore voxels with their conductance over D, and the voxels at both ends, five arrays.

    Pore voxels are numbered as in `image.inside[image.inside]`.
    """
    pores, (hx, hy, hz) = image.inside, image.spacing
    number = np.full(pores.shape, -1, np.int64)
    number[pores] = np.arange(np.count_nonzero(pores))
    links = []
    for axis, conductance in enumerate((hy * hz / hx, hx * hz / hy, hx * hy / hz)):
        first, second = number, np.roll(number, -1, axis)
        if axis == 2 or not image.periodic or pores.shape[axis] == 1:
            inner = tuple(slice(0, -1) if i == axis else slice(None) for i in range(3))
            first, second = first[inner], second[inner]
        both = (first >= 0) & (second >= 0)
        links.append((first[both], second[both], np.full(np.count_nonzero(both), conductance)))
    ends = [layer[layer >= 0] for layer in (number[:, :, 0], number[:, :, -1])]
    return *(np.concatenate(parts) for parts in zip(*links, strict=True)), *ends

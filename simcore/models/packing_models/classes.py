"""Size classes of a mixture: checks, size ratios, and the specific volume of a mixture that one class controls.

Symbols: y volume fraction of a class, V = 1 / (1 - n) specific volume at the porosity n, r = smaller over larger size.
If class i controls the packing, the mixture has the specific volume

    T_i = Σ_j y_j V_j - Σ_(j coarser than i) y_j (V_j - 1) g(r_ij) - Σ_(j finer than i) y_j V_j f(r_ij)

The filling f is the efficiency with which finer grains sit in the pores between the controlling grains, the occupying
g that with which coarser grains replace bulk material of the controlling grains; both are 0 at r = 1 and 1 at r = 0.
The linear packing model is the maximum of T_i over the classes; the loosening and wall effects of the compressible
packing model are 1 - f and 1 - g.
"""

import numpy as np


def check_classes(sizes, fractions, porosities):
    """Return sizes, fractions and porosities as arrays of one shape (..., k).

    sizes (..., k): of the classes, any one unit. fractions (..., k): of the solid volume. porosities (..., k): of beds
    of one class each. ValueError if sizes are not positive, fractions not >= 0 with sum 1, or porosities not in (0, 1).
    """
    try:
        sizes, fractions, porosities = np.broadcast_arrays(
            *(np.asarray(a, float) for a in (sizes, fractions, porosities))
        )
    except ValueError:
        shapes = ", ".join(str(np.shape(values)) for values in (sizes, fractions, porosities))
        raise ValueError(
            f"packing model: sizes, fractions and porosities have the shapes {shapes}, which do not broadcast; give "
            "one of each per class"
        ) from None
    if sizes.ndim == 0 or sizes.shape[-1] == 0:
        raise ValueError("packing model: there is no class; give at least one size, fraction and porosity")
    if not np.all(np.isfinite(sizes) & (sizes > 0)):
        raise ValueError(f"packing model: {_first(sizes, ~(sizes > 0))} is no size; give positive sizes")
    if not np.all(fractions >= 0):
        raise ValueError(
            f"packing model: {_first(fractions, ~(fractions >= 0))} is no volume fraction; give shares >= 0"
        )
    total = fractions.sum(axis=-1)
    if not np.all(np.abs(total - 1) <= 1e-6):
        wrong = _first(total, ~(np.abs(total - 1) <= 1e-6))
        raise ValueError(f"packing model: volume fractions sum to {wrong}, not to 1; divide them by their sum")
    if not np.all((porosities > 0) & (porosities < 1)):
        wrong = _first(porosities, ~((porosities > 0) & (porosities < 1)))
        raise ValueError(f"packing model: the one-class porosity {wrong} is not between 0 and 1; give a fraction")
    return sizes, fractions, porosities


def _first(values, wrong):
    return f"{values[wrong].ravel()[0]:.6g}" if np.any(wrong) else "an infinite value"


def size_ratios(sizes, stretch=1.0):
    """Return r (..., k, k), smaller over larger size of each pair of classes, and whether class j is coarser than i.

    r is raised to `stretch` (..., k), the exponent of the coarser class of a pair; a number applies to all pairs.
    """
    logs = np.log(sizes)
    difference = logs[..., None, :] - logs[..., :, None]  # of class j to class i
    coarser = difference > 0
    m = np.broadcast_to(np.asarray(stretch, float), sizes.shape)
    exponent = np.where(coarser, m[..., None, :], m[..., :, None])
    return np.exp(-np.abs(difference) * exponent), coarser


def controlled_volumes(fractions, volumes, filled, occupied, coarser):
    """Return T_i (..., k); -inf for classes without mass, which control nothing.

    fractions y and volumes V (..., k); filled f, occupied g and coarser (..., k, k), of class j where class i controls.
    """
    y, V = fractions[..., None, :], volumes[..., None, :]
    T = np.sum(y * (V - np.where(coarser, (V - 1) * occupied, V * filled)), axis=-1)
    return np.where(fractions > 0, T, -np.inf)


def specific_volume(porosities):
    """Return V = 1 / (1 - n)."""
    return 1.0 / (1.0 - np.asarray(porosities, float))


def porosity_of_volume(volumes):
    """Return n = 1 - 1 / V."""
    return 1.0 - 1.0 / np.asarray(volumes, float)

"""Compressible packing model: classes share the compaction of the packing, which an index K measures.

Equations: de Larrard (1999). With the virtual specific volume W = 1/β of a class, its
measured specific volume V = W (1 + K) / K, and T_i as in classes.py, the specific volume P of the mixture solves

    K = Σ_i y_i W_i / (P - T_i),   P > max T_i

K grows with compaction. K to infinity is the linear packing model, since then P = max T_i and W = V.
Splitting a class changes the published model, because its loosening effect has an infinite slope at equal sizes.
"""

import numpy as np

from simcore.models.packing_models.classes import (
    check_classes,
    controlled_volumes,
    porosity_of_volume,
    size_ratios,
    specific_volume,
)

ITERATIONS = 60


def filling(r):
    """Return 1 minus de Larrard's loosening effect a(r) = sqrt(1 - (1 - r)^1.02)."""
    return 1 - np.sqrt(1 - (1 - r) ** 1.02)


def occupying(r):
    """Return 1 minus de Larrard's wall effect b(r) = 1 - (1 - r)^1.5."""
    return (1 - r) ** 1.5


def compressible(sizes, fractions, porosities, K, stretch=1.0, functions=(filling, occupying)):
    """Return the porosity (...,) by the compressible packing model; arguments (..., k) as for check_classes.

    K > 0: compaction index (...,), of the one-class beds and of the mixture. stretch: exponent of the size ratios, as
    in size_ratios; 1 is the published model. functions: (f, g) of r. ValueError if K is not positive.
    """
    sizes, fractions, porosities = check_classes(sizes, fractions, porosities)
    K = np.asarray(K, float)
    if not np.all(np.isfinite(K) & (K > 0)):
        raise ValueError(f"compressible packing model: K = {K} is not positive and finite; give 2 to 20, or use linear")
    r, coarser = size_ratios(sizes, stretch)
    f, g = functions
    W = specific_volume(porosities) * (K / (1 + K))[..., None]
    if not np.all(W > 1):
        raise ValueError(
            f"compressible packing model: with K = {K} a class of the porosity {porosities.min():.3g} "
            "has a virtual density above 1; give a larger K"
        )
    T = controlled_volumes(fractions, W, f(r), g(r), coarser)
    return porosity_of_volume(_compacted(fractions * W, T, 1 / K))


def _compacted(weights, T, target):
    """Return P > max T_i with 1 / Σ weights / (P - T_i) = target; weights, T (..., k), target (...,).

    The left side is a weighted harmonic mean of P - T_i, which is concave in P, so Newton's method from below is
    monotonic. At the start only the controlling class counts.
    """
    top = np.argmax(T, axis=-1)[..., None]
    P = np.take_along_axis(T, top, -1) + np.take_along_axis(weights, top, -1) * target[..., None]
    target = np.broadcast_to(target[..., None], P.shape)
    for _ in range(ITERATIONS):
        share = weights / (P - T)
        total = share.sum(axis=-1, keepdims=True)
        slope = (share / (P - T)).sum(axis=-1, keepdims=True) / total**2
        step = (target - 1 / total) / slope
        P = P + step
        if np.all(np.abs(step) <= 1e-14 * P):
            break
    return P[..., 0]

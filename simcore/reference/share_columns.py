"""The columns share_A-Bmm of committed rows: the share by volume of the sieve class from A to B mm in a bed."""

import numpy as np

from simcore.grains.sieve import SieveCurve

_BEFORE, _UNIT = "share_", "mm"


def share_columns(bounds, fractions):
    """Return the columns of one bed, dict from the name to the share.

    bounds: lower and upper size of each sieve class [m], (n, 2); fractions: shares of the volume, (n,).
    """
    in_mm = 1e3 * np.asarray(bounds)
    return {f"{_BEFORE}{low:.6g}-{high:.6g}{_UNIT}": share for (low, high), share in zip(in_mm, fractions, strict=True)}


def realised_curve(row, name):
    """Return the SieveCurve, with a name, of a row whose columns share_A-Bmm are adjacent classes, from the finest."""
    shares = {column: float(row[column]) for column in row.index if column.startswith(_BEFORE)}
    bounds = [[float(end) for end in column[len(_BEFORE) : -len(_UNIT)].split("-")] for column in shares]
    fractions = np.array(list(shares.values()))
    edges = 1e-3 * np.array([low for low, _ in bounds] + [bounds[-1][1]])
    return SieveCurve(edges, fractions / fractions.sum(), name)

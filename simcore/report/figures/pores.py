"""Figure of the distribution of pore sizes."""

import numpy as np
from matplotlib.figure import Figure

from simcore.pores.pore_sizes import PERCENTILES, percentile


def pore_size_figure(diameters, shares, voxel, name):
    """Draw the share of the pore volume over the pore diameter, and its sum.

    diameters (n,) [m] and shares (n,): of simcore.pores.pore_sizes; voxel [m]: edge of the voxels, half of a class;
    name: of the packing, for the title.
    """
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.subplots()
    axes.bar(1e3 * diameters, 100.0 * shares, 1.8e3 * voxel, color="#c9d6d9", label="share of each diameter")
    axes.plot(
        1e3 * diameters, 100.0 * np.cumsum(shares), "o-", color="#20313b", ms=3, lw=1.4, label="up to this diameter"
    )
    for percent in PERCENTILES:
        size = 1e3 * percentile(diameters, shares, percent)
        axes.axvline(size, color="#b3541e", lw=0.9)
        axes.annotate(f"d{percent}", (size, 101.0), (3, -2), textcoords="offset points", va="top", fontsize="x-small",
                      color="#b3541e")  # fmt: skip
    axes.set_ylim(0, 102)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("pore diameter (local thickness) [mm]")
    axes.set_ylabel("share of the pore volume [%]")
    axes.set_title(name, fontsize="medium")
    axes.legend(frameon=False, fontsize="small", loc="center right")
    return figure

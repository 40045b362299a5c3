"""The pore space of a packing as text and as JSON."""

import json

import numpy as np
from tabulate import tabulate

from simcore.evaluation.rounding import MAX_DECIMALS, error_decimals, heights_in_mm
from simcore.pores.kozeny_carman import CONSTANT

# Ratio to Zick and Homsy (1982) less 1, face-centred and simple cubic; docs/how_to/pores.md.
NETWORK_MISSES = "−8 to +69 % at d/40"
INSTALL = "pip install '.[pores]' in the folder of Scree"


def pores_text(results, missing=(), reason="") -> str:
    """Return the results of simcore.pores.pores as text to read.

    results: dict of bulk_pores, with that of voxel_pores or without it; missing: libraries that are not installed.
    reason: why nothing was computed on voxels although it was asked for, or empty.
    """
    lines = [_bulk_table(results)]
    if "voxel_fine" in results:
        lines += ["", _voxel_table(results)]
    lines += [
        "",
        f"Kozeny–Carman has the constant {CONSTANT:g} (180 for spheres); the range is its spread of "
        f"{100 * results['kozeny_carman_spread']:.0f} %.",
        "Conductivities are for water at 10 °C. Darcy's law limits them: above the gradient, inertia adds a tenth.",
    ]
    if "voxel_fine" in results:
        lines.append(
            f"± is the difference from voxels of {1e3 * results['voxel_coarse']:.3g} mm, the error of resolution; that "
            "of the porosity is at least its error by the finite voxels. The tortuosity is extrapolated to voxels of "
            "size 0."
        )
    if "network_permeability" in results:
        lines.append(f"The pore network has a further error: it misses lattices of spheres by {NETWORK_MISSES}.")
    if reason:
        lines.append(f"Nothing is computed on voxels: {reason}")
    elif missing:
        lines.append(f"Pore sizes and pore network need {' and '.join(missing)}: {INSTALL}")
    return "\n".join(lines)


def pores_json(results, warnings=()) -> str:
    """Return the results and the warnings of the packing as JSON, in SI units; a number that is not finite is null."""
    numbers = {name: value if np.isfinite(value) else None for name, value in results.items()}
    return json.dumps({**numbers, "warnings": list(warnings)}, indent=1)


def _bulk_table(results):
    n, surface = results["porosity"], results["specific_surface"]
    spread = results["kozeny_carman_spread"]
    low, high = heights_in_mm(results["z_lower"], results["z_upper"])
    rows = [
        ("porosity n", f"{n:.4f} ± {results['porosity_sampling_error']:.4f}"),
        ("evaluated", f"{low} to {high} mm above the floor"),
        (
            "surface of the grains",
            f"{surface:.4g} m²/m³ of grains, {results['surface_per_bed_volume']:.4g} m²/m³ of bed",
        ),
        ("sphere of this surface", f"{6e3 / surface:.3g} mm"),
    ]
    for name, key, unit in (("permeability", "permeability", "m²"), ("conductivity", "conductivity", "m/s")):
        value = results[f"kozeny_carman_{key}"]
        low, high = (1.0 - spread) * value, (1.0 + spread) * value
        rows.append((f"{name}, Kozeny–Carman", f"{value:.3g} {unit} ({low:.2g} to {high:.2g})"))
    rows.append(("Darcy's law holds to", f"a hydraulic gradient of {results['darcy_gradient']:.2g}"))
    return tabulate(rows, tablefmt="plain", disable_numparse=True)


def _voxel_table(results):
    rows = [("voxels", f"{1e3 * results['voxel_fine']:.3g} mm")]
    names = [("porosity of the voxels", "voxel_porosity", 1.0, ""), ("tortuosity along z", "tortuosity", 1.0, "")]
    names += [
        ("permeability, pore network", "network_permeability", 1.0, " m²"),
        ("conductivity, pore network", "network_conductivity", 1.0, " m/s"),
    ]
    names += [(f"pore diameter d{p}", f"pore_diameter_d{p}", 1e3, " mm") for p in (10, 50, 90)]
    for title, key, factor, unit in names:
        if key in results:
            value, error = factor * results[key], factor * results[f"{key}_resolution"]
            rows.append((title, f"{_with_error(value, error)}{unit}"))
    return tabulate(rows, tablefmt="plain", disable_numparse=True)


def _with_error(value, error):
    """Return a value and its error as text, both with the decimals of the error's second digit."""
    if not np.isfinite(value):
        return "infinite: no path of pores"
    if value == 0.0:
        return "0: no path of pores"
    if not np.isfinite(error):
        return f"{value:.3g}, of unknown error: no path of pores on the coarse voxels"
    power = int(np.floor(np.log10(abs(value))))
    small = power < -3 or 0.0 < error < 10.0 ** (1 - MAX_DECIMALS) and power < -1  # a porosity has no power of ten
    scale = 10.0**power if small else 1.0
    decimals = error_decimals(error / scale, digits=2)
    text = f"{value / scale:.{decimals}f} ± {error / scale:.{decimals}f}"
    return f"({text})e{power:d}" if small else text

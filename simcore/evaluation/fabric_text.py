"""Formats a fabric as a table for reading."""

import numpy as np

from simcore.evaluation.rounding import heights_in_mm

LABELS = {"contact_normal": "contact normals", "long_axis": "long axes", "short_axis": "short axes"}


def fabric_text(fabric):
    """Return the text of a Dataset of simcore.evaluation.fabric, of one packing or of several."""
    several = "packings" in fabric.attrs
    count = f"{fabric.attrs['packings']} packings, " if several else ""
    source = "over seeds" if several else "within the packing, assuming independent contacts and grains"
    in_cylinder = fabric.attrs.get("domain_shape") == "cylinder"
    low, high = heights_in_mm(float(fabric["z_lower"]), float(fabric["z_upper"]))
    lines = [
        f"{count}{int(fabric['grains'])} grains in the bulk, {low} to {high} mm above the floor"
        + (", without those next to the wall" if in_cylinder else ""),
        f"± standard error {source}",
        "",
    ]
    for label, name in (
        ("solid fraction, up to the wall" if in_cylinder else "solid fraction", "solid_fraction"),
        ("contacts per grain", "coordination_number"),
        ("  without rattlers", "coordination_number_without_rattlers"),
        (f"rattlers (fewer than {fabric.attrs['bearing_contacts']} contacts)", "rattler_fraction"),
        ("distance of contacts / radius", "contact_radius"),
    ):
        lines.append(f"{label:34}{_with_error(fabric, name)}")
    lines += ["", " " * 26 + "".join(f"{LABELS[name]:>20}" for name in fabric["direction"].values)]
    columns = [fabric.sel(direction=name) for name in fabric["direction"].values]
    rows = [("number", [f"{int(column['vectors'])}" for column in columns])]
    rows += [
        (f"<P{order}> about the vertical", [_with_error(one.sel(order=order), "legendre", "+") for one in columns])
        for order in fabric["order"].values
    ]
    rows += [
        (f"eigenvalue {rank + 1}", [_with_error(one.isel(rank=rank), "eigenvalues") for one in columns])
        for rank in range(3)
    ]
    rows.append(("anisotropy of the tensor", [_with_error(one, "anisotropy") for one in columns]))
    for fold in fabric["fold"].values:
        rows.append((f"azimuth, {fold}-fold", [_azimuth(one.sel(fold=fold)) for one in columns]))
    lines += [f"{label:26}" + "".join(f"{text:>20}" for text in texts) for label, texts in rows]
    return "\n".join(lines)


def _azimuth(fabric):
    """Return resultant and p-value of one fold of one direction as text, or "-" if there is none."""
    resultant, p_value = (float(fabric[f"azimuth_{name}"]) for name in ("resultant", "p_value"))
    return "-" if np.isnan(resultant) else f"{resultant:.3f}, p {p_value:.3f}"


def _with_error(fabric, name, sign=""):
    """Return a value, with ± its standard error if it has one, as text, or "-" if there is none."""
    value = float(fabric[name])
    if np.isnan(value):
        return "-"
    error = float(fabric[f"{name}_std_error"]) if f"{name}_std_error" in fabric else np.nan
    return f"{value:{sign}.4f}" + ("" if np.isnan(error) else f" ± {error:.4f}")

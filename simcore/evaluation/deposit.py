"""What is measured in a deposit: its fabric, and how deep its contacts overlap."""

import numpy as np

from simcore.evaluation.fabric import fabric


def deposit(packing):
    """Fabric of a deposit's bulk (simcore.evaluation.fabric) with its mean_overlap, Dataset; the scene stands in its
    attributes.

    packing: Dataset as in packing_io. mean_overlap: of contacts between grains, over the diameter of the sphere of a
    grain's mean volume; a bed is denser by about three times that share of its solid fraction.
    """
    found = fabric(packing)
    overlap = packing["contact_overlap"].values
    between = (packing["contact_body"].values >= 0).all(axis=1) & (overlap > 0.0)
    diameter = np.cbrt(6.0 / np.pi * float(packing["volume"].mean()))
    share = overlap[between].mean() / diameter if between.any() else 0.0
    found["mean_overlap"] = ((), share, {"units": "1", "long_name": "mean overlap over the grains' diameter"})
    known = {name: packing.attrs[name] for name in ("steps", "time", "last_insertion", "cpu_seconds")}
    return found.assign_attrs(known, n_grains=packing.sizes["grain"])

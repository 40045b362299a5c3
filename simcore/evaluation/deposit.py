"""Evaluation of a deposit: its fabric and the mean overlap of its contacts."""

from simcore.evaluation.fabric import fabric
from simcore.grains.form import equal_volume_diameter
from simcore.provenance.code_name import name_of_sources


def deposit(packing):
    """Return the fabric of a deposit's bulk (simcore.evaluation.fabric) with its mean_overlap, Dataset.

    packing: Dataset of read_packing. mean_overlap: of contacts between grains, divided by the diameter of the sphere
    of the mean grain volume; the overlap increases the solid fraction by about three times this share. The attributes
    include the scene, and evaluation_code, the name of this code.
    """
    evaluation = fabric(packing)
    overlap = packing["contact_overlap"].values
    between = (packing["contact_body"].values >= 0).all(axis=1) & (overlap > 0.0)
    diameter = equal_volume_diameter(float(packing["volume"].mean()))
    share = overlap[between].mean() / diameter if between.any() else 0.0
    evaluation["mean_overlap"] = ((), share, {"units": "1", "long_name": "mean overlap over the grains' diameter"})
    run = {name: packing.attrs[name] for name in ("steps", "time", "last_insertion", "cpu_seconds")}
    run |= {"n_grains": packing.sizes["grain"], "evaluation_code": name_of_sources("simcore/evaluation/deposit.py")}
    return evaluation.assign_attrs(run)

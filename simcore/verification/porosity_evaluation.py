"""Error of the porosity of finished packings, by volume-equivalent spheres and by exact slices, against slice height.

The method of volume-equivalent spheres is that of Rettinger et al. (2022).
"""

import time

import pandas as pd

from simcore.evaluation.porosity import bulk_porosity

SLICE_HEIGHTS = (4e-3, 2e-3, 1e-3, 0.5e-3, 0.25e-3)  # [m]
REFERENCE_HEIGHT = 0.1e-3  # [m], exact
DEFAULT = ("spheres", 1e-3)  # of Rettinger et al. (2022)


def evaluation_runs(packings, slice_heights=SLICE_HEIGHTS, reference_height=REFERENCE_HEIGHT) -> pd.DataFrame:
    """Return runs for simcore.verification.work_precision; each packing is a repeat, the setting is the height [mm].

    packings: sequence of Datasets as in simcore.packing.file. The error is the difference in bulk porosity to exact
    slices of reference_height [m]; the error of the reference is the largest change on halving its slices to this
    height.
    """
    rows = []
    for repeat, packing in enumerate(packings):
        reference = float(bulk_porosity(packing, "exact", slice_height=reference_height).n)
        coarser = float(bulk_porosity(packing, "exact", slice_height=2.0 * reference_height).n)
        for method in ("spheres", "exact"):
            for height in slice_heights:
                began = time.process_time()
                n = float(bulk_porosity(packing, method, slice_height=height).n)
                rows.append(
                    {
                        "case": "bulk porosity",
                        "quantity": "porosity",
                        "method": {"spheres": "volume-equivalent spheres", "exact": "grains themselves"}[method],
                        "setting": height * 1e3,
                        "default": (method, height) == DEFAULT,
                        "repeat": repeat,
                        "error": abs(n - reference),
                        "cpu_s": time.process_time() - began,
                        "reference_error": abs(coarser - reference),
                    }
                )
    runs = pd.DataFrame(rows)
    return runs.assign(reference_error=runs.reference_error.max())

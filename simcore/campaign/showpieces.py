"""Selects from the plan of a campaign the packings that are shown as pictures."""

import numpy as np
import pandas as pd

from simcore.scene.sizes import size_curve

AXES = ("flatness", "elongation")
# Corners of Zingg's four fields, (flatness, elongation).
FIELDS = {"bladed": (0.0, 0.0), "oblate": (0.0, 1.0), "prolate": (1.0, 0.0), "equant": (1.0, 1.0)}


def showpieces(packings):
    """Return one packing to show for each kind of domain: rows of `packings` (of simcore.campaign.studies.expand).

    The packing has the widest range of sizes, since pictures are coloured by size. Among several, one with many forms
    is preferred, then the first.
    """
    table = pd.DataFrame(
        {
            "domain": [specification["domain"]["type"] for specification in packings["specification"]],
            "span": [_size_span(specification) for specification in packings["specification"]],
            "many": [specification["shapes"]["choice"] == "random" for specification in packings["specification"]],
        },
        index=packings.index,
    )
    best_first = table.sort_values(["span", "many"], ascending=False, kind="stable")
    return packings.loc[best_first.drop_duplicates("domain").sort_values("domain").index]


def corner_mixtures(packings):
    """Return the packings of form distributions nearest to the four corners of the Zingg diagram: rows of `packings`.

    Only the narrowest distributions of the first case are considered, so there may be fewer than four. The new column
    `label` gives mean and standard deviation of FL and EL.
    """
    shapes = packings["specification"].map(lambda specification: specification["shapes"])
    mixed = packings[shapes.map(lambda group: group["choice"] == "form_distribution")]
    if mixed.empty:
        return mixed.assign(label=[])
    cases = mixed["specification"].map(lambda specification: str(specification["sizes"]["case"]))
    mixed = mixed[cases == cases.iloc[0]]
    forms = np.array([[shapes[k][name][part] for part in ("mean", "std") for name in AXES] for k in mixed.index])
    width = forms[:, 2:].sum(axis=1)
    candidates = list(np.flatnonzero(width <= width.min() + 1e-9))
    chosen = []
    for corner in FIELDS.values():
        if candidates:
            distance = np.abs(forms[candidates, :2] - corner).sum(axis=1)
            chosen.append(candidates.pop(int(np.argmin(distance))))
    labels = [f"FL {forms[k, 0]:g} ± {forms[k, 2]:g}, EL {forms[k, 1]:g} ± {forms[k, 3]:g}" for k in chosen]
    return mixed.iloc[chosen].assign(label=labels)


def _size_span(specification):
    """Return the largest over the smallest size that has mass."""
    curve = size_curve(specification["sizes"])
    return curve.largest / curve.least

"""Which packings of a campaign are shown as pictures, from its plan alone."""

import numpy as np
import pandas as pd

from simcore.scene.sizes import size_curve

AXES = ("flatness", "elongation")
# Of Zingg's four fields, as far out as they go.
FIELDS = {"bladed": (0.0, 0.0), "oblate": (0.0, 1.0), "prolate": (1.0, 0.0), "equant": (1.0, 1.0)}


def showpieces(packings):
    """The packing shown of each kind of domain, rows of the table `packings` (of simcore.campaign.studies.expand).

    That whose sizes span the widest range, since pictures are coloured by size; of several one of many forms, then
    the first.
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
    """Packings of form distributions nearest to the four corners of the Zingg diagram, rows of `packings`.

    Of those with the narrowest distributions in the first case; fewer than four if there are no more. The new column
    `label` names mean and standard deviation of FL and EL.
    """
    shapes = packings["specification"].map(lambda specification: specification["shapes"])
    mixed = packings[shapes.map(lambda group: group["choice"] == "form_distribution")]
    if mixed.empty:
        return mixed.assign(label=[])
    cases = mixed["specification"].map(lambda specification: str(specification["sizes"]["case"]))
    mixed = mixed[cases == cases.iloc[0]]
    forms = np.array([[shapes[k][name][part] for part in ("mean", "std") for name in AXES] for k in mixed.index])
    width = forms[:, 2:].sum(axis=1)
    left = list(np.flatnonzero(width <= width.min() + 1e-9))
    chosen = []
    for corner in FIELDS.values():
        if left:
            distance = np.abs(forms[left, :2] - corner).sum(axis=1)
            chosen.append(left.pop(int(np.argmin(distance))))
    labels = [f"FL {forms[k, 0]:g} ± {forms[k, 2]:g}, EL {forms[k, 1]:g} ± {forms[k, 3]:g}" for k in chosen]
    return mixed.iloc[chosen].assign(label=labels)


def _size_span(specification):
    """Largest over smallest size that has mass."""
    curve = size_curve(specification["sizes"])
    return curve.largest / curve.least

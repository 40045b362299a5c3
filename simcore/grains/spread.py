"""Which forms a specification asks for, and which of many a study of single forms takes."""

import numpy as np

from simcore.grains.sampling import ShapeChoice


def shape_choice(shapes: dict) -> ShapeChoice:
    """ShapeChoice of the resolved group `shapes`, where a distribution of form or ratios is {mean, std}."""
    settings = {key: shapes[key] for key in ("kind", "choice", "grain", "ellipsoid_share")}
    for key in ("flatness", "elongation", "eta", "zeta"):
        value = shapes[key]
        if isinstance(value, dict):
            settings |= {key: value["mean"], f"{key}_std": value["std"]}
        else:
            settings[key] = value
    return ShapeChoice(**settings)


def spread_order(flatness, elongation):
    """Indices of all grains in the order that spreads them over the Zingg diagram, whatever number is taken.

    The first is the nearest to the mean, each next one that which lies farthest from all before it.

    flatness, elongation: (n,). Returns (n,) int; ties go to the lower index.
    """
    points = np.column_stack([flatness, elongation])
    order = [int(np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    distance = np.full(len(points), np.inf)
    while len(order) < len(points):
        distance = np.minimum(distance, np.linalg.norm(points - points[order[-1]], axis=1))
        distance[order[-1]] = -1.0
        order.append(int(np.argmax(distance)))
    return np.array(order)


def choose_form(specification, form, names):
    """The specification with the grain of rank `form` (from 1; 0: none is chosen) of `names` (n,), in that order."""
    if form == 0:
        return specification
    if form > len(names):
        raise ValueError(f"packing {specification['name']}: form {form} of a set of {len(names)} grains was asked for")
    return {**specification, "shapes": {**specification["shapes"], "grain": names[form - 1]}}

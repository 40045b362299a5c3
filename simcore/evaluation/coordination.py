"""Coordination number: the mean number of contacts of a grain with other grains."""

import numpy as np
import xarray as xr

from simcore.evaluation.porosity import describe

# ASSUME: a grain with fewer force-carrying contacts than this (floor and wall count) is a rattler. With friction two
# contacts can support a grain; without friction a grain that carries load needs four (three support only its weight).
BEARING_CONTACTS = 2


def coordination_number(packing, grains=None, bearing_contacts=BEARING_CONTACTS):
    """Return the mean number of grain-grain contacts per grain, with and without rattlers, with errors, Dataset.

    packing: Dataset of read_packing; grains: (n,) bool, the grains to average over, whose contacts with all others
    count; None means all. A pair that touches through two periodic images has two contacts. Rattlers are those of
    `grains` with fewer than bearing_contacts contacts that carry force (whose two bodies push each other apart). They
    are removed with their contacts until none is left. Grains outside `grains` are never removed; otherwise a whole bed
    could be removed grain by grain from its free surface. Standard errors assume independent grains;
    simcore.evaluation.fabric gives those over seeds. ValueError if there is no grain to average over.
    """
    n_grains = packing.sizes["grain"]
    grains = np.ones(n_grains, bool) if grains is None else np.asarray(grains)
    if not grains.any():
        raise ValueError("coordination_number: there is no grain to average over; set a smaller cut of the bulk")
    bodies = packing["contact_body"].values
    touching = packing["contact_overlap"].values > 0.0
    pushing = np.sum(packing["contact_force"].values * packing["contact_normal"].values, axis=1) > 0.0
    between_grains = touching & (bodies >= 0).all(axis=1)
    counts = _contacts_per_grain(bodies[between_grains], n_grains)

    bearing = np.ones(n_grains, bool)
    while True:
        remaining = touching & np.all((bodies < 0) | bearing[np.maximum(bodies, 0)], axis=1)
        has_enough = _contacts_per_grain(bodies[remaining & pushing], n_grains) >= bearing_contacts
        still_bearing = bearing & (has_enough | ~grains)
        if (still_bearing == bearing).all():
            break
        bearing = still_bearing
    bearing_counts = _contacts_per_grain(bodies[between_grains & remaining], n_grains)
    data = {}
    for name, values, text in (
        ("coordination_number", counts[grains], "mean grain-grain contacts per grain"),
        (
            "coordination_number_without_rattlers",
            bearing_counts[grains & bearing],
            "mean grain-grain contacts per grain, without rattlers",
        ),
        ("rattler_fraction", ~bearing[grains], "share of grains that are rattlers"),
    ):
        data[name] = ((), values.mean() if len(values) else np.nan, _number(text))
        error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
        data[f"{name}_std_error"] = ((), error, _number(f"standard error of the {text}"))
    return xr.Dataset(
        data | {"contacts": ("grain", counts, _number("grain-grain contacts of each grain"))},
        attrs=describe(packing, "Coordination number of a grain packing") | {"bearing_contacts": bearing_contacts},
    )


def _contacts_per_grain(bodies, n_grains):
    """Return the number of contacts of each grain, (n,); bodies (k, 2), where negative numbers are walls."""
    return np.bincount(bodies[bodies >= 0].ravel(), minlength=n_grains)


def _number(text):
    return {"units": "1", "long_name": text}

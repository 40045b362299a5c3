"""Coordination number: how many grains a grain touches."""

import numpy as np
import xarray as xr

from simcore.evaluation.porosity import describe

# ASSUME: a grain with fewer contacts that carry force than this (floor and wall count) carries nothing. With friction
# two contacts can hold a grain; without it a grain that bears load needs four (three bear its own weight alone).
BEARING_CONTACTS = 2


def coordination_number(packing, grains=None, bearing_contacts=BEARING_CONTACTS):
    """Mean number of grain-grain contacts per grain, with and without rattlers, and standard errors, Dataset.

    packing: Dataset as in packing_io; grains: (n,) bool, those averaged over, whose contacts with all others count; all
    if None. Contacts of overlap zero or less are memory, not contacts. A pair that touches through two periodic
    images has two contacts. Rattlers, those of `grains` with fewer than bearing_contacts contacts that carry force
    (whose two bodies push each other apart), are taken out until none is left; without them their contacts do not count
    either. All other grains stay: from a free surface on, a whole bed could be taken down one grain after the other.
    The standard errors take grains as independent; see simcore.evaluation.fabric for that over seeds.
    """
    n_grains = packing.sizes["grain"]
    grains = np.ones(n_grains, bool) if grains is None else np.asarray(grains)
    if not grains.any():
        raise ValueError("coordination_number: there is no grain to average over; widen what is taken as the bulk")
    bodies = packing["contact_body"].values
    touching = packing["contact_overlap"].values > 0.0
    pushing = np.sum(packing["contact_force"].values * packing["contact_normal"].values, axis=1) > 0.0
    between_grains = touching & (bodies >= 0).all(axis=1)
    counts = _contacts_per_grain(bodies[between_grains], n_grains)

    bearing = np.ones(n_grains, bool)
    while True:
        held = touching & np.all((bodies < 0) | bearing[np.maximum(bodies, 0)], axis=1)
        enough = _contacts_per_grain(bodies[held & pushing], n_grains) >= bearing_contacts
        still = bearing & (enough | ~grains)
        if (still == bearing).all():
            break
        bearing = still
    bearing_counts = _contacts_per_grain(bodies[between_grains & held], n_grains)
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
        data[name] = ((), values.mean() if len(values) else 0.0, _number(text))
        error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
        data[f"{name}_std_error"] = ((), error, _number(f"standard error of the {text}"))
    return xr.Dataset(
        data | {"contacts": ("grain", counts, _number("grain-grain contacts of each grain"))},
        attrs=describe(packing, "Coordination number of a grain packing") | {"bearing_contacts": bearing_contacts},
    )


def _contacts_per_grain(bodies, n_grains):
    """Number of contacts of each grain, (n,); bodies (k, 2), negative numbers are walls."""
    return np.bincount(bodies[bodies >= 0].ravel(), minlength=n_grains)


def _number(text):
    return {"units": "1", "long_name": text}

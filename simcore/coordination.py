"""Coordination number: how many grains a grain touches."""

import numpy as np
import xarray as xr

from simcore.porosity import describe

# ASSUME: a grain with fewer contacts than this (floor and wall count) carries nothing. With friction two contacts can
# hold a grain; without friction three are needed, set it so there.
BEARING_CONTACTS = 2


def coordination_number(packing, interval=None, bearing_contacts=BEARING_CONTACTS):
    """Mean number of grain-grain contacts per grain, with and without rattlers, Dataset.

    packing: Dataset as in packing_io; interval: heights (low, high) [m] of the centres of the grains averaged over, all
    grains if None. Contacts of overlap zero or less are memory, not contacts. A pair that touches through two periodic
    images has two contacts. Rattlers, grains with fewer than bearing_contacts contacts, are taken out until none is
    left; without them their contacts do not count either.
    """
    z = packing["position"].values[:, 2]
    low, high = (-np.inf, np.inf) if interval is None else interval
    inside = (z >= low) & (z <= high)
    if not inside.any():
        raise ValueError(f"coordination_number: no grain has its centre in {low} m to {high} m; widen the interval")
    bodies = packing["contact_body"].values[packing["contact_overlap"].values > 0.0]
    between_grains = (bodies >= 0).all(axis=1)
    counts = _contacts_per_grain(bodies[between_grains], len(z))

    bearing = np.ones(len(z), bool)
    while True:
        held = np.all((bodies < 0) | bearing[bodies], axis=1)
        still = bearing & (_contacts_per_grain(bodies[held], len(z)) >= bearing_contacts)
        if (still == bearing).all():
            break
        bearing = still
    bearing_counts = _contacts_per_grain(bodies[between_grains & held], len(z))
    counted = inside & bearing
    without = bearing_counts[counted].mean() if counted.any() else 0.0
    return xr.Dataset(
        {
            "coordination_number": ((), counts[inside].mean(), _number("mean grain-grain contacts per grain")),
            "coordination_number_without_rattlers": ((), without, _number("mean contacts per grain, without rattlers")),
            "rattler_fraction": ((), 1.0 - bearing[inside].mean(), _number("share of grains that are rattlers")),
            "contacts": ("grain", counts, _number("grain-grain contacts of each grain")),
        },
        attrs=describe(packing, "Coordination number of a grain packing") | {"bearing_contacts": bearing_contacts},
    )


def _contacts_per_grain(bodies, n_grains):
    """Number of contacts of each grain, (n,); bodies (k, 2), negative numbers are walls."""
    return np.bincount(bodies[bodies >= 0].ravel(), minlength=n_grains)


def _number(text):
    return {"units": "1", "long_name": text}

"""Quantities measured on a packing for comparison with published values; packings are as in simcore.packing.file."""

import numpy as np
from scipy.spatial import cKDTree

from simcore.evaluation.coordination import coordination_number
from simcore.evaluation.porosity import bulk_porosity, domain_area
from simcore.evaluation.slicing import slab_volumes
from simcore.grains.form import equal_volume_diameter

SLICES_PER_GRAIN = 8  # slices per mean grain diameter, in which the surface of the bed is detected
POINTS = 1_000_000  # number of points of core_porosity, whose error is then 0.0005


def porosity(packing, floor, surface):
    """Return the bulk porosity by exact slices; floor, surface [m]: heights left out at both ends of the bed."""
    return float(_bulk(packing, floor, surface)["n"])


def coordination(packing, floor, surface, bearing_contacts):
    """Return contacts per grain, without rattlers, of grains with centres between the heights left out.

    floor, surface [m]: heights left out at both ends of the bed. bearing_contacts: minimum number of
    force-carrying contacts of a grain that is not a rattler.
    """
    bulk = _bulk(packing, floor, surface)
    height = packing["position"].values[:, 2]
    inside = (height >= float(bulk["z_lower"])) & (height <= float(bulk["z_upper"]))
    return float(coordination_number(packing, inside, bearing_contacts)["coordination_number_without_rattlers"])


def core_porosity(packing, core, floor, surface):
    """Return the porosity of equal spheres within `core` [m] of the axis of a cylinder, by evenly distributed points.

    floor, surface [m]: heights left out at both ends of the bed. ValueError if the spheres are not equal.
    """
    bulk = _bulk(packing, floor, surface)
    rng = np.random.default_rng(0)
    radius, angle = core * np.sqrt(rng.random(POINTS)), 2.0 * np.pi * rng.random(POINTS)
    height = rng.uniform(float(bulk["z_lower"]), float(bulk["z_upper"]), POINTS)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
    radii = packing["scale"].values[:, 0]
    if np.ptp(radii) > 1e-4 * radii.mean():
        raise ValueError(
            "core_porosity: the spheres are not equal; use the measure porosity, which is valid for all grains"
        )
    distance, _ = cKDTree(packing["position"].values).query(points)
    return float((distance > radii.mean()).mean())


def column_porosity(packing):
    """Return the porosity of a column between the centres of its lowest and highest sphere, without end effects."""
    height = packing["position"].values[:, 2]
    low, high = height.min(), height.max()
    solid = slab_volumes(packing, [low, high], "exact")[0]
    return float(1.0 - solid / (domain_area(packing) * (high - low)))


def energy_ratio(record):
    """Return the energy over its initial value at the largest deviation from 1; record: of elastic.jump."""
    ratio = record["energy"].values / float(record["energy"][0])
    return float(ratio[np.argmax(np.abs(ratio - 1.0))])


def _bulk(packing, floor, surface):
    diameter = equal_volume_diameter(float(packing["volume"].mean()))
    return bulk_porosity(packing, "exact", (floor, surface), diameter / SLICES_PER_GRAIN)


MEASURES = {
    "porosity": porosity,
    "coordination": coordination,
    "core_porosity": core_porosity,
    "column_porosity": column_porosity,
    "energy_ratio": energy_ratio,
}

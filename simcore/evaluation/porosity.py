"""Porosity of a packing: profile over height, and bulk value with its sampling error over the evaluation interval."""

import numpy as np
import xarray as xr

from simcore.evaluation import interval
from simcore.evaluation.sampling_error import sampling_error
from simcore.evaluation.slicing import slab_volumes, vertical_extent
from simcore.scene.domain import Domain

CUT_OFF = 0.5  # porosity at the top of the bed (Rettinger et al. 2022)
ROUNDING = 1e-9  # share of a slice by which the evaluated height may be lower than a slice because numbers are rounded
ORIGIN = ("scene", "seed", "code_version", "converged", "domain_shape", "domain_width", "largest_sieve_size")


def domain_area(packing):
    """Return the horizontal area of the periodic box or of the cylinder [m²]."""
    return Domain(packing.attrs["domain_shape"], packing.attrs["domain_width"], height=np.inf).area


def porosity_profile(packing, slice_height=None, method="spheres"):
    """Return n(z) in horizontal slices from the floor to above the bed, Dataset over `z`, the slices' middles [m].

    packing: Dataset of read_packing; slice_height [m]: None for that of simcore.evaluation.interval; method: "spheres"
    slices volume-equivalent spheres, in exact segments (Rettinger et al. 2022), "exact" the polyhedra and ellipsoids
    themselves. The equivalent sphere of a flat grain on the floor extends below the floor; the volume there is in no
    slice and given as solid_volume_below_floor.
    ValueError if slice_height is not positive, or if there is no grain.
    """
    if packing.sizes["grain"] == 0:
        raise ValueError("porosity_profile: the packing contains no grain; check its amount and its log")
    if slice_height is None:
        slice_height = interval.slice_height(_median_of(packing))
    if not slice_height > 0.0:
        raise ValueError(f"porosity_profile: slice_height is {slice_height} m; it must be positive")
    low, high = vertical_extent(packing, method)
    n_slices = int(np.ceil(max(high.max(), slice_height) / slice_height)) + 1  # the topmost slice is empty
    edges = np.arange(n_slices + 1) * slice_height
    solid = slab_volumes(packing, edges, method)
    below = slab_volumes(packing, [min(low.min(), 0.0) - slice_height, 0.0], method)[0]
    slice_volume = domain_area(packing) * slice_height
    return xr.Dataset(
        {
            "porosity": ("z", 1.0 - solid / slice_volume, {"units": "1", "long_name": "porosity of the slice"}),
            "solid_volume": ("z", solid, {"units": "m3", "long_name": "volume of grains in the slice"}),
            "solid_volume_below_floor": (
                (),
                below,
                {"units": "m3", "long_name": "volume of the grains as sliced below z = 0"},
            ),
            "z_bounds": (("z", "bound"), np.stack([edges[:-1], edges[1:]], axis=1)),
        },
        coords={"z": ("z", 0.5 * (edges[1:] + edges[:-1]), _HEIGHT | {"bounds": "z_bounds"})},
        attrs=describe(packing, "Porosity profile of a grain packing")
        | {"slice_height": slice_height, "method": method},
    )


def bed_top(profile):
    """Return the height of the bed's surface z+ [m].

    From the top downwards, it is the first plane between a slice that is at most half solid and one below it that is at
    least half solid. ASSUME: there is no interpolation, so the half-empty slice is left out; the program of Rettinger
    et al. (2022) uses a slice too, not a point between slices. ValueError if no slice is half solid.
    """
    solid = 1.0 - profile["porosity"].values
    surface = (solid[1:] <= 1.0 - CUT_OFF) & (solid[:-1] >= 1.0 - CUT_OFF)
    if not surface.any():
        raise ValueError(
            f"bed_top: no slice of the packing has a solid fraction of {CUT_OFF:g} (the maximum is {solid.max():.3f}), "
            "so the bed has no surface; use more grains or a narrower domain, or check that the packing has settled"
        )
    return float(profile["z_bounds"].values[np.flatnonzero(surface)[-1], 1])


def largest_sieve_size(packing):
    """Return the upper bound of the sieve sizes of a packing [m]; ValueError if its file does not have it."""
    if "largest_sieve_size" not in packing.attrs:
        raise ValueError(
            "the packing has no attribute largest_sieve_size, by which the ends of the bed are cut; give the height "
            "that is cut, or pack the bed with `scree pack`"
        )
    return packing.attrs["largest_sieve_size"]


def evaluation_interval(packing, profile, cut=None):
    """Return the heights (z-, z+) [m] between which bulk porosity is evaluated.

    They follow from the surface in the profile and the cut at both ends; cut: as in
    simcore.evaluation.interval.end_cuts. ValueError if less than one slice is left, or if much of the bed is above its
    surface.
    """
    top = bed_top(profile)
    _check_surface(packing, profile, top)
    periodic = packing.attrs["domain_shape"] == "periodic"
    largest = largest_sieve_size(packing) if cut is None and periodic else np.nan
    at_floor, at_surface = interval.end_cuts(periodic, top, largest, _median_of(packing), cut)
    if top - at_floor - at_surface < profile.attrs["slice_height"] * (1.0 - ROUNDING):
        raise ValueError(
            f"the bed is {1e3 * top:.1f} mm high, too low to cut {1e3 * at_floor:.1f} mm from its "
            f"floor and {1e3 * at_surface:.1f} mm from its surface; use more grains, a narrower domain, or set a "
            "smaller cut"
        )
    return at_floor, top - at_surface


def _check_surface(packing, profile, top):
    """Raise ValueError if the volume above the surface would be a layer thicker than the largest grain size.

    That is a bed less than half solid, of which only the ordered grains on the floor are half solid.
    """
    solid = profile["solid_volume"].values
    above = solid[profile["z"].values > top].sum()
    if above > packing["D"].values.max() * domain_area(packing):
        raise ValueError(
            f"the bed is less than half solid above a height of {1e3 * top:.1f} mm, where "
            f"{100 * above / solid.sum():.0f} % of its volume is. Its surface, where the porosity is {CUT_OFF:g}, "
            "cannot be found. Check that the bed has settled, or shake it; beds looser than that cannot be evaluated"
        )


def _median_of(packing):
    return interval.median_size(packing["D"].values, packing["volume"].values)


def bulk_porosity(packing, method="spheres", cut=None, slice_height=None):
    """Return the mean porosity over the evaluation interval with its sampling error, Dataset of scalars.

    packing: Dataset of read_packing; method, slice_height [m] as in porosity_profile; cut [m]: height that is left out
    at floor and surface, or a pair of heights; None: the rule of simcore.evaluation.interval.end_cuts. n is the mean of
    n(z) over the interval, exact even if an end is inside a slice. n_std_error is the expected scatter over seeds
    (simcore.evaluation.sampling_error), not the bias of method or model.
    """
    profile = porosity_profile(packing, slice_height, method)
    z_lower, z_upper = evaluation_interval(packing, profile, cut)
    solid = slab_volumes(packing, [z_lower, z_upper], method)[0]
    error = sampling_error(packing, z_lower, z_upper, method)
    values = {
        "n": (1.0 - solid / (domain_area(packing) * (z_upper - z_lower)), "1", "bulk porosity"),
        "n_std_error": (error["n_std_error"], "1", "sampling standard error of the bulk porosity"),
        "n_contrasts": (error["n_contrasts"], "1", "number of block contrasts behind the standard error"),
        "block_size": (error["block_size"], "m", "size of the smallest blocks behind the standard error"),
        "correlation_length": (error["correlation_length"], "m", "cube root of the integral range of the solid field"),
        "z_lower": (z_lower, "m", "lower end of the evaluation interval"),
        "z_upper": (z_upper, "m", "upper end of the evaluation interval"),
        "bed_top": (bed_top(profile), "m", "height of the bed's surface"),
    }
    data = {name: ((), value, {"units": units, "long_name": text}) for name, (value, units, text) in values.items()}
    data["n"][2]["ancillary_variables"] = "n_std_error"
    attrs = describe(packing, "Bulk porosity of a grain packing") | {
        "slice_height": profile.slice_height,
        "method": method,
    }
    return xr.Dataset(data, attrs=attrs)


def check_physical(porosity):
    """Raise ValueError unless a porosity is between 0 and 1, as that of grains that do not overlap is."""
    if not 0.0 < float(porosity) < 1.0:
        raise ValueError(
            f"the porosity is {float(porosity):.3g}, but that of a bed is between 0 and 1. Check that the grains do "
            "not overlap, and that none is wider than the domain"
        )


_HEIGHT = {"units": "m", "long_name": "height above the floor", "axis": "Z", "positive": "up"}


def describe(packing, title):
    """Return the global attributes of a result: CF version, title, and the origin of the packing."""
    origin = {name: packing.attrs[name] for name in ORIGIN if name in packing.attrs}
    return {"Conventions": "CF-1.11", "title": title} | origin


def warnings_of(packing) -> list[str]:
    """Return the warnings in the Dataset of a packing, a list of sentences."""
    return [line for line in packing.attrs.get("warnings", "").split("\n") if line]

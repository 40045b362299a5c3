"""Fabric of a packing's bulk: solid fraction, contacts, and the orientation of contacts and grains.

The statistics include the grains whose centre is in the bulk (simcore.evaluation.bulk_region), and each contact with
another grain once for each of its two grains in the bulk. So a mean over the ends of contacts is a mean over grains,
each with all its contacts, and the ends of the bulk favour no direction. Contact normals and axes of grains are axes
without a sense (simcore.evaluation.axis_statistics).
"""

import json

import numpy as np
import xarray as xr

from simcore.evaluation.axis_statistics import (
    FOLDS,
    ORDERS,
    azimuth_moments,
    density_per_solid_angle,
    equal_solid_angles,
    grain_axes,
    legendre_moments,
    mean_and_error,
    rayleigh_test,
    second_rank_tensor,
    tensor_invariants,
)
from simcore.evaluation.bulk_region import bulk
from simcore.evaluation.contact_radius import contact_radii, largest_radius, radius_bins, surface_radii
from simcore.evaluation.coordination import BEARING_CONTACTS, coordination_number
from simcore.evaluation.porosity import describe
from simcore.scene.identity import differing_keys, shown_but_seed

N_BINS = 20
DIRECTIONS = ("contact_normal", "long_axis", "short_axis")

# name: (dimensions, units, long name)
_VARIABLES = {
    "solid_fraction": ((), "1", "solid fraction of the bulk"),
    "z_lower": ((), "m", "lower end of the bulk"),
    "z_upper": ((), "m", "upper end of the bulk"),
    "bed_top": ((), "m", "height of the bed's surface"),
    "coordination_number": ((), "1", "mean grain-grain contacts per grain"),
    "coordination_number_without_rattlers": ((), "1", "mean grain-grain contacts per grain, without rattlers"),
    "rattler_fraction": ((), "1", "share of grains that are rattlers"),
    "density": (("direction", "angle"), "1", "density per solid angle over that of isotropic directions"),
    "legendre": (("direction", "order"), "1", "mean Legendre polynomial of the cosine against the vertical"),
    "tensor": (("direction", "row", "column"), "1", "second-rank tensor, trace 1"),
    "azimuth_moment": (("direction", "fold", "part"), "1", "mean cosine and sine of the azimuth times the fold"),
    "contact_radius_density": (("radius",), "1", "density of contacts over their distance from the centre"),
    "surface_radius_density": (("radius",), "1", "density of the grains' surface over its distance from the centre"),
    "contact_radius": ((), "1", "mean distance of contacts from the centre over the equal-volume radius"),
    "eigenvalues": (("direction", "rank"), "1", "eigenvalues of the tensor, descending"),
    "anisotropy": (("direction",), "1", "√(3/2 D:D) of the tensor's deviator D"),
    "determinant": (("direction",), "1", "determinant of the tensor's deviator"),
    "azimuth_resultant": (("direction", "fold"), "1", "|<exp(i m phi)>| over the azimuths phi, m the fold"),
    "azimuth_p_value": (("direction", "fold"), "1", "p-value of the resultant for uniform azimuths, Rayleigh's test"),
    "azimuth_number": (("direction",), "1", "number of independent azimuths behind the test"),
    "grains": ((), "1", "number of grains in the bulk"),
    "vectors": (("direction",), "1", "number of distinct directions behind the statistics"),
}
_OF_TENSOR = ("eigenvalues", "anisotropy", "determinant")
_OF_AZIMUTH = ("azimuth_resultant", "azimuth_p_value", "azimuth_number")
_SUMS = ("grains", "vectors")


def fabric(packing, cut=None, bearing_contacts=BEARING_CONTACTS, n_bins=N_BINS):
    """Return the fabric of one packing, Dataset.

    packing: Dataset of read_packing; cut [m]: see simcore.evaluation.bulk_region; bearing_contacts: see
    simcore.evaluation.coordination; n_bins: number of bins of equal solid angle from the vertical to the horizontal.

    Scalars: solid_fraction; coordination_number, also _without_rattlers; rattler_fraction.
    Over `direction` (contact normals, long and short axes of grains): density per solid angle over `angle` [rad], 1 if
    isotropic; legendre, means of P2, P4, P6 over `order`; tensor, the mean of u ⊗ u over unit vectors u, and its
    eigenvalues, anisotropy, determinant; azimuth_resultant with azimuth_p_value over `fold`. They are nan for a kind of
    axis that no grain has.
    Over `radius`: contact_radius_density, see simcore.evaluation.contact_radius.

    *_std_error and p-values are from this packing alone and assume that contacts and grains are independent, which is
    not quite true; the error of the solid fraction is that of simcore.evaluation.sampling_error. fabric_over_seeds
    gives errors without this assumption, but its p-values have it too. Long axes of neighbours are partly parallel: in
    deposits of ellipsoids p^(1/1.9) is about the correct p-value of their twofold azimuth
    (benchmarks/studies/azimuths.py).
    """
    if n_bins < 1:
        raise ValueError(f"fabric: n_bins is {n_bins}, but at least one bin is needed")
    inner = bulk(packing, cut)
    bodies = packing["contact_body"].values
    touching = (packing["contact_overlap"].values > 0.0) & (bodies >= 0).all(axis=1)
    ends = touching[:, None] & inner.grains[np.maximum(bodies, 0)]  # negative numbers are walls, touching is False
    values = {
        "solid_fraction": 1.0 - float(inner.porosity["n"]),
        "solid_fraction_std_error": float(inner.porosity["n_std_error"]),
        "grains": inner.grains.sum(),
        **{name: float(inner.porosity[name]) for name in ("z_lower", "z_upper", "bed_top")},
    }
    coordination = coordination_number(packing, inner.grains, bearing_contacts)
    values |= {name: float(value) for name, value in coordination.items() if value.ndim == 0}
    edges = equal_solid_angles(n_bins)
    normals, times = packing["contact_normal"].values, ends.sum(axis=1)
    vectors = [(normals[times > 0], times[times > 0].astype(float))]
    for axes, grains in grain_axes(packing).values():
        axes = axes[inner.grains[grains]]
        vectors.append((axes, np.ones(len(axes))))
    statistics = [_of_directions(directions, weights, edges) for directions, weights in vectors]
    values |= {name: np.stack([one[name] for one in statistics]) for name in statistics[0]}
    radius, of_radius = _radial(packing, ends)
    attrs = describe(packing, "Fabric of a grain packing") | {
        "bearing_contacts": bearing_contacts,
        "cut": "default" if cut is None else cut,
    }
    return _dataset(values | of_radius, edges, radius, attrs)


def fabric_over_seeds(fabrics, names=None):
    """Return means over packings of one scene with different seeds, with standard errors over the seeds, Dataset.

    fabrics: two or more Datasets from fabric(), with the same variables. names: of each one in messages, such as its
    file; None: "fabric 1" and so on. Invariants of the tensor are those of the mean tensor, and their standard errors
    are by jackknife. Numbers of grains and vectors are sums over all packings. *_of_seed, over `seed`, are the values
    of the single packings. ValueError if the scenes differ in more than their seed, or have the same seed or none.
    """
    fabrics = list(fabrics)
    seeds = _check_scenes(fabrics, names or [f"fabric {k}" for k in range(1, len(fabrics) + 1)])
    n = len(fabrics)
    by_seed = xr.concat(
        [data.drop_vars([name for name in data if name.endswith("_std_error")]) for data in fabrics],
        xr.DataArray(seeds, dims="seed", name="seed"),
        data_vars="all",
        coords="minimal",
        compat="override",
        join="outer",
        fill_value=0.0,  # beyond the largest radius of a packing
        combine_attrs="override",
    )
    values = {}
    for name in set(_VARIABLES) - {*_OF_TENSOR, *_OF_AZIMUTH, *_SUMS}:
        of_seed = by_seed[name].values
        values[name] = of_seed.mean(axis=0)
        values[f"{name}_std_error"] = of_seed.std(axis=0, ddof=1) / np.sqrt(n)
    tensors = by_seed["tensor"].values
    values |= _of_tensors(values["tensor"])
    left_out = [_of_tensors((tensors.sum(axis=0) - tensors[k]) / (n - 1)) for k in range(n)]
    for name in _OF_TENSOR:
        others = np.stack([of_others[name] for of_others in left_out])
        values[f"{name}_std_error"] = np.sqrt((n - 1) * np.mean((others - others.mean(axis=0)) ** 2, axis=0))
    with np.errstate(divide="ignore"):
        # The mean of n means over n_k azimuths has the variance of a mean over this number of azimuths.
        number = n**2 / np.sum(1.0 / by_seed["azimuth_number"].values, axis=0)
    values |= _of_azimuths(values["azimuth_moment"], number)
    values |= {name: by_seed[name].values.sum(axis=0) for name in _SUMS}
    attrs = {name: value for name, value in fabrics[0].attrs.items() if name != "seed"}
    attrs |= {"title": "Fabric of a grain packing, mean over seeds", "packings": n}
    edges = np.append(fabrics[0]["angle_bounds"].values[:, 0], 0.5 * np.pi)
    return _dataset(values, edges, by_seed["radius"].values, attrs).merge(
        by_seed[list(_VARIABLES)].rename({name: f"{name}_of_seed" for name in _VARIABLES}), combine_attrs="override"
    )


def _of_directions(directions, weights, edges):
    """Return all statistics of one kind of directions, dict of arrays."""
    values = {"vectors": len(weights)}
    values["density"], values["density_std_error"] = density_per_solid_angle(directions, weights, edges)
    values["legendre"], values["legendre_std_error"] = legendre_moments(directions, weights)
    values["tensor"], values["tensor_std_error"] = second_rank_tensor(directions, weights)
    values["azimuth_moment"], number = azimuth_moments(directions, weights)
    return values | tensor_invariants(values["tensor"]) | _of_azimuths(values["azimuth_moment"], number)


def _of_tensors(tensors):
    """Return the invariants of tensors (d, 3, 3), dict of arrays (d, ...)."""
    invariants = [tensor_invariants(tensor) for tensor in tensors]
    return {name: np.stack([one[name] for one in invariants]) for name in _OF_TENSOR}


def _of_azimuths(moments, number):
    """Return the resultants and their test, dict; moments (..., m, 2), number (...) of azimuths in the moments."""
    resultant = np.hypot(*np.moveaxis(moments, -1, 0))
    p_value = rayleigh_test(resultant, np.expand_dims(number, -1))
    return {"azimuth_resultant": resultant, "azimuth_p_value": p_value, "azimuth_number": number}


def _radial(packing, ends):
    """Return the middles of the radial bins, (k,), and the radial distributions of contacts and surface, dict."""
    contacts, second = np.nonzero(ends)
    rho = contact_radii(packing, contacts, second > 0)
    grains = packing["contact_body"].values[contacts, second]
    number = np.bincount(grains, minlength=packing.sizes["grain"])
    touched = np.flatnonzero(number)
    edges, middles = radius_bins(max(rho.max(initial=0.0), largest_radius(packing, touched)))
    surface = surface_radii(packing, touched, number[touched].astype(float), edges)
    places = np.clip(np.searchsorted(edges, rho, side="right") - 1, 0, len(middles) - 1)
    counts = np.bincount(places, minlength=len(middles))
    n, width = len(rho), np.diff(edges)
    share = counts / n if n else np.full(len(middles), np.nan)
    error = np.sqrt(share * (1.0 - share) / (n - 1)) if n > 1 else np.full(len(middles), np.nan)
    mean, mean_error = mean_and_error(rho, np.ones(n))
    return middles, {
        "contact_radius_density": share / width,
        "contact_radius_density_std_error": error / width,
        "surface_radius_density": surface,
        "contact_radius": mean,
        "contact_radius_std_error": mean_error,
    }


def _dataset(values, edges, radius, attrs):
    """Return a Dataset of the values, in the order of _VARIABLES, with their standard errors."""
    data = {}
    for name, (dims, units, text) in _VARIABLES.items():
        about = {"units": units, "long_name": text}
        if f"{name}_std_error" in values:
            of_error = {"units": units, "long_name": f"standard error of the {text}"}
            data[f"{name}_std_error"] = (dims, values[f"{name}_std_error"], of_error)
            about["ancillary_variables"] = f"{name}_std_error"
        data[name] = (dims, values[name], about)
    heights = np.cos(edges)
    angle = {"units": "rad", "long_name": "angle against the vertical", "bounds": "angle_bounds"}
    coords = {
        "direction": list(DIRECTIONS),
        "angle": ("angle", np.arccos(0.5 * (heights[1:] + heights[:-1])), angle),
        "angle_bounds": (("angle", "bound"), np.stack([edges[:-1], edges[1:]], axis=1)),
        "order": ("order", list(ORDERS), {"units": "1", "long_name": "order of the Legendre polynomial"}),
        "row": list("xyz"),
        "column": list("xyz"),
        "fold": ("fold", list(FOLDS), {"units": "1", "long_name": "multiple of the azimuth"}),
        "part": ["cos", "sin"],
        "radius": (
            "radius",
            radius,
            {"units": "1", "long_name": "distance from the grain's centre over its equal-volume radius"},
        ),
    }
    return xr.Dataset(data, coords, attrs)


def _check_scenes(fabrics, names):
    """Return the seeds of the fabrics, (n,); ValueError if their packings differ in more than their seed."""
    if len(fabrics) < 2:
        raise ValueError("a standard error over seeds needs two packings or more; pack another seed")
    without = [name for name, data in zip(names, fabrics, strict=True) if "seed" not in data.attrs]
    if without:
        raise ValueError(
            f"{without[0]}: it has no attribute seed, so it may be of the same packing as another; make the fabrics "
            "from files of `scree pack`, or set the attribute"
        )
    seeds = [int(data.attrs["seed"]) for data in fabrics]
    reference = fabrics[0]
    for data, name in zip(fabrics[1:], names[1:], strict=True):
        differing = [key for key in ("bearing_contacts", "cut") if data.attrs[key] != reference.attrs[key]]
        differing += differing_keys(
            *(shown_but_seed(json.loads(one.attrs.get("scene", "{}"))) for one in (reference, data))
        )
        differing += ["n_bins"] if data.sizes["angle"] != reference.sizes["angle"] else []
        if differing:
            raise ValueError(
                f"{name} differs from {names[0]} in {', '.join(differing)}; give packings that differ only in their "
                "seed"
            )
    for k, seed in enumerate(seeds):
        if seed in seeds[:k]:
            raise ValueError(
                f"{names[k]} has the seed {seed}, as has {names[seeds.index(seed)]}, so that they are not independent; "
                "give each seed once"
            )
    return seeds

"""Evaluates a finished packing: all results in one dataset."""

import xarray as xr

from simcore.evaluation.composition import composition, separation_warnings
from simcore.evaluation.coordination import coordination_number
from simcore.evaluation.height_trends import height_trends
from simcore.evaluation.porosity import bulk_porosity, porosity_profile, warnings_of
from simcore.grains.statistics import mixture_features
from simcore.provenance.code_name import name_of_sources


def evaluate(packing, slice_height=None, cut=None):
    """Return porosity, its profile, coordination, trends over height and form of a packing in one Dataset.

    packing: Dataset as from simcore.packing.file.read_packing; slice_height, cut [m]: see simcore.evaluation.porosity.
    Porosities whose names end in _exact are from slices of the grains themselves, the others from slices of
    volume-equivalent spheres as in Rettinger et al. (2022); z_lower and z_upper belong to the latter, and n_exact has
    an evaluated part of its own. profile is n(z) over z; form are the 104 features of simcore.grains.statistics; axes
    are the means of L, I, S. The trends have the dimensions layer and quantity; if the
    bed is too low for them, the attribute height_trends gives the reason. The sieve curve and the forms of the whole
    bed and of its evaluated part are those of simcore.evaluation.composition. Where sizes separate, the attribute
    warnings has one more line. The attribute evaluation_code is the name of the code of the evaluation, beside
    code_version of the code that packed.
    """
    bulk = bulk_porosity(packing, "spheres", cut, slice_height)
    exact = bulk_porosity(packing, "exact", cut, slice_height)[["n", "n_std_error"]]
    composed = composition(packing, float(bulk.z_lower), float(bulk.z_upper))
    parts = [
        bulk,
        exact.rename(n="n_exact", n_std_error="n_std_error_exact"),
        _profile(packing, slice_height, "spheres", "profile"),
        _profile(packing, slice_height, "exact", "profile_exact"),
        coordination_number(packing).drop_vars("contacts"),
        _form(packing),
        composed,
    ]
    notes = {
        "slice_height": bulk.slice_height,
        "n_grains": packing.sizes["grain"],
        "evaluation_code": name_of_sources("simcore/evaluation/evaluate.py"),
    }
    warnings = [*warnings_of(packing), *separation_warnings(composed)]
    notes |= {"warnings": "\n".join(warnings)} if warnings else {}
    try:
        parts.append(_trends(packing, bulk))
    except ValueError as error:
        notes["height_trends"] = f"left out: {error}"
    merged = xr.merge(parts, join="outer", compat="override", combine_attrs="override")
    for name in ("profile", "profile_exact"):
        merged[name] = merged[name].fillna(1.0)  # above the last slice of the shorter one there are only pores
    title = {"Conventions": "CF-1.11", "title": "Evaluation of a grain packing"}
    return merged.assign_attrs(packing.attrs | title | notes)


def _profile(packing, slice_height, method, name):
    return porosity_profile(packing, slice_height, method)[["porosity"]].rename(porosity=name)


def _form(packing):
    statistics = mixture_features(*(packing[axis].values for axis in "LIS"))
    axes = [float(packing[axis].mean()) for axis in "LIS"]
    return xr.Dataset(
        {
            "form": ("feature", statistics.to_numpy(float), {"units": "1", "long_name": "statistics of form"}),
            "axes": ("axis", axes, {"units": "m", "long_name": "mean of the full axes over the grains"}),
        },
        {"feature": list(statistics.index), "axis": list("LIS")},
    )


def _trends(packing, bulk):
    # On the floor, large grains have higher centres. For a cylinder, whose porosity is evaluated from the floor, the
    # default interval of the trends leaves that layer out.
    periodic = packing.attrs["domain_shape"] == "periodic"
    interval = (float(bulk.z_lower), float(bulk.z_upper)) if periodic else None
    trends = height_trends(packing, interval)
    return trends.rename(z="layer", z_bounds="layer_bounds")

"""Composition of a bed: its sieve curve and forms, of the whole and of the evaluated part, and whether sizes separate.

A grain that a plane cuts counts with the share of its volume on either side. Sizes separate where the share of coarse
grains differs between the lower and the upper half of the evaluated part, or where fine grains gather on the floor.
Standard errors of shares take grains as independent. The rules:

    segregation         the shares of coarse grains in the two halves differ by more than LARGE_DIFFERENCE standard
                        errors
    fines on the floor  the share of fine grains in the layer below the evaluated part exceeds that in the evaluated
                        part by more than LARGE_DIFFERENCE standard errors and by more than the factor FLOOR_FACTOR

Coarse grains are the coarser half of the bed by volume, fine ones its finest tenth. Next to a flat floor small grains
fit better than large ones; the factor allows for that.
"""

import numpy as np
import xarray as xr

from simcore.evaluation.slicing import slab_volumes, vertical_extent

LARGE_DIFFERENCE = 3.0  # by chance in 3 of 1000 beds
FLOOR_FACTOR = 1.5
COARSE, FINE = 0.5, 0.1  # shares of the volume below the size where coarse grains begin, and where fine ones end
PARTS, WEIGHTS = ("bed", "evaluated"), ("volume", "number")


def composition(packing, z_lower, z_upper, method="spheres"):
    """Return the composition of a packing as a Dataset.

    packing: Dataset of read_packing; z_lower, z_upper [m]: ends of its evaluated part.

    sieve_fraction (part, weight, sieve_class): shares of the classes of the sieve curve, where the packing has one.
    form_mean, form_std (part, weight, ratio): mean and standard deviation of FL, EL and EQ. part: the whole bed, or its
    evaluated part; weight: by volume or by number. coarse_share, coarse_share_std_error (half): share of the volume in
    the lower and the upper half of the evaluated part that belongs to coarse grains. coarse_share_of_part,
    coarse_share_of_part_std_error (part): the same of the whole bed and of its evaluated part. fine_share,
    fine_share_std_error (zone): share of fine grains in the layer below the evaluated part, nan where there is none,
    and in the evaluated part. ValueError where no grain reaches into the evaluated part.
    """
    low, _ = vertical_extent(packing, method)
    middle = 0.5 * (z_lower + z_upper)
    bottom = min(float(low.min()), z_lower) - 1e-6 * (z_upper - z_lower)
    below, lower, upper = slab_volumes(packing, [bottom, z_lower, middle, z_upper], method, per_grain=True).T
    if not z_lower > 0.0:
        # Only overlaps with the floor are below it, and light grains have the largest.
        below = np.zeros(len(below))
    volume, size = packing["volume"].values, packing["D"].values
    evaluated = lower + upper
    if not evaluated.sum() > 0.0:
        raise ValueError(
            f"composition: no grain reaches into the evaluated part from {z_lower:.4g} m to {z_upper:.4g} m; correct "
            "the heights"
        )
    weights = {"bed": (volume, np.ones(len(volume))), "evaluated": (evaluated, evaluated / volume)}
    coarse = size > _size_at(size, volume, COARSE)
    fine = size <= _size_at(size, volume, FINE)
    halves = [_share(coarse, lower), _share(coarse, upper)]
    zones = [_share(fine, below), _share(fine, evaluated)]
    parts = [_share(coarse, weights[part][0]) for part in PARTS]
    data = _forms(packing, weights) | _pair("coarse", "half", halves) | _pair("fine", "zone", zones)
    data |= _pair("coarse", "part", parts, "_of_part")
    if "sieve_bounds" in packing:
        data |= _sieve_fractions(packing, weights)
    coordinates = {"part": list(PARTS), "weight": list(WEIGHTS), "ratio": ["FL", "EL", "EQ"]}
    return xr.Dataset(data, coordinates | {"half": ["lower", "upper"], "zone": ["floor", "evaluated"]})


def separation_warnings(composed) -> list[str]:
    """Return a sentence for each rule of this module that a Dataset of `composition` breaks."""
    lines = []
    lower, upper = composed["coarse_share"].values
    difference = _in_errors(upper - lower, composed["coarse_share_std_error"].values)
    if abs(difference) > LARGE_DIFFERENCE:
        lines.append(
            f"Sizes separate: coarse grains are {100 * lower:.0f} % of the lower and {100 * upper:.0f} % of the upper "
            f"half of the evaluated part{_in_words(difference)}."
        )
    floor, inside = composed["fine_share"].values
    excess = _in_errors(floor - inside, composed["fine_share_std_error"].values)
    if excess > LARGE_DIFFERENCE and floor > FLOOR_FACTOR * inside:
        lines.append(
            f"Fine grains gather on the floor: they are {100 * floor:.0f} % of the layer that is left out there, and "
            f"{100 * inside:.0f} % of the evaluated part{_in_words(excess)}."
        )
    return lines


def _size_at(size, volume, share):
    """Return the sieve size [m] at which the share of the volume that is not coarser is closest to `share`.

    It is 0 if a share of 0 is closest.
    """
    sizes, index = np.unique(size, return_inverse=True)
    passing = np.concatenate([[0.0], np.cumsum(np.bincount(index, volume))]) / volume.sum()
    return float(np.concatenate([[0.0], sizes])[np.argmin(np.abs(passing - share))])


def _share(chosen, volumes):
    """Return the share of the volume that the chosen grains have, and its standard error; nan without volume."""
    total = volumes.sum()
    if not total > 0.0:
        return np.nan, np.nan
    share = volumes[chosen].sum() / total
    return share, float(np.sqrt(np.sum(volumes**2 * (chosen - share) ** 2)) / total)


def _in_errors(difference, errors):
    """Return a difference over its standard error, which follows from the errors of its two parts.

    Shares of 0 and 1 have no error: their difference is infinitely many.
    """
    error = np.hypot(*errors)
    if error > 0.0:
        return float(difference / error)
    return float(np.sign(difference) * np.inf) if difference else 0.0


def _in_words(difference):
    """Return a clause with a difference in standard errors, or "" if it is infinite."""
    return f", a difference of {abs(difference):.1f} standard errors" if np.isfinite(difference) else ""


def _pair(name, dimension, shares, ending=""):
    values, errors = np.transpose(shares)
    text = f"share of {name} grains by volume"
    return {
        f"{name}_share{ending}": (dimension, values, {"units": "1", "long_name": text}),
        f"{name}_share{ending}_std_error": (
            dimension,
            errors,
            {"units": "1", "long_name": f"standard error of the {text}"},
        ),
    }


def _forms(packing, weights):
    longest, middle, shortest = (packing[name].values for name in "LIS")
    ratios = np.array([shortest / middle, middle / longest, shortest / longest])
    mean, std = np.empty((2, 2, 3)), np.empty((2, 2, 3))
    for i, part in enumerate(PARTS):
        for j, weight in enumerate(weights[part]):
            mean[i, j] = np.average(ratios, weights=weight, axis=1)
            std[i, j] = np.sqrt(np.average((ratios - mean[i, j][:, None]) ** 2, weights=weight, axis=1))
    dimensions = ("part", "weight", "ratio")
    return {
        "form_mean": (dimensions, mean, {"units": "1", "long_name": "mean of the ratio of axes"}),
        "form_std": (dimensions, std, {"units": "1", "long_name": "standard deviation of the ratio of axes"}),
    }


def _sieve_fractions(packing, weights):
    bounds = packing["sieve_bounds"].values
    classes = np.searchsorted(bounds[1:, 0], packing["D"].values, side="right")
    shares = np.array(
        [[np.bincount(classes, weight, len(bounds)) / weight.sum() for weight in weights[part]] for part in PARTS]
    )
    text = "share of the grains in the sieve class"
    return {
        "sieve_bounds": (("sieve_class", "bound"), bounds, packing["sieve_bounds"].attrs),
        "sieve_fraction": (("part", "weight", "sieve_class"), shares, {"units": "1", "long_name": text}),
    }

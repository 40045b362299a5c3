# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Draws the size, form and shape of every grain of a packing from random numbers that depend on the grain's id."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from simcore.grains.form import axes_from_form, equal_volume_diameter, sieve_size_of_volume
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.quota import ELONGATION, FLATNESS, NUMBERS_PER_GRAIN, SHAPE, SIZE_CLASS, SIZE_IN_CLASS, stratify

# Rettinger et al. (2022) draw flatness S/I and elongation I/L from normals, again until they are in this interval.
FORM_RANGE = (0.1, 1.0)
MAX_RATIO = 10.0  # maximum of L/I and of I/S: flatness and elongation are at least 0.1
CHOICES = ("one", "random", "form", "form_distribution", "form_by_size", "ratios")
# This stream decides which grains of kind "mixed" are ellipsoids. As it is separate, the sizes and forms are those that
# polyhedra alone would get.
_KIND_STREAM = 2
LARGEST_UNIFORM = 1.0 - 2.0**-53  # the largest number below 1
_QUANTILES = 1000  # of a distribution of flatness or elongation, for the mean volume of its grains
_QUOTA_STREAM = 4  # of the numbers that shuffle the strata of a draw by quota; 3 is that of random places


class FormsBelow(NamedTuple):
    """Distributions of form of the grains with sieve sizes below `below` [m]; inf for all coarser grains."""

    below: float
    flatness: float  # mean before redrawing
    flatness_std: float
    elongation: float
    elongation_std: float


@dataclass(frozen=True)
class ShapeChoice:
    """The rule by which the grains of a packing get their shapes. ValueError if its fields do not fit together.

    kind: "polyhedron", "ellipsoid", "sphere" or "mixed". With "mixed", each grain is an ellipsoid with probability
    `ellipsoid_share`, and otherwise a polyhedron of the same axes.
    choice: spheres ignore it.
    - "one": all grains have the shape of the grain named `grain`.
    - "random": each grain of the set is equally likely.
    - "form": all grains have the given `flatness` and `elongation`; only for ellipsoids.
    - "form_distribution": flatness and elongation are independent normals with means `flatness` and `elongation` and
      the two standard deviations, redrawn until they are in FORM_RANGE.
    - "form_by_size": the same, with the means and standard deviations of the first element of `by_size` whose `below`
      exceeds the grain's sieve size.
    - "ratios": eta = L/I and zeta = I/S are independent normals with means `eta` and `zeta` and the two standard
      deviations, redrawn until they are in [1, MAX_RATIO]; with a deviation of 0 they are constant; only for
      ellipsoids.
    """

    kind: str = "polyhedron"
    choice: str = "random"
    grain: str | None = None
    flatness: float | None = None
    elongation: float | None = None
    flatness_std: float | None = None
    elongation_std: float | None = None
    ellipsoid_share: float | None = None
    eta: float | None = None
    zeta: float | None = None
    eta_std: float = 0.0
    zeta_std: float = 0.0
    by_size: tuple[FormsBelow, ...] = ()

    def __post_init__(self):
        if self.kind not in ("polyhedron", "ellipsoid", "sphere", "mixed"):
            raise ValueError(f"shapes: kind {self.kind!r} is unknown; use polyhedron, ellipsoid, sphere or mixed")
        if self.choice not in CHOICES:
            raise ValueError(f"shapes: choice {self.choice!r} is unknown; use one of {', '.join(CHOICES)}")
        share = self.ellipsoid_share
        if self.kind == "mixed" and (share is None or not 0.0 <= share <= 1.0):
            raise ValueError(f"shapes: kind mixed needs `ellipsoid_share` from 0 to 1; it is {share}")
        if self.kind != "mixed" and share is not None:
            raise ValueError(
                f"shapes: ellipsoid_share {share} has no effect with kind {self.kind}; leave it out, or use kind mixed"
            )
        if self.kind == "sphere":
            return
        if self.choice == "one" and not self.grain:
            raise ValueError("shapes: choice `one` needs `grain`, the name of the grain")
        if self.choice == "form" and self.kind != "ellipsoid":
            raise ValueError(
                "shapes: choice `form` works only with kind ellipsoid; use that kind, or choice form_distribution"
            )
        if self.choice == "ratios":
            if self.kind != "ellipsoid":
                raise ValueError("shapes: choice `ratios` works only with kind ellipsoid; use that kind")
            for key in ("eta", "zeta"):
                value, std = getattr(self, key), getattr(self, f"{key}_std")
                if value is None or not 1.0 <= value <= MAX_RATIO:
                    raise ValueError(f"shapes: {key} is {value}; give a value from 1 to {MAX_RATIO:g}")
                if not std >= 0:
                    raise ValueError(f"shapes: {key}_std is {std}; it must not be negative")
        if self.choice in ("form", "form_distribution"):
            _check_forms("shapes", self, self.choice == "form_distribution")
        if self.choice == "form_by_size":
            _check_sizes([forms.below for forms in self.by_size])
            for number, forms in enumerate(self.by_size):
                _check_forms(f"shapes.by_size[{number}]", forms, True)


def _check_forms(where, forms, distributed):
    """Raise ValueError if the flatness or the elongation of `forms` is not in FORM_RANGE, or a deviation is wrong."""
    low, high = FORM_RANGE
    for key in ("flatness", "elongation"):
        value, std = getattr(forms, key), getattr(forms, f"{key}_std")
        if value is None or not low <= value <= high:
            raise ValueError(f"{where}: {key} is {value}; give a value from {low} to {high}")
        if distributed and (std is None or not std >= 0):
            raise ValueError(f"{where}: {key}_std is {std}; give a value that is not negative")


def _check_sizes(below):
    """Raise ValueError if the limits of `by_size` do not increase, or if the last one is not inf."""
    if not below or np.isfinite(below[-1]):
        raise ValueError("shapes.by_size: the last element is for all coarser grains; leave out its `below`")
    if not all(a < b for a, b in zip(below, below[1:], strict=False)):
        raise ValueError("shapes.by_size: every element but the last needs `below`; order them from fine to coarse")


@dataclass(frozen=True, eq=False)
class GrainSample:
    """The n grains of a packing, in the order of the ids given; all arrays have the shape (n,), scale (n, 3).

    shape: index of the base shape. For a polyhedron it is the grain's index in the set; for ellipsoids and spheres it
    is 0, or, with kind "mixed", the number of grains in the set.
    scale: factors along x, y and z of the base shape; dimensionless for polyhedra, for ellipsoids and spheres the
    semi-axes [m].
    L, I, S: axes [m]; D: sieve size [m]; volume [m³].
    """

    shape: np.ndarray
    scale: np.ndarray
    L: np.ndarray
    I: np.ndarray
    S: np.ndarray
    D: np.ndarray
    volume: np.ndarray


def grain_uniforms(grain_ids, seed, stream=0):
    """Return eight uniform random numbers in (0, 1) for each grain id, (n, 8).

    The numbers depend only on seed, stream and id: the counter-based Philox generator starts at a position given by
    the id, so a grain gets the same numbers in any subset and order of ids. Use another stream for each other purpose.
    """
    grain_ids = np.asarray(grain_ids, np.int64)
    if grain_ids.size == 0:
        return np.empty((0, NUMBERS_PER_GRAIN))
    lowest_id, highest_id = int(grain_ids.min()), int(grain_ids.max())
    generator = np.random.Philox(key=[seed, stream])
    generator.advance(lowest_id * NUMBERS_PER_GRAIN // 4)  # one step of the counter makes four numbers
    words = generator.random_raw((highest_id - lowest_id + 1) * NUMBERS_PER_GRAIN).reshape(-1, NUMBERS_PER_GRAIN)
    # The largest word would be rounded to 1.
    return np.minimum(((words[grain_ids - lowest_id] >> np.uint64(11)) + 0.5) * 2.0**-53, LARGEST_UNIFORM)


def quota_uniforms(curve, number, seed):
    """Return stratified random numbers (number, 8) of all grains of a packing; see simcore.grains.quota.stratify."""
    ids = np.arange(number)
    return stratify(curve, grain_uniforms(ids, seed), grain_uniforms(ids, seed, stream=_QUOTA_STREAM))


def sample_sizes(curve, grain_ids, seed):
    """Draw the sizes (n,) [m] of the grains with these ids, by number, from a size distribution.

    For a SieveCurve they are sieve sizes: a class is drawn by its number_fractions, and the size within it is uniform
    in log2. For BetaSizes they are the diameters of spheres of the grains' volumes, for OwnSizes the sieve sizes of the
    grains whose shapes are drawn.
    """
    return _sizes(curve, grain_uniforms(grain_ids, seed))


def _sizes(curve, uniforms):
    return curve.sizes(uniforms[:, [SHAPE] if isinstance(curve, OwnSizes) else [SIZE_CLASS, SIZE_IN_CLASS]])


def sample_grains(grain_ids, seed, curve, shapes, grains, quota=None):
    """Draw size, form and shape of the grains with these ids and return them as a GrainSample.

    curve: SieveCurve, BetaSizes, or OwnSizes of the grains; shapes: ShapeChoice; grains: list of Grain, which may be
    empty if `shapes` does not use the set. The result for a grain depends only on its id and the seed (see
    grain_uniforms). quota: as returned by quota_uniforms, to draw sizes and forms by quota. ValueError if the set is
    empty but needed, or does not contain the grain that `shapes` names.
    """
    uniforms = grain_uniforms(grain_ids, seed) if quota is None else quota[grain_ids]
    D = diameter = _sizes(curve, uniforms)
    flatness, elongation, index = _forms(shapes, grains, uniforms, D)
    if curve.of_volume:
        D = sieve_size_of_volume(D, flatness, elongation)
    L, I, S = axes_from_form(D, flatness, elongation)
    axes = np.stack([S, I, L], axis=1)
    if shapes.kind in ("ellipsoid", "sphere"):
        return GrainSample(np.zeros(len(D), int), axes / 2, L, I, S, D, np.pi / 6 * L * I * S)
    base_axes = np.array([(g.S, g.I, g.L) for g in grains])[index]
    scale = axes / base_axes
    if shapes.choice not in (
        "form_distribution",
        "form_by_size",
    ):  # the form is unchanged: one factor avoids round-off between the axes
        scale = np.repeat((D / np.array([g.sieve_size for g in grains])[index])[:, None], 3, axis=1)
    volume = np.array([g.volume for g in grains])[index] * scale.prod(axis=1)
    if shapes.kind == "mixed":
        is_ellipsoid = grain_uniforms(grain_ids, seed, stream=_KIND_STREAM)[:, 0] < shapes.ellipsoid_share
        index = np.where(is_ellipsoid, len(grains), index)
        scale = np.where(is_ellipsoid[:, None], axes / 2, scale)
        volume = np.where(is_ellipsoid, np.pi / 6 * L * I * S, volume)
    if curve.of_volume:
        # A polyhedron has less volume than its ellipsoid; with this factor it has that of the curve.
        larger = diameter / equal_volume_diameter(volume)
        D, L, I, S, volume = larger * D, larger * L, larger * I, larger * S, larger**3 * volume  # noqa: E741
        scale = larger[:, None] * scale
    return GrainSample(index, scale, L, I, S, D, volume)


def _forms(shapes, grains, uniforms, D):
    """Return flatness, elongation and index in the grain set for each grain, three arrays (n,). D: sizes (n,) [m]."""
    n = len(uniforms)
    index = np.zeros(n, int)
    if shapes.kind == "sphere":
        return np.ones(n), np.ones(n), index
    has_polyhedra = shapes.kind in ("polyhedron", "mixed")
    if (has_polyhedra or shapes.choice in ("one", "random")) and not grains:
        raise ValueError(
            f"shapes: kind {shapes.kind} with choice {shapes.choice} needs a grain set, but it is empty; give one in "
            "`grains`"
        )
    if shapes.choice == "one":
        names = [grain.name for grain in grains]
        if shapes.grain not in names:
            raise ValueError(
                f"shapes: there is no grain {shapes.grain!r} in the set; its grains are {', '.join(names)}"
            )
        index[:] = names.index(shapes.grain)
    elif has_polyhedra or shapes.choice == "random":
        index = (uniforms[:, SHAPE] * len(grains)).astype(int)
    if shapes.choice == "form":
        return np.full(n, shapes.flatness), np.full(n, shapes.elongation), index
    if shapes.choice == "ratios":
        eta = _truncated_normal(uniforms[:, ELONGATION], shapes.eta, shapes.eta_std, (1.0, MAX_RATIO))
        zeta = _truncated_normal(uniforms[:, FLATNESS], shapes.zeta, shapes.zeta_std, (1.0, MAX_RATIO))
        return 1.0 / zeta, 1.0 / eta, index
    if shapes.choice == "form_distribution":
        return (
            _truncated_normal(uniforms[:, FLATNESS], shapes.flatness, shapes.flatness_std),
            _truncated_normal(uniforms[:, ELONGATION], shapes.elongation, shapes.elongation_std),
            index,
        )
    if shapes.choice == "form_by_size":
        row = np.searchsorted([forms.below for forms in shapes.by_size], D, side="right")
        means = np.array(shapes.by_size)[row, 1:]
        return (
            _truncated_normals(uniforms[:, FLATNESS], means[:, 0], means[:, 1]),
            _truncated_normals(uniforms[:, ELONGATION], means[:, 2], means[:, 3]),
            index,
        )
    flatness = np.array([grain.flatness for grain in grains])
    elongation = np.array([grain.elongation for grain in grains])
    return flatness[index], elongation[index], index


def with_volume_factors(curve, shapes):
    """Return the SieveCurve with the volume_factors of its classes if forms depend on size, otherwise unchanged.

    shapes: ShapeChoice. With by_size the mean volume of grains of one sieve size changes from range to range. Within a
    range, flatness and elongation are independent, so that the mean of V / D³ is a product of two means.
    """
    if shapes.choice != "form_by_size" or shapes.kind == "sphere":
        return curve
    quantiles = (np.arange(_QUANTILES) + 0.5) / _QUANTILES
    low, high = curve.bounds[:-1], curve.bounds[1:]
    factors, below = np.zeros(len(low)), 0.0
    for forms in shapes.by_size:
        flatness = _truncated_normal(quantiles, forms.flatness, forms.flatness_std)
        elongation = _truncated_normal(quantiles, forms.elongation, forms.elongation_std)
        # Volume of a grain of sieve size 1 over that of a sphere; S/L = FL EL and I/L = EL
        unit = np.mean(_relative_volume(flatness, 1.0)) * np.mean(_relative_volume(1.0, elongation))
        # Share of the range in the mean D³ of a class, whose sizes are uniform in log D
        range_low, range_high = np.clip(below, low, high), np.clip(forms.below, low, high)
        factors += unit * (range_high**3 - range_low**3) / (high**3 - low**3)
        below = forms.below
    return replace(curve, volume_factors=factors)


def _relative_volume(flatness, elongation):
    """Return the volume of a grain over that of a sphere of the same sieve size; the two ratios enter as factors."""
    L, I, S = axes_from_form(1.0, flatness, elongation)
    return L * I * S


def _truncated_normals(uniforms, mean, std):
    """Draw from `_truncated_normal`, with a mean and a standard deviation for each number, (n,) each."""
    drawn = np.empty(len(uniforms))
    for pair in set(zip(mean, std, strict=True)):
        rows = (mean == pair[0]) & (std == pair[1])
        drawn[rows] = _truncated_normal(uniforms[rows], *pair)
    return drawn


def _truncated_normal(uniforms, mean, std, bounds=FORM_RANGE):
    """Draw normals truncated to `bounds` (n,), from one uniform number per grain.

    Inversion of the distribution gives the same law as redrawing until the value is within the bounds.
    """
    if std == 0:
        return np.full(len(uniforms), float(mean))
    low, high = ndtr((np.array(bounds) - mean) / std)
    return np.clip(mean + std * ndtri(low + uniforms * (high - low)), *bounds)

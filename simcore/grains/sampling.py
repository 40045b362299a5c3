# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Size, form and shape of every grain of a packing, from random numbers that belong to the grain's id."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from simcore.grains.form import axes_from_form, sieve_size_of_volume
from simcore.grains.own_sizes import OwnSizes
from simcore.grains.quota import ELONGATION, FLATNESS, NUMBERS_PER_GRAIN, SHAPE, SIZE_CLASS, SIZE_IN_CLASS, stratify

# The study redraws normal FL and EL until they lie in this interval.
FORM_RANGE = (0.1, 1.0)
MAX_RATIO = 10.0  # of L/I and I/S, as flatness and elongation are at least 0.1
# Stream of the numbers that say which grains of a mixture of kinds are ellipsoids: sizes and forms are those of meshes.
_KIND_STREAM = 2
_QUOTA_STREAM = 3  # of the numbers that shuffle the strata of a draw by quota


@dataclass(frozen=True)
class ShapeChoice:
    """Which shapes the grains of a packing get.

    kind: "polyhedron", "ellipsoid", "sphere", or "mixed": as "polyhedron", but each grain is, with the
    probability `ellipsoid_share`, the ellipsoid of the same axes instead.
    choice: "one" (the grain named `grain`), "random" (each grain of the set equally likely), "form" (given
    flatness and elongation, ellipsoids only), or "form_distribution" (flatness and elongation independent
    normals, here means, with the two standard deviations, redrawn into FORM_RANGE), or "ratios" (eta = L/I and
    zeta = I/S of ellipsoids, independent normals with their standard deviations, redrawn until at least 1 and at most
    MAX_RATIO; given ones where a deviation is 0). Spheres ignore it.
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

    def __post_init__(self):
        if self.kind not in ("polyhedron", "ellipsoid", "sphere", "mixed"):
            raise ValueError(f"shapes: kind {self.kind!r} is unknown: use polyhedron, ellipsoid, sphere or mixed")
        if self.choice not in ("one", "random", "form", "form_distribution", "ratios"):
            raise ValueError(
                f"shapes: choice {self.choice!r} is unknown: use one, random, form, form_distribution or ratios"
            )
        share = self.ellipsoid_share
        if self.kind == "mixed" and (share is None or not 0.0 <= share <= 1.0):
            raise ValueError(f"shapes: kind mixed needs `ellipsoid_share` from 0 to 1, not {share}")
        if self.kind != "mixed" and share is not None:
            raise ValueError(f"shapes: ellipsoid_share {share} is for kind mixed, not {self.kind}: leave it out")
        if self.kind == "sphere":
            return
        if self.choice == "one" and not self.grain:
            raise ValueError("shapes: choice `one` needs `grain`, the name of the grain")
        if self.choice == "form" and self.kind != "ellipsoid":
            raise ValueError("shapes: choice `form` is for ellipsoids: use kind ellipsoid or form_distribution")
        if self.choice == "ratios":
            if self.kind != "ellipsoid":
                raise ValueError("shapes: choice `ratios` is for ellipsoids: use kind ellipsoid")
            for key in ("eta", "zeta"):
                value, std = getattr(self, key), getattr(self, f"{key}_std")
                if value is None or not 1.0 <= value <= MAX_RATIO:
                    raise ValueError(f"shapes: {key} {value} must be given and lie in [1, {MAX_RATIO:g}]")
                if not std >= 0:
                    raise ValueError(f"shapes: {key}_std {std} must not be negative")
        if self.choice in ("form", "form_distribution"):
            low, high = FORM_RANGE
            for key in ("flatness", "elongation"):
                value, std = getattr(self, key), getattr(self, f"{key}_std")
                if value is None or not low <= value <= high:
                    raise ValueError(f"shapes: {key} {value} must be given and lie in [{low}, {high}]")
                if self.choice == "form_distribution" and (std is None or not std >= 0):
                    raise ValueError(f"shapes: {key}_std {std} must be given and not negative")


@dataclass(frozen=True, eq=False)
class GrainSample:
    """Grains of a packing, in the order of their ids; all arrays of length n, scale (n, 3).

    shape: index of the base shape (the grain in the set; 0 for ellipsoids and spheres, which in a mixture with meshes
    stand after the last grain); scale: factors along the base's x, y, z (dimensionless for meshes, semi-axes [m] of
    unit spheres); L, I, S, D [m]; volume [m³].
    """

    shape: np.ndarray
    scale: np.ndarray
    L: np.ndarray
    I: np.ndarray
    S: np.ndarray
    D: np.ndarray
    volume: np.ndarray


def grain_uniforms(grain_ids, seed, stream=0):
    """Eight uniform random numbers in (0, 1) for each grain id, (n, 8).

    They depend on (seed, stream, id) alone: the counter-based Philox generator is started at the grain's
    place, so any subset of ids, in any order, gets the same numbers. Give other purposes another stream.
    """
    grain_ids = np.asarray(grain_ids, np.int64)
    if grain_ids.size == 0:
        return np.empty((0, NUMBERS_PER_GRAIN))
    first, last = int(grain_ids.min()), int(grain_ids.max())
    generator = np.random.Philox(key=[seed, stream])
    generator.advance(first * NUMBERS_PER_GRAIN // 4)  # one step of the counter makes four numbers
    words = generator.random_raw((last - first + 1) * NUMBERS_PER_GRAIN).reshape(-1, NUMBERS_PER_GRAIN)
    return ((words[grain_ids - first] >> np.uint64(11)) + 0.5) * 2.0**-53


def quota_uniforms(curve, number, seed):
    """Stratified random numbers (number, 8) of all grains of a packing, as of simcore.grains.quota.stratify."""
    ids = np.arange(number)
    return stratify(curve, grain_uniforms(ids, seed), grain_uniforms(ids, seed, stream=_QUOTA_STREAM))


def sample_sizes(curve, grain_ids, seed):
    """Sizes (n,) [m] by number, of a SieveCurve sieve sizes: class by its number_fractions, in it uniform in log2.

    Of BetaSizes diameters of spheres of the grains' volume, of OwnSizes those of the grains whose shape is drawn.
    """
    return _sizes(curve, grain_uniforms(grain_ids, seed))


def _sizes(curve, uniforms):
    return curve.sizes(uniforms[:, [SHAPE] if isinstance(curve, OwnSizes) else [SIZE_CLASS, SIZE_IN_CLASS]])


def sample_grains(grain_ids, seed, curve, shapes, grains, quota=None):
    """Draw the grains with these ids: a GrainSample.

    curve: SieveCurve, BetaSizes, or OwnSizes of the grains; shapes: ShapeChoice; grains: list of Grain, may be empty
    where the form is given.
    Random numbers belong to the id (see grain_uniforms). quota: as of quota_uniforms, to draw sizes and forms by quota.
    ValueError if the chosen grain is not in the set.
    """
    uniforms = grain_uniforms(grain_ids, seed) if quota is None else quota[grain_ids]
    D = _sizes(curve, uniforms)
    flatness, elongation, index = _forms(shapes, grains, uniforms)
    if curve.of_volume:
        D = sieve_size_of_volume(D, flatness, elongation)
    L, I, S = axes_from_form(D, flatness, elongation)
    axes = np.stack([S, I, L], axis=1)
    if shapes.kind in ("ellipsoid", "sphere"):
        return GrainSample(np.zeros(len(D), int), axes / 2, L, I, S, D, np.pi / 6 * L * I * S)
    base_axes = np.array([(g.S, g.I, g.L) for g in grains])[index]
    scale = axes / base_axes
    if shapes.choice != "form_distribution":  # the same form: one factor, free of round-off between the axes
        scale = np.repeat((D / np.array([g.sieve_size for g in grains])[index])[:, None], 3, axis=1)
    volume = np.array([g.volume for g in grains])[index] * scale.prod(axis=1)
    if shapes.kind == "mixed":
        smooth = grain_uniforms(grain_ids, seed, stream=_KIND_STREAM)[:, 0] < shapes.ellipsoid_share
        index = np.where(smooth, len(grains), index)
        scale = np.where(smooth[:, None], axes / 2, scale)
        volume = np.where(smooth, np.pi / 6 * L * I * S, volume)
    return GrainSample(index, scale, L, I, S, D, volume)


def _forms(shapes, grains, uniforms):
    """Flatness, elongation and index in the grain set of each grain, each (n,)."""
    n = len(uniforms)
    index = np.zeros(n, int)
    if shapes.kind == "sphere":
        return np.ones(n), np.ones(n), index
    hulls = shapes.kind in ("polyhedron", "mixed")
    if (hulls or shapes.choice in ("one", "random")) and not grains:
        raise ValueError(f"shapes: {shapes.kind} with choice {shapes.choice} needs a grain set, it is empty")
    if shapes.choice == "one":
        names = [grain.name for grain in grains]
        if shapes.grain not in names:
            raise ValueError(f"shapes: no grain {shapes.grain!r} in the set, there are {', '.join(names)}")
        index[:] = names.index(shapes.grain)
    elif hulls or shapes.choice == "random":
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
    flatness = np.array([grain.flatness for grain in grains])
    elongation = np.array([grain.elongation for grain in grains])
    return flatness[index], elongation[index], index


def _truncated_normal(uniforms, mean, std, bounds=FORM_RANGE):
    """Normals redrawn until within bounds, by inversion: the same law from one number per grain."""
    if std == 0:
        return np.full(len(uniforms), float(mean))
    low, high = ndtr((np.array(bounds) - mean) / std)
    return np.clip(mean + std * ndtri(low + uniforms * (high - low)), *bounds)

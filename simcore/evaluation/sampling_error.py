"""Sampling error of a packing's bulk porosity, from contrasts between smooth blocks of the same packing.

The bulk solid fraction is the mean of the solid field over the evaluation volume. Its scatter over seeds is estimated
from the field of one packing. A contrast is a weight over the volume with mean zero and mean square one, for example
left blocks minus right blocks. Its weighted mean has the same variance as the mean if its blocks are thicker than the
correlation length. The contrasts used are the eigenmodes of the domain: waves in the periodic box, Bessel modes in the
cylinder, cosines along z. They have two advantages over sharp blocks: a grain that is cut by the border of a block does
not count as scatter, and no correction for correlated neighbouring blocks is needed, because the modes are orthogonal.
The modes are integrated over the ellipsoids of the grains (simcore.evaluation.grain_points). Spheres of equal volume
would overstate the error of a wide sieve curve, because fine grains fill the space beside a flat or long grain.

By the symmetry of the domain, modes that vary horizontally have the expected value zero for any profile along height
and radius, so that floor, wall and compaction with depth have no influence. In the periodic box, whose floor and
surface are cut away, modes that vary only with height are used as well, except the first, because a linear change of
porosity with depth would contribute to it most; the third has a ninth of that amplitude.

Two effects on the shortest waves oppose each other: within a grain a wave partly averages out, by a fifth of its
variance at three grains, and in a dense bed the spectrum rises towards the wavelength of a grain. Neither is corrected.

Blocks with more coarse grains are denser. The part of the contrasts that the sizes explain, by linear regression on the
logarithm of the sieve size, is therefore replaced by what sizes do to the whole evaluated part. The evaluated part
exchanges grains with the rest of the bed as blocks do with each other; this counts with the share of the bed that is
not evaluated. If sizes are drawn at random, those of the whole bed vary too, independently from grain to grain. By
quota they do not.
"""

import json

import numpy as np
from scipy.special import jnp_zeros, jv

from simcore.evaluation.grain_points import grain_points
from simcore.evaluation.slicing import slab_volumes
from simcore.grains.form import equal_volume_diameter
from simcore.scene.domain import Domain

# ASSUME: half a wavelength, the size of a block, is at least 1.5 volume-weighted mean grain diameters. At this distance
# the pair correlation of dense packings is a few per cent, and their spectrum is flat for longer waves.
BLOCK_DIAMETERS = 1.5
# The longest waves are the most similar to the mean; with 32 of them the error is accurate to 1/sqrt(2 * 32) = 12 %.
ENOUGH_CONTRASTS = 32
FEWEST_TO_DIVIDE = 6  # contrasts from which the effect of sizes is separated; with fewer the slope is mostly chance
ONE_SIZE = 1e-9  # largest difference of log2 of the sieve sizes of grains of one size


def sampling_error(packing, z_lower, z_upper, method="spheres"):
    """Estimate the standard error of the mean solid fraction (and porosity) between two heights, from one packing.

    packing: Dataset of read_packing; z_lower, z_upper [m]; method: as in slab_volumes. Returns a dict: n_std_error;
    n_contrasts, the number of independent contrasts (the relative error of n_std_error is 1/sqrt(2 n_contrasts));
    block_size [m], half the shortest wavelength used; correlation_length [m], the cube root of the integral range,
    which is the volume per independent sample that the error implies; it can be compared with block_size.
    """
    shape, width = packing.attrs["domain_shape"], packing.attrs["domain_width"]
    height = z_upper - z_lower
    area = Domain(shape, width, height).area
    inside = slab_volumes(packing, [z_lower, z_upper], method, per_grain=True)[:, 0]
    volume = packing["volume"].values
    block = BLOCK_DIAMETERS * np.average(equal_volume_diameter(volume), weights=inside)
    modes = _choose_modes(_all_modes(shape, width, height, np.pi / block), np.pi / block)

    points = grain_points(packing, z_lower, z_upper, modes[-1][0])
    log_size = np.log2(packing["D"].values)
    if np.ptp(log_size) < ONE_SIZE:
        log_size = np.zeros(len(log_size))
    volume_times_size = points.volume * (log_size - np.average(log_size, weights=inside))[points.grain]
    x, y, z = points.position.T
    phase = np.pi * (z - z_lower) / height
    contrasts, of_size = [], []
    for _, horizontal, vertical in modes:
        along_z = np.sqrt(2.0) * np.cos(vertical * phase) if vertical else 1.0
        for values in _mode_values(shape, width, horizontal, x, y):
            contrasts.append((values * along_z) @ points.volume)
            of_size.append((values * along_z) @ volume_times_size)
    evaluated = inside.sum() / volume.sum()
    left, of_one_contrast, slope_squared = _divided(np.array(contrasts), np.array(of_size))
    square = left + (1.0 - evaluated) * slope_squared * of_one_contrast
    if not _draws_by_quota(packing):
        of_bed = volume * (log_size - np.average(log_size, weights=volume))
        square += slope_squared * evaluated**2 * (of_bed @ of_bed)
    variance = square / (area * height) ** 2
    solid_fraction = inside.sum() / (area * height)
    integral_range = variance * area * height / (solid_fraction * (1.0 - solid_fraction))
    return {
        "n_std_error": float(np.sqrt(variance)),
        "n_contrasts": len(contrasts),
        "block_size": float(np.pi / modes[-1][0]),
        "correlation_length": float(np.cbrt(integral_range)),
    }


def _draws_by_quota(packing):
    """Return whether the sizes of a packing were drawn by quota."""
    scene = json.loads(packing.attrs.get("scene") or "{}")
    return scene.get("sizes", {}).get("draw") == "quota"


def _divided(contrasts, of_size):
    """Divide the mean square of contrasts (m,) by regression on the contrasts of size (m,).

    Returns (part that sizes do not explain, mean square of the contrasts of size, square of the slope without the part
    that is chance). With few contrasts, or grains of one size, the first part is the whole and the slope is 0.
    """
    scale, number = of_size @ of_size, len(contrasts)
    if number < FEWEST_TO_DIVIDE or not scale > 0.0:
        return contrasts @ contrasts / number, 0.0, 0.0
    slope = of_size @ contrasts / scale
    left = np.sum((contrasts - slope * of_size) ** 2) / (number - 1)
    return left, scale / number, max(slope**2 - left / scale, 0.0)


def _all_modes(shape, width, height, k_max):
    """Return a list of (wave number [1/m], horizontal mode, vertical order) up to k_max, by increasing wave number.

    The longest horizontal modes are always included. The horizontal mode (0, 0) is the constant one.
    """
    m = int(k_max * width / (2.0 * np.pi)) + 1
    if shape == "periodic":
        horizontal_modes = [(0, j) for j in range(m + 1)] + [(i, j) for i in range(1, m + 1) for j in range(-m, m + 1)]
    else:  # m-th order, n-th root; the first root of order m is larger than m
        horizontal_modes = [(i, n) for i in range(1, int(0.5 * k_max * width) + 2) for n in range(1, m + 1)]
    modes = []
    for horizontal in horizontal_modes:
        k = _wave_number(shape, width, horizontal)
        lowest_order = 2 if horizontal == (0, 0) else 0
        for vertical in range(lowest_order, max(lowest_order, int(k_max * height / np.pi)) + 1):
            modes.append((float(np.hypot(k, np.pi * vertical / height)), horizontal, vertical))
    return sorted(modes)


def _choose_modes(modes, k_max):
    """Select the longest waves, up to wave number k_max, until there are ENOUGH_CONTRASTS.

    Shells of equal wavelength are complete. The shell of the longest horizontal waves is always included, so that there
    is an error for narrow domains as well.
    """
    longest = min(k for k, horizontal, _ in modes if horizontal != (0, 0))
    chosen, count = [], 0
    for k, horizontal, vertical in modes:
        shell_complete = count >= ENOUGH_CONTRASTS and k > chosen[-1][0] * (1.0 + 1e-9)
        in_first_shell = horizontal != (0, 0) and k <= longest * (1.0 + 1e-9)
        if in_first_shell or (k <= k_max and not shell_complete):
            chosen.append((k, horizontal, vertical))
            count += 1 if horizontal == (0, 0) else 2
    return chosen


def _wave_number(shape, width, mode):
    """Return the horizontal wave number of a mode [1/m]."""
    if shape == "periodic":
        return 2.0 * np.pi / width * np.hypot(*mode)
    return jnp_zeros(mode[0], mode[1])[-1] / (0.5 * width)


def _mode_values(shape, width, mode, x, y):
    """Return the even and the odd form of a mode at n points, (2, n); (1, n) for the constant mode.

    Their mean square over the area of the domain is one.
    """
    if mode == (0, 0):
        return np.ones((1, len(x)))
    if shape == "periodic":
        phase = 2.0 * np.pi / width * (mode[0] * x + mode[1] * y)
        return np.sqrt(2.0) * np.array([np.cos(phase), np.sin(phase)])
    m, root = mode[0], jnp_zeros(mode[0], mode[1])[-1]
    norm = np.sqrt(0.5 * (1.0 - (m / root) ** 2)) * abs(jv(m, root))
    radial = jv(m, root * np.hypot(x, y) / (0.5 * width)) / norm
    angle = m * np.arctan2(y, x)
    return radial * np.array([np.cos(angle), np.sin(angle)])

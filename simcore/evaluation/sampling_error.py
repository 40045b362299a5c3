"""Sampling error of a packing's bulk porosity, from contrasts between smooth blocks of the same packing.

The bulk solid fraction is the mean of the solid field over the evaluation volume. How much it would change from one
seed to the next is asked of the field itself: any weight over the volume with mean zero and mean square one (a
contrast, say left blocks against right ones) has the same variance as the mean as long as its blocks are thicker than
the correlation length. The contrasts used are the eigenmodes of the domain: waves in the periodic box, Bessel modes in
the cylinder, cosines along z. Against sharp blocks they have two advantages: a grain cut by a block's border does not
count as scatter, and neighbouring blocks need no correction for being correlated, since the modes are orthogonal.

Modes that vary horizontally have the expected value zero by the symmetry of the domain, whatever the profiles along
height and radius are, so that floor, wall and compaction with depth do not enter. In the periodic box, whose floor and
surface are cut away, modes of height alone are taken too, from the second on: the first would take a linear change of
porosity with depth for scatter.
"""

import numpy as np
from scipy.special import jnp_zeros, jv, spherical_jn

from simcore.evaluation.slicing import slab_volumes

# ASSUME: half a wavelength, the size of a block, is at least 1.5 volume-weighted mean grain diameters; the pair
# correlation of dense packings is damped out to a few per cent there, and their spectrum is flat beyond.
BLOCK_DIAMETERS = 1.5
# The longest waves are the closest to the mean; 32 of them give the error itself to 1/sqrt(2 * 32) = 12 %.
ENOUGH_CONTRASTS = 32


def sampling_error(packing, z_lower, z_upper, method="spheres"):
    """Standard error of the mean solid fraction (and of porosity) between two heights, from one packing.

    Returns a dict: n_std_error; n_contrasts, the number of independent contrasts (the error's own relative error is
    1/sqrt(2 n_contrasts)); block_size [m], half the shortest wavelength used; correlation_length [m], the cube root of
    the integral range that the error implies: the volume per independent sample, to be compared with block_size.
    """
    shape, width = packing.attrs["domain_shape"], packing.attrs["domain_width"]
    height = z_upper - z_lower
    area = width**2 if shape == "periodic" else 0.25 * np.pi * width**2
    inside = slab_volumes(packing, [z_lower, z_upper], method, per_grain=True)[:, 0]
    diameter = np.cbrt(6.0 * packing["volume"].values / np.pi)
    block = BLOCK_DIAMETERS * np.average(diameter, weights=inside)
    modes = _choose_modes(_all_modes(shape, width, height, np.pi / block), np.pi / block)

    n_layers = max(1, int(np.ceil(4.0 * height / block)))
    edges = np.linspace(z_lower, z_upper, n_layers + 1)
    volumes = slab_volumes(packing, edges, method, per_grain=True)
    phase = (0.5 * (edges[1:] + edges[:-1]) - z_lower) / height
    x, y = packing["position"].values[:, :2].T
    squares, wave_numbers = [], []
    for wave_number, horizontal, vertical in modes:
        k = _wave_number(shape, width, horizontal)
        ball = _ball_average(0.5 * k * diameter)
        along_z = volumes @ (np.sqrt(2.0) * np.cos(np.pi * vertical * phase)) if vertical else inside
        for values in _mode_values(shape, width, horizontal, x, y):
            squares.append(np.sum(values * ball * along_z) ** 2)
            wave_numbers.append(wave_number)
    variance = np.mean(squares) / (area * height) ** 2
    solid_fraction = inside.sum() / (area * height)
    integral_range = variance * area * height / (solid_fraction * (1.0 - solid_fraction))
    return {
        "n_std_error": float(np.sqrt(variance)),
        "n_contrasts": len(squares),
        "block_size": float(np.pi / max(wave_numbers)),
        "correlation_length": float(np.cbrt(integral_range)),
    }


def _all_modes(shape, width, height, k_max):
    """List of (wave number [1/m], horizontal mode, vertical order) up to k_max, and always the longest horizontal ones.

    The horizontal mode (0, 0) is the constant one.
    """
    m = int(k_max * width / (2.0 * np.pi)) + 1
    if shape == "periodic":
        horizontal_modes = [(0, j) for j in range(m + 1)] + [(i, j) for i in range(1, m + 1) for j in range(-m, m + 1)]
    else:  # m-th order, n-th root; the first root of order m lies above m
        horizontal_modes = [(i, n) for i in range(1, int(0.5 * k_max * width) + 2) for n in range(1, m + 1)]
    modes = []
    for horizontal in horizontal_modes:
        k = _wave_number(shape, width, horizontal)
        first = 2 if horizontal == (0, 0) else 0
        for vertical in range(first, max(first, int(k_max * height / np.pi)) + 1):
            modes.append((float(np.hypot(k, np.pi * vertical / height)), horizontal, vertical))
    return sorted(modes)


def _choose_modes(modes, k_max):
    """The longest waves: up to wave number k_max, no more than give ENOUGH_CONTRASTS, but whole shells of equal length.

    The shell of the longest horizontal waves is always among them, so that a narrow domain has an error too.
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


def _ball_average(kr):
    """Mean of an eigenmode of wave number k over a ball of radius r, divided by its value at the centre."""
    kr = np.maximum(kr, 1e-9)  # the constant mode: 1
    return 3.0 * spherical_jn(1, kr) / kr


def _wave_number(shape, width, mode):
    """Horizontal wave number of a mode [1/m]."""
    if shape == "periodic":
        return 2.0 * np.pi / width * np.hypot(*mode)
    return jnp_zeros(mode[0], mode[1])[-1] / (0.5 * width)


def _mode_values(shape, width, mode, x, y):
    """The even and the odd form of a mode at the grains' centres, (2, n), mean square one over the domain's area."""
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

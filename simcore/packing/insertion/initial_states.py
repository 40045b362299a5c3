"""Lattice sites, orientations and velocities of inserted grains."""

from typing import NamedTuple

import numpy as np

from simcore.compilation import kernel
from simcore.scene.domain import Domain
from simcore.scene.scene import Generation


class InitialStates(NamedTuple):
    """State of n inserted grains; SI units."""

    position: np.ndarray  # (n, 3)
    orientation: np.ndarray  # (n, 4)
    velocity: np.ndarray  # (n, 3)
    angular_velocity: np.ndarray  # (n, 3)


def occupy_sites(sites, reach, half_height, domain: Domain) -> np.ndarray:
    """Return the indices of the sites that grains take one after the other, (n,), n <= len(reach).

    reach (k,) [m]: largest horizontal distance of a grain's surface from its centre; half_height (k,) [m]: vertical.
    # ASSUME: a site where a grain could touch an earlier one stays empty, and the grain takes the next free site. (On
    # the lattice of Rettinger et al. (2022) large grains may overlap at insertion.)
    """
    if len(sites) == 0 or len(reach) == 0:
        return np.zeros(0, np.int64)
    width = domain.width if domain.periodic else 0.0
    limit = np.inf if domain.periodic else 0.5 * domain.width
    return _occupy(sites, np.asarray(reach), np.asarray(half_height), width, limit)


@kernel
def _occupy(sites, reach, half_height, width, limit):
    taken = np.empty(len(sites), np.int64)
    n = 0
    tallest = half_height.max()
    for site in range(len(sites)):
        if n == len(reach):
            break
        x, y, z = sites[site, 0], sites[site, 1], sites[site, 2]
        if width > 0.0:
            free = 2.0 * reach[n] < width  # otherwise it would touch its own periodic image
        else:
            free = np.sqrt(x * x + y * y) + reach[n] < limit
        k = n - 1
        while free and k >= 0:
            other = taken[k]
            if z - sites[other, 2] > tallest + half_height[n]:
                break
            dx, dy = x - sites[other, 0], y - sites[other, 1]
            if width > 0.0:
                dx -= width * np.round(dx / width)
                dy -= width * np.round(dy / width)
            apart = reach[n] + reach[k]
            if dx * dx + dy * dy < apart * apart and z - sites[other, 2] < half_height[n] + half_height[k]:
                free = False
            k -= 1
        if free:
            taken[n] = site
            n += 1
    return taken[:n].copy()


def initial_states(generation: Generation, position, sieve_size, uniforms) -> InitialStates:
    """Return the InitialStates of grains at `position` (n, 3) [m], with their orientations and velocities.

    sieve_size (n,) [m]. uniforms (n, 8): random numbers of the grains in (0, 1), five for the velocities and three
    for a random orientation (Shoemake 1992).
    """
    signed = 2.0 * uniforms - 1.0
    velocity = np.column_stack([generation.velocity_horizontal * signed[:, :2], np.full(len(position), 0.0)])
    velocity[:, 2] = generation.velocity_z
    angular = generation.velocity_angular * signed[:, 2:5] / np.asarray(sieve_size)[:, None]
    if generation.orientation == "random":
        u, v, w = uniforms[:, 5:8].T
        a, b = np.sqrt(1.0 - u), np.sqrt(u)
        v, w = 2.0 * np.pi * v, 2.0 * np.pi * w
        orientation = np.column_stack([b * np.cos(w), a * np.sin(v), a * np.cos(v), b * np.sin(w)])
    else:
        orientation = np.tile([1.0, 0.0, 0.0, 0.0], (len(position), 1))
    return InitialStates(position, orientation, velocity, angular)

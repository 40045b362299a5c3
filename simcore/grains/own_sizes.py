"""Sizes of grains that keep their own, as they were measured, beside the sieve curve."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class OwnSizes:
    """Sieve sizes (n,) [m] of the grains of a set, each equally likely, and drawn together with the grain's shape."""

    class_diameters: np.ndarray

    of_volume = False  # sizes are sieve sizes

    @property
    def least(self) -> float:
        """Size of the smallest grain [m]."""
        return float(self.class_diameters.min())

    @property
    def largest(self) -> float:
        """Size of the largest grain [m]."""
        return float(self.class_diameters.max())

    def number_fractions(self) -> np.ndarray:
        """Share of the packed grains, by number, of each of class_diameters."""
        return np.full(len(self.class_diameters), 1.0 / len(self.class_diameters))

    def class_means(self, power: float) -> np.ndarray:
        """D^power (n,) [m^power] of class_diameters."""
        return self.class_diameters**power

    def mean(self, power: float) -> float:
        """Mean of D^power over all grains, by number [m^power]."""
        return float(self.number_fractions() @ self.class_means(power))

    def sizes(self, uniforms) -> np.ndarray:
        """Sizes (n,) [m] from the random number that also chooses the shape, the first of each grain's (n, k)."""
        return self.class_diameters[(uniforms[:, 0] * len(self.class_diameters)).astype(int)]

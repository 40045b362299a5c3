"""Size distribution of grains that keep their measured sizes."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class OwnSizes:
    """Sieve sizes of the grains of a set, each equally likely, and drawn together with the grain's shape.

    class_diameters: the sieve sizes (n,) [m].
    """

    class_diameters: np.ndarray

    of_volume = False  # the sizes are sieve sizes, not diameters of spheres of equal volume

    @property
    def least(self) -> float:
        """Size of the smallest grain [m]."""
        return float(self.class_diameters.min())

    @property
    def largest(self) -> float:
        """Size of the largest grain [m]."""
        return float(self.class_diameters.max())

    def number_fractions(self) -> np.ndarray:
        """Return the expected share of the packed grains, by number, of each of class_diameters (n,)."""
        return np.full(len(self.class_diameters), 1.0 / len(self.class_diameters))

    def class_means(self, power: float) -> np.ndarray:
        """Return D^power (n,) [m^power] of class_diameters."""
        return self.class_diameters**power

    def mean(self, power: float) -> float:
        """Return the mean of D^power over all grains, by number [m^power]."""
        return float(self.number_fractions() @ self.class_means(power))

    def sizes(self, uniforms) -> np.ndarray:
        """Draw sizes (n,) [m] from the first of each grain's numbers (n, k), the one that also chooses the shape."""
        return self.class_diameters[(uniforms[:, 0] * len(self.class_diameters)).astype(int)]

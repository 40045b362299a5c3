"""Sizes whose volume is beta-distributed, of Baram & Lind's deposits, beside the sieve curve.

The share of the solid volume at the radius r is V(r) = C (r - r_min)^alpha (r_max - r)^beta on [r_min, r_max], a beta
distribution with the exponents alpha + 1 and beta + 1 (after Voivret et al. 2007); by number n(r) ~ V(r) / r³. Its
spread is S = (r_max - r_min) / (r_max + r_min): 0 of equal grains, towards 1 without bound. r is the radius of the
sphere of the grain's volume, r³ = a b c of an ellipsoid's semi-axes.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import roots_jacobi, roots_legendre

NODES = 64  # of quadratures; 1/r³ is smooth, at S = 0.95 it changes by 6e4: moments then are right to 1e-12
PANELS = 2048  # of the table that sizes are drawn from


@dataclass(frozen=True, eq=False)
class BetaSizes:
    """Sizes with mid-range radius (r_min + r_max) / 2 [m], spread S in [0, 1) and exponents >= 0; ValueError else."""

    radius: float
    spread: float
    alpha: float
    beta: float

    of_volume = True  # sizes are diameters of spheres of the grains' volume

    def __post_init__(self):
        if not (self.radius > 0.0 and 0.0 <= self.spread < 1.0 and self.alpha >= 0.0 and self.beta >= 0.0):
            raise ValueError(
                f"sizes: radius {self.radius} m, spread {self.spread}, exponents {self.alpha} and {self.beta}: the "
                f"radius must be positive, the spread from 0 to below 1, exponents not negative"
            )

    @property
    def least(self) -> float:
        """Smallest diameter there can be [m]."""
        return 2.0 * self.radius * (1.0 - self.spread)

    @property
    def largest(self) -> float:
        """Largest diameter there can be [m]."""
        return 2.0 * self.radius * (1.0 + self.spread)

    @cached_property
    def _quadrature(self):
        """Places in [0, 1] from r_min to r_max, and shares of the volume."""
        x, weights = roots_jacobi(NODES, self.beta, self.alpha)
        return 0.5 * (1.0 + x), weights / weights.sum()

    @property
    def class_diameters(self) -> np.ndarray:
        """Diameters (k,) [m] that stand for all, with number_fractions."""
        return self.least + (self.largest - self.least) * self._quadrature[0]

    def number_fractions(self) -> np.ndarray:
        """Share of the grains, by number, of each of class_diameters: means over them are exact to rounding."""
        numbers = self._quadrature[1] / self.class_diameters**3
        return numbers / numbers.sum()

    def class_means(self, power: float) -> np.ndarray:
        """D^power (k,) [m^power] of class_diameters."""
        return self.class_diameters**power

    def mean(self, power: float) -> float:
        """Mean of D^power over all grains, by number [m^power]."""
        return float(self.number_fractions() @ self.class_means(power))

    def moment(self, power: float) -> float:
        """Mean of r^power over the grains, by number [m^power]."""
        return float(self.number_fractions() @ (0.5 * self.class_diameters) ** power)

    @cached_property
    def _table(self):
        """Places in [0, 1] and the share of grains below, at the ends of panels that are narrow at both ends."""
        edges = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, PANELS + 1)))
        x, weights = roots_legendre(8)
        half = 0.5 * np.diff(edges)
        place = edges[:-1, None] + half[:, None] * (1.0 + x)
        size = 1.0 - self.spread + 2.0 * self.spread * place
        density = place**self.alpha * (1.0 - place) ** self.beta / size**3
        below = np.concatenate([[0.0], np.cumsum(half * (density @ weights))])
        return edges, below / below[-1]

    def sizes(self, uniforms) -> np.ndarray:
        """Diameters (n,) [m] by number, from the first of each grain's random numbers (n, k).

        Between the ends of a panel the inverse is taken as straight: a panel holds at most 0.002 of the range, and
        its chance is exact, so that moments are off by less than 2e-6 of themselves.
        """
        edges, below = self._table
        return self.least + (self.largest - self.least) * np.interp(np.asarray(uniforms)[:, 0], below, edges)

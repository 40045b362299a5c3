"""Size distribution whose volume is beta-distributed, as in the deposits of Baram & Lind.

The density of the solid volume over the radius r is V(r) = C (r - r_min)^alpha (r_max - r)^beta on [r_min, r_max], a
beta distribution with the exponents alpha + 1 and beta + 1 (after Voivret et al. 2007). The number density is
n(r) ~ V(r) / r³. The spread is S = (r_max - r_min) / (r_max + r_min). It is 0 for equal grains; as it approaches 1,
r_max / r_min grows without bound. r is the radius of the sphere of the grain's volume; for an ellipsoid with the
semi-axes a, b, c it is r³ = a b c.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

NODES = 64  # of the quadrature: at S = 0.95, where 1/r³ varies by a factor of 6e4, moments are correct to 1e-12
PANELS = 2048  # of the table from which sizes are drawn


@dataclass(frozen=True, eq=False)
class BetaSizes:
    """Beta distribution of sizes; ValueError if a parameter is out of its range.

    radius: mid-range radius (r_min + r_max) / 2 [m], positive; spread: S in [0, 1); alpha, beta: exponents >= 0.
    """

    radius: float
    spread: float
    alpha: float
    beta: float

    of_volume = True  # the sizes are diameters of spheres of the grains' volumes, not sieve sizes

    def __post_init__(self):
        if not (self.radius > 0.0 and 0.0 <= self.spread < 1.0 and self.alpha >= 0.0 and self.beta >= 0.0):
            raise ValueError(
                f"sizes.beta: radius {self.radius} m, spread {self.spread}, exponents {self.alpha} and {self.beta} are "
                "out of bounds; the radius must be positive, the spread from 0 to below 1, the exponents not negative"
            )

    @property
    def least(self) -> float:
        """Smallest possible diameter 2 r_min [m]."""
        return 2.0 * self.radius * (1.0 - self.spread)

    @property
    def largest(self) -> float:
        """Largest possible diameter 2 r_max [m]."""
        return 2.0 * self.radius * (1.0 + self.spread)

    @cached_property
    def _quadrature(self):
        """Nodes in [0, 1] between r_min and r_max, (NODES,), and their shares of the volume, (NODES,)."""
        from scipy.special import roots_jacobi  # imported here because it loads slowly

        x, weights = roots_jacobi(NODES, self.beta, self.alpha)
        return 0.5 * (1.0 + x), weights / weights.sum()

    @property
    def class_diameters(self) -> np.ndarray:
        """Diameters (k,) [m] at the nodes of the quadrature; with number_fractions they represent the distribution."""
        return self.least + (self.largest - self.least) * self._quadrature[0]

    def number_fractions(self) -> np.ndarray:
        """Return the share of the grains, by number, of each of class_diameters (k,); means over them are exact."""
        numbers = self._quadrature[1] / self.class_diameters**3
        return numbers / numbers.sum()

    def class_means(self, power: float) -> np.ndarray:
        """Return D^power (k,) [m^power] of class_diameters."""
        return self.class_diameters**power

    def mean(self, power: float) -> float:
        """Return the mean of D^power over all grains, by number [m^power]."""
        return float(self.number_fractions() @ self.class_means(power))

    def moment(self, power: float) -> float:
        """Return the mean of r^power over all grains, by number [m^power]."""
        return float(self.number_fractions() @ (0.5 * self.class_diameters) ** power)

    @cached_property
    def _table(self):
        """Ends of the panels in [0, 1] between r_min and r_max, and the share of grains below each, (PANELS + 1,) each.

        The panels are narrow at both ends of the range.
        """
        from scipy.special import roots_legendre  # imported here because it loads slowly

        edges = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, PANELS + 1)))
        x, weights = roots_legendre(8)
        half = 0.5 * np.diff(edges)
        place = edges[:-1, None] + half[:, None] * (1.0 + x)
        size = 1.0 - self.spread + 2.0 * self.spread * place
        density = place**self.alpha * (1.0 - place) ** self.beta / size**3
        below = np.concatenate([[0.0], np.cumsum(half * (density @ weights))])
        return edges, below / below[-1]

    def sizes(self, uniforms) -> np.ndarray:
        """Draw diameters (n,) [m] by number, from the first of each grain's uniform random numbers (n, k).

        Within a panel the inverse of the distribution is interpolated linearly. A panel spans at most 0.002 of the
        range and its probability is exact, so the relative error of moments is less than 5e-6.
        """
        edges, below = self._table
        return self.least + (self.largest - self.least) * np.interp(np.asarray(uniforms)[:, 0], below, edges)

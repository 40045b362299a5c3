"""Sieve curves: mass fractions per size class, the numbers of grains they stand for, and Table 3's cases."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True, eq=False)
class SieveCurve:
    """Mass fractions (k,) between class bounds (k + 1,) [m]; ValueError if they are not a sieve curve.

    name: of the case, for messages.
    """

    of_volume = False  # sizes are sieve sizes

    bounds: np.ndarray
    mass_fractions: np.ndarray
    name: str = "sieve curve"

    def __post_init__(self):
        for field in ("bounds", "mass_fractions"):
            object.__setattr__(self, field, np.array(getattr(self, field), float))
        bounds, fractions = self.bounds, self.mass_fractions
        if bounds.ndim != 1 or fractions.ndim != 1 or len(bounds) != len(fractions) + 1 or len(fractions) == 0:
            self._refuse(f"{bounds.size} bounds, {fractions.size} mass fractions: give one bound more than fractions")
        if not (np.all(np.isfinite(bounds)) and bounds[0] > 0 and np.all(np.diff(bounds) > 0)):
            self._refuse(f"bounds {bounds} m are not positive and increasing: order them from fine to coarse")
        if not (np.all(np.isfinite(fractions)) and np.all(fractions >= 0)):
            self._refuse(f"mass fractions {fractions} are not all >= 0")
        if abs(fractions.sum() - 1) > 1e-6:
            self._refuse(f"mass fractions sum to {fractions.sum():.6g}, not to 1: divide them by their sum")

    def _refuse(self, reason):
        raise ValueError(f"sieve curve {self.name!r}: {reason}")

    @property
    def class_diameters(self):
        """Geometric mean size of each class (k,) [m]."""
        return np.sqrt(self.bounds[:-1] * self.bounds[1:])

    @property
    def least(self):
        """Lower bound of the smallest class that holds mass [m]."""
        return float(self.bounds[:-1][self.mass_fractions > 0][0])

    @property
    def largest(self):
        """Upper bound of the largest class that holds mass [m]."""
        return float(self.bounds[1:][self.mass_fractions > 0][-1])

    def number_fractions(self):
        """Share of the grains, by number, in each class (k,): M_i / d_i³, normalised."""
        numbers = self.mass_fractions / self.class_diameters**3
        return numbers / numbers.sum()

    def sizes(self, uniforms):
        """Sizes (n,) [m] by number from two random numbers each, (n, 2): the class, and within it uniform in log2."""
        edges = np.cumsum(self.number_fractions())
        index = np.searchsorted(edges / edges[-1], uniforms[:, 0], side="left")
        logs = np.log2(self.bounds)
        return 2.0 ** (logs[index] + uniforms[:, 1] * np.diff(logs)[index])

    def expected_numbers(self, mass, density):
        """Expected number of grains in each class (k,) of a packing of mass [kg], solid density [kg/m³]."""
        return self.mass_fractions * mass / (density * np.pi / 6 * self.class_diameters**3)

    def check_top_class(self, mass, density, minimum=5):
        """ValueError if fewer than `minimum` grains are expected in the largest class that holds mass."""
        expected = self.expected_numbers(mass, density)[self.mass_fractions > 0][-1]
        if expected < minimum:
            self._refuse(
                f"{mass:g} kg hold {expected:.2g} grains of its top class (up to {self.largest * 1e3:g} mm), "
                f"fewer than {minimum}: give at least {mass * minimum / expected:.3g} kg, or allow it with "
                "`allow_few_top_grains: true`"
            )


@dataclass(frozen=True)
class Case:
    """One row of the table of cases: its sieve curve and the study's generation spacing [m]."""

    curve: SieveCurve
    generation_spacing: float


def read_cases(path):
    """The cases of a table like config/cases.tsv, dict of name to Case.

    Columns: case, one `a-b mm` per size class (mass fractions), `generation_spacing [mm]`; any others are
    ignored. ValueError names the file and what is wrong in it.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"table of cases {path} does not exist: correct the path")
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader((line for line in file if not line.startswith("#")), delimiter="\t"))
    columns = list(rows[0]) if rows else []
    classes = {c: [float(b) * 1e-3 for b in m.groups()] for c in columns if (m := _CLASS.fullmatch(c or ""))}
    limits = list(classes.values())
    if not classes or not {"case", "generation_spacing [mm]"} <= set(columns):
        raise ValueError(f"{path}: needs the tab-separated columns case, generation_spacing [mm], and `2.8-4 mm` ...")
    if any(a[1] != b[0] for a, b in zip(limits, limits[1:], strict=False)):
        raise ValueError(f"{path}: each size class must begin where the one before it ends, got {list(classes)}")
    bounds = [limits[0][0]] + [upper for _, upper in limits]
    try:
        return {
            row["case"]: Case(
                SieveCurve(bounds, [float(row[c]) for c in classes], row["case"]),
                float(row["generation_spacing [mm]"]) * 1e-3,
            )
            for row in rows
        }
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


_CLASS = re.compile(r"([0-9.]+)-([0-9.]+) mm")

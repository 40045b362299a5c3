"""Sieve curves: mass fractions per size class, the resulting numbers of grains, and the cases of Table 3.

Within a class of bounds a < b, sizes are drawn uniformly in log D. The mean of D^p over the class then has the closed
form (b^p - a^p) / (p ln(b / a)). With p = 3 it gives the mean volume of a class. Numbers of grains computed with it
reproduce the given mass fractions, whatever the widths of the classes, if the grains of all classes have the same
distribution of form; otherwise volume_factors of the classes correct them. Rettinger et al. (2022) divide by the cube
of the geometric mean instead, which is smaller than the mean of D³ by the factor (r³ - 1) / (3 r^1.5 ln r) for a class
of ratio r = b / a. The factor cancels if all classes have the same ratio. The classes of Table 3 of Rettinger et al.
have ratios of 1.40 to 1.43, so the expected share of the mass in a class differs from the given one by at most

    case        U1      U3      U5      U7      B30     B50     B70
    difference  0       0.0013  0.0010  0.0007  0.0006  0.0005  0.0007
"""

import csv
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np


@dataclass(frozen=True, eq=False)
class SieveCurve:
    """Mass fractions (k,) between class bounds (k + 1,) [m]; ValueError if they do not form a sieve curve.

    name: the curve's name in messages. numbers_by: the volume by which the mass of a class is divided to get its
    number of grains: "mean_volume" of the sizes drawn in it, or the cube of the "geometric_mean" of its bounds, which
    Rettinger et al. (2022) use for their cases. volume_factors (k,): mean volume of the grains of each class relative
    to that of spheres of their sieve sizes; None: it is equal in all classes.
    """

    of_volume = False  # the sizes are sieve sizes, not diameters of spheres of equal volume

    bounds: np.ndarray
    mass_fractions: np.ndarray
    name: str = "sieve curve"
    numbers_by: str = "mean_volume"
    volume_factors: np.ndarray | None = None

    def __post_init__(self):
        for field in ("bounds", "mass_fractions"):
            object.__setattr__(self, field, np.array(getattr(self, field), float))
        if self.numbers_by not in ("mean_volume", "geometric_mean"):
            self._refuse(f"numbers_by {self.numbers_by!r} is unknown; use mean_volume or geometric_mean")
        bounds, fractions = self.bounds, self.mass_fractions
        if bounds.ndim != 1 or fractions.ndim != 1 or len(bounds) != len(fractions) + 1 or len(fractions) == 0:
            self._refuse(
                f"{bounds.size} bounds do not fit {fractions.size} mass fractions; give one bound more than fractions"
            )
        if not (np.all(np.isfinite(bounds)) and bounds[0] > 0 and np.all(np.diff(bounds) > 0)):
            self._refuse(f"bounds {bounds} m are not positive and increasing; order them from fine to coarse")
        if not (np.all(np.isfinite(fractions)) and np.all(fractions >= 0)):
            self._refuse(f"mass fractions {fractions} are not all >= 0; correct those that are not")
        if abs(fractions.sum() - 1) > 1e-6:
            self._refuse(_why_not_one(fractions))

    def _refuse(self, reason):
        raise ValueError(f"{self.name}: {reason}")

    @property
    def least(self):
        """Lower bound of the finest class whose mass fraction is positive [m]."""
        return float(self.bounds[:-1][self.mass_fractions > 0][0])

    @property
    def largest(self):
        """Upper bound of the coarsest class whose mass fraction is positive [m]."""
        return float(self.bounds[1:][self.mass_fractions > 0][-1])

    def without_empty_ends(self):
        """Return the SieveCurve of these bounds and mass fractions from the finest to the coarsest class with mass."""
        filled = np.flatnonzero(self.mass_fractions > 0.0)
        kept = slice(filled[0], filled[-1] + 1)
        factors = None if self.volume_factors is None else self.volume_factors[kept]
        bounds = self.bounds[kept.start : kept.stop + 1]
        return replace(self, bounds=bounds, mass_fractions=self.mass_fractions[kept], volume_factors=factors)

    def class_means(self, power):
        """Return the mean of D^power over the sizes drawn in each class (k,) [m^power]; power must not be 0."""
        # The closed form is written as sinh(h) / h times a power of the geometric mean, so that narrow classes lose no
        # digits.
        half = 0.5 * power * np.log(self.bounds[1:] / self.bounds[:-1])
        return np.sqrt(self.bounds[:-1] * self.bounds[1:]) ** power * np.sinh(half) / half

    def mean(self, power):
        """Return the mean of D^power over all grains, by number [m^power]; power must not be 0."""
        return float(self.number_fractions() @ self.class_means(power))

    def number_fractions(self):
        """Return the share of the grains, by number, in each class (k,): M_i / v_i, normalised.

        M_i is the mass fraction of the class and v_i the volume that `numbers_by` selects, times the volume factor.
        """
        if self.numbers_by == "mean_volume":
            volumes = self.class_means(3)
        else:
            volumes = np.sqrt(self.bounds[:-1] * self.bounds[1:]) ** 3
        numbers = self.mass_fractions / self._with_forms(volumes)
        return numbers / numbers.sum()

    def _with_forms(self, volumes):
        return volumes if self.volume_factors is None else volumes * self.volume_factors

    def expected_fractions(self):
        """Return the expected share of the drawn mass in each class (k,).

        With numbers_by "mean_volume" these are the mass fractions.
        """
        masses = self.number_fractions() * self._with_forms(self.class_means(3))
        return masses / masses.sum()

    def class_of(self, D):
        """Return the index of the class (n,) of each sieve size D (n,) [m].

        A size on a bound belongs to the coarser class, a size outside the curve to its first or last class.
        """
        return np.clip(np.searchsorted(self.bounds, D, side="right") - 1, 0, len(self.mass_fractions) - 1)

    def sizes(self, uniforms):
        """Draw sizes (n,) [m] by number from two uniform random numbers each, (n, 2).

        The first number selects the class, the second one the size within it, uniform in log2.
        """
        edges = np.cumsum(self.number_fractions())
        index = np.searchsorted(edges / edges[-1], uniforms[:, 0], side="left")
        logs = np.log2(self.bounds)
        return 2.0 ** (logs[index] + uniforms[:, 1] * np.diff(logs)[index])

    def expected_numbers(self, mass, density):
        """Return the expected number of spheres in each class (k,); mass of the packing [kg], solid density [kg/m³]."""
        return self.number_fractions() * mass / (density * np.pi / 6 * self.mean(3))

    def check_top_class(self, mass, density, minimum=5, grains=None):
        """Raise ValueError if fewer than `minimum` grains are expected in the coarsest class that has mass.

        grains: the number of grains with this mass, if the number was specified and not the mass.
        """
        expected = self.expected_numbers(mass, density)[self.mass_fractions > 0][-1]
        if expected < minimum:
            few, factor = f"{expected:.2g}", minimum / expected
            if grains is None:
                contained, needed = f"{mass:g} kg contain {few} grains", f"{mass * factor:.3g} kg"
            else:
                contained, needed = f"of {grains} grains, {few} are", f"{int(np.ceil(grains * factor))} grains"
            self._refuse(
                f"{contained} of the coarsest class (up to {self.largest * 1e3:g} mm), but at least {minimum} grains "
                f"are needed; give at least {needed}, or allow fewer grains with `allow_few_top_grains: true`"
            )


def class_fractions(curve, D, volume):
    """Return the share of the volume of grains in each class (k,) of a SieveCurve.

    D: sieve sizes (n,) [m]; volume: volumes of the grains (n,). If all grains have the same density, these are also the
    shares of the mass. ValueError if there is no grain.
    """
    D, volume = np.asarray(D, float), np.asarray(volume, float)
    if D.size == 0:
        raise ValueError("class_fractions: there is no grain; give at least one")
    shares = np.bincount(curve.class_of(D), weights=volume, minlength=len(curve.mass_fractions))
    return shares / shares.sum()


def _why_not_one(fractions):
    """Describe why mass fractions (k,) do not sum to 1 and how to correct them."""
    total = fractions.sum()
    if len(fractions) > 1 and np.all(np.diff(fractions) >= 0) and abs(fractions[-1] - 1) <= 1e-6:
        retained = ", ".join(f"{share:.4g}" for share in np.diff(fractions, prepend=0.0))
        return (
            f"mass_fractions {_format_numbers(fractions)} sum to {total:.6g}, not to 1; they look cumulative: give the "
            f"share retained in each class, [{retained}]"
        )
    if len(fractions) > 1 and np.all(np.diff(fractions) <= 0) and abs(fractions[0] - 1) <= 1e-6:
        retained = ", ".join(f"{share:.4g}" for share in -np.diff(fractions, append=0.0))
        return (
            f"mass_fractions {_format_numbers(fractions)} sum to {total:.6g}, not to 1; they look cumulative from the "
            f"coarse end: give the share retained in each class, [{retained}]"
        )
    if abs(total - 100) <= 0.5 or (total > 100 and abs(fractions.max() - 100) <= 1e-4):
        return f"mass_fractions {_format_numbers(fractions)} sum to {total:.6g}: give fractions, not percent"
    return f"mass_fractions {_format_numbers(fractions)} sum to {total:.6g}, not to 1: divide them by their sum"


def _format_numbers(numbers):
    return f"[{', '.join(f'{number:.4g}' for number in numbers)}]"


@dataclass(frozen=True)
class Case:
    """One row of a table of cases: its sieve curve, the spacing of its generation lattice [m], and its family.

    family: curves that are left out together when models are compared; "" if the table has no such column.
    """

    curve: SieveCurve
    generation_spacing: float
    family: str = ""


def read_cases(path, numbers_by="geometric_mean"):
    """Read a table of cases like config/cases.tsv and return a dict of name to Case.

    Columns: `case`, one `a-b mm` per size class (mass fractions), `generation_spacing [mm]`, and optionally `family`;
    other columns are ignored. numbers_by: of the SieveCurves. ValueError names the file and the fault in it.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"the table of cases {path} does not exist; correct the path")
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader((line for line in file if not line.startswith("#")), delimiter="\t"))
    columns = list(rows[0]) if rows else []
    classes = {c: [float(b) * 1e-3 for b in m.groups()] for c in columns if (m := _CLASS.fullmatch(c or ""))}
    limits = list(classes.values())
    if not classes or not {"case", "generation_spacing [mm]"} <= set(columns):
        raise ValueError(
            f"{path}: the table needs the tab-separated columns `case`, `generation_spacing [mm]` and one per size "
            "class, such as `2.8-4 mm`"
        )
    if any(a[1] != b[0] for a, b in zip(limits, limits[1:], strict=False)):
        raise ValueError(
            f"{path}: each size class must begin where the previous one ends; the classes are {', '.join(classes)}"
        )
    bounds = [limits[0][0]] + [upper for _, upper in limits]
    try:
        return {
            row["case"]: Case(
                SieveCurve(bounds, [float(row[c]) for c in classes], f"sieve curve {row['case']!r}", numbers_by),
                float(row["generation_spacing [mm]"]) * 1e-3,
                row.get("family") or "",
            )
            for row in rows
        }
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


_CLASS = re.compile(r"([0-9.]+)-([0-9.]+) mm")

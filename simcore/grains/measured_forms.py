"""Measured forms of grains: a CSV of axes, or of flatness and elongation, or of their statistics, as samples.

What a row is follows from the columns:

    L, I, S                                a grain: its axes, longest first, in any one unit
    FL, EL                                 a grain: S/I and I/L
    mean_FL, std_FL, mean_EL, std_EL       a sample (mu_ and sigma_ are taken too)

A column `sample`, or another one that is named, says to which sample a grain belongs, or names the row's sample.
"""

import csv
import re
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from simcore.grains.statistics import equancy_statistics

AXES, RATIOS = ("L", "I", "S"), ("FL", "EL")
MEANS = ("mean_FL", "std_FL", "mean_EL", "std_EL")
SAMPLE = "sample"
# "L", "L_mm", "L [mm]" and "L (mm)" are one column.
_UNIT = "(?:[µμumcdk]?m|inch|in|ft|px|pixels?)"
_AXIS = re.compile(rf"([LISlis])(?:\s*\[\s*({_UNIT})\s*\]|\s*\(\s*({_UNIT})\s*\)|[\s_]+({_UNIT}))?")
_LONGEST = 100.0  # L/S; grains of FL and EL of 0.1, the study's least, have it
_NEEDED = (
    "give the columns L, I, S (axes of each grain), or FL, EL (of each grain), or mean_FL, std_FL, mean_EL, std_EL (of "
    "each sample)"
)
ALIKE = 1e-9  # relative; measured grains differ by more, copies of one row by rounding


@dataclass(frozen=True)
class Sample:
    """A sample's statistics over its grains, number-based.

    grains: how many were measured, 0 where only statistics are known. From statistics alone, those of EQ are of
    independent FL and EL (the study).
    """

    name: str
    grains: int
    mu_FL: float
    sigma_FL: float
    mu_EL: float
    sigma_EL: float
    mu_EQ: float
    sigma_EQ: float

    @property
    def one_form(self):
        """Whether all grains are alike."""
        return self.sigma_FL <= ALIKE * self.mu_FL and self.sigma_EL <= ALIKE * self.mu_EL


def read_samples(path, column=None):
    """List of Sample from a CSV file, in the order in which they appear.

    column: the column that tells the samples apart; None: "sample", where there is one. Commas, semicolons (with
    decimal commas) or tabs. ValueError with file and row, as a spreadsheet counts them, and how to mend it.
    """
    header, rows = _read(Path(path))
    kind, columns = _columns(path, header)
    by = _sample_column(path, header, column, set(columns))
    found = {}
    for number, row in rows:
        where = f"{path}, row {number}"
        values = [_number(where, name, row[position]) for name, position in columns.items()]
        default = f"row {number}" if kind == MEANS else Path(path).stem
        name = default if by is None else row[by].strip()
        if not name:
            raise ValueError(f"{where}: {header[by]} is empty; name the sample in every row")
        found.setdefault(name, []).append((where, values))
    if not found:
        raise ValueError(f"{path}: there are no rows below the header; {_NEEDED}")
    if kind == MEANS:
        return [_from_means(name, entries) for name, entries in found.items()]
    check = _check_axes if kind == AXES else _check_ratios
    return [_from_grains(name, [check(*entry) for entry in entries]) for name, entries in found.items()]


def _read(path):
    """Header and [(row number, fields)] of the rows that are not empty."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise ValueError(f"{path}: there is no such file") from None
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text in UTF-8; save it as CSV (UTF-8)") from None
    first = next((line for line in text.splitlines() if line.strip()), "")
    if not first:
        raise ValueError(f"{path}: is empty; {_NEEDED}")
    delimiter = next((mark for mark in ";\t" if mark in first), ",")
    reader = csv.reader(text.splitlines(), delimiter=delimiter)
    rows = [(reader.line_num, fields) for fields in reader if any(field.strip() for field in fields)]
    header = [name.strip() for name in rows[0][1]]
    for number, fields in rows[1:]:
        if len(fields) != len(header):
            raise ValueError(
                f"{path}, row {number}: {len(fields)} fields where the header has {len(header)}; fill or drop some, "
                "and write decimals with a point where commas part the fields"
            )
    if delimiter == ";":
        rows = [(number, [re.sub(r"^\s*([-+]?\d*),(\d+)\s*$", r"\1.\2", f) for f in fields]) for number, fields in rows]
    return header, rows[1:]


def _columns(path, header):
    """What the columns are (AXES, RATIOS or MEANS), and their positions by name."""
    axes, units = {}, {}
    for position, name in enumerate(header):
        match = _AXIS.fullmatch(name)
        if match:
            axis = match[1].upper()
            if axis in axes:
                raise ValueError(f"{path}: the columns {header[axes[axis]]} and {name} are both {axis}; drop one")
            axes[axis], units[axis] = position, match[2] or match[3] or match[4]
    plain = {re.sub("^sigma_", "std_", re.sub("^mu_", "mean_", name)): i for i, name in reversed([*enumerate(header)])}
    if set(axes) == set(AXES):
        if len(set(units.values())) > 1:
            said = ", ".join(f"{axis} in {units[axis] or 'no unit'}" for axis in AXES)
            raise ValueError(f"{path}: the header mixes units ({said}); give all three axes in one")
        return AXES, {axis: axes[axis] for axis in AXES}
    for kind in (RATIOS, MEANS):
        if set(kind) <= set(plain):
            return kind, {name: plain[name] for name in kind}
    said = ", ".join(header)
    for kind, there in ((MEANS, plain), (RATIOS, plain), (AXES, axes)):
        missing = [name for name in kind if name not in there]
        if len(missing) < len(kind):
            raise ValueError(f"{path}: the column {', '.join(missing)} is missing beside {said}; {_NEEDED}")
    raise ValueError(f"{path}: none of its columns ({said}) is a form; {_NEEDED}")


def _sample_column(path, header, column, used):
    wanted = column or SAMPLE
    if wanted in header:
        if wanted in used:
            raise ValueError(f"{path}: {wanted} is a form, not the name of a sample; name another column")
        return header.index(wanted)
    if column is None:
        return None
    raise ValueError(f"{path}: there is no column {column} to tell samples apart; there are {', '.join(header)}")


def _number(where, name, text):
    try:
        value = float(text)
    except ValueError:
        raise ValueError(
            f"{where}: {name} is '{text.strip()}'; a number is needed, its unit, if any, in the header"
        ) from None
    if not isfinite(value):
        raise ValueError(f"{where}: {name} is {text.strip()}; a finite number is needed, drop the row if it is unknown")
    return value


def _check_axes(where, values):
    """FL and EL of a grain."""
    L, I, S = values
    slack = 1 - 1e-12
    if S <= 0:
        raise ValueError(f"{where}: S = {S:g} is not positive; L >= I >= S > 0 is needed")
    if I < S * slack or L < I * slack:
        raise ValueError(
            f"{where}: L = {L:g}, I = {I:g}, S = {S:g}; L >= I >= S is needed: sort the axes, and give all in one unit"
        )
    if L > _LONGEST * S:
        raise ValueError(
            f"{where}: L = {L:g} is {L / S:.4g} times S = {S:g}, more than of any gravel; give all axes in one unit"
        )
    return min(S / I, 1.0), min(I / L, 1.0)


def _check_ratios(where, values):
    for name, value in zip(RATIOS, values, strict=True):
        if not 0 < value <= 1:
            raise ValueError(
                f"{where}: {name} = {value:g} is not in (0, 1]; FL is S/I and EL is I/L, not their inverses"
            )
    if values[0] * values[1] * _LONGEST < 1:
        raise ValueError(
            f"{where}: FL = {values[0]:g}, EL = {values[1]:g} give L/S above {_LONGEST:g}, longer than any "
            "gravel; correct or drop the row"
        )
    return values


def _from_grains(name, forms):
    FL, EL = np.array(forms, float).T
    statistics = {}
    for feature, values in (("FL", FL), ("EL", EL), ("EQ", FL * EL)):
        # As the models have it (simcore.grains.statistics): of the grains there are, and of like ones none but
        # rounding.
        mean, std = values.mean(), values.std(ddof=0)
        statistics |= {f"mu_{feature}": float(mean), f"sigma_{feature}": float(std if std > ALIKE * mean else 0.0)}
    return Sample(name=name, grains=len(FL), **statistics)


def _from_means(name, entries):
    if len(entries) > 1:
        raise ValueError(f"{entries[1][0]}: sample {name} is there twice; a row of means and deviations is one sample")
    where, (mu_FL, sigma_FL, mu_EL, sigma_EL) = entries[0]
    for feature, mu, sigma in (("FL", mu_FL, sigma_FL), ("EL", mu_EL, sigma_EL)):
        if not 0 < mu <= 1:
            raise ValueError(f"{where}: mean_{feature} = {mu:g} is not in (0, 1]; FL is S/I and EL is I/L")
        # Of all distributions on [0, 1] with this mean, that of 0 and 1 alone is the widest.
        widest = np.sqrt(mu * (1 - mu))
        if not 0 <= sigma <= widest:
            raise ValueError(
                f"{where}: std_{feature} = {sigma:g}; with a mean of {mu:g} it lies between 0 and {widest:.3g}: give "
                "the standard deviation, not the variance or a percentage"
            )
    mu_EQ, sigma_EQ = equancy_statistics(mu_FL, sigma_FL, mu_EL, sigma_EL)
    # The difference of squares is rounding where nothing varies.
    sigma_EQ = float(sigma_EQ) if sigma_FL or sigma_EL else 0.0
    return Sample(name, 0, mu_FL, sigma_FL, mu_EL, sigma_EL, float(mu_EQ), sigma_EQ)

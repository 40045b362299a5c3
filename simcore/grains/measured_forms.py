"""Read measured forms of grains from a table: axes, or flatness and elongation, or their statistics, as samples.

The columns decide what a row is:

    L, I, S                                a grain: its axes, longest first, in any one unit (a, b, c; long, ... too)
    FL, EL                                 a grain: S/I and I/L (under these names too)
    mean_FL, std_FL, mean_EL, std_EL       a sample (mu_ and sigma_ are taken too)

A column `sample`, or another one that is named, says to which sample a grain belongs, or names the row's sample. A
column of counts (count, n, number, ...) gives the number of grains that a row of a grain stands for.
"""

import logging
import re
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from simcore.grains.form_columns import AXES, MEANS, NEEDED, RATIOS, may_number_rows, recognise_columns
from simcore.grains.statistics import equancy_statistics
from simcore.grains.summary_rows import find_summary_rows
from simcore.grains.table_file import read_table

log = logging.getLogger(__name__)

_LONGEST = 100.0  # L/S; grains of FL and EL of 0.1, the least of Rettinger et al. (2022), have it
_MAX_GRAINS = 1e12  # of one row; more is no count
ALIKE = 1e-9  # relative; measured grains differ by more, copies of one row by rounding
_SHOWN = 5  # values that a notice lists one by one
_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity)", re.IGNORECASE)
# 1,234 may be a thousand and some, or one and some.
_AMBIGUOUS = re.compile(r"[1-9]\d{0,2}[.,]\d{3}")


@dataclass(frozen=True)
class Sample:
    """A sample's statistics over its grains, number-based.

    grains: how many were measured, 0 if only statistics are given; with weights that do not count grains, the number of
    rows. From statistics alone, those of EQ are of independent FL and EL, as Rettinger et al. (2022) have them.
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
    """Read a list of Sample from a table, in the order in which they appear; notices go to the log as warnings.

    Arguments and errors: as of read_measured.
    """
    samples, notices = read_measured(path, column)
    for notice in notices:
        log.warning("%s", notice)
    return samples


def read_measured(path, column=None):
    """Read (samples, notices) from a table: a list of Sample in the order of the rows, and sentences on the reading.

    path: a text file or an Excel workbook, see simcore.grains.table_file. column: the column that tells the samples
    apart; None: "sample", if there is one. Numbers may have a decimal comma.
    Rows that summarise others, such as Mean or Total, are left out, with a notice; so are columns that are not needed.
    ValueError with file and row, as a spreadsheet counts them, and how to mend it.
    """
    table = read_table(path)
    if not table.header:
        raise ValueError(f"{path}: is empty; {NEEDED}")
    columns = recognise_columns(path, table.header, column)
    cells, notices = _leave_out_summaries(path, table.cells, columns)
    if cells.empty:
        raise ValueError(f"{path}: there are no rows below the header; {NEEDED}")
    counts, count_notices = _read_counts(path, table.header, cells, columns)
    groups = {}
    for row, texts in cells.iterrows():
        where = f"{path}, row {row}"
        values = _read_forms(where, table.header, texts, columns)
        name = _name_of(where, table.header, texts, columns, row, Path(path).stem)
        groups.setdefault(name, []).append((where, values, row))
    if columns.kind == MEANS:
        samples = [_from_means(name, entries) for name, entries in groups.items()]
    else:
        check = _check_axes if columns.kind == AXES else _check_ratios
        samples = [_from_grains(path, name, entries, check, counts) for name, entries in groups.items()]
    notices = [*table.notices, *notices, *count_notices, *_describe_unused(table.header, cells, columns)]
    return samples, [f"{path}: {notice}" for notice in notices]


def _leave_out_summaries(path, cells, columns):
    """The cells without the rows that summarise others, and notices."""
    labels = find_summary_rows(cells[[i for i in cells if i not in columns.forms.values() and i != columns.counts]])
    if not labels:
        return cells, []
    said = ", ".join(f"row {row} ({label})" for row, label in labels.items())
    if len(labels) == len(cells):
        raise ValueError(f"{path}: all rows summarise others ({said}); give the grains themselves, a row each")
    verb = "summarise others and are" if len(labels) > 1 else "summarises others and is"
    return cells.drop(index=list(labels)), [f"{said} {verb} left out"]


def _read_forms(where, header, texts, columns):
    """The numbers of the kind's columns in a row, list of float."""
    width = max((i + 1 for i, text in enumerate(texts) if text), default=0)
    if max(columns.forms.values()) >= width:
        raise ValueError(
            f"{where}: {width} fields where the header has {len(header)}; fill or drop some, and write decimals with "
            "a point where commas part the fields"
        )
    return [_number(where, name, texts[position]) for name, position in columns.forms.items()]


def _name_of(where, header, texts, columns, row, stem):
    """Name of the sample that a row belongs to."""
    if columns.sample is None:
        return f"row {row}" if columns.kind == MEANS else stem
    if not texts[columns.sample]:
        raise ValueError(f"{where}: {header[columns.sample]} is empty; name the sample in every row")
    return texts[columns.sample]


@dataclass(frozen=True)
class _Counts:
    """weights: dict from row to its weight; whole: whether the weights are numbers of grains, not shares."""

    weights: dict
    whole: bool


def _read_counts(path, header, cells, columns):
    """The _Counts of the rows (None: each row is a grain), and notices."""
    if columns.counts is None:
        return None, []
    name, texts = header[columns.counts], cells[columns.counts]
    used = cells[[*columns.forms.values(), columns.counts]].to_numpy().ravel()
    marks = {mark for text in used for mark in ".," if mark in text and not _AMBIGUOUS.fullmatch(text)}
    weights = {}
    for row, text in texts.items():
        where = f"{path}, row {row}"
        if _AMBIGUOUS.fullmatch(text) and not marks == {mark for mark in ".," if mark in text}:
            raise ValueError(f"{where}: {name} is {text}; write it without a separator of thousands")
        weights[row] = _number(where, name, text)
        if not 0 <= weights[row] <= _MAX_GRAINS:
            raise ValueError(f"{where}: {name} = {weights[row]:g}; a number of grains lies between 0 and 1e12")
    values = list(weights.values())
    if len(values) > 1 and may_number_rows(name) and all(b - a == 1 for a, b in zip(values, values[1:], strict=False)):
        return None, [f"the column {name} numbers the rows, so it is not taken for a number of grains"]
    if all(value.is_integer() for value in values) and not re.search("%|percent", name):
        return _Counts(weights, True), [
            f"the column {name} is the number of grains of each row, {sum(values):.0f} in all"
        ]
    return _Counts(weights, False), [f"the column {name} weighs the rows; how many grains there are is not known"]


def _describe_unused(header, cells, columns):
    """Notices on the columns that are not read, and on one that may tell samples apart."""
    unused = {i: header[i] or f"(column {i + 1}, no name)" for i in cells if i not in columns.used}
    notices = []
    may_tell_apart = columns.sample is None and columns.kind != MEANS
    for position in list(unused) if may_tell_apart else []:
        values = [text for text in dict.fromkeys(cells[position]) if text]
        if 1 < len(values) < len(cells) and not all(_NUMBER.fullmatch(text) for text in values) and header[position]:
            notices.append(
                f"the column {unused.pop(position)} repeats ({_listed(values)}) and is not used, so all grains are one "
                f"sample; to tell samples apart by it, give --sample '{header[position]}'"
            )
    if unused:
        notices.append(f"not used: {', '.join(unused.values())}")
    return notices


def _listed(texts):
    """The first texts after each other, with how many there are besides."""
    shown = ", ".join(texts[:_SHOWN])
    return shown if len(texts) <= _SHOWN else f"{shown} and {len(texts) - _SHOWN} more"


def _number(where, name, text):
    plain = text.replace("\u2212", "-")
    if plain.rstrip().endswith("%"):
        raise ValueError(f"{where}: {name} is '{text}'; give a fraction, 0.65 not 65 %")
    if "." in plain and "," in plain or plain.count(",") > 1 or plain.count(".") > 1:
        raise ValueError(
            f"{where}: {name} is '{text}'; a number is needed, without separators of thousands, its unit, if any, in "
            "the header"
        )
    if not _NUMBER.fullmatch(plain):
        raise ValueError(f"{where}: {name} is '{text}'; a number is needed, its unit, if any, in the header")
    value = float(plain.replace(",", "."))
    if not isfinite(value):
        raise ValueError(f"{where}: {name} is {text}; a finite number is needed, drop the row if it is unknown")
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
                f"{where}: {name} = {value:g} is not in (0, 1]; FL is S/I and EL is I/L, not their inverses, nor "
                "percent"
            )
    if values[0] * values[1] * _LONGEST < 1:
        raise ValueError(
            f"{where}: FL = {values[0]:g}, EL = {values[1]:g} give L/S above {_LONGEST:g}, longer than any "
            "gravel; correct or drop the row"
        )
    return values


def _from_grains(path, name, entries, check, counts):
    """The Sample of a group of rows (where, values, row); check returns FL and EL of a row's values."""
    FL, EL = np.array([check(where, values) for where, values, _ in entries], float).T
    weights, grains = None, len(FL)
    if counts is not None:
        weights = np.array([counts.weights[row] for *_, row in entries])
        if not weights.sum() > 0:
            raise ValueError(f"{path}: the numbers of grains of sample {name} are all 0; correct or drop its rows")
        grains = int(weights.sum()) if counts.whole else int((weights > 0).sum())
    statistics = {}
    for feature, values in (("FL", FL), ("EL", EL), ("EQ", FL * EL)):
        mean, std = _mean_and_std(values, weights)
        # As the models have it (simcore.grains.statistics): the deviation over the grains themselves (ddof 0). Grains
        # that are alike differ by rounding alone.
        statistics |= {f"mu_{feature}": float(mean), f"sigma_{feature}": float(std if std > ALIKE * mean else 0.0)}
    return Sample(name=name, grains=grains, **statistics)


def _mean_and_std(values, weights):
    if weights is None:
        return values.mean(), values.std(ddof=0)
    mean = np.average(values, weights=weights)
    return mean, np.sqrt(np.average((values - mean) ** 2, weights=weights))


def _from_means(name, entries):
    if len(entries) > 1:
        raise ValueError(f"{entries[1][0]}: sample {name} is there twice; a row of means and deviations is one sample")
    where, (mu_FL, sigma_FL, mu_EL, sigma_EL), _ = entries[0]
    for feature, mu, sigma in (("FL", mu_FL, sigma_FL), ("EL", mu_EL, sigma_EL)):
        if not 0 < mu <= 1:
            raise ValueError(f"{where}: mean_{feature} = {mu:g} is not in (0, 1]; FL is S/I and EL is I/L, not percent")
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

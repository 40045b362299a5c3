"""Reads samples of measured grains from a table of axes, of flatness and elongation, or of their statistics.

The columns determine the meaning of a row:

    L, I, S                                a grain: its axes, longest first, in any one unit (also a, b, c; long, ...)
    FL, EL                                 a grain: flatness S/I and elongation I/L (also under the names S/I and I/L)
    mean_FL, std_FL, mean_EL, std_EL       a sample (also with mu_ and sigma_)
    L, I                                   a grain of which S is unknown, only in read_two_axes

Exports of G3Point and PebbleCounts are such tables: of three axes (Dmax, Dmed, Dmin) and of two (a, b).

The column `sample` (or `Probe`, `bed`, `Bett`), or another that the caller names, gives the sample of each row. A
column of counts (count, n, number, ...) gives the number of grains that a row represents, or of which means and
deviations are.
"""

import logging
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from simcore.grains.cell_numbers import NUMBER, check_decimal_marks, read_number
from simcore.grains.class_labels import CLASS_NAME, group_noun, look_like_classes
from simcore.grains.form_columns import AXES, MEANS, NEEDED, RATIOS, TWO_AXES, has_two_axes, recognise_columns
from simcore.grains.form_notices import (
    SHOWN,
    describe_mean_rows,
    describe_single_rows,
    describe_slips,
    describe_small_deviations,
)
from simcore.grains.grain_counts import read_counts, read_numbers
from simcore.grains.row_errors import read_each
from simcore.grains.statistics import equancy_statistics, few_grains_covariance, means_covariance
from simcore.grains.summary_rows import find_summary_rows
from simcore.grains.table_file import advice_on_fields, read_table
from simcore.grains.text_lists import join_first

log = logging.getLogger(__name__)

LONGEST = 100.0  # maximum L/S, that of FL = EL = 0.1, the minimum in Rettinger et al. (2022)
ALIKE = 1e-9  # relative deviation; measured grains differ by more, copies of one row only by rounding
FEWEST_FOR_ERRORS = 5  # grains, from which they determine the errors of their statistics


@dataclass(frozen=True)
class Sample:
    """Statistics of a sample over its grains, number-based.

    grains: number of grains measured; 0 if it is unknown, as with weights that are not counts. If only one row has a
    positive weight of this kind, it is 1. If the table has only statistics, those of EQ assume that FL and EL are
    independent, as in Rettinger et al. (2022). covariance: that of simcore.grains.statistics.few_grains_covariance, or
    of means_covariance there, as tuples; None if the number of grains is unknown or below FEWEST_FOR_ERRORS, or if all
    have one form.
    """

    name: str
    grains: int
    mu_FL: float
    sigma_FL: float
    mu_EL: float
    sigma_EL: float
    mu_EQ: float
    sigma_EQ: float
    covariance: tuple | None = None

    @property
    def form(self):
        """Means and standard deviations of FL and EL, which repeats of a bed have in common."""
        return self.mu_FL, self.sigma_FL, self.mu_EL, self.sigma_EL

    @property
    def one_form(self):
        """Whether all grains have the same form, up to rounding."""
        return self.sigma_FL <= ALIKE * self.mu_FL and self.sigma_EL <= ALIKE * self.mu_EL


def read_samples(path, column=None):
    """Read a list of Sample from a table, in the order in which they appear; log the notices as warnings.

    Arguments and errors are those of read_measured.
    """
    samples, notices = read_measured(path, column)
    for notice in notices:
        log.warning("%s", notice)
    return samples


def read_measured(path, column=None):
    """Read a table and return (samples, notices): a list of Sample in the order of the rows, and a list of sentences.

    path: a text file or an Excel workbook, see simcore.grains.table_file. column: name of the column with the name of
    the sample; with None it is "sample", "Probe", "bed" or "Bett", if there is such a column. Numbers may have a
    decimal comma. Rows that summarise others, such as Mean or Total, and columns that are not needed are left out, with
    a notice. ValueError names the file, the row as a spreadsheet counts it, and the remedy.
    """
    return samples_of_table(_read_table(path), column)


def samples_of_table(table, column=None, of_beds=False, of="", labels=None):
    """Return (samples, notices) as read_measured does, from a TextTable with a header.

    of_beds: each row is a bed, so that samples of a single row have no notice. of: text for notices on the classes of a
    sample, " of the sample A". labels: positions of the columns in which rows that summarise others are labelled, such
    as Mean; None: all columns without the form.
    """
    path = table.path
    rows = _read_rows(path, table, _recognise(path, table, column), labels)
    kind, counts, noun = rows.columns.kind, rows.counts, rows.noun
    if kind == MEANS:
        samples = [_from_means(name, entries, counts, noun) for name, entries in rows.groups.items()]
        rows.notices.extend(describe_small_deviations(path, samples, noun, of))
    else:
        check = _CHECKS[kind]
        samples = [_from_grains(path, name, entries, check, counts, noun) for name, entries in rows.groups.items()]
        rows.notices.extend(describe_slips(path, rows.groups, check))
        rows.notices.extend([] if of_beds or counts else describe_mean_rows(path, rows.groups, noun))
        rows.notices.extend([] if of_beds else describe_single_rows(path, rows.groups, noun, of))
    return samples, rows.notices


@dataclass(frozen=True)
class TwoAxisSample:
    """Statistics of a sample of grains of which only two axes are measured: grains as in Sample, and those of EL."""

    name: str
    grains: int
    mu_EL: float
    sigma_EL: float


def read_two_axes(path, column=None):
    """Read a table of grains of which only L and I are measured, such as in a photo taken from above.

    Returns (samples, notices), with a list of TwoAxisSample, or None if the table has other columns. path and column:
    as in read_measured, as are the errors.
    """
    table = _read_table(path)
    if not _with_notices(table, lambda: has_two_axes(path, table.header)):
        return None
    rows = _read_rows(path, table, _recognise(path, table, column, two_axes=True))
    samples = []
    for name, entries in rows.groups.items():
        EL = np.array([_check_two_axes(where, values)[-1] for where, values, _ in entries])
        weights, grains = _weigh(path, name, entries, rows.counts, rows.noun)
        mean, std = _mean_and_std(EL, weights)
        samples.append(TwoAxisSample(name, grains, float(mean), float(std if std > ALIKE * mean else 0.0)))
    rows.notices.extend(describe_slips(path, rows.groups, _check_two_axes))
    return samples, rows.notices


def _recognise(path, table, column, two_axes=False):
    return _with_notices(table, lambda: recognise_columns(path, table.header, column, two_axes))


def _with_notices(table, function):
    """Return the result of a function; its ValueError gets the notices, such as which sheet of a workbook was read."""
    try:
        return function()
    except ValueError as error:
        raise ValueError("; ".join([str(error), *table.notices])) from None


def _read_table(path):
    table = read_table(path)
    if not table.header:
        raise ValueError(f"{path}: the file is empty; {NEEDED}")
    return table


@dataclass(frozen=True)
class _Rows:
    """Rows of a table of forms: the FormColumns, (where, numbers, row) by sample, Counts or None, and notices.

    noun: what a group is, "sample" or "class".
    """

    columns: object
    groups: dict
    counts: object
    notices: list
    noun: str


def _read_rows(path, table, columns, labels=None):
    """Return the _Rows of a TextTable; labels: as in samples_of_table."""
    if labels is None:
        labels = [i for i in table.cells if i not in columns.forms.values() and i != columns.counts]
    cells, notices = _leave_out_summaries(path, table.cells, labels)
    if cells.empty:
        raise ValueError(f"{path}: there are no rows below the header; {NEEDED}")
    read = read_numbers if columns.kind == MEANS else read_counts
    counts, count_notices = read(path, table.header, cells, columns)
    check_decimal_marks(path, {position: name for name, position in columns.forms.items()}, cells)
    stem = Path(path).stem

    def read_row(row, texts):
        where = f"{path}, row {row}"
        values = _read_forms(where, table, texts, columns, row)
        _CHECKS[columns.kind](where, values)
        return _name_of(where, table.header, texts, columns, row, stem), (where, values, row)

    groups = {}
    rows = ((row, dict(zip(cells, texts, strict=True))) for row, *texts in cells.itertuples(name=None))
    for name, form in read_each(rows, read_row):
        groups.setdefault(name, []).append(form)
    notices = [*table.notices, *notices, *count_notices, *_describe_unused(table.header, cells, columns)]
    noun = group_noun(table.header, columns.sample)
    return _Rows(columns, groups, counts, [f"{path}: {notice}" for notice in notices], noun)


def _leave_out_summaries(path, cells, positions):
    """Return the cells without the rows that a label in one of these columns marks as summaries, and notices."""
    labels = find_summary_rows(cells[positions])
    if not labels:
        return cells, []
    rows = ", ".join(f"row {row} ({label})" for row, label in labels.items())
    if len(labels) == len(cells):
        raise ValueError(f"{path}: all rows summarise others ({rows}); give the grains themselves, one row each")
    verb = "summarise others and are" if len(labels) > 1 else "summarises others and is"
    return cells.drop(index=list(labels)), [f"{rows} {verb} left out"]


def _read_forms(where, table, texts, columns, row):
    """Return the numbers in the columns of the form in one row, list of float."""
    has, fields = table.short.get(row, (len(table.header), None))
    if max(columns.forms.values()) >= has:
        raise ValueError(
            f"{where}: the row has {fields} fields, but the header has {table.columns_of_file or len(table.header)}; "
            f"{advice_on_fields(table.separator)}"
        )
    for name, position in columns.forms.items():
        if not texts[position]:
            raise ValueError(f"{where}: {name} is empty; measure it, or remove the row")
    return [read_number(where, name, texts[position]) for name, position in columns.forms.items()]


def _name_of(where, header, texts, columns, row, stem):
    """Return the name of the sample of a row."""
    if columns.sample is None:
        return f"row {row}" if columns.kind == MEANS else stem
    if not texts[columns.sample]:
        name = header[columns.sample]
        remedy = "write it in every row" if CLASS_NAME.fullmatch(name) else "name the sample in every row"
        raise ValueError(f"{where}: {name} is empty; {remedy} (merged cells of a workbook count as empty)")
    return texts[columns.sample]


def _describe_unused(header, cells, columns):
    """Return notices on the columns that are not read, and on columns that may name samples."""
    unused = {i: header[i] or f"(column {i + 1}, no name)" for i in cells if i not in columns.used}
    notices = []
    for position in list(unused) if columns.sample is None else []:
        values = [text for text in dict.fromkeys(cells[position]) if text]
        if header[position] and not CLASS_NAME.fullmatch(header[position]) and look_like_classes(values):
            notices.append(
                f"the column {unused.pop(position)} is not used; its values look like sieve classes "
                f"({join_first(values, SHOWN)}); to give forms by class beside a sieve curve, rename the column to "
                "`class`"
            )
    may_name_samples = columns.sample is None and columns.kind != MEANS
    for position in list(unused) if may_name_samples else []:
        values = [text for text in dict.fromkeys(cells[position]) if text]
        if 1 < len(values) < len(cells) and not all(NUMBER.fullmatch(text) for text in values) and header[position]:
            notices.append(
                f"the column {unused.pop(position)} has repeated values ({join_first(values, SHOWN)}) and is not used, "
                f"so all grains are one sample; if its values are samples, give --sample '{header[position]}'"
            )
    if unused:
        notices.append(f"columns that are not used: {', '.join(unused.values())}")
    return notices


def _check_axes(where, values):
    """Return FL and EL of a grain with these axes; ValueError if they are not axes of a grain."""
    L, I, S = values
    slack = 1 - 1e-12
    if S <= 0:
        raise ValueError(f"{where}: S = {S:g} is not positive; L >= I >= S > 0 is needed")
    if I < S * slack or L < I * slack:
        raise ValueError(
            f"{where}: L = {L:g}, I = {I:g}, S = {S:g}; L >= I >= S is needed: sort the axes, and give all in one unit"
        )
    if L > LONGEST * S:
        raise ValueError(
            f"{where}: L = {L:g} is {L / S:.4g} times S = {S:g}, more than for any gravel; give all axes in one unit"
        )
    return min(S / I, 1.0), min(I / L, 1.0)


def _check_two_axes(where, values):
    """Return (EL,) of a grain with these two axes; ValueError if they are not axes of a grain."""
    L, I = values
    if I <= 0:
        raise ValueError(f"{where}: I = {I:g} is not positive; L >= I > 0 is needed")
    if L < I * (1 - 1e-12):
        raise ValueError(f"{where}: L = {L:g}, I = {I:g}; L >= I is needed: sort the axes, and give both in one unit")
    if L > LONGEST * I:
        raise ValueError(f"{where}: L = {L:g} is {L / I:.4g} times I = {I:g}, more than for any gravel; correct them")
    return (min(I / L, 1.0),)


def _check_ratios(where, values):
    for name, value in zip(RATIOS, values, strict=True):
        if not 0 < value <= 1:
            raise ValueError(
                f"{where}: {name} = {value:g} is not in (0, 1]; FL is S/I and EL is I/L; do not give their inverses or "
                "percent"
            )
    if values[0] * values[1] * LONGEST < 1:
        raise ValueError(
            f"{where}: FL = {values[0]:g}, EL = {values[1]:g} give L/S above {LONGEST:g}, more than for any "
            "gravel; correct or remove the row"
        )
    return values


def _check_means(where, values):
    mu_FL, sigma_FL, mu_EL, sigma_EL = values
    for feature, mu, sigma in (("FL", mu_FL, sigma_FL), ("EL", mu_EL, sigma_EL)):
        if not 0 < mu <= 1:
            raise ValueError(f"{where}: mean_{feature} = {mu:g} is not in (0, 1]; FL is S/I and EL is I/L, not percent")
        # The distribution on [0, 1] with this mean that has the values 0 and 1 only is the widest.
        widest = np.sqrt(mu * (1 - mu))
        if not 0 <= sigma <= widest:
            raise ValueError(
                f"{where}: std_{feature} = {sigma:g}; with a mean of {mu:g} it is between 0 and {widest:.3g}; give "
                "the standard deviation, not the variance or a percentage"
            )


_CHECKS = {AXES: _check_axes, TWO_AXES: _check_two_axes, RATIOS: _check_ratios, MEANS: _check_means}


def _from_grains(path, name, entries, check, counts, noun):
    """Return the Sample of a group of rows (where, values, row); check(where, values) returns FL and EL of a row."""
    FL, EL = np.array([check(where, values) for where, values, _ in entries], float).T
    weights, grains = _weigh(path, name, entries, counts, noun)
    statistics = {}
    for feature, values in (("FL", FL), ("EL", EL), ("EQ", FL * EL)):
        mean, std = _mean_and_std(values, weights)
        # As in the models (simcore.grains.statistics), the deviation is that of the grains themselves (ddof 0). Below
        # ALIKE it is rounding.
        statistics |= {f"mu_{feature}": float(mean), f"sigma_{feature}": float(std if std > ALIKE * mean else 0.0)}
    sample = Sample(name=name, grains=grains, **statistics)
    if sample.one_form or grains < FEWEST_FOR_ERRORS or not (counts is None or counts.whole):
        return sample
    covariance = few_grains_covariance(FL * EL, EL, weights)
    return replace(sample, covariance=tuple(map(tuple, covariance.tolist())))


def _weigh(path, name, entries, counts, noun):
    """Return the weights of a group of rows, or None if all count alike, and the number of its grains, 0 if unknown."""
    if counts is None:
        return None, len(entries)
    weights = np.array([counts.weights[row] for *_, row in entries])
    if not weights.sum() > 0:
        raise ValueError(f"{path}: the numbers of grains of {noun} {name} are all 0; correct or remove its rows")
    # A row with a weight is at least one grain.
    return weights, int(weights.sum()) if counts.whole else int(np.count_nonzero(weights) == 1)


def _mean_and_std(values, weights):
    if weights is None:
        return values.mean(), values.std(ddof=0)
    mean = np.average(values, weights=weights)
    return mean, np.sqrt(np.average((values - mean) ** 2, weights=weights))


def _from_means(name, entries, counts, noun):
    if len(entries) > 1:
        raise ValueError(
            f"{entries[1][0]}: {noun} {name} occurs twice, but each row of means and deviations is one {noun}; rename "
            "or remove one"
        )
    _, (mu_FL, sigma_FL, mu_EL, sigma_EL), row = entries[0]
    mu_EQ, sigma_EQ = equancy_statistics(mu_FL, sigma_FL, mu_EL, sigma_EL)
    # If nothing varies, the difference of squares is rounding.
    sigma_EQ = float(sigma_EQ) if sigma_FL or sigma_EL else 0.0
    grains = 0 if counts is None else counts.weights[row]
    if grains == 1 and (sigma_FL or sigma_EL):
        raise ValueError(
            f"{entries[0][0]}: a single grain has no standard deviation, but {noun} {name} has one; correct the "
            "number of grains or the deviations; if that column numbers the rows, rename it to `id`"
        )
    sample = Sample(name, grains, mu_FL, sigma_FL, mu_EL, sigma_EL, float(mu_EQ), sigma_EQ)
    if sample.one_form or grains < FEWEST_FOR_ERRORS:
        return sample
    covariance = means_covariance(mu_FL, sigma_FL, mu_EL, sigma_EL, grains)
    return replace(sample, covariance=tuple(map(tuple, covariance.tolist())))

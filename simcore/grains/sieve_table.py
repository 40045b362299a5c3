"""Reads a sieve curve from a table: openings in mm or phi, and masses or percent, retained or passing.

A row is a sieve. The amount retained on it lies between its opening and that of the next coarser sieve. A row `pan` has
what passes the finest sieve. The rows may run from coarse to fine or from fine to coarse. A row may also be a class
between two sieves, such as 8-11.2 mm, with its amount.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from simcore.grains.cell_numbers import check_decimal_marks, read_number
from simcore.grains.row_errors import read_each
from simcore.grains.sieve import SieveCurve
from simcore.grains.sieve_classes import NEARLY, SAME_SIEVE, retained_only, with_joined_bounds, with_lower_sieves
from simcore.grains.sieve_columns import (
    CUMULATIVE,
    FRACTION,
    MASSES,
    NEEDED,
    PASSING,
    PERCENT,
    RETAINED,
    check_one_sample,
    notices_of_counts,
    reading_rules,
    recognise_sieve_columns,
)
from simcore.grains.sieve_openings import notices_of_size, opening_rules, read_openings
from simcore.grains.sieve_sums import FEWEST_SUMS, LOSS, SMALL_STEP, notices_of_sums, notices_of_total
from simcore.grains.summary_rows import find_summary_rows, is_total
from simcore.grains.table_file import advice_on_names, read_table

SMALL_END = 0.01  # open ends with at most this share of the mass get a bound by assumption
# Deviation of a sum from 1 that rounded percentages explain, without round-off; it is removed, with a notice.
ROUNDING = 0.005 + 1e-9
AGREEMENT = 0.01  # two columns of one table agree if their shares passing differ by at most this


@dataclass(frozen=True, eq=False)
class SieveTable:
    """A measured sieve curve.

    openings: ascending (k,) [m]. passing: share of the mass that passes each (k,). mass: total [kg], or None. doubts:
    notices that another reading of the table is possible.
    """

    openings: np.ndarray
    passing: np.ndarray
    mass: float | None = None
    doubts: tuple = ()

    @property
    def below(self):
        """Share of the mass that passes the finest sieve; the size of these grains is not bounded below."""
        return float(self.passing[0])

    @property
    def above(self):
        """Share of the mass retained on the coarsest sieve; the size of these grains is not bounded above."""
        return float(1.0 - self.passing[-1])

    def closed(self, finest=None, coarsest=None):
        """Return the table with bounds [m] of the grains that pass the finest, or stay on the coarsest sieve.

        ValueError if a bound is on the wrong side of the sieves. A bound of an end that has no grains is ignored.
        """
        table = self
        if finest is not None and self.below > 0.0:
            if not 0.0 < finest < self.openings[0]:
                raise ValueError(
                    f"the size of the finest grains, {finest * 1e3:g} mm, is not below the finest sieve, "
                    f"{self.openings[0] * 1e3:g} mm; give a smaller one"
                )
            table = replace(table, openings=np.r_[finest, table.openings], passing=np.r_[0.0, table.passing])
        if coarsest is not None and self.above > 0.0:
            if not coarsest > self.openings[-1]:
                raise ValueError(
                    f"the size of the coarsest grains, {coarsest * 1e3:g} mm, is not above the coarsest sieve, "
                    f"{self.openings[-1] * 1e3:g} mm; give a larger one"
                )
            table = replace(table, openings=np.r_[table.openings, coarsest], passing=np.r_[table.passing, 1.0])
        return table

    def ends_without_effect(self, finest=None, coarsest=None):
        """Return notices on bounds, as of `closed`, of ends that have no grains."""
        notices = []
        if finest is not None and not self.below > 0.0:
            notices.append(
                f"the size of the finest grains has no effect, because nothing passes {self.openings[0] * 1e3:g} mm"
            )
        if coarsest is not None and not self.above > 0.0:
            notices.append(
                f"the size of the coarsest grains has no effect, because all grains pass {self.openings[-1] * 1e3:g} mm"
            )
        return notices

    def with_small_ends_closed(self):
        """Return (SieveTable with bounds at the ends with at most SMALL_END of the mass, notices).

        Each notice is a clause, such as "the 0.4% in the pan are coarser than 2 mm".
        # ASSUME: an open class with little mass is as wide, in phi, as its neighbour.
        """
        openings, passing, notices = self.openings, self.passing, []
        if 0.0 < self.below <= SMALL_END:
            openings, passing = np.r_[openings[0] ** 2 / openings[1], openings], np.r_[0.0, passing]
            notices.append(f"the {self.below:.1%} in the pan are coarser than {openings[0] * 1e3:.3g} mm")
        if 0.0 < self.above <= SMALL_END:
            openings, passing = np.r_[openings, openings[-1] ** 2 / openings[-2]], np.r_[passing, 1.0]
            notices.append(f"the {self.above:.1%} on the coarsest sieve are finer than {openings[-1] * 1e3:.3g} mm")
        return replace(self, openings=openings, passing=passing), notices

    def curve(self, name="sieve curve"):
        """Return the SieveCurve of the classes from the finest to the coarsest class that has mass.

        ValueError if an end is open, that is, has mass but no bound.
        """
        faults = []
        if self.below > 0.0:
            faults.append(
                f"{self.below:.1%} of the mass pass the finest sieve, {self.openings[0] * 1e3:g} mm; give the size of "
                "the finest of these grains with --finest"
            )
        if self.above > 0.0:
            faults.append(
                f"{self.above:.1%} of the mass stay on the coarsest sieve, {self.openings[-1] * 1e3:g} mm; give the "
                "size of the coarsest of these grains with --coarsest"
            )
        if faults:
            raise ValueError("; ".join([*faults, *(f"before that, check: {doubt}" for doubt in self.doubts)]))
        shares = np.diff(self.passing)
        used = np.flatnonzero(shares > 0.0)
        first, last = used[0], used[-1] + 1
        shares = shares[first:last] / shares[first:last].sum()
        return SieveCurve(self.openings[first : last + 1], shares, name)


def read_curve(path, finest=None, coarsest=None):
    """Return (SieveCurve, notices) of the table at `path`; finest, coarsest [m]: as in SieveTable.closed."""
    table, notices = read_sieve_table(path, coarsest)
    notices = [*notices, *(f"{path}: {notice}" for notice in table.ends_without_effect(finest, coarsest))]
    try:
        table, assumed = table.closed(finest, coarsest).with_small_ends_closed()
        return table.curve(Path(path).stem), [*notices, *(f"{path}: it is assumed that {text}" for text in assumed)]
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def read_sieve_table(path, coarsest=None):
    """Read the table at `path` and return (SieveTable, notices); notices: sentences on how it was read.

    path: text or a workbook, see simcore.grains.table_file. coarsest: size of the coarsest grains [m]; with it, the
    share passing the coarsest sieve may be less than 1 in a column of passing percent. ValueError names the file, the
    row and the remedy.
    """
    given = read_table(path)
    if not given.header:
        raise ValueError(f"{path}: the file is empty; {NEEDED}")
    try:
        given = with_joined_bounds(path, given)
        text, classes = with_lower_sieves(path, given)
        columns = recognise_sieve_columns(path, text, classes)
    except ValueError as error:
        raise ValueError("; ".join([str(error), *advice_on_names(given.separator), *given.notices])) from None
    columns = columns if classes is None else retained_only(path, columns)
    cells, labels, notices = _leave_out_totals(text.cells, columns, list(text.notices))
    if cells.empty:
        raise ValueError(f"{path}: there are no rows below the header; {NEEDED}")
    used = [columns.opening, *(column.position for column in columns.amounts)]
    written = given.cells.loc[given.cells.index.isin(cells.index)]  # classes as they were before with_lower_sieves
    in_grams = [column.position for column in columns.amounts if column.unit == "g"]
    check_decimal_marks(path, {position: given.header[position] for position in used}, written, in_grams)
    check_one_sample(path, text, used)
    rows, openings, pan = read_openings(path, text.header, cells, columns)
    results, doubts = [], []
    for column in columns.amounts:
        name = text.header[column.position]
        read = read_each(
            cells[column.position].items(),
            lambda row, text, name=name: _read_amount(f"{path}, row {row}", name, text, row == pan),
        )
        values = dict(zip(cells.index, read, strict=True))
        results.append((name, _passing(path, name, column, (rows, openings, pan), values, coarsest, notices)))
        if column.meaning == RETAINED:
            totals = [
                (row, label, text.cells.loc[row, column.position]) for row, label in labels.items() if is_total(label)
            ]
            notices += notices_of_total(name, np.nan_to_num(list(values.values())), totals)
        if len(columns.amounts) == 1 and _is_mass_retained(column):
            listed = [row for row in rows[::-1] if row in given.cells.index]  # without the sieve above all classes
            in_pan = None if pan is None else np.nan_to_num(values[pan])
            doubts = notices_of_sums(name, column.unit, np.array([values[row] for row in listed]), in_pan)
            notices += doubts
    if pan is None and all(_is_mass_retained(column) for column in columns.amounts):
        notices.append(
            f"there is no row `pan`: nothing is taken to pass {openings[0] * 1e3:g} mm; if finer grains were weighed, "
            "add them in a row `pan`"
        )
    name, table = results[0]
    for other, further in results[1:]:
        difference = np.abs(further.passing - table.passing).max()
        if difference > AGREEMENT:
            raise ValueError(
                f"{path}: the columns {name} and {other} give shares passing that differ by {100 * difference:.1f} % "
                "of the mass; correct or remove one"
            )
        notices.append(f"the columns {name} and {other} agree; {name} is used")
    _check_classes(path, table)
    of_size = notices_of_size(text.header[columns.opening], columns.unit, openings, table.passing)
    notices += of_size
    unused = [text.header[i] or f"(column {i + 1}, no name)" for i in cells if i not in used]
    if unused:
        notices.append(f"columns that are not used: {', '.join(unused)}")
    notices += notices_of_counts(name, unused, columns.amounts)
    table = replace(table, doubts=(*doubts, *of_size))
    return table, [f"{path}: {notice}" for notice in notices]


def table_rules():
    """Return all that a reader of such tables in another language needs, as plain values: dict of words and numbers."""
    rules, of_openings = reading_rules(), opening_rules()
    return {
        **rules,
        **of_openings,
        "patterns": {**rules["patterns"], **of_openings["patterns"]},
        "small_end": SMALL_END,
        "rounding": ROUNDING,
        "agreement": AGREEMENT,
        "fewest_sums": FEWEST_SUMS,
        "small_step": SMALL_STEP,
        "loss": LOSS,
        "same_sieve": SAME_SIEVE,
        "nearly": NEARLY,
    }


def _check_classes(path, table):
    """Raise ValueError if fewer than two classes have mass: all statistics would follow from the interpolation."""
    shares = np.diff(table.passing, prepend=0.0, append=1.0)
    if np.count_nonzero(shares > 0.0) >= 2:
        return
    sieves = [f"{D * 1e3:g} mm" for D in table.openings]
    used = int(np.argmax(shares))
    if used in (0, len(sieves)):
        raise ValueError(
            f"{path}: all of the mass {f'passes {sieves[0]}' if used == 0 else f'stays on {sieves[-1]}'}; at least two "
            "size classes with mass are needed, so add sieves there"
        )
    raise ValueError(
        f"{path}: all of the mass is between {sieves[used - 1]} and {sieves[used]}; at least two size classes with "
        "mass are needed. The porosity of a single class is that of --case one-class, and that of the name U1 in a "
        "column of sieve curves. To pack it, write "
        f"`sizes: {{bounds: [{sieves[used - 1]}, {sieves[used]}], mass_fractions: [1]}}` in a specification"
    )


def _is_mass_retained(column):
    """Return whether an AmountColumn has masses retained; a column without a unit is taken as masses."""
    return column.meaning == RETAINED and column.unit not in (PERCENT, FRACTION)


def _leave_out_totals(cells, columns, notices):
    """Return the cells without the rows that summarise others, the labels of these rows, and the notices."""
    labels = find_summary_rows(cells[[columns.opening]])
    if labels:
        rows = ", ".join(f"row {row} ({label})" for row, label in labels.items())
        verb = "are no sieves and are" if len(labels) > 1 else "is no sieve and is"
        notices.append(f"{rows} {verb} left out")
    return cells.drop(index=list(labels)), labels, notices


def _read_amount(where, name, text, of_pan):
    """Return the amount in a cell; nan if it is the empty cell of a pan."""
    if not text and of_pan:
        return np.nan
    if not text:
        raise ValueError(f"{where}: {name} is empty; give the amount of every sieve, 0 if there is nothing on it")
    value = read_number(where, name, text.rstrip("% "))
    if value < 0:
        raise ValueError(f"{where}: {name} = {value:g} is negative; correct it")
    return value


def _passing(path, name, column, sieves, values, coarsest, notices):
    """Return the SieveTable of one column of amounts. sieves: (rows, openings, row of the pan or None)."""
    rows, openings, pan = sieves
    amounts = np.array([values[row] for row in rows])
    in_pan = values[pan] if pan is not None else np.nan
    whole = {PERCENT: 100.0, FRACTION: 1.0}.get(column.unit)
    if column.unit == PERCENT and 0.0 < np.nanmax([*amounts, in_pan]) <= 1.0:
        raise ValueError(
            f"{path}: {name} has no value above 1, so that its values look like fractions; write percent, such as 85 "
            "instead of 0.85, or leave the % out of the name"
        )
    largest = np.sort(amounts)[::-1]
    if column.unit == PERCENT and column.meaning != RETAINED and len(amounts) > 3 and largest[1] <= 1 < largest[0]:
        raise ValueError(
            f"{path}: {name} has one value above 1, {largest[0]:g}, and the others look like fractions; write percent, "
            "such as 85 instead of 0.85"
        )
    if column.meaning == RETAINED:
        return _from_retained(path, name, openings, (amounts, None if pan is None else in_pan), column.unit, notices)
    if column.unit in MASSES:
        whole = None
        if column.meaning == CUMULATIVE and np.isfinite(in_pan):
            whole = in_pan
        elif column.meaning == PASSING:
            whole = amounts[-1]
            if coarsest is not None:
                raise ValueError(
                    f"{path}: {name} is a mass, so that what stays on the coarsest sieve is unknown; give it in "
                    "percent, or leave out --coarsest"
                )
            notices.append(f"{name}: all grains are taken to pass the coarsest sieve")
        if not whole:
            raise ValueError(f"{path}: {name} is a mass, but its total is unknown; give it in percent, or add the pan")
    if whole is None:
        whole = 1.0 if amounts.max() <= 1.0 else 100.0
        notices.append(f"the column {name} is taken as {'a fraction' if whole == 1.0 else 'percent'}")
    shares = amounts / whole
    over = np.flatnonzero(shares > 1.0 + ROUNDING)
    if len(over):
        raise ValueError(
            f"{path}, row {rows[over[0]]}: {name} = {amounts[over[0]]:g} is more than the whole; correct it"
        )
    end = in_pan / whole
    if column.meaning == CUMULATIVE and np.isfinite(end) and abs(end - 1.0) > ROUNDING:
        raise ValueError(f"{path}, row {pan}: {name} of the pan is {in_pan:g}; it must end at the whole; correct it")
    if column.meaning == PASSING and np.isfinite(end) and end > ROUNDING:
        raise ValueError(f"{path}, row {pan}: {name} of the pan is {in_pan:g}, but nothing passes it; give 0")
    _check_direction(path, name, rows, amounts, column.meaning)
    passing = shares if column.meaning == PASSING else 1.0 - shares
    if 0.0 < abs(passing[-1] - 1.0) <= ROUNDING and coarsest is None:
        notices.append(
            f"{name}: {100 * passing[-1]:.4g} % pass the coarsest sieve instead of 100 %; the shares are divided by it"
        )
        passing = passing / passing[-1]
    elif passing[-1] < 1.0 and coarsest is None:
        raise ValueError(
            f"{path}, row {rows[-1]}: only {100 * passing[-1]:.4g} % pass the coarsest sieve, not 100 %; add the sieve "
            "that all grains pass, or give their largest size with --coarsest"
        )
    return SieveTable(
        openings, np.clip(passing, 0.0, 1.0), whole * MASSES[column.unit] if column.unit in MASSES else None
    )


def _from_retained(path, name, openings, amounts, unit, notices):
    """Return the SieveTable of the amounts: retained on the sieves, and in the pan (None if there is no such row)."""
    retained, has_pan = amounts[0], amounts[1] is not None
    in_pan = np.nan_to_num(amounts[1]) if has_pan else 0.0
    total = float(retained.sum() + in_pan)
    if total <= 0.0:
        raise ValueError(f"{path}: all amounts in {name} are 0; give those of the sieves that retained grains")
    whole = {PERCENT: 100.0, FRACTION: 1.0}.get(unit)
    if whole is not None and abs(total / whole - 1.0) > ROUNDING:
        raise ValueError(
            f"{path}: {name} sums to {total:.4g}, not to {whole:g}; "
            f"{'add what is missing, such as a row `pan`, or ' if total < whole else ''}correct the values; cumulative "
            "values need a name such as `passing [%]` or `cumulative retained [%]`"
        )
    if whole is not None and abs(total / whole - 1.0) > 1e-9:
        notices.append(f"{name} sums to {total:.6g} instead of {whole:g}; it is divided by its sum")
        if total < whole and not has_pan:
            notices[-1] += (
                f"; there is no row `pan`: if the missing part passed {openings[0] * 1e3:g} mm, give it in a row `pan`"
            )
    if unit is None:
        notices.append(f"the column {name} has no unit; its values are taken relative to their sum, {total:.6g}")
    passing = (in_pan + np.r_[0.0, np.cumsum(retained)[:-1]]) / total
    # Without the round-off of the sum, which would be a class of its own.
    passing[np.cumsum(retained[::-1])[::-1] == 0.0] = 1.0
    return SieveTable(openings, passing, total * MASSES[unit] if unit in MASSES else None)


def _check_direction(path, name, rows, amounts, meaning):
    """Raise ValueError unless amounts, from fine to coarse, rise (passing) or fall (cumulative retained)."""
    steps = np.diff(amounts) * (1 if meaning == PASSING else -1)
    if np.all(steps >= 0):
        return
    if np.all(steps <= 0):
        other = "cumulative retained" if meaning == PASSING else "passing"
        raise ValueError(
            f"{path}: {name} {'falls' if meaning == PASSING else 'rises'} from fine to coarse sieves, the wrong way; "
            f"is it `{other}`?"
        )
    wrong = int(np.flatnonzero(steps < 0)[0])
    raise ValueError(
        f"{path}, row {rows[wrong + 1]}: {name} = {amounts[wrong + 1]:g} beside {amounts[wrong]:g} on the next finer "
        f"sieve (row {rows[wrong]}); what is {meaning} cannot {'fall' if meaning == PASSING else 'rise'} from fine to "
        "coarse; correct it"
    )

"""Reads a table of beds whose porosity was measured, one bed per row.

A row has the form of its grains, as in simcore.grains.measured_forms (mean_FL, std_FL, mean_EL, std_EL, or FL, EL of
one form, or L, I, S of one form), and:

    n           measured porosity, a fraction, or per cent if the header has %; also named porosity, Porosität
    n_error     standard error of the measured porosity in the same unit, optional
    case        sieve curve of the bed, such as U1 or one-class, optional
    sieve       file with the table of the bed's sieve curve, beside this table, or the name of a listed curve, optional
"""

import re
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from simcore.grains.cell_numbers import read_number
from simcore.grains.form_columns import SAMPLE, sample_position
from simcore.grains.form_notices import SHOWN
from simcore.grains.measured_forms import Sample, samples_of_table
from simcore.grains.row_errors import read_each
from simcore.grains.sieve import SieveCurve
from simcore.grains.sieve_table import read_curve
from simcore.grains.table_file import read_table
from simcore.grains.text_lists import join_first

_PERCENT = r"(?:[\s_,]*(?:in\s+)?[\[(]?\s*(?:vol\.?\s*-?\s*)?(?:%|percent|per cent|prozent)\s*[\])]?)"
_FRACTION = r"(?:\s*[\[(]\s*[-–1]?\s*[\])])?"
_POROSITY = r"(?:n|(?:total[\s_]+)?porosity(?:[\s_]+n)?|porosit(?:ä|ae)t(?:[\s_]+n)?|porenanteil(?:[\s_]+n)?)"
_COLUMNS = {
    "n": rf"(?:measured[\s_]+)?{_POROSITY}(?:[\s_]+\(?(?:measured|gemessen)\)?)?",
    "n_error": rf"{_POROSITY}[\s_]+(?:(?:std|standard)[\s_]+)?(?:error|uncertainty)",
    "case": r"case",
    "sieve": r"(?:sieve|sieves|sieve[\s_]+curve|curve|siebkurve)(?:[\s_]+file)?",
}
SIEVE_NAME = re.compile(_COLUMNS["sieve"], re.IGNORECASE)  # of the column with the sieve curve of each bed or sample
MAX_ERROR = 0.05  # maximum of n_error as a fraction; a larger one is probably in percentage points
LEAST_ERROR = 0.001  # minimum that a measurement can reach
_MEANINGS = {"n": "the porosity", "n_error": "the error of n", "case": "the sieve curve", "sieve": "the sieve curve"}
# Columns from which n follows, and how.
_OTHER_MEASURES = {
    re.compile(r"e$|void|porenzahl", re.IGNORECASE): "the porosity of a void ratio e is n = e/(1 + e); ",
    re.compile(r"(?:dry|bulk).*density|.*dichte|rho|ρ", re.IGNORECASE): "the porosity is n = 1 - dry density of the "
    "bed / density of the grains; ",
}
NEEDED = (
    "give a row per bed with the column n, its measured porosity, and the form of its grains: mean_FL, std_FL, "
    "mean_EL, std_EL, or FL, EL, or L, I, S"
)


@dataclass(frozen=True)
class MeasuredBed:
    """A bed of measured porosity n.

    sample: Sample with the form of its grains. n_error: standard error of n, nan if unknown. case: name of the sieve
    curve. curve: SieveCurve, or None if only the name of a case is given. where: file and row. in_percent: whether the
    table has porosities in per cent.
    """

    sample: Sample
    n: float
    n_error: float
    case: str
    curve: SieveCurve | None = None
    where: str = field(default="", compare=False)
    in_percent: bool = field(default=False, compare=False)


class CurveReader:
    """Reads sieve curves, each file once.

    listed: dict of name to SieveCurve. finest, coarsest [m]: as in simcore.grains.sieve_table.read_curve.
    """

    def __init__(self, listed=None, finest=None, coarsest=None):
        self.listed, self.ends = listed or {}, (finest, coarsest)
        self._read = {}

    def check_ends(self):
        """Raise ValueError if a size of finest or coarsest grains is given, and no file of a curve was read."""
        if not self._read and any(end is not None for end in self.ends):
            raise ValueError(
                "--finest and --coarsest are sizes for the file of a sieve curve, and no file is read; leave them out"
            )

    def read(self, where, text, folder=None):
        """Return (SieveCurve, notices): a listed one, in any case of letters, or that of a file in `folder`.

        where: file and row, for messages.
        """
        path = Path(text) if folder is None else Path(folder) / text
        listed = (
            text if text in self.listed else next((name for name in self.listed if name.lower() == text.lower()), "")
        )
        if text in self.listed or listed and not path.is_file():
            return replace(self.listed[listed], name=listed), []
        if not path.is_file():
            names = f", nor one of the listed curves {', '.join(self.listed)}" if self.listed else ""
            raise ValueError(
                f"{where}: the sieve curve {text} is no file ({path}){names}; give "
                + ("the path of a file" if folder is None else "the name of a file beside the table")
            )
        if path in self._read:
            return self._read[path], []
        try:
            self._read[path], notices = read_curve(path, *self.ends)
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
        return self._read[path], notices


def read_measured_beds(path, case=None, column=None, sieve=None, curves=None, default=None):
    """Read a table and return (beds, notices): a list of MeasuredBed in the order of the rows, and a list of sentences.

    path: a text file or a workbook, see simcore.grains.table_file. case: sieve curve of all beds, for a table without
    the columns case and sieve. sieve: path of the sieve curve of all beds instead. default: the case if neither these
    columns nor case nor sieve are given. curves: CurveReader. column: name of the column with the names of the beds;
    with None it is "sample", "Probe", "bed" or "Bett", if there is such a column. Rows of one name are repeats with the
    same form. ValueError names the file, the row as a spreadsheet counts it, and the remedy.
    """
    table = read_table(path)
    if not table.header or table.cells.empty:
        raise ValueError(f"{table.path}: there are no rows below a header; {NEEDED}")
    positions, percent = _recognise(table.path, table.header)
    curves = curves or CurveReader()
    if case is None and sieve is None and not {"case", "sieve"} & set(positions):
        case = default
    _check_case(table.path, positions, case, sieve)
    of_all = None if sieve is None else curves.read("--sieve", str(sieve))
    forms = table.without(*positions.values())
    labels = _columns_with_labels(forms, column)
    forms, names, given = _name_rows(forms, column)
    samples, notices = samples_of_table(forms, column, of_beds=True, labels=labels)
    if all(sample.one_form for sample in samples):
        notices.append(
            f"{table.path}: each row has one form; if that is a mean over the grains of the bed, the predicted "
            "porosity is too low, by 0.01 to 0.03 for gravel: give mean_FL, std_FL, mean_EL, std_EL"
        )
    rows = {name: row for row, name in names.items()}

    def read_bed(row, sample):
        texts, where = table.cells.loc[row], f"{table.path}, row {row}"
        n, n_error = _read_porosity(where, texts, positions, percent)
        of_bed = _read_case(where, texts, positions, case)
        curve, more = of_all or (None, [])
        if of_all is None and "sieve" in positions and not of_bed:
            of_bed = texts[positions["sieve"]]
            curve, more = curves.read(where, of_bed, Path(table.path).parent)
        return MeasuredBed(sample, n, n_error, of_bed, curve, where, percent), more

    read = read_each(((rows[sample.name], sample) for sample in samples), read_bed)
    beds = [bed for bed, _ in read]
    if of_all is None:
        notices += [notice for _, more in read for notice in more]
    else:
        notices += of_all[1]
    curves.check_ends()
    _check_repeats(table.path, beds, rows, given)
    if sample_position(table.path, table.header, column) is None:
        _check_grains(table.path, beds, rows)
    if percent and all(bed.n < 0.01 for bed in beds):
        raise ValueError(
            f"{table.path}: the header of n has %, but all porosities are below 1 %; remove % if they are fractions"
        )
    if all(bed.n_error < LEAST_ERROR for bed in beds):
        least, remedy = f"{LEAST_ERROR:g}", ""
        if percent:
            least, remedy = f"{100 * LEAST_ERROR:g} %", "; if they are fractions, remove % from its header"
        notices.append(
            f"{table.path}: all n_error are below {least}, which few measurements of porosity reach; check their "
            f"unit{remedy}"
        )
    return beds, notices


def _recognise(path, header):
    """Return the positions of n, n_error, case and sieve (those that exist), and whether porosities are in per cent.

    ValueError if n is missing, if two columns have one meaning, or if only one of n and n_error is in per cent.
    """
    positions, percent = {}, {}
    for meaning, pattern in _COLUMNS.items():
        for position, name in enumerate(header):
            in_percent = re.fullmatch(pattern + _PERCENT, name, re.IGNORECASE) is not None
            if not in_percent and not re.fullmatch(pattern + _FRACTION, name, re.IGNORECASE):
                continue
            if meaning in positions:
                remedy = "; if n is the number of grains, rename it to grains" if meaning == "n" else ""
                raise ValueError(
                    f"{path}: the columns {header[positions[meaning]]} and {name} are both "
                    f"{_MEANINGS[meaning]}; remove one{remedy}"
                )
            positions[meaning], percent[meaning] = position, in_percent
    if "n" not in positions:
        columns = ", ".join(name or "(no name)" for name in header)
        other = next((hint for pattern, hint in _OTHER_MEASURES.items() if any(map(pattern.match, header))), "")
        raise ValueError(f"{path}: the column n is missing beside {columns}; {other}{NEEDED}")
    if percent.get("n_error", percent["n"]) != percent["n"]:
        raise ValueError(
            f"{path}: one of the columns {header[positions['n']]} and {header[positions['n_error']]} is in %, the "
            "other is not; give both in one unit"
        )
    return positions, percent["n"]


def _check_case(path, positions, case, sieve):
    """Raise a ValueError unless the sieve curve is given exactly once."""
    if case is not None and sieve is not None:
        raise ValueError("--case and --sieve are both the sieve curve of all beds; give one")
    options = {"--case": case, "--sieve": sieve}
    given = next((option for option, value in options.items() if value is not None), None)
    columns = [name for name in ("case", "sieve") if name in positions]
    if given is None and not columns:
        raise ValueError(
            f"{path}: the sieve curve of the beds is not given; add --case, such as --case one-class for any single "
            "sieve class, a column case, --sieve CURVE.csv, or a column sieve with a file in each row"
        )
    if given is not None and columns:
        raise ValueError(f"{path}: the table has a column {columns[0]}; leave out {given}, or remove the column")


def _name_rows(table, column):
    """Return the TextTable with a different name in each row, these names, and the names as given, dicts by row."""
    position = sample_position(table.path, table.header, column)
    given = {row: f"row {row}" for row in table.cells.index} if position is None else table.cells[position].to_dict()
    names, used = {}, set()
    for row, name in given.items():
        names[row] = f"{name} (row {row})" if name in used else name
        used.add(name)
    if position is None:
        table, position = replace(table, header=[*table.header, SAMPLE]), len(table.header)
    cells = table.cells.copy()
    cells[position] = list(names.values())
    return replace(table, cells=cells), names, given


def _columns_with_labels(table, column):
    """Return the positions of the column with the names of the beds, or else of a first column of different texts.

    Other columns may have words such as min, which is a state of a bed there.
    """
    position = sample_position(table.path, table.header, column)
    if position is not None:
        return [position]
    first = min(table.cells)
    texts = [text for text in table.cells[first] if text]
    return [first] if len(set(texts)) == len(texts) else []


def form_key(bed):
    """Return what MeasuredBeds of the same form have in common, their form without round-off."""
    return tuple(f"{value:.8g}" for value in bed.sample.form)


def _check_repeats(path, beds, rows, given):
    """Raise a ValueError if two beds were given the same name and have different forms."""
    first_beds = {}
    for bed in beds:
        row = rows[bed.sample.name]
        other = first_beds.setdefault(given[row], bed)
        if form_key(other) != form_key(bed):
            raise ValueError(
                f"{path}, row {row}: {given[row]} is also the name of row {rows[other.sample.name]}, which has another "
                "form. If both are beds of one gravel, give both the mean form of its grains, so that they count as "
                "repeats; if they are different gravels, rename one; if the rows are grains of one bed, give their "
                "means and deviations in one row"
            )


def _check_grains(path, beds, rows):
    """Raise a ValueError if most rows have the porosity of the row above, but another form, as the grains of a bed."""
    same_bed = [
        rows[bed.sample.name]
        for above, bed in pairwise(beds)
        if (above.n, str(above.n_error), above.case) == (bed.n, str(bed.n_error), bed.case)
        and form_key(above) != form_key(bed)
    ]
    if 2 * len(same_bed) > len(beds) and all(bed.sample.one_form for bed in beds):
        raise ValueError(
            f"{path}: rows {join_first([str(row) for row in same_bed], SHOWN)} have the porosity of the row above, but "
            "another form. A row is one bed, not one grain: give the means and deviations of the grains of a bed in "
            "one row (mean_FL, std_FL, mean_EL, std_EL). If each row is a bed, name the beds in a column sample"
        )


def _read_porosity(where, texts, positions, percent):
    """Return the porosity in a row and its standard error, nan if it is not given, as fractions."""
    scale, unit = (100.0, " %") if percent else (1.0, "")
    if not texts[positions["n"]]:
        raise ValueError(f"{where}: n is empty; give the porosity, or remove the row")
    sign = "% " if percent else ""  # the unit of the header may be repeated in the cells
    n = read_number(where, "n", texts[positions["n"]].rstrip(sign or None))
    if not 0 < n < scale:
        remedy = "correct it" if percent else "give a fraction, or write n [%] in the header if it is in per cent"
        raise ValueError(f"{where}: n = {n:g}{unit} is not between 0 and {scale:g}{unit}; {remedy}")
    text = texts[positions["n_error"]] if "n_error" in positions else ""
    if not text:
        return n / scale, float("nan")
    n_error = read_number(where, "n_error", text.rstrip(sign or None))
    if n_error == 0:
        raise ValueError(f"{where}: n_error = 0, but each measurement has an error; if it is unknown, leave it empty")
    if not percent and n_error > MAX_ERROR:
        is_percent = LEAST_ERROR <= n_error / 100.0 <= MAX_ERROR
        in_percent = f"; if {n_error:g} is in percentage points, write {n_error / 100:g}" if is_percent else ""
        raise ValueError(
            f"{where}: n_error = {n_error:g} is above {MAX_ERROR:g}, but n is a fraction{in_percent}; if it is "
            "unknown, leave it empty"
        )
    if not 0 <= n_error <= MAX_ERROR * scale:
        raise ValueError(
            f"{where}: n_error = {n_error:g}{unit} is not between 0 and {MAX_ERROR * scale:g}{unit}; correct it; if it "
            "is unknown, leave it empty"
        )
    return n / scale, n_error / scale


def _read_case(where, texts, positions, case):
    """Return the case of a row, "" if it has a sieve curve instead."""
    columns = [name for name in ("case", "sieve") if name in positions]
    if not columns:
        return case or ""
    filled = [name for name in columns if texts[positions[name]]]
    if not filled:
        raise ValueError(f"{where}: {' and '.join(columns)} {'is' if len(columns) == 1 else 'are'} empty; name the "
                         "sieve curve in every row")  # fmt: skip
    if len(filled) > 1:
        raise ValueError(f"{where}: case and sieve are both given; each row has one sieve curve, so remove one")
    return texts[positions["case"]] if filled == ["case"] else ""

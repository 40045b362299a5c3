"""Reads a table from a text file or a workbook as text, with any common encoding and separator."""

import csv
import io
import re
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path

import pandas as pd

from simcore.grains.form_columns import SAMPLE_NAMES
from simcore.grains.table_head import (
    comment_of,
    comments_above,
    join_units,
    may_be_names,
    nameless_column,
    rows_above_header,
    width,
)

_WORKBOOKS = (".xlsx", ".xlsm", ".ods")
_THREE_DECIMALS = re.compile(r"-?\d+\.\d{3}")
# Kind of workbook, library that reads it, and pandas' name of the library.
_EXCEL = ("Excel workbook", "openpyxl>=3.1,<4", "openpyxl")
_OPEN_DOCUMENT = ("OpenDocument sheet", "odfpy>=1.4,<2", "odf")
_OPEN_DOCUMENT_MARK = b"application/vnd.oasis.opendocument.spreadsheet"
# PebbleCounts (Purinton and Bookhagen 2019) writes its settings first; the table of grains follows the second line.
_PEBBLECOUNTS, _PEBBLES = "PebbleCounts Parameters", "Pebble Details"
_ZIP, _OLD_EXCEL = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
# UTF-32 precedes UTF-16, because its byte order mark begins with that of UTF-16.
_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_EXCEL_SEPARATOR = re.compile(r'"?sep=([!#-/:-@[-^`{-~\t]|\\t)"?[;,\t]*', re.IGNORECASE)
_SEPARATORS = (";", "\t", "|", ",")
_SPACES = r"\s+"
OF_SPACES = "blanks separate the columns, also inside their names: separate the columns with semicolons or tabs"
_WEAK_SEPARATORS = (",", _SPACES)  # which a title may contain too
SAVE_AS = "save it as CSV (UTF-8)"


@dataclass(frozen=True)
class TextTable:
    """A table whose cells are text.

    path: the file. header: names of the columns, with single spaces. cells: DataFrame of str, columns 0, 1, ...; its
    index is the row as a spreadsheet or an editor counts it, from 1. notices: sentences on how the file was read.
    short: dict from each row of a text file that has fewer fields than the header to the number of the columns that it
    has, and of its fields in the file. columns_of_file: as the header of the file; None: as that of the table.
    separator: of the columns, "" in a workbook.
    """

    path: Path
    header: list
    cells: pd.DataFrame
    notices: list
    short: dict = field(default_factory=dict)
    separator: str = ""
    columns_of_file: int | None = None

    def without(self, *left_out, rows=None):
        """Return the table without the columns at these positions, and with the rows of a mask only."""
        kept = [position for position in range(len(self.header)) if position not in left_out]
        cells = self.cells if rows is None else self.cells[rows]
        cells = cells[kept].set_axis(range(len(kept)), axis=1)
        short = {row: (sum(position < has for position in kept), of_file) for row, (has, of_file) in self.short.items()}
        short = {row: numbers for row, numbers in short.items() if numbers[0] < len(kept)}
        header, columns = [self.header[position] for position in kept], self.columns_of_file or len(self.header)
        return replace(self, header=header, cells=cells, short=short, columns_of_file=columns)


def read_table(path):
    """Read the file at `path` as a TextTable; rows and columns without any text are left out.

    Text may be UTF-8, UTF-16 or UTF-32 (this one only with a byte order mark). Other text is read as Windows-1252
    (Latin-1), with a notice. Columns are separated by semicolons, tabs, bars, commas or, without any of these, white
    space; Excel's first line `sep=` overrides this. In a workbook (.xlsx, .ods) the first sheet that is not empty is
    read. The settings at the beginning of an export of PebbleCounts are left out, and with a notice the rows of a title
    above the names of the columns. A row of units below the names is joined with them. ValueError if the file does not
    exist or is not a table, if a row below the header is a comment, or if it has more cells than the header.
    """
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path}: this is a folder; give the file of a table")
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise ValueError(f"{path}: there is no such file; correct the path") from None
    if data.startswith(_OLD_EXCEL):
        raise ValueError(f"{path}: this is an Excel file of the old kind (.xls); save it as .xlsx or as CSV (UTF-8)")
    if data.startswith(_ZIP) or path.suffix.lower() in _WORKBOOKS:
        open_document = _OPEN_DOCUMENT_MARK in data[:200] or path.suffix.lower() == ".ods"
        cells, notices = _read_workbook(path, data, *(_OPEN_DOCUMENT if open_document else _EXCEL))
        return _split_header(path, cells, notices)
    return _split_header(path, *_read_text(path, data))


def advice_on_fields(separator):
    """Return what to do about a row with another number of fields than the header."""
    if separator == _SPACES:
        return f"add or remove fields; {OF_SPACES}"
    of_commas = ", and write decimals with a point, because commas separate the fields" if separator == "," else ""
    return f"add or remove fields{of_commas}"


def advice_on_names(separator):
    """Return a list with what to do about columns that were not recognised, empty if their names may have blanks."""
    return [OF_SPACES] if separator == _SPACES else []


def _read_text(path, data):
    """Return all cells of a text file, DataFrame of str, notices, the number of fields in each row, the separator."""
    text, notices = _decode(path, data)
    lines = _leave_out_settings(text.split("\n"))
    # The line of `sep=` becomes empty instead of being removed, so that rows are counted as in an editor.
    start = next((i for i, line in enumerate(lines) if line.strip()), len(lines))
    declared = _EXCEL_SEPARATOR.fullmatch(lines[start].strip(" ")) if start < len(lines) else None
    if declared:
        separator = "\t" if declared[1] == "\\t" else declared[1]
        lines[: start + 1] = [""] * (start + 1)
    else:
        separator = _find_separator("\n".join(lines[start:]))
    if not any(line.strip() for line in lines):
        return pd.DataFrame(dtype=str), notices, [], separator
    parts = (line.split() if separator == _SPACES else line.split(separator) for line in lines)
    try:
        cells = pd.read_csv(
            io.StringIO("\n".join(lines)),
            sep=separator,
            header=None,
            names=range(max(map(len, parts))),
            index_col=False,
            dtype=str,
            na_filter=False,
            skip_blank_lines=False,
            skipinitialspace=True,
        )
    except pd.errors.ParserError:
        raise ValueError(f'{path}: a quotation mark (") is not closed; close it or remove it') from None
    return cells, notices, _count_fields(lines, separator), separator


def _count_fields(lines, separator):
    """Return the number of fields in each row, which pandas fills up; an empty list if a field is too long to count."""
    if separator == _SPACES:
        return [len(line.split()) for line in lines]
    try:
        return [len(row) for row in csv.reader(lines, delimiter=separator, skipinitialspace=True)]
    except csv.Error:
        return []


def _leave_out_settings(lines):
    """Return lines, in which the settings of an export of PebbleCounts are empty lines."""
    first = next((i for i, line in enumerate(lines) if line.strip()), 0)
    starts = [i for i, line in enumerate(lines) if line.strip(" ,") == _PEBBLES]
    if lines[first].strip(" ,") != _PEBBLECOUNTS or not starts:
        return lines
    return [""] * (starts[0] + 1) + lines[starts[0] + 1 :]


def _decode(path, data):
    """Return the text, with \\n between its lines, and notices."""
    notices = []
    encoding = next((name for mark, name in _MARKS if data.startswith(mark)), None)
    if encoding is None and b"\0" in data:
        zeros = data[0::2].count(0), data[1::2].count(0)
        encoding = "utf-16-be" if zeros[0] > zeros[1] else "utf-16-le"
    try:
        text = data.decode(encoding or "utf-8")
    except UnicodeDecodeError:
        if encoding is not None:
            raise ValueError(f"{path}: the file is not the text of a table; {SAVE_AS}") from None
        # Five byte values are undefined in Windows-1252, hence errors="replace".
        text = data.decode("cp1252", errors="replace")
        notices.append("the text is not UTF-8; it is read as Windows-1252 (Latin-1)")
    text = re.sub(r"\r\n?|[\u2028\u2029\x0b\x0c\x85]", "\n", text).replace("\ufeff", "").rstrip("\x1a")
    if re.search(r"[\x00-\x08\x0e-\x1f]", text):
        raise ValueError(f"{path}: the file is not the text of a table; {SAVE_AS}")
    return text, notices


def _find_separator(text):
    """Return the separator of the columns, outside quoted fields: that of the first row, or that of most rows below it.

    The latter counts only if the first row is a title, in which commas and spaces separate words.
    """
    header = ""
    for line in text.split("\n"):
        header += line + "\n"
        if header.count('"') % 2 == 0:
            break
    bare = _without_quoted(header)
    own = next((mark for mark in _SEPARATORS if mark in bare), _SPACES if len(bare.split()) > 1 else ",")
    if own not in _WEAK_SEPARATORS:
        return own
    rows = [line for line in _without_quoted(text[len(header) :]).split("\n") if line.strip()]
    return next((mark for mark in _SEPARATORS if mark != own and _separates(mark, rows)), own)


def _separates(mark, rows):
    """Return whether a mark separates the columns in most of the rows, of which one has the names of the columns.

    A row of names has no digits, unlike a row with a mark in a note. Beside spaces, the comma of a number is decimal.
    """
    names = [mark in row and not re.search(r"\d", row) for row in rows]
    numbers = [mark in row and (mark != "," or len(row.split()) == 1) for row in rows]
    return any(names) and sum(map(max, names, numbers)) > 0.5 * len(rows)


def _without_quoted(text):
    return re.sub(r'"[^"]*"', "", text)


def _read_workbook(path, data, kind, library, engine):
    """Return all cells of the first sheet that is not empty, DataFrame of str, and notices.

    kind: of workbook, for messages; library: its requirement for pip; engine: pandas' name of it.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about styles and the like, which do not affect the values
            sheets = pd.read_excel(io.BytesIO(data), sheet_name=None, header=None, dtype=object, engine=engine)
    except ImportError:
        raise ValueError(
            f"{path}: {kind}s are read with {library.partition('>')[0]}, which is not installed; install it "
            f"(python -m pip install '{library}'), or {SAVE_AS}"
        ) from None
    except Exception as error:  # a damaged archive can raise any exception
        reason = " ".join(str(error).split())
        raise ValueError(f"{path}: the file cannot be read as an {kind} ({reason}); save it again, or as CSV") from None
    filled = {name: sheet for name, sheet in sheets.items() if sheet.notna().any(axis=None)}
    if not filled:
        return pd.DataFrame(dtype=str), []
    name, *others = filled
    notices = [f"only the sheet {name} is read, not {', '.join(map(str, others))}"] if others else []
    if engine == _EXCEL[2] and filled[name].isna().any(axis=None):
        _check_formulas(path, filled[name], name, data)
        _put_errors(filled[name], name, data)
    return filled[name].map(_cell_text).astype(str), notices


def _check_formulas(path, sheet, name, data):
    """Raise ValueError if no formula of the sheet has a stored result, as in a workbook that a program has written.

    Formulas that can result in an empty text do not count, since their results look like missing ones.
    """
    from openpyxl import load_workbook

    rows = load_workbook(io.BytesIO(data), read_only=True, keep_links=False)[name].iter_rows()
    formulas = [cell for cells in rows for cell in cells if cell.data_type == "f" and '""' not in str(cell.value)]
    inside = [cell for cell in formulas if cell.row <= sheet.shape[0] and cell.column <= sheet.shape[1]]
    if formulas and all(pd.isna(sheet.iat[cell.row - 1, cell.column - 1]) for cell in inside):
        first = formulas[0]
        raise ValueError(
            f"{path}, row {first.row}: column {first.column} has a formula without its result, as have all formulas of "
            f"the sheet {name}; open the file in a spreadsheet, save it there, and give it again"
        )


def _put_errors(sheet, name, data):
    """Put errors of formulas, such as #DIV/0!, into a sheet of an Excel workbook; pandas reads them as empty cells.

    Rows without any value stay empty: formulas are often copied below the data.
    """
    from openpyxl import load_workbook

    rows = load_workbook(io.BytesIO(data), read_only=True, data_only=True, keep_links=False)[name].iter_rows()
    has_values = sheet.notna().any(axis=1).to_numpy()
    for cell in (cell for cells in rows for cell in cells if cell.data_type == "e"):
        if cell.row <= sheet.shape[0] and cell.column <= sheet.shape[1] and has_values[cell.row - 1]:
            sheet.iat[cell.row - 1, cell.column - 1] = cell.value


def _cell_text(cell):
    """Return the text of a cell. A number such as 1.234 gets another decimal, because the text 1.234 may mean 1234."""
    text = "" if pd.isna(cell) else str(cell)
    return f"{text}0" if isinstance(cell, float) and _THREE_DECIMALS.fullmatch(text) else text


def _split_header(path, cells, notices, fields=(), separator=""):
    """Return the TextTable of all cells.

    The header is the first row that is not empty, or the row below a title; a row of units is joined with it. fields:
    number of fields in each row.
    """
    cells = cells.map(lambda text: " ".join(text.split()))
    cells.index, cells.columns = range(1, len(cells) + 1), range(cells.shape[1])
    cells = cells[(cells != "").any(axis=1)]
    if cells.empty:
        return TextTable(path, [], cells, notices)
    if comments := comments_above(cells.to_numpy().tolist()):
        cells = cells.iloc[comments:]
    above = rows_above_header(cells.to_numpy().tolist())
    if above:
        rows = ", ".join(f"row {row}" for row in cells.index[:above])
        verb = "are" if above > 1 else "is"
        notices = [*notices, f"{rows} {verb} above the names of the columns and {verb} left out"]
        rows = cells.to_numpy().tolist()
        if nameless := nameless_column(rows[:above], rows[above], rows[above + 1 :], SAMPLE_NAMES):
            position, row = nameless
            raise ValueError(
                f"{path}: column {position + 1} has values but no name in row {cells.index[above]}; write its "
                f"name there (row {cells.index[row]} has {rows[row][position]})"
            )
    first, names, cells = cells.index[above], cells.iloc[above].tolist(), cells.iloc[above + 1 :]
    columns = width(names)
    for row, *texts in cells.itertuples(name=None):
        if comment := comment_of(texts):
            raise ValueError(f"{path}, row {row}: the line is a comment, '{comment}'; remove it")
        if width(texts) > columns:
            raise ValueError(
                f"{path}, row {row}: the row has {width(texts)} fields, but the header has {columns}; "
                f"{advice_on_fields(separator)}; if there is a title above the names of the columns, remove it"
            )
    joined = join_units(names, cells.iloc[0].tolist()) if len(cells) else None
    if joined:
        notices = [*notices, f"row {cells.index[0]} has the units of the columns"]
        names, cells = joined, cells.iloc[1:]
    elif not above and len(cells) and may_be_names(cells.iloc[0].tolist()):
        notices = [
            *notices,
            f"row {cells.index[0]} has no numbers; if row {first} is a title above the columns, remove it",
        ]
    kept = [position for position in range(columns) if names[position] or (cells[position] != "").any()]
    cells = cells[kept].set_axis(range(len(kept)), axis=1)
    numbers = {row: sum(position < number for position in kept) for row, number in enumerate(fields, start=1)}
    short = {row: (numbers[row],) * 2 for row in cells.index if numbers.get(row, len(kept)) < len(kept)}
    return TextTable(path, [names[position] for position in kept], cells, notices, short, separator)


def plain_words(text):
    """Return the words of a column's name in lower case, without punctuation and numbers, as a set."""
    return set(re.findall(r"[^\W\d_]+", text.lower()))

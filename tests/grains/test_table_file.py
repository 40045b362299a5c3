"""Tables as common programs save them: encodings, separators, decimals, workbooks."""

import builtins

import pandas as pd
import pytest

from simcore.grains.measured_forms import read_measured, read_samples
from simcore.grains.table_file import read_table

ROWS = [("40.5", "20.25", "10"), ("30", "20.5", "15"), ("9", "8", "2.125")]


def written(separator=",", decimal=".", quote="", end="\n", header=("L", "I", "S")):
    rows = [header, *([cell.replace(".", decimal) for cell in row] for row in ROWS)]
    return "".join(separator.join(f"{quote}{cell}{quote}" for cell in row) + end for row in rows)


@pytest.fixture
def expected(tmp_path):
    (tmp_path / "bed.csv").write_text(written())
    return read_samples(tmp_path / "bed.csv")


@pytest.fixture
def read(tmp_path):
    def read_bytes(data, name="bed.csv"):
        (tmp_path / name).write_bytes(data)
        return read_samples(tmp_path / name)

    return read_bytes


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_encoding_and_end_of_line_gives_the_same(read, expected, encoding, end):
    for separator in ",;\t|":
        assert read(written(separator, end=end).encode(encoding)) == expected
        assert read(written(separator, ",", '"', end).encode(encoding)) == expected


@pytest.mark.parametrize("separator", [";", "\t", "|", "  "])
def test_a_decimal_comma_needs_no_quotes_where_other_marks_separate(read, expected, separator):
    assert read(written(separator, ",").encode()) == expected


def test_excels_first_line_names_the_separator(read, expected):
    for first, separator in (("sep=;", ";"), ("sep=,", ","), ("SEP=\\t", "\t"), ('"sep=;"', ";"), ("sep=:", ":")):
        for encoding in ("utf-8", "utf-8-sig", "utf-16"):
            assert read(f"{first}\r\n{written(separator, end=chr(13) + chr(10))}".encode(encoding)) == expected
    with pytest.raises(ValueError, match="row 3: L is 'x'"):
        read(b"sep=;\nL;I;S\nx;2;1\n")


def test_trailing_separators_and_empty_rows_hold_nothing(read, expected):
    for separator in ",;\t":
        lines = written(separator).splitlines()
        assert read("".join(line + separator + "\n" for line in lines).encode()) == expected
        assert (
            read("".join(line + 3 * separator + "\n" for line in [lines[0], "", *lines[1:], ""]).encode()) == expected
        )
        assert read("\n".join([lines[0], *(line + separator for line in lines[1:])]).encode()) == expected
    assert read(b"L,I,S,note\n40.5,20.25,10\n30,20.5,15,wet\n9,8,2.125,\n") == expected
    with pytest.raises(ValueError, match="row 3: the row has 5 fields, but the header has 3"):
        read(b"L,I,S,\n4,2,1,\n4,2,1,,x\n")


def test_a_row_is_counted_as_an_editor_does(read):
    with pytest.raises(ValueError, match="row 6: I is 'x'"):
        read(b"\n\nL,I,S\n4,2,1\n\n4,x,1\n")


def test_names_with_letters_of_latin_1_are_read_with_a_notice(tmp_path):
    (tmp_path / "bed.csv").write_bytes("sample;FL;EL\nK\xf6ln;0,5;0,7\nK\xf6ln;0,6;0,7\n".encode("latin-1"))
    (sample,), (notice,) = read_measured(tmp_path / "bed.csv")
    assert sample.name == "K\xf6ln" and "the text is not UTF-8; it is read as Windows-1252" in notice


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\x0dIHDR", "is not the text of a table"),
        (b"\xff\xfeL", "is not the text of a table"),
        (bytes(range(256)), "is not the text of a table"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "is an Excel file of the old kind"),
        (b"PK\x03\x04\xff\xfe", "cannot be read as an Excel workbook"),
        (b'L,I,S\n"4,2,1\n', "a quotation mark .* is not closed"),
        (b"sep=;\n", "is empty"),
        (b"", "is empty"),
        (b" \n,,\n", "is empty"),
    ],
)
def test_what_is_no_table_is_said_in_one_line(read, data, message):
    with pytest.raises(ValueError, match=f"bed.csv: .*{message}") as error:
        read(data)
    assert "\n" not in str(error.value)


def test_a_folder_is_no_table(tmp_path):
    with pytest.raises(ValueError, match="is a folder"):
        read_table(tmp_path)


def workbook(path, **sheets):
    with pd.ExcelWriter(path, engine="openpyxl") as file:
        for name, rows in sheets.items():
            pd.DataFrame(rows).to_excel(file, sheet_name=name, header=False, index=False)
    return path


def test_a_workbook_is_read_as_the_same_rows_in_text(tmp_path, expected):
    pytest.importorskip("openpyxl")
    numbers = [[float(cell) for cell in row] for row in ROWS]
    path = workbook(tmp_path / "bed.xlsx", grains=[["L [mm]", "I [mm]", "S [mm]"], *numbers])
    assert read_measured(path) == (expected, [])
    path = workbook(tmp_path / "bed.xlsx", empty=[], grains=[["L", "I", "S"], *ROWS], notes=[["dry"]])
    samples, (notice,) = read_measured(path)
    assert samples == expected and notice.endswith("only the sheet grains is read, not notes")
    path = workbook(tmp_path / "bed.xlsx", notes=[["dry"]], grains=[["L", "I", "S"], *ROWS])
    with pytest.raises(ValueError, match="is an axis or a form; .*; only the sheet notes is read, not grains"):
        read_measured(path)
    # The content determines the type of a file, not its name; numbers, text and empty cells keep their meaning.
    rows = [["sample", "FL", "EL", "count"], [7, 0.5, 0.7, 3], [7, "0,9", 0.7, 1], [None, None, None, None]]
    workbook(tmp_path / "bed.xlsx", grains=rows).rename(tmp_path / "bed.csv")
    (sample,), _ = read_measured(tmp_path / "bed.csv")
    assert (sample.name, sample.grains, sample.mu_FL) == ("7", 4, pytest.approx(0.6))
    # The text 2.125 beside 120 may have a separator of thousands, a number cannot.
    axes = [["L", "I", "S"], [300, 200, 120], [140, 100, 2.125]]
    assert read_measured(workbook(tmp_path / "bed.xlsx", grains=axes))[0][0].grains == 2
    with pytest.raises(ValueError, match="row 3: S is '2.125'; if it is 2125, write it so"):
        read_measured(
            workbook(tmp_path / "bed.xlsx", grains=[axes[0], *([str(cell) for cell in row] for row in axes[1:])])
        )
    path = workbook(
        tmp_path / "bed.xlsx", grains=[["L", "I", "S"], [4, 2, 1], [None] * 3, [4, pd.Timestamp("2020-05-01"), 1]]
    )
    with pytest.raises(
        ValueError, match="bed.xlsx, row 4: I is '2020-05-01 00:00:00'; a spreadsheet took the number for"
    ):
        read_samples(path)


def test_an_error_of_a_formula_in_a_workbook_is_named(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    # Formulas that were copied below the data are no row of the table.
    for row in (["L", "I", "S"], [4, 2, 1], [None] * 3, [4, "#DIV/0!", 1], [None, None, "#DIV/0!"]):
        book.active.append(row)
    book.create_sheet("notes").append(["dry", None, "#N/A"])
    assert book.active["B4"].data_type == "e"
    book.save(tmp_path / "bed.xlsx")
    with pytest.raises(ValueError, match="bed.xlsx, row 4: I is '#DIV/0!', an error of the spreadsheet"):
        read_samples(tmp_path / "bed.xlsx")
    book.active["B4"] = 2
    book.save(tmp_path / "bed.xlsx")
    assert read_samples(tmp_path / "bed.xlsx")[0].grains == 2


def test_formulas_that_no_spreadsheet_has_computed_are_an_error(tmp_path):
    """A file of a program has formulas without results, which pandas reads as empty cells."""
    pytest.importorskip("openpyxl")
    rows = [["L", "I", "S"], [4, 2, 1], ["=A2+1", 2, 1]]
    path = workbook(tmp_path / "bed.xlsx", grains=rows)
    with pytest.raises(ValueError, match="bed.xlsx, row 3: column 1 has a formula without its result.*save it there"):
        read_samples(path)
    path = workbook(tmp_path / "bed.xlsx", grains=[[*rows[0], "note"], [*rows[1], '=IF(A2>5,"long","")']])
    assert read_samples(path)[0].grains == 1


def test_without_openpyxl_it_is_said_how_to_install_it(tmp_path, monkeypatch):
    pytest.importorskip("openpyxl")
    path = workbook(tmp_path / "bed.xlsx", grains=[["L", "I", "S"], [4, 2, 1]])
    importing = builtins.__import__

    def without(name, *arguments, **options):
        if name.startswith("openpyxl"):
            raise ImportError(name)
        return importing(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    for module in [name for name in __import__("sys").modules if name.startswith("openpyxl")]:
        monkeypatch.delitem(__import__("sys").modules, module)
    with pytest.raises(ValueError, match=r"openpyxl, which is not installed; install it \(python -m pip install"):
        read_samples(path)

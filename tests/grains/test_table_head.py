"""Rows above the names of the columns, and rows of units below them."""

import pandas as pd
import pytest

from simcore.grains.table_file import read_table
from simcore.grains.table_head import join_units, rows_above_header


@pytest.mark.parametrize(
    ("rows", "above"),
    [
        ([["L", "I"], ["4", "2"]], 0),
        ([["Gravel", ""], ["L", "I"], ["4", "2"]], 1),
        ([["Gravel", "", ""], ["date", "12.03.2025", ""], ["sample", "L", "I"], ["A", "4", "2"]], 2),
        # These rows are data of a table whose header has too few names.
        ([["L", ""], ["4", "2"], ["a", "b"]], 0),
        ([["L", "I", ""], ["4", "2", ""], ["wet", "cold", "old"]], 0),
        ([["A", "4", "2", ""], ["a", "b", "c", "d"]], 0),
        # The wider row is one cell far to the right, or has units.
        ([["L", "I", ""], ["4", "2", ""], ["", "", "note"]], 0),
        ([["L", ""], ["mm", "mm"]], 0),
    ],
)
def test_the_names_of_the_columns_are_in_the_first_row_or_in_a_wider_one_without_numbers(rows, above):
    assert rows_above_header(rows) == above


@pytest.mark.parametrize(
    ("names", "texts", "joined"),
    [
        (["L", "I"], ["mm", "[cm]"], ["L [mm]", "I [cm]"]),
        (["sample", "d", "passing"], ["-", "(µm)", "Gew.-%"], ["sample", "d [µm]", "passing [Gew.-%]"]),
        (["sample", "L [mm]", ""], ["Einheit:", "mm", "mm"], ["sample", "L [mm]", ""]),
        (["L", "I"], ["mm", ""], ["L [mm]", "I"]),
        (["L", "I"], ["-", ""], None),
        (["L", "I"], ["mm", "2"], None),
        (["note", "L"], ["g", "sandy"], None),
    ],
)
def test_units_below_the_names_are_joined_with_them(names, texts, joined):
    assert join_units(names, texts) == joined


def test_rows_keep_their_numbers_below_a_title(tmp_path):
    (tmp_path / "bed.csv").write_text("Gravel, Rhine km 640\n\nsample;L;I\n;mm;mm\nA;4;2,5\n")
    table = read_table(tmp_path / "bed.csv")
    assert table.header == ["sample", "L [mm]", "I [mm]"] and table.separator == ";"
    assert table.cells.index.tolist() == [5] and table.cells.loc[5].tolist() == ["A", "4", "2,5"]
    assert table.notices == [
        "row 1 is above the names of the columns and is left out", "row 4 has the units of the columns"
    ]  # fmt: skip


def test_a_workbook_may_have_a_title(tmp_path):
    rows = [["Sieve analysis", None], [None, None], ["opening", "mass"], ["mm", "g"], [16, 0], [8, 20.5]]
    pd.DataFrame(rows).to_excel(tmp_path / "curve.xlsx", header=False, index=False)
    table = read_table(tmp_path / "curve.xlsx")
    assert table.header == ["opening [mm]", "mass [g]"] and table.cells.index.tolist() == [5, 6]


def test_semicolons_in_notes_do_not_separate_a_table_with_commas(tmp_path):
    (tmp_path / "bed.csv").write_text("L,I,S,note\n4,2,1,wet; cold\n5,2,1,dry; cold\n")
    assert read_table(tmp_path / "bed.csv").header == ["L", "I", "S", "note"]

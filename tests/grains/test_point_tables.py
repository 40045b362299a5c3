"""Point clouds from tables: columns by name, errors with row and column, tables of axes refused."""

import numpy as np
import pytest

from simcore.grains.mesh import make_grain
from simcore.grains.readers import read_grain, read_grain_files
from simcore.grains.spiral import spiral_directions

POINTS = np.round(spiral_directions(60) * [3.0, 4.5, 6.5] + [0.2, -0.3, 0.1], 4)


def lines(mark=",", before=(), after=()):
    """Return the points as text, one per line, with fields before and after x, y, z."""
    return [mark.join([*before, *(f"{value:.4f}" for value in point), *after]) for point in POINTS]


def read(tmp_path, name, text, encoding="utf-8", unit="mm"):
    path = tmp_path / name
    path.write_text(text, encoding=encoding)
    return read_grain(path, unit)


READ = {
    "header": ("a.csv", ["x,y,z", *lines()]),
    "capitals": ("a.csv", ["X,Y,Z", *lines()]),
    "units": ("a.csv", ["x [mm],y (mm),z_mm", *lines()]),
    "id before": ("a.csv", ["id,x,y,z", *lines(before=["7"])]),
    "text column": ("a.csv", ["name,x,y,z", *lines(before=["stone"])]),
    "normals before": ("a.csv", ['"Normals:0","Points:0","Points:1","Points:2"', *lines(before=["9"])]),
    "other order": ("a.csv", ["z,y,x", *(",".join(reversed(line.split(","))) for line in lines())]),
    "blanks": ("a.xyz", lines(" ")),
    "tabs": ("a.csv", ["x\ty\tz", *lines("\t")]),
    "comment as header": ("a.xyz", ["# x y z intensity", *lines(" ", after=["128"])]),
    "cloud compare": ("a.csv", ["//X,Y,Z,R,G,B", *lines(after=["1", "2", "3"])]),
    "count first": ("a.xyz", [str(len(POINTS)), *lines(" ")]),
    "semicolons": ("a.csv", ["x;y;z", *(line.replace(".", ",") for line in lines(";"))]),
    "semicolons, points": ("a.csv", ["x;y;z", *lines(";")]),
    "decimal commas": ("a.xyz", [line.replace(".", ",") for line in lines(" ")]),
    "quoted decimal commas": ("a.csv", ["x,y,z", *(f'"{a}","{b}","{c}"' for a, b, c in
                              (line.replace(".", ",").split(";") for line in lines(";")))]),
    "excel": ("a.csv", ["sep=;", "x;y;z", *lines(";")]),
    "trailing separators": ("a.csv", ["x,y,z,", *lines(after=[""])]),
    "exponents": ("a.csv", ["x,y,z", *(",".join(f"{v:.6e}" for v in point) for point in POINTS)]),
    "blank lines": ("a.csv", ["", "x,y,z", "", *lines(), "", ""]),
}  # fmt: skip


@pytest.mark.parametrize("kind", READ)
def test_points_are_read_whatever_the_table(tmp_path, kind):
    name, rows = READ[kind]
    expected = make_grain("a", POINTS * 1e-3)
    grain = read(tmp_path, name, "\n".join(rows) + "\n")
    assert (grain.L, grain.I, grain.S) == (expected.L, expected.I, expected.S)


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8-sig", "utf-16"])
def test_encodings(tmp_path, encoding):
    grain = read(tmp_path, "a.csv", "\n".join(["x (Länge),y,z", *lines()]), encoding)
    assert grain.volume == make_grain("a", POINTS * 1e-3).volume


def test_columns_that_are_not_used_are_noted(tmp_path):
    grain = read(tmp_path, "a.csv", "\n".join(["id,x,y,z,density", *lines(before=["1"], after=["2"])]))
    assert grain.notes == ("was read from the columns x, y, z; not used: id, density",)


WRONG = {
    "four columns": (lines(before=["128"]), "4 columns and no header"),
    "no number": (["x,y,z", *lines()[:6], "1,two,3"], "row 8, column y: 'two' is not a number"),
    "empty field": (["x,y,z", *lines()[:6], "1,,3"], "row 8, column y: '' is not a number"),
    "thousands": (["x,y,z", *lines()[:6], '"1,234.5",2,3'], "row 8, column x: '1,234.5' is not a number"),
    "NaN": (["x,y,z", "nan,1,2", *lines()], "row 2, column x: 'nan' is NaN"),
    "short row": (["x,y,z", *lines()[:6], "1,2"], "row 8 has 2 fields, not 3"),
    "decimal commas between commas": (["x,y,z", *lines()[:6], "1,5,2,5,3,5"], "row 8 has 6 fields.*with a point"),
    "x twice": (["x,y,z,X", *lines(after=["1"])], "names x twice"),
    "no z": (["x,y,depth", *lines()], "names no column z"),
    "velocities": (["x_velocity,y_velocity,z_velocity", *lines()], "names no column x, y, z"),
    "count is wrong": ([str(len(POINTS) + 3), *lines()], "counts 63 points, but 60 follow"),
    "other unit": (["x_cm,y_cm,z_cm", *lines()], "header gives x_cm, but `grains.unit` is mm"),
    "empty": (["x,y,z"], "contains no points"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_cannot_be_read_is_named_with_row_and_column(tmp_path, kind):
    rows, reason = WRONG[kind]
    with pytest.raises(ValueError, match=rf"a\.csv: .*{reason}") as error:
        read(tmp_path, "a.csv", "\n".join(rows))
    assert "\n" not in str(error.value) and "numpy" not in str(error.value)


AXES = np.random.default_rng(3).uniform([5, 3, 1], [8, 5, 3], (40, 3))


def table_of_axes(header, columns, mark=","):
    return "\n".join([header, *(mark.join(f"{value:.6f}" for value in row) for row in columns)])


@pytest.mark.parametrize("name", ["a.csv", "a.txt", "a.xyz", "a.tsv"])
@pytest.mark.parametrize("header", ["L,I,S", "L [mm],I [mm],S [mm]", "L_mm,I_mm,S_mm", "FL,EL"])
def test_a_table_of_axes_is_refused_with_its_statistics(tmp_path, name, header):
    FL, EL = AXES[:, 2] / AXES[:, 1], AXES[:, 1] / AXES[:, 0]
    columns = np.column_stack([FL, EL]) if header == "FL,EL" else AXES
    with pytest.raises(ValueError, match=rf"{name}.*choice: form_distribution") as error:
        read(tmp_path, name, table_of_axes(header, columns))
    assert f"flatness: {{mean: {FL.mean():.3f}, std: {FL.std():.3f}}}" in str(error.value)
    assert f"elongation: {{mean: {EL.mean():.3f}, std: {EL.std():.3f}}}" in str(error.value)


@pytest.mark.parametrize(
    "header", ["a,b,c", "A (mm),B (mm),C (mm)", "length,width,thickness", "nr;L;I;S", "mu_FL,mu_EL"]
)
def test_other_tables_of_axes_are_refused(tmp_path, header):
    mark = ";" if ";" in header else ","
    rows = np.column_stack([np.arange(40), AXES]) if "nr" in header else AXES[:, : header.count(mark) + 1]
    with pytest.raises(ValueError, match=r"a\.csv.*form_distribution"):
        read(tmp_path, "a.csv", table_of_axes(header, rows, mark))


def test_forms_that_are_not_packed_are_named(tmp_path):
    with pytest.raises(ValueError, match=r"flatness: \{mean: 0\.0\d+, .*means below 0\.1 are not packed"):
        read(tmp_path, "a.csv", table_of_axes("L,I,S", AXES * [1, 1, 0.08]))


def test_axes_without_header_are_no_cloud(tmp_path):
    text = "\n".join(",".join(f"{value:.3f}" for value in row) for row in AXES)
    with pytest.raises(ValueError, match="like a table of axes"):
        read(tmp_path, "a.csv", text)
    # With the header x,y,z the same numbers are points.
    expected = make_grain("a", np.round(AXES, 3) * 1e-3)
    assert read(tmp_path, "a.csv", "x,y,z\n" + text).volume == pytest.approx(expected.volume)


def test_a_spreadsheet_is_refused_with_the_way_to_do_it(tmp_path):
    (tmp_path / "a.xlsx").write_bytes(b"PK\x03\x04")
    with pytest.raises(ValueError, match=r"a\.xlsx.*form_distribution"):
        read_grain(tmp_path / "a.xlsx", "mm")


@pytest.mark.parametrize("far", [5.4e6, 512345.0])
def test_a_cloud_too_far_from_the_origin_for_its_precision_is_refused(tmp_path, far):
    moved = (POINTS + [far, far, 0]).astype(np.float32 if far > 1e6 else float)
    np.savetxt(tmp_path / "a.csv", moved, "%.0f" if far < 1e6 else "%.6f", ",", header="x,y,z", comments="")
    with pytest.raises(ValueError, match=r"a\.csv.*too far from the origin.*shift them"):
        read_grain(tmp_path / "a.csv", "mm")


def test_a_cloud_far_from_the_origin_is_read_where_its_digits_suffice(tmp_path):
    np.savetxt(tmp_path / "a.csv", POINTS + 5000.0, "%.4f", ",", header="x,y,z", comments="")
    assert read_grain(tmp_path / "a.csv", "mm").L == pytest.approx(make_grain("a", POINTS * 1e-3).L, rel=1e-6)


def test_a_table_of_axes_beside_scans_is_left_out_of_their_folder(tmp_path):
    (tmp_path / "a.csv").write_text("\n".join(["x,y,z", *lines()]))
    (tmp_path / "axes.csv").write_text(table_of_axes("L,I,S", AXES))
    assert [grain.name for grain in read_grain_files(tmp_path, "mm")] == ["a"]

"""Tables with two axes only: a range over the third axis, never a number; exports of programs for photos and clouds."""

import json

import pandas as pd
import pytest

from simcore.__main__ import main
from simcore.grains.measured_forms import Sample, read_measured, read_two_axes
from simcore.grains.statistics import equancy_statistics
from simcore.models.fitting import fit_reference_models
from simcore.models.prediction import predict_samples
from simcore.models.two_axes import predict_two_axes, two_axes_text
from simcore.reference.r22_tables import read_r22_table

GRAINS = "sample,a [mm],b [mm]\nbar,40,24\nbar,30,24\nchute,20,13\nchute,25,20\n"
# The lines that PebbleCounts.py and PebbleCountsAuto.py write (github.com/bpurinton/PebbleCounts).
PEBBLECOUNTS = """PebbleCounts Parameters
otsu_threshold,cutoff,percent_overlap,misfit_threshold,min_size_threshold,first_nl_denoise,tophat_th,sobel_th,canny_sig
50,9,15,30,2,5,90,90,2

Image Details
perc. not meas.,perc. background color
31.7,4.2

Pebble Details
a (px),b (px),a (m),b (m),area (px),area (m2),orientation,ellipse area (px),perc. diff. area
40,24,0.040,0.024,750,0.00075,0.1,754,0.5
30,24,0.030,0.024,560,0.00056,-0.1,565,0.9
"""


@pytest.fixture(scope="module")
def fitted():
    return fit_reference_models()


@pytest.fixture
def write(tmp_path):
    def write_text(text, name="photo.csv"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write_text


def test_two_axes_give_elongation_and_samples(write):
    samples, notices = read_two_axes(write(GRAINS))
    assert [(s.name, s.grains) for s in samples] == [("bar", 2), ("chute", 2)]
    assert (samples[0].mu_EL, samples[0].sigma_EL) == (pytest.approx(0.7), pytest.approx(0.1))
    assert notices == []
    same, _ = read_two_axes(write("Major axis (px);Minor axis (px);count\n40;24;1\n30;24;1\n"))
    assert (same[0].mu_EL, same[0].sigma_EL, same[0].grains) == (pytest.approx(0.7), pytest.approx(0.1), 2)
    alike, _ = read_two_axes(write("a,b\n40,24\n20,12\n"))
    assert (alike[0].mu_EL, alike[0].sigma_EL) == (pytest.approx(0.6), 0.0)


def test_other_tables_are_not_of_two_axes(write):
    for header in ("a,b,c", "FL,EL", "mean_FL,std_FL,mean_EL,std_EL", "long,short"):
        assert read_two_axes(write(f"{header}\n")) is None
    with pytest.raises(ValueError, match="the column I is missing beside long, short"):
        read_measured(write("long,short\n4,1\n"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n2,3\n", "row 2: L = 2, I = 3; L >= I is needed: sort the axes"),
        ("a,b\n2,0\n", "row 2: I = 0 is not positive"),
        ("a,b\n200,1\n", "row 2: L = 200 is 200 times I = 1"),
        ("a [mm],b [cm]\n2,1\n", r"mixes units \(L in mm, I in cm\); give both axes in one unit"),
        ("a,long,b\n2,2,1\n", "the columns a and long are both L; remove one"),
        ("a,b\n", "there are no rows below the header"),
    ],
)
def test_wrong_axes_are_refused(write, text, message):
    with pytest.raises(ValueError, match=f"photo.csv.*{message}"):
        read_two_axes(write(text))


def test_the_range_is_that_of_the_predictions_at_each_flatness(write, fitted):
    samples, _ = read_two_axes(write(GRAINS))
    row = predict_two_axes(samples, "U1", fitted).iloc[0]
    n, lower, upper = [], [], []
    for form in read_r22_table("table2_form_statistics").itertuples():
        mu_EQ, sigma_EQ = equancy_statistics(form.mu_FL, form.sigma_FL, 0.7, 0.1)
        sample = Sample("x", 2, form.mu_FL, form.sigma_FL, 0.7, 0.1, mu_EQ, sigma_EQ)
        best = predict_samples([sample], "U1", fitted).query("preferred").iloc[0]
        for values, value in ((n, best.n), (lower, best.lower), (upper, best.upper)):
            values.append(value)
    assert (row.n_low, row.n_high) == pytest.approx((min(n), max(n)), rel=1e-9)
    assert (row.lower, row.upper) == pytest.approx((min(lower), max(upper)), rel=1e-9)
    assert row.n_high - row.n_low > 0.02
    assert (row.flatness_low, row.flatness_high) == (0.357, 0.790)
    assert "n" not in row and "preferred" not in row


def test_a_case_without_our_mixtures_has_the_model_of_the_paper_without_interval(write, fitted):
    samples, _ = read_two_axes(write("a,b\n40,24\n30,24\n"))
    table = predict_two_axes(samples, "U7", fitted)
    assert table.n_low.notna().all() and table.lower.isna().all()
    with pytest.raises(ValueError, match="case U2: there is no model for it"):
        predict_two_axes(samples, "U2", fitted)


def test_a_sample_without_a_model_is_listed_beside_the_others(write, fitted):
    narrow, _ = read_two_axes(write("a,b\n200,130\n250,163\n"))
    with pytest.raises(ValueError, match="sample photo: no model can be evaluated at any flatness: 1/std. dev. EL"):
        predict_two_axes(narrow, "U7", fitted)
    both, _ = read_two_axes(write("sample,a,b\nnarrow,200,130\nnarrow,250,163\nwide,40,24\nwide,30,24\n"))
    table = predict_two_axes(both, "U7", fitted)
    assert table.refused[0].startswith("1/std. dev. EL") and table.refused[1] == ""
    assert table[["n_low", "n_high", "flatness_low"]].isna().all(axis=1).tolist() == [True, False]
    lines = two_axes_text(table, "U7").splitlines()
    assert next(line for line in lines if line.startswith("narrow")).count("  -") == 3
    assert any(line.startswith("  narrow: 1/std. dev. EL") for line in lines)
    assert json.loads(two_axes_text(table, "U7", output="json"))["samples"][0]["n_low"] is None


def test_an_export_of_pebblecounts_gives_a_range_on_the_command_line(write, capsys):
    path = write(PEBBLECOUNTS)
    assert main(["predict", "--case", "U1", str(path)]) == 0
    printed = capsys.readouterr()
    assert printed.out.startswith("Range of the porosity of a bed, case U1") and "0.700 ± 0.100" in printed.out
    assert "a (px), b (px)" in printed.err
    assert main(["predict", "--case", "U1", "--json", str(path)]) == 0
    (row,) = json.loads(capsys.readouterr().out)["samples"]
    assert row["n_low"] < row["n_high"] and "n" not in row
    assert main(["predict", "--case", "U1", "--csv", str(path)]) == 0
    assert capsys.readouterr().out.startswith("sample,grains,mu_EL,sigma_EL,n_low,n_high,lower,upper,")
    wrong = write(PEBBLECOUNTS.replace("0.030,0.024", "0.030,0.034"))
    assert main(["predict", "--case", "U1", str(wrong)]) == 2
    assert "photo.csv, row 12: L = 0.03, I = 0.034; L >= I is needed" in capsys.readouterr().err


def test_an_export_of_pebblecounts_without_metres_is_read_in_pixels(write):
    text = PEBBLECOUNTS.replace(",a (m),b (m)", "").replace(",0.040,0.024", "").replace(",0.030,0.024", "")
    assert read_two_axes(write(text))[0][0].mu_EL == pytest.approx(0.7)


def test_an_export_of_g3point_has_three_axes(tmp_path):
    """The columns that exportgranulotoxls.m of G3Point writes; the three diameters are full axes."""
    pytest.importorskip("openpyxl")
    header = ["Ngrain", "Xc", "Yc", "Zc", "Dmax", "Dmed", "Dmin", "angle_Mview", "angle_Xview"]
    rows = [[1, 0.1, 0.2, 0.3, 0.05, 0.04, 0.02, 10.0, 20.0], [2, 0.4, 0.2, 0.3, 0.04, 0.02, 0.015, 30.0, 40.0]]
    pd.DataFrame(rows, columns=header).to_excel(tmp_path / "cloud_granulo.xlsx", index=False)
    (sample,), notices = read_measured(tmp_path / "cloud_granulo.xlsx")
    assert (sample.grains, sample.mu_FL, sample.mu_EL) == (2, pytest.approx(0.625), pytest.approx(0.65))
    assert "Ngrain, Xc, Yc, Zc, angle_Mview, angle_Xview" in notices[0]


def test_a_sheet_of_libreoffice_is_read(tmp_path):
    pytest.importorskip("odf")
    frame = pd.DataFrame({"a [mm]": [40.0, 30.0], "b [mm]": [20.0, 24.0], "c [mm]": [10.0, 12.0]})
    frame.to_excel(tmp_path / "bed.ods", index=False, engine="odf")
    (sample,), _ = read_measured(tmp_path / "bed.ods")
    assert (sample.mu_FL, sample.mu_EL) == (pytest.approx(0.5), pytest.approx(0.65))
    (tmp_path / "bed.ods").rename(tmp_path / "bed.csv")  # the content determines the type, not the name
    assert read_measured(tmp_path / "bed.csv")[0][0].mu_EL == pytest.approx(0.65)
    (tmp_path / "bad.ods").write_bytes(b"PK\x03\x04" + bytes(50))
    with pytest.raises(ValueError, match="bad.ods: the file cannot be read as an OpenDocument sheet"):
        read_measured(tmp_path / "bad.ods")


def test_a_case_without_a_model_of_distributions_needs_a_third_axis_and_a_sieve_curve(write, fitted):
    """The flatness is assumed to vary, so that the grains never have one form."""
    samples, _ = read_two_axes(write(GRAINS))
    remedy = "measure the third axis too, and use predict --sieve B50"
    with pytest.raises(ValueError, match=f"case B50, sample bar: .*no model was fitted to beds of B50 .*{remedy}"):
        predict_two_axes(samples, "B50", fitted)

"""Measured forms: what is read from which columns, and one clear line for what is wrong."""

import numpy as np
import pytest

from simcore.grains.measured_forms import read_samples


@pytest.fixture
def read(tmp_path):
    def read_text(text, column=None):
        (tmp_path / "bed.csv").write_text(text, encoding="utf-8")
        return read_samples(tmp_path / "bed.csv", column)

    return read_text


def test_axes_are_grains_in_any_unit(read):
    (sample,) = read("grain,L,I,S\na,4,2,1\nb,30,20,15\n")
    assert (sample.name, sample.grains, sample.one_form) == ("bed", 2, False)
    fl, el = np.array([0.5, 0.75]), np.array([0.5, 2 / 3])
    assert (sample.mu_FL, sample.sigma_FL) == pytest.approx((fl.mean(), fl.std()))
    assert (sample.mu_EQ, sample.sigma_EQ) == pytest.approx(((fl * el).mean(), (fl * el).std()))
    for header in ("L [mm],I [mm],S [mm]", "L_mm,I_mm,S_mm", "l (mm),i (mm),s (mm)"):
        assert read(header + "\n4,2,1\n30,20,15\n") == [sample]
    assert read("L;I;S\n4,0;2,0;1,0\n\n30;20;15\n") == [sample]
    assert read("\ufeffS\tI\tL\n1\t2\t4\n15\t20\t30\n") == [sample]


def test_flatness_and_elongation_are_grains_and_alike_ones_are_one_form(read):
    (sample,) = read("FL,EL\n0.5,0.7\n0.5,0.7\n0.5,0.7\n")
    assert sample.one_form and (sample.mu_EQ, sample.sigma_EQ) == (pytest.approx(0.35), 0.0)
    assert not read("FL,EL\n0.5,0.7\n0.5,0.71\n")[0].one_form


def test_a_column_tells_samples_apart(read):
    text = "site,sample,FL,EL\nx,a,0.5,0.7\ny,b,0.6,0.8\nx,b,0.7,0.9\n"
    assert [(s.name, s.grains) for s in read(text)] == [("a", 1), ("b", 2)]
    assert [(s.name, s.grains) for s in read(text, "site")] == [("x", 2), ("y", 1)]


@pytest.mark.parametrize("names", ["mean_FL,std_FL,mean_EL,std_EL", "mu_FL,sigma_FL,mu_EL,sigma_EL"])
def test_statistics_are_samples_of_independent_flatness_and_elongation(read, names):
    first, second = read(names + "\n0.6,0.1,0.7,0.2\n0.6,0,0.7,0\n")
    assert (first.name, first.grains, first.one_form) == ("row 2", 0, False)
    assert first.mu_EQ == pytest.approx(0.42)
    assert first.sigma_EQ**2 == pytest.approx((0.36 + 0.01) * (0.49 + 0.04) - 0.42**2)
    assert second.one_form and second.sigma_EQ == 0.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "bed.csv: is empty; give the columns L, I, S"),
        ("L,I,S\n", "bed.csv: there are no rows below the header"),
        ("L,I\n4,2\n", "the column S is missing beside L, I"),
        ("FL\n0.5\n", "the column EL is missing beside FL"),
        ("mean_FL,mean_EL\n0.5,0.5\n", "the column std_FL, std_EL is missing beside mean_FL, mean_EL"),
        ("a,b\n1,2\n", r"none of its columns \(a, b\) is a form"),
        ("L,I,S\n4,2,1\n\n2,4,1\n", "row 4: L = 2, I = 4, S = 1; L >= I >= S is needed: sort the axes"),
        ("L,I,S\n4,2,0\n", "row 2: S = 0 is not positive"),
        ("L [mm],I [cm],S [mm]\n4,2,1\n", r"the header mixes units \(L in mm, I in cm, S in mm\)"),
        ("L,I,S\n0.04,0.02,0.0001\n", "row 2: L = 0.04 is 400 times S = 0.0001, .* give all axes in one unit"),
        ("L,L [mm],I,S\n4,4,2,1\n", "the columns L and L .mm. are both L"),
        ("L,I,S\n4 mm,2,1\n", "row 2: L is '4 mm'; a number is needed, its unit, if any, in the header"),
        ("L,I,S\n4,,1\n", "row 2: I is ''; a number is needed"),
        ("L,I,S\n4,nan,1\n", "row 2: I is nan; a finite number is needed"),
        ("L,I,S\n4,2\n", "row 2: 2 fields where the header has 3"),
        ("FL,EL\n0.5,1.5\n", r"row 2: EL = 1.5 is not in \(0, 1\]; FL is S/I and EL is I/L, not their inverses"),
        ("FL,EL\n0,0.5\n", r"row 2: FL = 0 is not in \(0, 1\]"),
        ("FL,EL\n0.05,0.1\n", "row 2: FL = 0.05, EL = 0.1 give L/S above 100"),
        ("mean_FL,std_FL,mean_EL,std_EL\n64.7,17,68,14\n", r"row 2: mean_FL = 64.7 is not in \(0, 1\]"),
        ("mean_FL,std_FL,mean_EL,std_EL\n0.6,0.6,0.7,0.1\n", "row 2: std_FL = 0.6; with a mean of 0.6 .* 0 and 0.49"),
        ("mean_FL,std_FL,mean_EL,std_EL\n0.6,-0.1,0.7,0.1\n", "row 2: std_FL = -0.1"),
        ("sample,FL,EL\n,0.5,0.5\n", "row 2: sample is empty"),
        (
            "sample,mean_FL,std_FL,mean_EL,std_EL\na,0.6,0,0.7,0\na,0.6,0,0.7,0\n",
            "row 3: sample a is there twice",
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_line(read, text, message):
    with pytest.raises(ValueError, match=message) as error:
        read(text)
    assert "\n" not in str(error.value) and "bed.csv" in str(error.value)


def test_a_missing_file_and_a_missing_column(read, tmp_path):
    with pytest.raises(ValueError, match="none.csv: there is no such file"):
        read_samples(tmp_path / "none.csv")
    with pytest.raises(ValueError, match="there is no column site to tell samples apart; there are FL, EL"):
        read("FL,EL\n0.5,0.5\n", "site")
    (tmp_path / "bed.xlsx").write_bytes(b"PK\x03\x04\xff\xfe")
    with pytest.raises(ValueError, match="bed.xlsx: is no text in UTF-8"):
        read_samples(tmp_path / "bed.xlsx")

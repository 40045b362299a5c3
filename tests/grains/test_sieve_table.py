"""Tables of sieve curves: what is read from which columns, what is corrected with a notice, and what is refused."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.sieve_table import read_curve, read_sieve_table
from tests.helpers.table_cases import SAME_SIEVES, SIEVES, assert_words

OPENINGS = [2, 4, 8, 16]  # mm
PASSING = [0.1, 0.4, 0.8, 1.0]
MASSES = "opening [mm],mass [g]\n16,0\n8,20\n4,40\n2,30\npan,10\n"


@pytest.fixture
def read(tmp_path):
    def read_text(text, **options):
        (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
        table, notices = read_sieve_table(tmp_path / "curve.csv", **options)
        return table, [notice.removeprefix(f"{tmp_path}/curve.csv: ") for notice in notices]

    return read_text


def assert_expected(table):
    np.testing.assert_allclose(table.openings, np.array(OPENINGS) * 1e-3, rtol=1e-12)
    np.testing.assert_allclose(table.passing, PASSING, atol=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        MASSES,
        "mass [g],opening [mm]\n10,pan\n30,2\n40,4\n20,8\n0,16\n",  # from fine to coarse
        "phi,weight (kg)\n-4,0\n-3,0.02\n-2,0.04\n-1,0.03\npan,0.01\n",
        "Sieve size (µm);Retained (%)\n16000;0\n8000;20,0\n4000;40,0\n2000;30,0\nPan;10,0\n",
        "size\tpercent retained\n1.6 cm\t0 %\n8 mm\t20 %\n4 mm\t40 %\n2000 um\t30 %\npan\t10 %\n",
        "D_mm,% passing\n16,100\n8,80\n4,40\n2,10\n",
        "D_mm,% passing\n16,100\n8,80\n4,40\n2,10\npan,\n",
        "opening [phi],finer [%]\n-1,10\n-2,40\n-3,80\n-4,100\n",
        "mesh [in],cumulative retained [%]\n0.62992126,0\n0.31496063,20\n0.157480315,60\n0.0787401575,90\npan,100\n",
        "opening [mm],cum. mass retained [g]\n16,0\n8,20\n4,60\n2,90\npan,100\n",
        "opening [mm],mass fraction\n16,0\n8,0.2\n4,0.4\n2,0.3\n0,0.1\n",
        "mm,g\n16,0\n8,20\n4,40\n2,30\n< 2,10\nTotal,100\n",
        "opening [mm],mass [g],passing [%]\n16,0,100\n8,20,80\n4,40,40\n2,30,10\npan,10,0\n",
    ],
)
def test_a_curve_is_the_same_however_it_is_written(read, text):
    table, _ = read(text)
    np.testing.assert_allclose(table.openings, np.array(OPENINGS) * 1e-3, rtol=1e-7)
    np.testing.assert_allclose(table.passing, PASSING, atol=1e-9)
    assert table.below == pytest.approx(0.1) and table.above == 0.0


@pytest.mark.parametrize(("classes", "sieves"), SAME_SIEVES)
def test_a_table_of_classes_is_one_of_sieves(read, classes, sieves):
    of_classes, notices = read(classes)
    of_sieves, _ = read(sieves)
    np.testing.assert_allclose(of_classes.openings, of_sieves.openings, rtol=1e-12)
    np.testing.assert_allclose(of_classes.passing, of_sieves.passing, atol=1e-15)
    assert of_classes.mass == of_sieves.mass
    assert not any("finer grains were weighed" in notice for notice in notices) or "pan" not in sieves


def test_a_workbook_and_a_byte_order_mark_are_read(tmp_path):
    frame = pd.DataFrame({"opening [mm]": [16, 8, 4, 2, "pan"], "mass [g]": [0, 20, 40, 30, 10]})
    frame.to_excel(tmp_path / "curve.xlsx", index=False)
    assert_expected(read_sieve_table(tmp_path / "curve.xlsx")[0])
    (tmp_path / "curve.csv").write_text(MASSES, encoding="utf-8-sig")
    assert_expected(read_sieve_table(tmp_path / "curve.csv")[0])


def test_a_class_exercise_of_the_literature_has_its_printed_percentages(read):
    """J. Anderson, Georgia Perimeter College: Example of Sieve Analysis Data Calculations, upper sand, GA 88."""
    table, _ = read("phi,weight [g]\n-1,2.95\n0,4.95\n1,13.36\n2,9.55\n3,2.13\n4,0.46\npan,0.02\n")
    retained = 100 * np.diff(np.r_[table.passing, 1.0])[::-1]
    assert [f"{share:.2f}" for share in retained] == ["8.83", "14.81", "39.98", "28.58", "6.37", "1.38"]
    assert [f"{share:.2f}" for share in np.cumsum(retained)] == ["8.83", "23.64", "63.61", "92.19", "98.56", "99.94"]
    assert table.mass == pytest.approx(33.42e-3)


def test_harmless_faults_are_corrected_with_a_notice(read):
    for text, notice in (
        ("opening [mm],retained [%]\n16,0\n8,20\n4,40\n2,30.3\npan,10\n", "sums to 100.3 instead of 100"),
        ("opening [mm],passing [%]\n16,99.8\n8,80\n4,40\n2,10\n", "99.8 % pass the coarsest sieve instead of 100 %"),
        ("opening [mm],passing\n16,1\n8,.8\n4,.4\n2,.1\n", "the column passing is taken as a fraction"),
        (
            "opening [mm],retained\n16,0\n8,2\n4,4\n2,3\npan,1\n",
            "no unit; its values are taken relative to their sum, 10",
        ),
        (MASSES + "Sum,100\n", r"row 7 (Sum) is no sieve and is left out"),
        (
            "opening [mm],mass [g],passing [%]\n16,0,100\n8,20,80\n4,40,40\n2,30,10\npan,10,0\n",
            "agree; mass [g] is used",
        ),
        ("opening [mm],mass [g],remark\n16,0,a\n8,20,\n4,40,\n2,30,\npan,10,b\n", "columns that are not used: remark"),
    ):
        table, notices = read(text)
        assert any(notice in text for text in notices), (notice, notices)
        np.testing.assert_allclose(table.passing, PASSING, atol=0.005)


@pytest.mark.parametrize(
    "totals", ["Sum,1410", "Sum,1.410", "Sum,1400", "Total,1390", "Sum,", "Total of sand,300\nSum,1410"]
)
def test_a_total_that_agrees_gives_no_notice(read, totals):
    """One total agrees within what sieving loses, whatever its separator of thousands; others may be of a part."""
    _, notices = read(f"opening [mm],mass [g]\n16,0\n8,410\n4,700\n2,290\npan,10\n{totals}\n")
    assert not any("the other rows sum to" in text for text in notices)


@pytest.mark.parametrize("totals", ["Sum,1250", "Sum,1.600", "grand total,1300"])
def test_a_total_that_differs_gives_a_notice(read, totals):
    _, notices = read(f"opening [mm],mass [g]\n16,0\n8,410\n4,700\n2,290\npan,10\n{totals}\n")
    assert sum("the other rows sum to 1410; if a sieve or class is missing" in text for text in notices) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty; give a column of sieve openings"),
        ("opening [mm],mass [g]\n", "there are no rows below the header"),
        ("a,b\n1,2\n", r"none of the columns \(a, b\) has sieve openings"),
        ("opening [mm],colour\n1,2\n", "has amounts; give a column of sieve openings"),
        ("opening [mm],D [mm],mass [g]\n1,1,2\n", r"opening \[mm\] and D \[mm\] are both sieve openings; remove one"),
        ("opening [mm],mass [g],weight [kg]\n1,2,3\n", r"mass \[g\] and weight \[kg\] are both the amount retained"),
        (
            "opening [furlong],mass [g]\n1,2\n",
            r"opening \[furlong\] has the unknown unit 'furlong'; .* m, cm, mm, µm, in",
        ),
        ("opening [g],mass [g]\n1,2\n", "is in g, but sieve openings are a length"),
        ("opening [mm],mass [mm]\n1,2\n", "is in mm, but amounts are masses or percent"),
        ("opening,mass [g]\n16,0\n8,20\n", "the unit of the column opening is missing, and units are never guessed"),
        ("opening,mass [g]\n16 ells,0\n8 mm,20\n", "row 2: opening is '16 ells'; its unit is unknown"),
        ("opening [mm],cumulative [%]\n16,0\n8,20\n", "may be passing or retained"),
        ("opening [mm],mass [g]\n16,0\n4,20\n8,30\n", "row 4: the opening 8 mm follows 4 mm; order the sieves"),
        ("opening [mm],mass [g]\n16,0\n8,20\n8,30\n", "row 4: the opening 8 mm follows 8 mm; .* each once"),
        ("opening [mm],mass [g]\n16,0\npan,20\npan,30\n", "row 4: this is a second pan, after row 3"),
        ("opening [mm],mass [g]\n16,0\npan,20\n", "the table has 1 sieve; at least two are needed"),
        ("opening [mm],mass [g]\n16,0\n8,-20\n4,30\n", r"row 3: mass \[g\] = -20 is negative"),
        ("opening [mm],mass [g]\n16,0\n8,\n4,30\n", r"row 3: mass \[g\] is empty; give the amount of every sieve"),
        ("opening [mm],mass [g]\n16,0\n8,0\n", r"all amounts in mass \[g\] are 0"),
        ("opening [mm],mass [g]\n16,0\n8,much\n", r"row 3: mass \[g\] is 'much'; a number is needed"),
        ("opening [mm],mass [g]\nNo. 4,0\n8,1\n", "row 2: .*a number of a sieve; give its opening instead, in mm"),
        ("opening [mm],mass [g]\n16,0\n-8,20\n", r"= -8 mm is negative; write \[phi\] if it is in phi"),
        ("opening [phi],mass [g]\n16000,0\n8000,20\n", "16000 phi is no sieve"),
        ("opening [mm],retained [%]\n16,0\n8,20\n4,40\n", r"retained \[%\] sums to 60, not to 100; .* a row `pan`"),
        (
            "opening [mm],retained [%]\n16,100\n8,80\n4,40\n",
            "sums to 220, not to 100; .* cumulative values need a name",
        ),
        (
            "opening [mm],passing [%]\n16,95\n8,20\n",
            "row 2: only 95 % pass the coarsest sieve, not 100 %; add the sieve",
        ),
        (
            "opening [mm],passing [%]\n16,0\n8,20\n4,100\n",
            "falls from fine to coarse sieves, the wrong way; is it `cumul",
        ),
        ("opening [mm],cumulative retained [%]\n16,100\n8,20\n4,0\n", "rises from fine to coarse .* is it `passing`"),
        (
            "opening [mm],passing [%]\n16,100\n8,20\n4,30\n",
            r"row 3: passing \[%\] = 20 beside 30 on the next finer sieve",
        ),
        ("opening [mm],passing [%]\n16,120\n8,20\n", r"row 2: passing \[%\] = 120 is more than the whole"),
        (
            "opening [mm],passing [%]\n16,100\n8,20\npan,20\n",
            r"row 4: passing \[%\] of the pan is 20, but nothing passes",
        ),
        ("opening [mm],mass [g],passing [%]\n16,0,100\n8,20,70\n4,80,0\n", "shares passing that differ by 10.0 %"),
    ],
)
def test_each_fault_has_one_line_that_says_what_to_do(read, text, message):
    with pytest.raises(ValueError, match=message) as error:
        read(text)
    assert "curve.csv" in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("case", SIEVES)
def test_each_case_that_the_page_shares_has_its_words(read, case):
    assert_words(case, lambda text: read(text)[1], "curve.csv")


def test_a_pan_is_only_missed_where_it_may_be_missing(read):
    for text in (
        MASSES,
        "opening [mm],mass [g],passing [%]\n16,0,100\n8,20,80\n4,80,0\n",
        "opening [mm],retained [%]\n16,0\n8,20\n4,80\n",
        "opening [mm],retained [%]\n16,0\n8,20\n4,79.7\npan,\n",
    ):
        assert not any("no row `pan`" in notice for notice in read(text)[1]), text


def test_masses_of_single_sieves_are_not_taken_for_sums(read):
    """The most is in the pan, in the middle, on three rows only, on each sieve alike, or another column agrees."""
    for text in (
        "opening [mm],mass [g]\n8,20\n4,40\n2,60\npan,90\n",
        "opening [mm],mass [g]\n16,0\n8,0\n4,0\n2,60\n1,60\npan,90\n",
        MASSES,
        "opening [mm],mass [g]\n8,10\n4,20\npan,21\n",
        "opening [mm],mass [g]\n16,10\n8,10\n4,10\npan,10\n",
        "opening [mm],mass [g]\n16,400\n8,300\n4,200\npan,100\n",
        "opening [mm],mass [g],passing [%]\n16,0,100\n8,20,80\n4,39,41\npan,41,0\n",
    ):
        assert not any("name the column" in notice for notice in read(text)[1]), text


def test_open_ends_are_closed_by_the_sizes_given(read):
    table, _ = read("opening [mm],mass [g]\n8,20\n4,40\n2,30\npan,10\n")
    assert (table.below, table.above) == (pytest.approx(0.1), pytest.approx(0.2))
    closed = table.closed(1e-3, 12e-3)
    np.testing.assert_allclose(closed.openings, [1e-3, 2e-3, 4e-3, 8e-3, 12e-3])
    np.testing.assert_allclose(closed.curve().mass_fractions, [0.1, 0.3, 0.4, 0.2])
    for arguments, message in (
        ((2e-3, None), "the finest grains, 2 mm, is not below the finest sieve, 2 mm"),
        ((None, 8e-3), "the coarsest grains, 8 mm, is not above the coarsest sieve, 8 mm"),
    ):
        with pytest.raises(ValueError, match=message):
            table.closed(*arguments)
    with pytest.raises(ValueError, match="10.0% of the mass pass the finest sieve, 2 mm; give .* --finest"):
        table.curve()
    with pytest.raises(ValueError, match="20.0% of the mass stay on the coarsest sieve, 8 mm; give .* --coarsest"):
        table.closed(1e-3).curve()
    table, _ = read("opening [mm],passing [%]\n8,80\n4,40\n2,0\n", coarsest=12e-3)
    np.testing.assert_allclose(table.closed(None, 12e-3).curve().mass_fractions, [0.4, 0.4, 0.2])


def test_classes_without_mass_at_the_ends_are_left_out_of_the_curve(read):
    table, _ = read("opening [mm],mass [g]\n32,0\n16,0\n8,20\n4,40\n2,0\n1,0\n")
    np.testing.assert_allclose(table.curve().bounds, [4e-3, 8e-3, 16e-3])


@pytest.mark.parametrize(
    "text, fault",
    [
        ("size [mm],mass [g]\n8,50\n", "the table has 1 sieve; at least two are needed"),
        ("size [mm],mass [g]\npan,50\n", "the table has no sieves; at least two are needed"),
        ("size [mm],passing [%]\n8,100\n4,0\n", "all of the mass is between 4 mm and 8 mm; at least two size classes"),
        ("size [mm],mass [g]\n8,0\n4,0\npan,9\n", "all of the mass passes 4 mm; at least two size classes"),
        ("size [mm],mass [g]\n8,5\n4,0\n", "all of the mass stays on 8 mm; at least two size classes"),
    ],
)
def test_fewer_than_two_classes_are_refused(tmp_path, text, fault):
    (tmp_path / "c.csv").write_text(text)
    with pytest.raises(ValueError, match="c.csv: " + fault):
        read_sieve_table(tmp_path / "c.csv")


def test_empty_sieves_above_the_coarsest_grains_add_no_class(read):
    """The sum of these masses in another order differs by a rounding error."""
    masses = {90: 0, 63: 0, 45: 2.4, 32: 0.1, 16: 3.6, 8: 1.6, 4: 6.2, 2: 2.9, 1: 3.4, "pan": 1.3}
    table, _ = read("opening [mm],mass [g]\n" + "".join(f"{size},{mass}\n" for size, mass in masses.items()))
    assert table.closed(5e-4).curve().largest == pytest.approx(0.063)


def test_the_size_of_an_end_without_grains_has_no_effect_and_a_notice(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text("opening [mm],passing [%]\n16,100\n8,60\n4,0\n")
    curve, notices = read_curve(path, 2e-3, 0.032)
    assert curve.bounds.tolist() == [4e-3, 8e-3, 16e-3]
    assert notices[-2:] == [
        f"{path}: the size of the finest grains has no effect, because nothing passes 4 mm",
        f"{path}: the size of the coarsest grains has no effect, because all grains pass 16 mm",
    ]
    path.write_text("opening [mm],passing [%]\n16,99\n8,60\n4,5\n")
    assert not any("no effect" in notice for notice in read_curve(path, 2e-3, 0.032)[1])


def test_a_size_of_the_coarsest_grains_is_used_or_refused(read):
    sieves = "opening [mm],passing [%]\n16,99.6\n8,80\n4,40\n2,0\n"
    table, notices = read(sieves, coarsest=0.032)
    assert table.above == pytest.approx(0.004) and not notices
    closed = table.closed(None, 0.032)
    np.testing.assert_allclose(closed.openings, np.array([2, 4, 8, 16, 32]) * 1e-3)
    with pytest.raises(
        ValueError, match="what stays on the coarsest sieve is unknown; give it in percent, or leave out"
    ):
        read("opening [mm],passing [g]\n16,950\n8,400\n4,50\n", coarsest=0.032)

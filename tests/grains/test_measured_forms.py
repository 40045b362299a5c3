"""Measured forms: the columns that are read, and errors of one clear line."""

import numpy as np
import pytest

from simcore.grains.measured_forms import read_measured, read_samples
from simcore.grains.statistics import equancy_statistics, means_covariance
from tests.helpers.table_cases import GRAINS, assert_words


@pytest.fixture
def read(tmp_path):
    def read_text(text, column=None):
        (tmp_path / "bed.csv").write_text(text, encoding="utf-8")
        return read_samples(tmp_path / "bed.csv", column)

    return read_text


@pytest.fixture
def notices_of(tmp_path):
    """Return a function that returns the samples and notices of a text, without the folder's name."""

    def read_text(text, column=None):
        (tmp_path / "bed.csv").write_text(text, encoding="utf-8")
        samples, notices = read_measured(tmp_path / "bed.csv", column)
        return samples, [notice.removeprefix(f"{tmp_path}/") for notice in notices]

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


def test_a_column_separates_samples(read):
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
        ("", "bed.csv: the file is empty; give the columns L, I, S"),
        ("L,I,S\n", "bed.csv: there are no rows below the header"),
        ("L,I\n4,2\n", "the column S is missing beside L, I"),
        ("FL\n0.5\n", "the column EL is missing beside FL"),
        (
            "mean_FL,mean_EL\n0.5,0.5\n",
            "the columns std_FL, std_EL are missing beside mean_FL, mean_EL .if they were not measured, give those of "
            "similar grains",
        ),
        ("flatness,elongation\n0.5,0.5\n", "flatness and elongation may be defined in several ways; .* FL and EL"),
        ("L,I,S,Length\n4,2,1,4\n", "the columns L and Length are both L"),
        ("L [furlong],I [furlong],S [furlong]\n3,2,1\n", r"L \[furlong\] has the unknown unit 'furlong'; axes are in"),
        ("x,y\n1,2\n", r"none of its columns \(x, y\) is an axis or a form"),
        ("a,b\n2,1\n", "the column S is missing beside a, b"),
        ("4,2,1\n5,3,2\n", r"the first row \(4, 2, 1\) contains numbers where the names of the columns are needed"),
        ("FL,EL,FL\n0.5,0.5,0.6\n", "two columns are named FL; remove or rename one"),
        ("FL,S/I,EL\n0.5,0.6,0.5\n", "the columns FL and S/I are both FL; remove one"),
        ("L,I,S,a (mm)\n4,2,1,4\n", r"the columns L and a \(mm\) are both L; remove one"),
        ("long,L,I,S\n4,4,2,1\n", "the columns long and L are both L; remove one"),
        ("mean_FL,mu_FL,std_FL,mean_EL,std_EL\n.6,.6,0,.7,0\n", "the columns mean_FL and mu_FL are both mean_FL"),
        ("sample,sample,FL,EL\na,b,0.5,0.5\n", "two columns are named sample"),
        ("count,n,FL,EL\n1,1,0.5,0.5\n", "the columns count and n are both the number of grains; remove one"),
        ("FL [%],EL [%]\n50,50\n", r"the column FL \[%\] is in percent; give FL as a fraction"),
        ("FL,EL\n50%,50%\n", "row 2: FL is '50%'; give a fraction"),
        ("FL,EL\n65,70\n", r"row 2: FL = 65 is not in \(0, 1\]; .* or percent"),
        ("L,I,S\n1_0,2,1\n", "row 2: L is '1_0'; a number is needed"),
        ('L,I,S\n"1,234.5",2,1\n', "row 2: L is '1,234.5'; a number is needed, without separators of thousands"),
        (
            "L,I,S\n50,5,40,1,27,3\n",
            "row 2: the row has 6 fields, but the header has 3; .* decimals with a point",
        ),
        ("L,I,S\nmm,mm,x\n4,2,1\n", "row 2: L is 'mm'; a number is needed; enter it, or remove the row"),
        ("L,I,S,count\n4,2,1,-1\n", "row 2: count = -1; a number of grains must be between 0 and 1e12"),
        ("L,I,S,count\n4,2,1,\n", "row 2: count is ''; a number is needed"),
        ("L,I,S,count\n4,2,1,few\n", "row 2: count is 'few'; a number is needed"),
        ("L,I,S,count\n4,2,1,0\n", "the numbers of grains of sample bed are all 0"),
        ('L,I,S,count\n4,2,1,"1,234"\n', "row 2: count is 1,234; write it without a separator of thousands"),
        ("L;I;S;count\n4,5;2;1;1.250\n", "row 2: count is 1.250; write it without a separator of thousands"),
        ("grain,FL,EL\nMean,0.5,0.5\nMax,0.6,0.6\n", r"all rows summarise others \(row 2 \(Mean\), row 3 \(Max\)\)"),
        ("L,I,S\n4,2,1\n\n2,4,1\n", "row 4: L = 2, I = 4, S = 1; L >= I >= S is needed: sort the axes"),
        ("L,I,S\n4,2,0\n", "row 2: S = 0 is not positive"),
        ("L [mm],I [cm],S [mm]\n4,2,1\n", r"the header mixes units \(L in mm, I in cm, S in mm\)"),
        ("L,I,S\n0.04,0.02,0.0001\n", "row 2: L = 0.04 is 400 times S = 0.0001, .* give all axes in one unit"),
        ("L,L [mm],I,S\n4,4,2,1\n", "the columns L and L .mm. are both L"),
        ("L,I,S\n4 mm,2,1\n", "row 2: L is '4 mm'; a number is needed; write its unit, if any, in the header"),
        ("L,I,S\n4,,1\n", "row 2: I is empty; measure it, or remove the row"),
        ("L,I,S\n4,nan,1\n", "row 2: I is nan; a finite number is needed"),
        ("L,I,S\n4,2\n", "row 2: the row has 2 fields, but the header has 3"),
        (
            "FL,EL\n0.5,1.5\n",
            r"row 2: EL = 1.5 is not in \(0, 1\]; FL is S/I and EL is I/L; .* inverses",
        ),
        ("FL,EL\n0,0.5\n", r"row 2: FL = 0 is not in \(0, 1\]"),
        ("FL,EL\n0.05,0.1\n", "row 2: FL = 0.05, EL = 0.1 give L/S above 100"),
        ("mean_FL,std_FL,mean_EL,std_EL\n64.7,17,68,14\n", r"row 2: mean_FL = 64.7 is not in \(0, 1\]"),
        ("mean_FL,std_FL,mean_EL,std_EL\n0.6,0.6,0.7,0.1\n", "row 2: std_FL = 0.6; with a mean of 0.6 .* 0 and 0.49"),
        ("mean_FL,std_FL,mean_EL,std_EL\n0.6,-0.1,0.7,0.1\n", "row 2: std_FL = -0.1"),
        ("sample,FL,EL\n,0.5,0.5\n", "row 2: sample is empty"),
        (
            "sample,mean_FL,std_FL,mean_EL,std_EL\na,0.6,0,0.7,0\na,0.6,0,0.7,0\n",
            "row 3: sample a occurs twice",
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_line(read, text, message):
    with pytest.raises(ValueError, match=message) as error:
        read(text)
    assert "\n" not in str(error.value) and "bed.csv" in str(error.value)


@pytest.mark.parametrize("case", GRAINS)
def test_each_case_that_the_page_shares_has_its_words(notices_of, case):
    assert_words(case, lambda text: notices_of(text)[1], "bed.csv")


def test_a_missing_file_and_a_missing_column(read, tmp_path):
    with pytest.raises(ValueError, match="none.csv: there is no such file"):
        read_samples(tmp_path / "none.csv")
    with pytest.raises(ValueError, match="there is no column site to distinguish the samples; the columns are FL, EL"):
        read("FL,EL\n0.5,0.5\n", "site")
    with pytest.raises(ValueError, match="FL is a form, not the name of a sample"):
        read("FL,EL\n0.5,0.5\n", "FL")


@pytest.mark.parametrize(
    "header",
    [
        "L/mm;I/mm;S/mm",
        "L, mm;I, mm;S, mm",
        "L in mm;I in mm;S in mm",
        "L..mm.;I..mm.;S..mm.",
        '"L\n[mm]";"I\n[mm]";"S [mm]"',
        "a (mm);b (mm);c (mm)",
        "A;B;C",
        "a-axis [cm];b-axis [cm];c-axis [cm]",
        "Long axis;Intermediate axis;Short axis",
        "long;intermediate;short",
        "LONGEST_mm;MEDIUM_mm;SHORTEST_mm",
        "major axis (px);intermediate axis (px);minor axis (px)",
        "L [µm];I [um];S [microns]",
    ],
)
def test_axes_by_other_names_and_units_are_the_same_sample(read, header):
    (expected,) = read("L,I,S\n4,2.5,1\n30,20,15\n")
    assert read(header + "\n4;2,5;1\n30;20;15\n") == [expected]


@pytest.mark.parametrize(
    "header", ["S/I,I/L", "c/b,b/a", "FL [-],EL [-]", "fl,el", "FL (S/I),EL (I/L)", "FL = S/I,EL = I/L", "s / i,i / l"]
)
def test_ratios_by_other_names_are_the_same_sample(read, header):
    assert read(header + "\n0.5,0.7\n0.6,0.8\n") == read("FL,EL\n0.5,0.7\n0.6,0.8\n")


@pytest.mark.parametrize(
    "header", ["Mean FL,Std FL,Mean EL,Std EL", "FL_mean,FL_sd,EL_mean,EL_sd", "µ_FL,σ_FL,µ_EL,σ_EL"]
)
def test_statistics_by_other_names_are_the_same_sample(read, header):
    assert read(header + "\n0.6,0.1,0.7,0.2\n") == read("mean_FL,std_FL,mean_EL,std_EL\n0.6,0.1,0.7,0.2\n")


def test_rows_that_summarise_others_are_left_out_and_named(notices_of):
    """The name of the column does not matter, and the numbers of these rows are not read, as some are no form."""
    (expected,), nothing = notices_of("FL,EL\n0.5,0.7\n0.6,0.8\n")
    assert nothing == []
    for labels in (
        ["Mean", "Max"],
        ["Mittelwert", "Standardabweichung"],
        ["average:", "Std. dev."],
        ["Grand total", "MEDIAN (n=2)"],
        ["Sum of all", "min value"],
    ):
        rows = "".join(f"{label},7,-3\n" for label in labels)
        (sample,), (left_out, *_) = notices_of("stone,FL,EL\nx1,0.5,0.7\nx2,0.6,0.8\n" + rows)
        assert sample == expected
        assert f"row 4 ({labels[0]}), row 5 ({labels[1]}) summarise others and are left out" in left_out
    samples, (left_out, *_) = notices_of("sample,FL,EL\nx,0.5,0.7\nx,0.6,0.8\nTotal,1.1,1.5\n")
    assert [sample.name for sample in samples] == ["x"]
    assert left_out.endswith("row 4 (Total) summarises others and is left out")
    # These rows are those of pandas.DataFrame.describe.
    below = "".join(f"{label},2,2\n" for label in ("count", "mean", "std", "min", "25%", "50%", "75%", "max"))
    samples, (left_out, *_) = notices_of(",FL,EL\n0,0.5,0.7\n1,0.6,0.8\n" + below)
    assert samples == [expected] and "row 4 (count), row 5 (mean)" in left_out and "row 11 (max)" in left_out


def test_names_that_look_like_summaries_are_no_summaries(notices_of):
    """The names are a grain n among letters, a place SD, places that begin with Max, and the person Max."""
    letters = "".join(f"{letter},0.5,0.7\n" for letter in "lmnop")
    assert notices_of("stone,FL,EL\n" + letters + "Mean,0.5,0.7\n")[0][0].grains == 5
    assert notices_of("place,FL,EL\nSD,0.5,0.7\nSE,0.5,0.7\nTX,0.5,0.7\n")[0][0].grains == 3
    assert notices_of("place,FL,EL\nMax Creek,0.5,0.7\nTotality,0.5,0.7\nMeander,0.5,0.7\n")[0][0].grains == 3
    assert notices_of("who,FL,EL\nMax,0.5,0.7\nMax,0.5,0.7\nAnna,0.5,0.7\n")[0][0].grains == 3


@pytest.mark.parametrize("name", ["count", "Counts", "n", "number", "Anzahl", "frequency", "no. of grains", "n_grains"])
def test_counts_weigh_like_rows_that_are_written_out(notices_of, name):
    forms, counts = [("9", "8", "7"), ("9", "5", "3"), ("8", "7", "2")], [2, 90, 8]
    lines = [",".join(form) for form in forms]
    written_out = "L,I,S\n" + "".join(f"{line}\n" * count for line, count in zip(lines, counts, strict=True))
    counted = f"L,I,S,{name}\n" + "".join(f"{line},{count}\n" for line, count in zip(lines, counts, strict=True))
    ((expected,), _), ((sample,), notices) = notices_of(written_out), notices_of(counted)
    assert (sample.grains, expected.grains) == (100, 100)
    for field in ("mu_FL", "sigma_FL", "mu_EL", "sigma_EL", "mu_EQ", "sigma_EQ"):
        assert getattr(sample, field) == pytest.approx(getattr(expected, field), rel=1e-12)
    assert notices == [f"bed.csv: the column {name} is the number of grains of each row, 100 in all"]


def test_counts_go_to_their_samples_and_shares_count_no_grains(notices_of):
    (a, b), _ = notices_of("sample,FL,EL,count\na,0.5,0.7,3\nb,0.6,0.8,5\na,0.9,0.7,1\nb,0.6,0.9,0\n")
    assert (a.grains, b.grains, b.one_form) == (4, 5, True)
    assert a.mu_FL == pytest.approx(0.6) and a.sigma_FL == pytest.approx(np.sqrt(0.03))
    (share,), (notice,) = notices_of("FL,EL,frequency [%]\n0.5,0.7,75\n0.9,0.7,25\n")
    assert (share.mu_FL, share.grains) == (pytest.approx(0.6), 0)
    assert "the column frequency [%] is the weight of each row; the number of grains is unknown" in notice
    (share,), _ = notices_of("FL;EL;count\n0,5;0,7;1,250\n0,9;0,7;2,25\n")
    assert share.mu_FL == pytest.approx((0.5 * 1.25 + 0.9 * 2.25) / 3.5)


def test_a_column_that_numbers_the_rows_is_no_count(notices_of):
    (sample,), (running,) = notices_of("n,FL,EL\n1,0.5,0.7\n2,0.9,0.7\n3,0.9,0.7\n")
    assert (sample.grains, sample.mu_FL) == (3, pytest.approx(2.3 / 3))
    assert "the column n numbers the rows, so it is not used as a number of grains" in running
    rows = [f"{number},0.5,0.7" for number in (101, 102, 104, 105, 107)]
    (sample,), _ = notices_of("\n".join(["n,FL,EL", *rows]))  # five rising numbers may be counts
    assert sample.grains == 519
    with pytest.raises(ValueError, match="rename the column to `id` if they number the grains, or to `count`"):
        notices_of("\n".join(["n,FL,EL", *rows, "109,0.5,0.7"]))
    (sample,), _ = notices_of("\n".join(["count,FL,EL", *rows, "109,0.5,0.7"]))
    assert sample.grains == 628


MEANS_HEADER = "mean_FL,std_FL,mean_EL,std_EL"


def test_means_may_have_the_number_of_grains(notices_of):
    (first, few, alike), (notice,) = notices_of(f"{MEANS_HEADER},n\n.6,.1,.7,.1,9\n.6,.1,.8,.1,4\n.6,0,.8,0,9\n")
    assert (first.grains, few.grains, alike.grains) == (9, 4, 9)
    assert np.shape(first.covariance) == (4, 4) and few.covariance is None and alike.covariance is None
    assert notice.endswith(
        "the column n is the number of grains of each sample; FL and EL are assumed to be independent"
    )
    (sample, _), (notice, _) = notices_of(f"{MEANS_HEADER},n,grains\n.6,.1,.7,.1,.31,40\n.6,.1,.8,.1,.33,30\n")
    assert sample.grains == 40 and "the column grains is the number" in notice


@pytest.mark.parametrize("name, numbers", [("n", ("0.31", "0.33")), ("grains [%]", ("40", "60")), ("n", ("1", "2"))])
def test_other_numbers_beside_means_are_not_used(notices_of, name, numbers):
    rows = "".join(f".6,.1,.7,.1,{number}\n" for number in numbers)
    (sample, _), _ = notices_of(f"{MEANS_HEADER},{name}\n{rows}")
    assert (sample.grains, sample.covariance) == (0, None)


def test_errors_of_means_are_those_of_drawing_so_many_grains():
    given = {"mu_FL": 0.6, "sigma_FL": 0.12, "mu_EL": 0.7, "sigma_EL": 0.09}
    FL, EL = (
        np.random.default_rng(seed).normal(given[f"mu_{name}"], given[f"sigma_{name}"], (20000, 40))
        for seed, name in enumerate(("FL", "EL"))
    )
    drawn = equancy_statistics(FL.mean(axis=1), FL.std(axis=1), EL.mean(axis=1), EL.std(axis=1))
    expected = np.cov([*drawn, EL.mean(axis=1), EL.std(axis=1)])
    found = means_covariance(**given, grains=40)
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(found / np.outer(scale, scale), expected / np.outer(scale, scale), atol=0.05)


def test_a_column_that_may_separate_samples_is_named(notices_of):
    text = "river,FL,EL,D50\nRhine,0.5,0.7,9\nKall,0.6,0.8,8\nRhine,0.7,0.9,7\n"
    (sample,), (hint, unused) = notices_of(text)
    assert sample.grains == 3
    assert "the column river has repeated values (Rhine, Kall) and is not used, so all grains are one sample" in hint
    assert "give --sample 'river'" in hint and unused.endswith("not used: D50")
    samples, (unused, single) = notices_of(text, "River")
    assert [sample.name for sample in samples] == ["Rhine", "Kall"] and unused.endswith("not used: D50")
    # With a name per grain, one name for all, or a column `sample`, no grains of different samples were merged.
    assert notices_of("stone,FL,EL\nx,.5,.7\ny,.6,.7\n")[1] == ["bed.csv: columns that are not used: stone"]
    assert notices_of("river,FL,EL\nx,.5,.7\nx,.6,.7\n")[1] == ["bed.csv: columns that are not used: river"]
    assert notices_of("Sample,FL,EL\nx,.5,.7\nx,.6,.7\ny,.6,.7\ny,.6,.8\n")[1] == []


def test_notices_go_to_the_log_of_who_reads_samples_alone(read, caplog):
    read("FL,EL,D50\n0.5,0.7,9\n")
    assert "not used: D50" in caplog.text

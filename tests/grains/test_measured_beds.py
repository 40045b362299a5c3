"""Tables of measured beds: what is read, and what is refused with its place and remedy."""

import math

import pytest

from simcore.grains.measured_beds import read_measured_beds

MEANS = "sample,mean_FL,std_FL,mean_EL,std_EL,n,n_error,case\n"

ONE_FORM = (
    "each row has one form; if that is a mean over the grains of the bed, the predicted porosity is too low, by 0.01 "
    "to 0.03 for gravel: give mean_FL, std_FL, mean_EL, std_EL"
)


@pytest.fixture
def read(tmp_path):
    def read_text(text, case=None, column=None):
        (tmp_path / "beds.csv").write_text(text, encoding="utf-8")
        return read_measured_beds(tmp_path / "beds.csv", case, column)

    return read_text


def test_a_row_is_a_bed(read):
    beds, notices = read(MEANS + "A,0.6,0.15,0.7,0.1,0.36,0.004,U1\nB,0.5,0.1,0.7,0.1,0.29,0.003,U7\n")
    assert [(bed.sample.name, bed.n, bed.n_error, bed.case) for bed in beds] == [
        ("A", 0.36, 0.004, "U1"),
        ("B", 0.29, 0.003, "U7"),
    ]
    assert (beds[0].sample.mu_FL, beds[0].sample.sigma_EL, beds[0].sample.grains) == (0.6, 0.1, 0)
    assert notices == []


@pytest.mark.parametrize("row, fields", [("0.36,U1,0.6", 3), ("0.36,U1,0.6,0.1,0.7", 5)])
def test_a_short_row_is_named_with_its_fields_in_the_file(read, row, fields):
    """The columns n and case, which are read first, are in front of those of the forms."""
    with pytest.raises(ValueError, match=f"row 2: the row has {fields} fields, but the header has 6; add or remove"):
        read(f"n,case,mean_FL,std_FL,mean_EL,std_EL\n{row}\n")


def test_forms_of_one_grain_and_percent_are_the_same_bed(read):
    axes, _ = read("L [mm];I [mm];S [mm];porosity [%];porosity error (%)\n40;28;14;36,5;0,4\n40;20;18;40;0,5\n", "U1")
    ratios, _ = read("FL,EL,n,n_std_error\n0.5,0.7,0.365,0.004\n0.9,0.5,0.40,0.005\n", "U1")
    for a, b in zip(axes, ratios, strict=True):
        assert a.sample.one_form and a.sample.mu_EQ == pytest.approx(b.sample.mu_EQ)
        assert (a.n, a.n_error) == (pytest.approx(b.n), pytest.approx(b.n_error))
        assert a.sample.name == b.sample.name and a.case == "U1"
    assert [bed.sample.name for bed in axes] == ["row 2", "row 3"]
    german, _ = read("Länge;Breite;Höhe;Porosität [%];Porosität error [%]\n40;28;14;36,5;0,6\n", "U1")
    assert (german[0].n, german[0].n_error) == (pytest.approx(0.365), pytest.approx(0.006))
    without, _ = read("FL,EL,n\n0.5,0.7,0.365\n", "one-class")
    assert math.isnan(without[0].n_error) and without[0].case == "one-class"
    some, _ = read("FL,EL,n,n_error\n0.5,0.7,0.365,\n0.5,0.7,0.36,0.004\n", "one-class")
    assert math.isnan(some[0].n_error) and some[1].n_error == 0.004


def test_summaries_and_other_columns_are_left_out_with_a_notice(read):
    beds, notices = read("bed,FL,EL,D50,n\nA,0.5,0.7,9,0.36\nMean,0.6,0.7,9,0.37\nB,0.6,0.7,9,0.38\n", "U1", "bed")
    assert [(bed.sample.name, bed.n) for bed in beds] == [("A", 0.36), ("B", 0.38)]
    assert [text.split(": ", 1)[1] for text in notices] == [
        "row 3 (Mean) summarises others and is left out",
        "columns that are not used: D50",
        ONE_FORM,
    ]


@pytest.mark.parametrize(
    ("header", "hint"),
    [
        ("e", "the porosity of a void ratio e is n = e/(1 + e); "),
        ("Porenzahl", "the porosity of a void ratio e is n = e/(1 + e); "),
        ("Trockendichte", "the porosity is n = 1 - dry density of the bed / density of the grains; "),
        ("mass", ""),
    ],
)
def test_without_porosities_the_error_says_how_to_compute_them(read, header, hint):
    with pytest.raises(ValueError) as error:
        read(f"bed,FL,EL,{header}\nA,0.5,0.7,0.6\n", "U1")
    assert f"the column n is missing beside bed, FL, EL, {header}; {hint}give a row per bed" in str(error.value)


def test_rows_of_one_name_are_repeats_or_refused(read):
    beds, _ = read("sample,FL,EL,n\nA,0.5,0.7,0.36\nA,0.5,0.7,0.37\n", "U1")
    assert [(bed.sample.name, bed.n) for bed in beds] == [("A", 0.36), ("A (row 3)", 0.37)]
    beds, _ = read("sample,L,I,S,n\nA,30,20,10,0.36\nA,0.3,0.2,0.1,0.37\n", "U1")
    assert [bed.n for bed in beds] == [0.36, 0.37], "the ratios of 0.3, 0.2 and 0.1 differ in their last digits"
    with pytest.raises(
        ValueError, match=r"row 4: A is also the name of row 2, which has another form. If both are beds"
    ):
        read("sample,FL,EL,n\nA,0.5,0.7,0.36\nB,0.5,0.7,0.36\nA,0.6,0.7,0.36\n", "U1")


def test_a_state_of_beds_is_no_label_of_a_summary(read):
    """Beds in the states min and max are beds, also if this column is the first one; a row Mean is a summary."""
    rows = [("natural", 0.38), ("min", 0.35), ("natural", 0.39), ("min", 0.36)]
    for header, row in (("n,state,FL,EL", "{1},{0},0.5,0.7"), ("state,n,FL,EL", "{0},{1},0.5,0.7")):
        beds, notices = read("\n".join([header, *(row.format(*values) for values in rows)]), "U1")
        assert [bed.n for bed in beds] == [0.38, 0.35, 0.39, 0.36]
        assert any("state" in notice and "not used" in notice for notice in notices)
    for name in ("sample", ""):
        beds, notices = read(f"{name},n,FL,EL\nA,0.36,0.5,0.7\nB,0.37,0.6,0.7\nMean,0.365,0.55,0.7\n", "U1")
        assert len(beds) == 2 and any("row 4 (Mean) summarises others" in notice for notice in notices)


@pytest.mark.parametrize("header", ["Porosität [Vol.-%]", "n in %", "porosity (measured) [%]", "total porosity (%)"])
def test_usual_headers_of_the_porosity_are_read(read, header):
    assert read(f"FL,EL,{header}\n0.5,0.7,36\n", "U1")[0][0].n == pytest.approx(0.36)


@pytest.mark.parametrize("header", ["porosity n (-)", "n (measured)", "Porenanteil n [-]", "measured porosity"])
def test_usual_headers_of_a_fraction_are_read(read, header):
    assert read(f"FL,EL,{header}\n0.5,0.7,0.36\n", "U1")[0][0].n == 0.36


def test_cells_may_repeat_the_percent_of_their_header(read):
    (bed,), _ = read("FL,EL,n [%],n_error [%]\n0.5,0.7,36 %,0.4%\n", "U1")
    assert (bed.n, bed.n_error) == (pytest.approx(0.36), pytest.approx(0.004))


def test_the_columns_of_a_density_lead_to_the_formula(read):
    with pytest.raises(ValueError, match="the porosity is n = 1 - dry density of the bed / density of the grains"):
        read("FL,EL,rho_d,rho_s\n0.5,0.7,1722,2650\n", "U1")


def test_repeats_may_differ_in_their_number_of_grains(read):
    beds, _ = read("sample,grains,FL,EL,n\nA,40,0.5,0.7,0.36\nA,42,0.5,0.7,0.37\n", "U1")
    assert [bed.n for bed in beds] == [0.36, 0.37]


@pytest.mark.parametrize("name", ["bed", "Bett", "Probe", "SAMPLE"])
def test_the_column_of_names_has_several_names(read, name):
    beds, notices = read(f"{name},FL,EL,n\nA,0.5,0.7,0.36\nB,0.5,0.7,0.37\n", "U1")
    assert [bed.sample.name for bed in beds] == ["A", "B"]
    assert [text.split(": ", 1)[1] for text in notices] == [ONE_FORM]
    with pytest.raises(ValueError, match="row 3: 1 is also the name of row 2, .*; if the rows are grains of one bed"):
        read(f"{name},n,L,I,S\n1,0.350,9.5,7.2,5.1\n1,0.350,11,8.1,4.9\n2,0.365,9.5,7.2,3.1\n", "U1")


def test_the_column_sample_counts_before_others(read):
    beds, notices = read("bed,Probe,sample,FL,EL,n\nA,x,C,0.5,0.7,0.36\n", "U1")
    assert beds[0].sample.name == "C" and notices[0].endswith("columns that are not used: bed, Probe")


@pytest.mark.parametrize(
    ("rows", "refused"),
    [
        ([(0.35, 0.5), (0.35, 0.6), (0.35, 0.7)], "rows 3, 4"),
        ([(0.35, 0.5), (0.35, 0.6), (0.35, 0.7), (0.365, 0.4), (0.365, 0.5), (0.365, 0.6)], "rows 3, 4, 6, 7"),
        ([(0.35, 0.5), (0.35, 0.6)], ""),
        ([(0.36, 0.5), (0.36, 0.6), (0.38, 0.7)], ""),
        ([(n, FL) for n in (0.34, 0.35, 0.36, 0.38) for FL in (0.5, 0.6)], ""),
        ([(0.35, 0.5)] * 3, ""),
    ],
)
def test_a_row_per_grain_is_refused(read, rows, refused):
    """Beds whose rounded porosities are sometimes equal, repeats, and beds with names are read."""
    text = "".join(f"{FL},0.7,{n}\n" for n, FL in rows)
    if refused:
        with pytest.raises(ValueError, match=f"{refused} have the porosity of the row above, but another form. A row "):
            read(f"FL,EL,n\n{text}", "U1")
    else:
        assert len(read(f"FL,EL,n\n{text}", "U1")[0]) == len(rows)
    named = "".join(f"{i},{FL},0.7,{n}\n" for i, (n, FL) in enumerate(rows))
    assert len(read(f"sample,FL,EL,n\n{named}", "U1")[0]) == len(rows)
    errors = "".join(f"{FL},0.7,{n},0.00{i + 1}\n" for i, (n, FL) in enumerate(rows))
    assert len(read(f"FL,EL,n,n_error\n{errors}", "U1")[0]) == len(rows)


def test_errors_that_no_measurement_reaches_are_questioned(read):
    def notices(n, n_error, unit=""):
        _, found = read(f"mean_FL,std_FL,mean_EL,std_EL,n{unit},n_error{unit}\n0.6,0.1,0.7,0.1,{n},{n_error}\n", "U1")
        return found

    (notice,) = notices(36, 0.003, " [%]")
    assert (
        "all n_error are below 0.1 %, which few measurements of porosity reach; check their unit" in notice
        and notice.endswith("remove % from its header")
    )
    (notice,) = notices(0.36, 1e-6)
    assert notice.endswith("all n_error are below 0.001, which few measurements of porosity reach; check their unit")
    assert notices(36, 0.3, " [%]") == notices(0.36, 0.003) == []


@pytest.mark.parametrize(
    ("text", "case", "message"),
    [
        ("", "U1", "there are no rows below a header; give a row per bed"),
        ("FL,EL,n\n", "U1", "there are no rows below a header"),
        ("FL,EL\n0.5,0.7\n", "U1", "the column n is missing beside FL, EL; give a row per bed with the column n"),
        ("FL,EL,n\n0.5,0.7,0.36\n", None, "the sieve curve of the beds is not given; add --case"),
        ("FL,EL,n,case\n0.5,0.7,0.36,U1\n", "U1", "the table has a column case; leave out --case"),
        ("FL,EL,n,case\n0.5,0.7,0.36,\n", None, "row 2: case is empty; name the sieve curve in every row"),
        ("FL,EL,n\n0.5,0.7,36\n", "U1", r"row 2: n = 36 is not between 0 and 1; give a fraction, or write n \[%\]"),
        ("FL,EL,n\n0.5,0.7,0\n", "U1", "row 2: n = 0 is not between 0 and 1"),
        ("FL,EL,n\n0.5,0.7,1\n", "U1", "row 2: n = 1 is not between 0 and 1"),
        ("FL,EL,n [%]\n0.5,0.7,120\n", "U1", "row 2: n = 120 % is not between 0 and 100 %; correct it"),
        ("FL,EL,n [%]\n0.5,0.7,0.36\n", "U1", "all porosities are below 1 %; remove % if they are fractions"),
        ("FL,EL,n,n_error\n0.5,0.7,0.36,-1\n", "U1", "row 2: n_error = -1 is not between 0 and 0.05"),
        (
            "FL,EL,n,n_error\n0.5,0.7,0.36,0.05\n0.5,0.7,0.36,0.3\n",
            "U1",
            "row 3: n_error = 0.3 is above 0.05, but n is a fraction; if 0.3 is in percentage points, write 0.003; if",
        ),
        (
            "FL,EL,n,n_error\n0.5,0.7,0.36,30\n",
            "U1",
            "row 2: n_error = 30 is above 0.05, but n is a fraction; if it is",
        ),
        (
            "FL,EL,n [%],n_error [%]\n0.5,0.7,36,100\n",
            "U1",
            "row 2: n_error = 100 % is not between 0 and 5 %; correct it; if it is unknown, leave",
        ),
        ("FL,EL,n\n0.5,0.7,\n", "U1", "row 2: n is empty; give the porosity, or remove the row"),
        ("FL,EL,n [%],n_error\n0.5,0.7,36,0.4\n", "U1", r"columns n \[%\] and n_error is in %, the other is not"),
        (
            "FL,EL,n,porosity\n0.5,0.7,0.36,0.36\n",
            "U1",
            "the columns n and porosity are both the porosity; remove one; if n is the number",
        ),
        ("FL,n\n0.5,0.36\n", "U1", "the column EL is missing beside FL"),
        ("FL,EL,n\n0.5,1.7,0.36\n", "U1", r"row 2: EL = 1.7 is not in \(0, 1\]"),
        (
            "FL,EL,n\n0.5,0.7,loose\n0.6,0.7,0.36\n0.7,0.7,36\n0.8,0.7,\n",
            "U1",
            "row 2: n is .loose.; a number is needed; .*; rows 4, 5 have errors too",
        ),
        ("FL,EL,n\n0.5,0.7,loose\n", "U1", "row 2: n is 'loose'; a number is needed"),
        ("FL,EL,n\n0.5,0.7,n.a.\n", "U1", "row 2: n is 'n.a.'; a number is needed; enter it, or remove the row"),
        ("FL,EL,n,n_error\n0.5,0.7,0.36,0\n", "U1", "row 2: n_error = 0, but each measurement has an error"),
    ],
)
def test_what_is_wrong_is_named(read, text, case, message):
    with pytest.raises(ValueError, match=f"beds.csv(:|, ).*{message}"):
        read(text, case)


def test_a_column_of_names_that_does_not_exist_is_refused(read):
    with pytest.raises(ValueError, match="there is no column river to distinguish the samples"):
        read("FL,EL,n\n0.5,0.7,0.36\n", "U1", "river")

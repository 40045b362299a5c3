"""Tables of forms with several samples: each with its own sieve curve, and with forms by sieve class."""

import json

import numpy as np
import pandas as pd
import pytest

import simcore
from simcore.__main__ import main
from simcore.grains.sieve import SieveCurve
from simcore.models.size_and_form.bed_forms import has_curves, read_bed_forms
from simcore.models.size_and_form.forms_by_class import BY_CLASS
from simcore.scene.sizes import all_cases

MEANS = "mean_FL,std_FL,mean_EL,std_EL"
CURVE = "opening [mm],passing [%]\n16,100\n8,60\n4,0\n"
A, B = "0.6,0.15,0.7,0.12", "0.5,0.1,0.65,0.1"


@pytest.fixture
def write(tmp_path):
    (tmp_path / "own.csv").write_text(CURVE)

    def write_table(header, *rows):
        (tmp_path / "forms.csv").write_text("\n".join([header, *rows]) + "\n")
        return tmp_path / "forms.csv"

    return write_table


def test_each_sample_is_predicted_with_its_curve(write, tmp_path, capsys):
    path = write(f"sample,sieve,{MEANS}", f"a,own.csv,{A}", f"b,U7,{B}", f"c,own.csv,{B}")
    table = simcore.predict(path)
    assert table["sample"].tolist() == ["a", "b", "c"] and table["curve"].tolist() == ["own.csv", "U7", "own.csv"]
    assert table.index.tolist() == [0, 1, 2]
    forms = write(f"sample,{MEANS}", f"a,{A}", f"c,{B}")
    own, named = simcore.predict(forms, curve=tmp_path / "own.csv"), simcore.predict(forms, curve="U7")
    assert table.n.tolist() == [own.n[0], named.n[1], own.n[1]] and "curve" not in own
    one = simcore.predict(write(f"sample,sieve,{MEANS}", f"a,U7,{A}"))
    assert one["curve"].tolist() == ["U7"] and one.n[0] == named.n[0]
    path = write(f"sample,sieve,{MEANS}", f"a,own.csv,{A}", f"b,U7,{B}", f"c,own.csv,{B}")
    assert main(["predict", str(path), "--csv"]) == 0
    assert [line.split(",")[0] for line in capsys.readouterr().out.splitlines()] == ["sample", "a", "b", "c"]
    assert main(["predict", str(path), "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)
    assert [each["sample"] for each in first["samples"]] == ["a", "c"] and second["samples"][0]["n"] == table.n[1]
    assert first["curve"]["bounds_mm"] == pytest.approx([4, 8, 16]) and second["curve"]["name"] == "U7"
    assert main(["predict", str(path)]) == 0
    text = capsys.readouterr().out
    assert (
        f"the sieve curves in {path}" in text
        and text.count("prediction intervals") == 1
        and "How the curve acts" not in text
    )
    rows = [line.split()[:2] for line in text.splitlines()[2:6]]
    assert rows == [["sample", "curve"], ["a", "own.csv"], ["b", "U7"], ["c", "own.csv"]]
    path = write(f"sample,sieve,{MEANS}", f"a,U7,{A}", f"b,U7,{B}")
    assert main(["predict", str(path)]) == 0
    text = capsys.readouterr().out
    assert "sieve curve of U7" in text and text.count("How the curve acts") == 1 and "add --json" not in text


def test_a_file_may_have_a_number_as_its_name(write, tmp_path):
    for name in ("1.csv", "2024-05.csv"):
        (tmp_path / name).write_text(CURVE)
        path = write(f"sample,sieve,{MEANS}", f"a,{name},{A}")
        assert has_curves(path) and read_bed_forms(path)[0][0].source.name == name
    assert not has_curves(write("sieve,FL,EL", "4-8 mm,0.6,0.7", "> 8,0.6,0.7"))


def test_a_size_of_the_finest_grains_needs_a_file_of_a_curve(write, tmp_path, capsys):
    forms = str(write(MEANS, A))
    for words in (["--sieve", "U7"], []):
        table = forms if words else str(write(f"sample,sieve,{MEANS}", f"a,U7,{A}"))
        assert main(["predict", table, *words, "--finest", "1 mm"]) == 2
        assert "--finest and --coarsest are sizes for the file of a sieve curve" in capsys.readouterr().err
    path = write(f"sample,sieve,{MEANS}", f"a,U7,{A}", f"b,own.csv,{B}")
    assert main(["predict", str(path), "--finest", "1 mm"]) == 0
    forms = str(write(MEANS, A))
    capsys.readouterr()
    printed = []
    for name in ("U7", "u7"):
        assert main(["predict", forms, "--sieve", name, "--json"]) == 0
        printed.append(json.loads(capsys.readouterr().out)["samples"])
    assert printed[0] == printed[1]
    assert main(["predict", forms, "--sieve", "u8"]) == 2
    assert "the sieve curve u8 is no file (u8), nor one of the listed curves U1, U3" in capsys.readouterr().err
    beds = tmp_path / "beds.csv"
    beds.write_text(f"n,{MEANS}\n0.36,{A}\n")
    assert main(["fit", str(beds), "--case", "one-class", "--finest", "1 mm"]) == 2
    assert "--finest and --coarsest are sizes" in capsys.readouterr().err


def test_a_specification_that_cannot_be_written_is_refused_before_the_prediction(write, tmp_path, capsys):
    (tmp_path / "file").touch()
    assert main(["predict", str(write(MEANS, A)), "--sieve", "U7", "--pack", str(tmp_path / "file" / "bed.yaml")]) != 0
    printed = capsys.readouterr()
    assert printed.out == "" and "bed.yaml cannot be written" in printed.err


def test_without_names_grains_of_one_curve_are_one_sample(write):
    beds, _ = read_bed_forms(write("sieve,FL,EL", "U7,0.6,0.7", "own.csv,0.5,0.6", "U7,0.8,0.7"))
    assert [(str(bed.source), [(each.name, each.grains) for each in bed.samples]) for bed in beds] == [
        ("U7", [("U7", 2)]),
        ("own.csv", [("own.csv", 1)]),
    ]
    beds, _ = read_bed_forms(write(f"sieve,{MEANS}", f"U7,{A}", f"U7,{B}"))
    assert [each.name for each in beds[0].samples] == ["row 2", "row 3"]


def test_samples_have_forms_by_class(write, tmp_path):
    header = "class [mm],sample,FL,EL"
    rows = ["0-8,a,0.6,0.7", "> 8,a,0.7,0.8", "0-8,b,0.5,0.5", "> 8,b,0.9,0.9", "> 8,b,0.8,0.9"]
    table = simcore.predict(write(header, *rows), curve="U7")
    assert table["sample"].tolist() == ["a", "b"] and table["grains"].tolist() == [2, 3]
    for name in "ab":
        alone = write(header.replace("sample", "note"), *(row for row in rows if f",{name}," in row))
        (row,) = simcore.predict(alone, curve="U7").itertuples()
        assert row.sample == BY_CLASS and row.n == table.set_index("sample").n[name]
    with_curves = write(f"{header},sieve", *(f"{row},{'U7' if ',a,' in row else 'U5'}" for row in rows))
    mixed = simcore.predict(with_curves)
    assert mixed["curve"].tolist() == ["U7", "U5"] and mixed.n.iloc[0] == table.n[0] and mixed.n.iloc[1] > table.n[1]


def test_notices_on_classes_name_their_sample(write):
    rows = ["0-63,a,0.6,0.7", "63-90,a,0.7,0.8", "63-90,a,0.8,0.8", "0-63,b,0.5,0.5", "0-63,b,0.6,0.5"]
    _, notices = read_bed_forms(write("class [mm],sample,FL,EL", *rows), "U7")
    assert any("the class 0-63 of the sample a has one row, so that" in notice for notice in notices)
    assert any("the class 63 to 90 mm of the sample a is not used, because" in notice for notice in notices)
    with pytest.raises(ValueError, match="the classes below 63 mm and 8 to 16 mm of the sample b overlap"):
        read_bed_forms(write("class [mm],sample,FL,EL", *rows, "8-16,b,0.5,0.5"), "U7")


def test_a_curve_is_given_once_in_any_way(write, tmp_path, monkeypatch):
    path = write(f"sample,{MEANS}", f"a,{A}")
    curve = all_cases()["U7"].curve
    same = SieveCurve(curve.bounds, curve.mass_fractions, "mine")
    assert simcore.predict(path, curve=same).equals(simcore.predict(path, curve="U7")) and not has_curves(path)
    (tmp_path / "U7").write_text(CURVE)
    own = simcore.predict(path, curve=tmp_path / "own.csv")
    assert simcore.predict(path, curve=tmp_path / "U7").equals(own)
    monkeypatch.chdir(tmp_path)  # a listed name is the listed curve, as for `fit` and in a column
    assert simcore.predict(path, curve="U7").n[0] != own.n[0]


def test_any_column_names_the_samples(write, tmp_path):
    """Another column `sample` is then left out. The one sample of a table is packed without the empty classes of U5."""
    german = write("Probe,Siebkurve,FL,EL", "x,U7,0.6,0.7", "x,U7,0.7,0.8", "y,U5,0.6,0.7")
    assert simcore.predict(german)["sample"].tolist() == ["x", "y"]
    path = write("site,sample,sieve,FL,EL", "x,1,U7,0.6,0.7", "x,2,U7,0.7,0.8", "y,1,U5,0.6,0.7")
    table = simcore.predict(path, column="site")
    assert table["sample"].tolist() == ["x", "y"] and table["grains"].tolist() == [2, 1]
    assert simcore.predict(path, column="sieve")["sample"].tolist() == ["U7", "U5"]
    one = write("sample,sieve,FL,EL", "a,U5,0.6,0.7", "a,U5,0.7,0.8")
    assert main(["predict", str(one), "--pack", str(tmp_path / "bed.yaml")]) == 0
    text = (tmp_path / "bed.yaml").read_text()
    assert 'name: "U5"' in text and "bounds: [4 mm, 5.6 mm, 8 mm, 11.2 mm, 16 mm, 22.4 mm]" in text


@pytest.mark.parametrize(
    "header, rows, options, fault",
    [
        (f"sample,sieve,{MEANS}", [f"a,U7,{A}"], ["--sieve", "U7"], "column sieve has the sieve curve of each sample"),
        (f"sample,sieve,{MEANS}", [f"a,none.csv,{A}"], [], "row 2: the sieve curve none.csv is no file"),
        (f"sample,sieve,{MEANS}", [f"a,,{A}"], [], "row 2: the sieve curve is empty"),
        ("sample,sieve,FL,EL", ["a,U7,0.6,0.7", "a,U5,0.6,0.7"], [], "curve of a is U5, but in row 2 it is U7"),
        ("sample,class [mm],FL,EL", [",0-8,0.6,0.7"], ["--sieve", "U7"], "row 2: sample is empty"),
        (f"sample,{MEANS}", [f"a,{A}"], [], "the sizes of the grains are not given"),
        (f"sample,sieve,{MEANS}", [f"a,U7,{A}"], ["--sample", "name"], "there is no column name"),
        (f"sample,sieve,{MEANS}", [f"a,U7,{A}"], ["--case", "U7"], "leave out --case"),
        (f"sample,sieve,{MEANS}", [], [], "there are no rows below the header"),
        ("sample,class [mm],FL,EL", [], ["--sieve", "U7"], "there are no rows below the header"),
        (
            "sample,class [mm],FL,EL",
            ["a,0-8,0.6,0.7", "a,0-8,0.6,0.8"],
            ["--sieve", "U7"],
            "sample a: sieve curve U7: the class 8 to 11.2 mm",
        ),
    ],
)
def test_faults_have_one_clear_error(write, capsys, header, rows, options, fault):
    assert main(["predict", str(write(header, *rows)), *options]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and fault in printed.err and printed.err.count("\n") == 1


def test_sieve_classes_in_a_column_sieve_are_no_curves(write):
    assert not has_curves(write("sieve,FL,EL", "4-8 mm,0.6,0.7", "8-16 mm,0.6,0.7"))
    assert not has_curves(write("curve,FL,EL", "> 8,0.6,0.7", "8/11.2,0.6,0.7", "8,0.6,0.7"))
    table = pd.DataFrame(simcore.predict(write("sieve,FL,EL", "4-8 mm,0.6,0.7", "8-16 mm,0.5,0.7"), curve="U7"))
    assert len(table) == 1 and np.isfinite(table.n[0])

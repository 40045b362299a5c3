"""Beds in which each sieve class has its own form."""

import json
from dataclasses import replace

import numpy as np
import pytest

import simcore
from simcore.__main__ import main
from simcore.evaluation.confidence import student_quantile
from simcore.grains.forms_by_class import class_name, classes_of_table
from simcore.grains.sampling import sample_grains
from simcore.grains.sieve import SieveCurve
from simcore.grains.sieve_table import read_curve
from simcore.grains.table_file import read_table
from simcore.models.fitting import fit_reference_models
from simcore.models.packing_models.curves import split
from simcore.models.size_and_form.bed_forms import read_bed_forms
from simcore.models.size_and_form.bed_prediction import predict_curve, rhine_one_class, sensitivity
from simcore.models.size_and_form.forms_by_class import BY_CLASS, one_class_by_class, predict_by_class
from simcore.models.size_and_form.sized_model import current_model
from simcore.paths import ROOT
from simcore.scene.setup import shape_choice
from simcore.scene.sizes import size_curve
from simcore.scene.specification import read_specification
from tests.helpers.table_cases import CLASSES

CURVE = SieveCurve([2e-3, 4e-3, 8e-3, 16e-3], [0.3, 0.3, 0.4], "three classes")
FLAT, ROUND = "0.45,0.15,0.6,0.13", "0.7,0.15,0.75,0.13"
NEAR_THE_LIMIT = "0.4,0.25,0.32,0.2"  # its one-class porosity is within the range of the model, but not its interval
HEADER = "class,mean_FL,std_FL,mean_EL,std_EL"


@pytest.fixture(scope="module")
def fitted():
    return fit_reference_models()


@pytest.fixture
def table(tmp_path):
    def write(*rows, header=HEADER):
        path = tmp_path / "forms.csv"
        path.write_text("\n".join([header, *rows]) + "\n")
        return path

    return write


def classes_of(path):
    table = read_table(path)
    return classes_of_table(table, class_name(table.header))[0]


@pytest.mark.parametrize("form", [FLAT, NEAR_THE_LIMIT])
def test_equal_forms_give_the_prediction_for_all_grains(fitted, table, form):
    classes = classes_of(table(f"2-4 mm,{form}", f"4 to 16 mm,{form}"))
    found = predict_by_class(CURVE, classes, fitted).iloc[0]
    expected = predict_curve(CURVE, [next(iter(classes.values()))], fitted).iloc[0]
    assert found["sample"] == BY_CLASS
    for name in (
        "n",
        "lower",
        "upper",
        "n_one_class",
        "mu_FL",
        "sigma_FL",
        "mu_EL",
        "sigma_EL",
        "n_long_shaken",
        "n_not_shaken",
    ):
        assert found[name] == pytest.approx(expected[name], abs=1e-9)


def test_each_class_has_the_one_class_porosity_of_its_form(fitted, table):
    found = predict_by_class(CURVE, classes_of(table(f"2-4 mm,{FLAT}", f"4-16 mm,{ROUND}")), fitted).iloc[0]
    flat, round_ = (
        predict_by_class(CURVE, classes_of(table(f"2-16 mm,{form}")), fitted).iloc[0] for form in (FLAT, ROUND)
    )
    n1 = [flat.n_one_class, round_.n_one_class, round_.n_one_class]
    expected = current_model().predict(CURVE, np.array([n1]), reference=rhine_one_class(fitted))
    assert found.n == pytest.approx(expected[0], abs=1e-9)
    assert round_.n < found.n < flat.n
    assert 1 / (1 - found.n_one_class) == pytest.approx(CURVE.mass_fractions @ (1 / (1 - np.array(n1))))
    assert found.mu_FL == pytest.approx(0.3 * 0.45 + 0.7 * 0.7)
    between = 0.3 * 0.7 * 0.25**2
    assert found.sigma_FL == pytest.approx(np.sqrt(0.15**2 + between))


def test_errors_of_few_grains_of_different_classes_are_independent(fitted, table):
    """The same grains stand for all classes, or twice, as samples of two classes."""
    axes = np.sort(np.random.default_rng(1).uniform(5.0, 10.0, (20, 3)))[:, ::-1]
    grains = [",".join(f"{axis:.3f}" for axis in grain) for grain in axes]
    tables = [[f"{label},{grain}" for label in labels for grain in grains] for labels in (["2-16"], ["2-4", "4-16"])]
    classes = [classes_of(table(*rows, header="class [mm],L,I,S")) for rows in tables]
    whole, divided = (predict_by_class(CURVE, samples, fitted).iloc[0] for samples in classes)
    assert divided.n == pytest.approx(whole.n, abs=1e-12)
    shares = np.array([0.3, 0.7])
    error = whole.one_class_few_grains_error
    assert divided.one_class_few_grains_error == pytest.approx(np.linalg.norm(shares) * error, rel=1e-4)
    half = student_quantile(0.95, 19) * error
    changes = half * np.array([[1, 0, 0], [0, 1, 1]])
    model, of_rhine = current_model(), rhine_one_class(fitted)
    ends = [model.predict(CURVE, whole.n_one_class + sign * changes, reference=of_rhine) for sign in (1.0, -1.0)]
    of_class = 0.5 * np.subtract(*ends)
    less = (whole.upper - whole.n) ** 2 - (divided.upper - divided.n) ** 2
    assert less == pytest.approx(2 * of_class.prod(), rel=1e-2)
    less = (whole.one_class_upper - whole.n_one_class) ** 2 - (divided.one_class_upper - divided.n_one_class) ** 2
    assert less == pytest.approx(2 * half**2 * shares.prod(), rel=1e-2)


def test_splitting_a_class_of_the_curve_changes_next_to_nothing(fitted, table):
    classes = classes_of(table(f"2-4 mm,{FLAT}", f"4-16 mm,{ROUND}"))
    whole = predict_by_class(CURVE, classes, fitted).n[0]
    assert predict_by_class(split(CURVE, 4, "mass"), classes, fitted).n[0] == pytest.approx(whole, abs=1e-3)


def test_units_may_stand_in_the_header_and_axes_in_the_rows(table):
    rows = ["8-16,20,15,10", "8-16,22,15,11", '"2,5-8",9,6,4']
    classes = classes_of(table(*rows, header="Size class [mm],L,I,S"))
    assert list(classes) == [(2.5e-3, 8e-3), (8e-3, 16e-3)]
    assert [sample.grains for sample in classes.values()] == [1, 2]


def test_a_table_without_classes_has_no_such_column(table):
    assert class_name(HEADER.removeprefix("class,").split(",")) is None


@pytest.mark.parametrize(
    "rows, fault",
    [
        ([f"coarse,{FLAT}"], "row 2: class is 'coarse'; give both sieves, such as '8-11.2 mm'"),
        ([f"2-16,{FLAT}"], "class is '2-16' without a unit; write it as '2-16 mm'"),
        ([f"2-16 furlong,{FLAT}"], "its unit 'furlong' is unknown, use m, cm, mm"),
        ([f"16-2 mm,{FLAT}"], "give the smaller size first"),
        ([f"2-8 mm,{FLAT}", f"4-16 mm,{ROUND}"], "classes 2 to 8 mm and 4 to 16 mm overlap"),
    ],
)
def test_wrong_classes_have_one_clear_error(table, rows, fault):
    with pytest.raises(ValueError, match=fault):
        classes_of(table(*rows))


@pytest.mark.parametrize("case", CLASSES)
def test_each_case_that_the_page_shares_has_its_words(tmp_path, case):
    path = tmp_path / "forms.csv"
    path.write_text(case.text, encoding="utf-8")
    if case.error:
        with pytest.raises(ValueError) as error:
            classes_of(path)
        assert str(error.value).partition("forms.csv")[2].lstrip(",: ") == case.error
    else:
        given = read_table(path)
        classes, notices = classes_of_table(given, class_name(given.header))
        assert any(case.notice in notice for notice in ["", *notices])
        np.testing.assert_allclose(np.array(list(classes)), [[8e-3, 11.2e-3], [11.2e-3, 16e-3]], rtol=1e-12)


def test_a_class_without_forms_is_refused(fitted, table):
    with pytest.raises(
        ValueError, match="the class 2 to 4 mm has mass, but no class of the table of forms contains it"
    ):
        predict_by_class(CURVE, classes_of(table(f"4-16 mm,{ROUND}")), fitted)


def test_a_form_far_outside_is_a_refusal_that_names_its_class(fitted, table):
    row = predict_by_class(CURVE, classes_of(table(f"2-4 mm,{FLAT}", "4-16 mm,0.05,0.01,0.6,0.1")), fitted).iloc[0]
    assert row.refused.startswith("4-16 mm: ") and "1/mean EQ = " in row.refused and np.isnan(row.n)


def test_a_one_class_porosity_outside_the_range_is_a_refusal(fitted, table, monkeypatch):
    monkeypatch.setattr("simcore.models.size_and_form.forms_by_class.LARGEST", 0.5)
    classes = classes_of(table(f"2-4 mm,{ROUND}", f"4-16 mm,{NEAR_THE_LIMIT}"))
    row = predict_by_class(CURVE, classes, fitted).iloc[0]
    assert row.refused == "the one-class porosity of a class is outside 0.2 to 0.5" and np.isnan(row.n)


def test_the_command_and_the_function_use_the_classes(table, capsys):
    path, curve = table(f"1.9-5.6 mm,{FLAT}", f"5.6-16 mm,{ROUND}"), ROOT / "examples" / "sieve_curve.csv"
    assert main(["predict", str(path), "--sieve", str(curve), "--csv"]) == 0
    line = capsys.readouterr().out.splitlines()[1]
    n = simcore.predict(path, curve=curve).n[0]
    assert line.startswith(BY_CLASS) and f"{n:.10f}"[:8] in line


def test_a_class_without_mass_has_a_notice(table):
    path = table(f"0-2 mm,{FLAT}", f"2-16 mm,{ROUND}", f"> 16,{FLAT}", header=HEADER.replace("class", "class [mm]"))
    notices = read_bed_forms(path, CURVE)[1]
    ending = "is not used, because the sieve curve has no mass there"
    assert notices[-2:] == [f"{path}: the class {name} {ending}" for name in ("below 2 mm", "above 16 mm")]
    assert not any("is not used" in notice for notice in read_bed_forms(table(f"1.9-16 mm,{FLAT}"), CURVE)[1])


def test_the_text_says_that_predictions_by_class_were_confirmed(table, capsys):
    curve = ROOT / "examples" / "sieve_curve.csv"
    assert main(["predict", str(table(f"1.9-16 mm,{FLAT}")), "--sieve", str(curve)]) == 0
    assert "On two packed beds, forms by sieve class had a smaller error" in capsys.readouterr().out
    assert main(["predict", str(ROOT / "examples" / "grains.csv"), "--sieve", str(curve)]) == 0
    assert "On two packed beds" not in capsys.readouterr().out


def test_pack_writes_the_forms_of_each_class(table, tmp_path):
    path, curve = table(f"1.9-5.6 mm,{FLAT}", f"5.6-16 mm,{ROUND}"), ROOT / "examples" / "sieve_curve.csv"
    assert main(["predict", str(path), "--sieve", str(curve), "--pack", str(tmp_path / "bed.yaml")]) == 0
    specification = read_specification(tmp_path / "bed.yaml")
    fine, coarse = specification["shapes"]["by_size"]
    assert fine["below"] == pytest.approx(5.6e-3) and coarse["below"] is None
    flat, round_ = (float(text.split(",")[0]) for text in (FLAT, ROUND))
    assert (fine["flatness"]["mean"], coarse["flatness"]["mean"]) == (flat, round_)
    choice = shape_choice(specification["shapes"])
    sizes = specification["sizes"]
    drawn = sample_grains(np.arange(4000), 1, size_curve(sizes), replace(choice, kind="ellipsoid"), [])
    flatness, is_fine = drawn.S / drawn.I, drawn.D < 5.6e-3
    assert flatness[is_fine].mean() == pytest.approx(flat, abs=0.02)
    assert flatness[~is_fine].mean() == pytest.approx(round_, abs=0.03)


def test_what_the_curve_does_is_that_of_the_bed_with_these_forms(fitted, table, tmp_path, capsys):
    """The printed step and changes are differences of predictions with the forms by class."""
    path = table(f"2-4 mm,{FLAT}", f"4-16 mm,{ROUND}")
    sieves = tmp_path / "curve.csv"
    sieves.write_text("opening [mm],mass [g]\n16,0\n8,40\n4,30\n2,30\n")
    classes, curve = classes_of(path), read_curve(sieves)[0]
    row = predict_by_class(curve, classes, fitted).iloc[0]
    assert main(["predict", str(path), "--sieve", str(sieves)]) == 0
    text = capsys.readouterr().out
    assert f"if its classes did not interact, the bed would have the porosity {row.n_one_class:.3f}," in text
    assert f"and the range of sizes lowers it by {row.n_one_class - row.n:.3f}." in text
    changes = []
    for index in range(3):
        more = curve.mass_fractions + 0.01 * (np.arange(3) == index)
        more = SieveCurve(curve.bounds, more / more.sum(), "more")
        changes.append(predict_by_class(more, classes, fitted).n[0] - row.n)
    assert min(np.abs(changes)) > 2e-4
    for change in changes:
        assert f"  {change:+.4f}\n" in text
    main(["predict", str(path), "--sieve", str(sieves), "--json"])
    assert json.loads(capsys.readouterr().out)["samples"][0]["sensitivity"] == pytest.approx(changes, abs=1e-12)


def test_a_class_without_mass_and_forms_has_no_change_of_porosity(fitted, table):
    gap = SieveCurve([2e-3, 4e-3, 8e-3, 16e-3], [0.4, 0.0, 0.6], "gap")
    for labels, known in ((("2-4 mm", "8-16 mm"), False), (("2-4 mm", "4-16 mm"), True)):
        classes = classes_of(table(*(f"{label},{form}" for label, form in zip(labels, (FLAT, ROUND), strict=True))))
        changes = sensitivity(gap, one_class_by_class(gap, classes, fitted), fitted)
        assert np.isfinite(changes).tolist() == [True, known, True]


def test_notices_on_few_grains_are_about_classes(table, tmp_path, capsys):
    path = table("2-4 mm,0.5,0.1,0.7,0.1,40", f"4-8 mm,{FLAT},6", header=f"{HEADER},grains")
    sieves = tmp_path / "curve.csv"
    sieves.write_text("opening [mm],mass [g]\n8,0\n4,30\n2,30\n")
    assert main(["predict", str(path), "--sieve", str(sieves)]) == 0
    text = capsys.readouterr().out
    assert "Fewer than 30 grains do not determine the spread of form well: 4-8 mm." in text


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        (
            ("2-10 mm", "10-16 mm"),
            "only partly within 2 to 10 mm and 10 to 16 mm of the table of forms; let the classes",
        ),
        (("2-4 mm", "4-8 mm"), "no class of the table of forms contains it; add its forms, or remove the column"),
    ],
)
def test_a_class_of_the_curve_without_forms_is_an_error(fitted, table, labels, message):
    classes = classes_of(table(*(f"{label},{ROUND}" for label in labels)))
    with pytest.raises(ValueError, match=message):
        predict_by_class(CURVE, classes, fitted)


def test_a_class_that_is_written_in_two_ways_is_an_error(table):
    with pytest.raises(ValueError, match="8-16 mm and 8 to 16 mm are the same class; write it in one way"):
        classes_of(table(f"8-16 mm,{FLAT}", f"8 to 16 mm,{ROUND}"))

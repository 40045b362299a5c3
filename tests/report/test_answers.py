"""The answer of a page, its uncertainty, and the check against committed packings."""

import numpy as np
import pandas as pd
import pytest

from simcore.report.answers import (
    answer,
    check,
    describe_case,
    how_sure,
    one_form_models,
    predict_form,
    replaced_by_ellipsoids,
)

TERMS = {"intercept": 0.28, "EQ_inv": 0.02, "EL_inv": 0.01}


@pytest.fixture
def tables(tmp_path):
    """Return tables of a campaign whose model of one form is n = 0.28 + 0.02 L/S + 0.01 L/I, up to L/S = 4."""

    def write(name, rows):
        pd.DataFrame(rows).to_csv(tmp_path / f"{name}.csv", index=False)
        return str(tmp_path / f"{name}.csv")

    same = {"case": "U1", "mean_absolute_error": 0.0048, "scatter": 0.006, "samples": 63}
    rows = [
        {"source": source, "model": "single_form", "term": term, "coefficient": value, **same}
        | {"feature_min": np.nan if term == "intercept" else 1.0, "feature_max": 4.0}
        for source in ("synthetic", "scans")
        for term, value in TERMS.items()
    ]
    experiment = {"case": ["U1", "U3"], "n": [0.384, 0.373], "experiment_n": [0.371, 0.356]}
    return {"single_form": write("single_form", rows), "validation": write("validation", experiment), "write": write}


def test_the_sampling_error_is_that_of_one_packing_and_one_curve(tables):
    """The rows are means over two seeds for U1, and beds of more grains for U7."""
    rows = {"case": ["U1", "U1", "U7"], "runs": [2, 2, 1], "n_std_error": [0.0020, 0.0022, 0.009]}
    tables["single_form_porosities"] = tables["write"]("forms", rows | {"grains": [1200, 1200, 6000], "n": 0.35})
    sentences = " ".join(how_sure(tables)[-1]["texts"])
    error = np.median([0.0020, 0.0022]) * np.sqrt(2)
    assert f"1200 grains of one form with the sieve curve U1 has a sampling error of {error:.4f}" in sentences


def test_the_answer_is_a_sentence_and_a_table_of_typical_forms(tables):
    sentence, examples, formulas = answer({"single_form": tables["single_form"]})
    assert sentence["kind"] == "answer"
    # These are the densest and the loosest of the forms inside the fit.
    assert (
        "has a porosity of 0.32 if the grains are nearly round and 0.37 if the grains are flat and long"
        in (sentence["text"])
    )
    cells = {row[0].text: row[1].text for row in examples["table"].rows}
    assert cells["nearly round"] == f"{0.28 + 0.02 / 0.81 + 0.01 / 0.9:.3f} ± 0.006"
    assert examples["table"].columns[1].words == "porosity, U1"
    assert "<i>n</i> = 0.280" in formulas["table"].rows[0][0].text
    assert answer({}) == []


def test_the_only_form_inside_the_fit_is_named_once(tables):
    rows = pd.read_csv(tables["single_form"]).assign(feature_max=1.9, feature_min=1.6)
    rows.loc[rows.term == "intercept", "feature_min"] = np.nan
    rows.loc[rows.term == "EL_inv", "feature_min"] = 1.0
    rows.loc[rows.term == "EQ_inv", "feature_max"] = 2.5
    sentence, *_ = answer({"single_form": tables["write"]("narrow", rows)})
    assert sentence["text"].endswith("a porosity of 0.34 at the mean form of the Rhine gravel of Rettinger et al.")


def test_a_form_outside_the_fit_has_no_porosity(tables):
    (terms,) = one_form_models(tables).values()
    assert predict_form(terms, 0.5, 0.8) == (pytest.approx(0.28 + 0.02 / 0.4 + 0.01 / 0.8), 0.006)
    assert np.isnan(predict_form(terms, 0.3, 0.5)[0])


def test_a_sieve_curve_is_described_by_its_classes():
    assert describe_case("U1") == "U1 (one sieve class, 5.6 to 8 mm)"
    assert describe_case("U3") == "U3 (3 sieve classes, 5.6 to 16 mm)"
    assert describe_case("own") == "own"


def test_how_sure_has_the_scatter_the_experiment_and_the_limits(tables):
    in_short, listed = how_sure(tables)
    assert "within 0.012 of the model" in in_short["text"]
    assert "by 0.015 on average and by 0.017 at most" in in_short["text"]
    assert "the mean error of porosity of the models above is 0.0048" in listed["texts"][0]
    assert any("river bed" in text for text in listed["texts"])


def test_grains_are_compared_with_their_ellipsoids(tables):
    row = {"case": "U1", "rms_difference": 0.0168, "mean_difference": 0.0042, "forms": 8}
    (sentence,) = replaced_by_ellipsoids({"shape_kinds": tables["write"]("shape_kinds", [row])})
    assert "is +0.0042 on average and 0.0168 root mean square over 8 forms." in sentence
    assert replaced_by_ellipsoids({}) == []


def test_own_packings_are_compared_with_committed_ones_of_the_same_settings(tables):
    own = {"case": "U1", "grain": ["G1", "G2", "G9"], "n": [0.34, 0.36, 0.9], "n_std_error": 0.003}
    committed = {"source": ["synthetic", "synthetic", "scans"], "case": "U1", "grain": ["G1", "G2", "G9"], "n": 0.36}
    paths = tables["write"]("own", own), tables["write"]("committed", committed | {"n_std_error": 0.004})
    sentence, compared = check({"forms": paths[0], "other": paths[0]}, {"forms": paths[1]}, {"forms": "Forms"})
    (row,) = compared["table"].rows
    assert [cell.text for cell in row] == ["Forms", "2", "0.350", "0.360", "−0.010 ± 0.004", "−2.8"]
    assert "settings in common with the committed campaign: 1. The mean" in sentence["text"]
    assert check({"forms": paths[0]}, {}, {"forms": "Forms"}) == []
    assert "grains" not in compared["caption"]
    single = own | {"n_std_error": [0.003, float("nan"), 0.003]}
    sentence, _ = check({"forms": tables["write"]("single", single)}, {"forms": paths[1]}, {"forms": "Forms"})
    assert "3 standard errors in 0 of them. In 1 of them the standard error is unknown." in sentence["text"]
    # One packing of the campaign for each friction, of which the committed rows have one
    rough = own | {"grain": ["G1", "G1", "G2"], "friction": [0.1, 0.9, 0.5], "grains": 300}
    paths = (
        tables["write"]("rough", rough),
        tables["write"]("large", committed | {"n_std_error": 0.004, "grains": 1200}),
    )
    _, compared = check({"forms": paths[0]}, {"forms": paths[1]}, {"forms": "Forms"})
    assert compared["table"].rows[0][1].text == "1"
    assert "have 0.25 times as many grains" in compared["caption"]
    assert check({"forms": paths[1]}, {"forms": paths[1]}, {"forms": "Forms"}) == []
    sizes = {"of": "size of the bed", "setting": "300 grains in 45 mm", "against": "1200 grains in 63 mm"}
    biases = tables["write"]("biases", [sizes | {"difference": -0.0126, "difference_std_error": 0.0017}])
    *_, effect = check({"forms": paths[0]}, {"forms": paths[1]}, {"forms": "Forms"}, biases)
    assert "1200 grains in 63 mm and for single forms: 300 grains in 45 mm −0.0126 ± 0.0017." in effect["text"]

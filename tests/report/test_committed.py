"""Tables and figures from committed rows alone."""

from itertools import product

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from simcore.models.unified import UNIFIED, unified_features
from simcore.report.committed import EARLIER, findings, gathered_packings, notes_of_rows, read_rows
from simcore.report.findings import Findings

ROWS = {"n_error": 0.002, "grains": 1200, "cpu_s": 100.0}


def single(L, I, S):  # noqa: E741
    return 0.28 + 0.02 * L / S + 0.01 * L / I


@pytest.fixture
def folder(tmp_path):
    """Return a folder of made-up rows whose porosities follow straight lines, ellipsoids 0.01 below their grains."""
    forms = [(12e-3, 12e-3 * EL, 12e-3 * EL * FL) for FL, EL in product((0.4, 0.6, 0.85), (0.5, 0.75, 0.9))]
    rows = [
        {"source": "synthetic", "case": "U1", "grain": f"G{i}", "representation": kind, "seed": seed}
        | {"L": L, "I": I, "S": S, "n": single(L, I, S) - lower + (-1) ** seed * 1e-3, **ROWS}
        for i, (L, I, S) in enumerate(forms)
        for kind, lower in (("polyhedron", 0.0), ("ellipsoid", 0.01))
        for seed in (1, 2)
    ]
    # Scans have the same forms and a porosity that is higher by 0.03.
    rows += [{**row, "source": "scans", "n": row["n"] + 0.03} for row in rows if row["representation"] == "polyhedron"]
    pd.DataFrame(rows).to_csv(tmp_path / "single_form.csv", index=False)
    rows = []
    for FL, EL, a, b in product((0.4, 0.6), (0.5, 0.7), (0.1, 0.2), (0.1, 0.2)):
        mean, spread = FL * EL, np.hypot(a * EL, b * FL)
        n = 0.28 + 0.02 / mean + 0.01 / EL - 0.003 / spread - 0.001 / b
        nominal = {"mu_FL_nominal": FL, "sigma_FL_nominal": a, "mu_EL_nominal": EL, "sigma_EL_nominal": b}
        found = {"mu_EQ": mean, "sigma_EQ": spread, "mu_EL": EL, "sigma_EL": b}
        rows.append({"case": "U1", **nominal, **found, "seed": 1, "n": n, **ROWS})
    pd.DataFrame(rows).to_csv(tmp_path / "form_mixture.csv", index=False)
    unseen = [{"case": "U1", "choice": choice, "seed": 1, **found, "n": n + 0.004, **ROWS} for choice in ("random",)]
    pd.DataFrame(unseen).to_csv(tmp_path / "application.csv", index=False)
    cases = [{"case": case, "run": run, "n": n, **ROWS} for case, n in (("U1", 0.38), ("U7", 0.29)) for run in (1, 2)]
    pd.DataFrame(cases).to_csv(tmp_path / "validation.csv", index=False)
    spheres = [{"case": "U1", "shape_kind": "sphere", "flatness": np.nan, "elongation": np.nan, "seed": 1}]
    spheres += [{**spheres[0], "shape_kind": "ellipsoid", "flatness": 0.8, "elongation": 0.8}]
    pd.DataFrame([{**row, "n": 0.36, **ROWS} for row in spheres]).to_csv(tmp_path / "near_spheres.csv", index=False)
    return tmp_path


def test_models_of_rows_are_the_lines_that_they_follow(folder):
    tables, figures = findings(folder)
    models = tables["single_form"].query("model == 'single_form'").set_index(["source", "term"]).coefficient
    for source, intercept in (("synthetic", 0.28), ("scans", 0.31)):
        assert models[source].to_numpy() == pytest.approx([intercept, 0.02, 0.01], abs=1e-9)
        assert {f"single_form_{name}_{source}" for name in ("features", "zingg", "prediction")} <= set(figures)
    at = tables["single_form_mean_form"].set_index("source")
    assert at.n["synthetic"] == pytest.approx(0.28 + 0.02 / (0.647 * 0.682) + 0.01 / 0.682, abs=1e-9)
    assert at.n["scans"] - at.n["synthetic"] == pytest.approx(0.03, abs=1e-9)
    assert at.r22_n["scans"] == pytest.approx(0.278 + 0.019 / (0.647 * 0.682) + 0.014 / 0.682)
    assert at.difference["scans"] == pytest.approx(at.n["scans"] - at.r22_n["scans"])
    assert (tables["single_form"].query("source == 'scans'").samples == 9).all(), "seeds do not pass for forms"


def test_ellipsoids_are_compared_with_grains_and_spheres(folder):
    tables, figures = findings(folder)
    (row,) = tables["shape_kinds"].itertuples()
    assert (row.forms, round(row.mean_difference, 9), round(row.rms_difference, 9)) == (9, 0.01, 0.01)
    assert "shape_kinds" in figures
    spheres = read_rows(folder / "near_spheres.csv")
    assert spheres.EQ.tolist() == [1.0, pytest.approx(0.64)]


def test_mixtures_predict_what_was_not_fitted(folder):
    tables, figures = findings(folder)
    models = tables["form_mixture"].set_index("term").coefficient
    expected = {"mu_EQ_inv": 0.02, "sigma_EQ_inv": -0.003, "mu_EL_inv": 0.01, "sigma_EL_inv": -0.001}
    assert models[list(expected)].to_dict() == pytest.approx(expected, abs=1e-9)
    (row,) = tables["application_predictions"].itertuples()
    assert row.abs_error == pytest.approx(0.004, abs=1e-9) and row.r22_simulated == pytest.approx(0.353)
    unified = tables["unified"].set_index("term").coefficient
    statistics = pd.DataFrame({"mu_EQ": [0.42], "sigma_EQ": [np.hypot(0.14, 0.12)], "mu_EL": [0.7], "sigma_EL": [0.2]})
    features = unified_features(statistics).iloc[0]
    by_hand = unified["intercept"] + sum(unified[name] * features[name] for name in UNIFIED)
    assert row.unified_predicted == pytest.approx(by_hand, abs=1e-12)
    assert row.unified_abs_error == pytest.approx(abs(by_hand - row.simulated), abs=1e-12)
    assert set(tables["unified_feature_sets"].model) == {"unified", "separate", "r22"}
    assert {"form_mixture_sets", "form_mixture_prediction"} <= set(figures)


def test_our_model_is_compared_with_that_of_r22_for_each_mixture(folder):
    rows = pd.read_csv(folder / "form_mixture.csv")
    rows.loc[0, "n"] += 0.01  # which no line through all of them follows
    rows.to_csv(folder / "form_mixture.csv", index=False)
    tables, _ = findings(folder)
    sets, terms = tables["form_mixture_porosities"], tables["form_mixture"].set_index("term").coefficient
    features = unified_features(rows[["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"]])
    by_hand = terms["intercept"] + sum(terms[name] * features[name] for name in terms.index.drop("intercept"))
    np.testing.assert_allclose(sets.model_n, by_hand, atol=1e-12)
    np.testing.assert_allclose(sets.model_difference, by_hand - sets.r22_n, atol=1e-12)
    assert (sets.model_n - sets.n).abs().max() > 1e-3


def test_other_studies_are_compared_with_r22_values(folder):
    tables, figures = findings(folder)
    cases = tables["validation"].set_index("case")
    assert cases.runs.tolist() == [2, 2] and cases.r22_n["U1"] == 0.383
    assert cases.experiment_error_percent["U1"] == pytest.approx(100 * (0.38 / 0.371 - 1))
    assert "validation" in figures and "mesh_resolution" not in tables


def test_cases_come_in_the_order_of_their_table(tmp_path):
    cases = [{"case": case, "run": 1, "n": 0.3, **ROWS} for case in ("B30", "mine", "U1", "U7", "B50")]
    pd.DataFrame(cases).to_csv(tmp_path / "validation.csv", index=False)
    assert read_rows(tmp_path / "validation.csv").case.tolist() == ["U1", "U7", "B30", "B50", "mine"]


def test_a_folder_without_rows_is_refused(tmp_path):
    with pytest.raises(ValueError, match="there is no table of packings; gather some first"):
        findings(tmp_path)


def test_rows_of_earlier_settings_have_no_note_on_today_s_bias(tmp_path):
    columns = dict.fromkeys(("table", "code", "command", "machine"), "x")
    rows = [("one", "synthetic", 0), ("two", "synthetic", 0), ("two", "scans", 3), ("not_shown", "synthetic", 1)]
    table = pd.DataFrame(rows, columns=["study", "source", "packings"]).assign(**columns)
    assert gathered_packings(tmp_path, ["one"]) == {}
    table.to_csv(tmp_path / "collected.csv", index=False)
    gathered = gathered_packings(tmp_path, ["one", "two", "three"])
    assert (
        list(gathered["collected"]) == ["study", "source", "packings", "code", "machine"]
        and len(gathered["collected"]) == 3
    )
    biases = {"one": "1", "two": "2", "three": "3"}
    assert notes_of_rows(biases, gathered) == biases | {"one": EARLIER}
    assert notes_of_rows(biases, {}) == biases


def test_findings_are_written_into_a_new_folder_by_their_names(tmp_path):
    figure = Figure()
    Findings({"both": pd.DataFrame({"n": [0.4]})}, {"both": figure}).write_into(tmp_path / "new")
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == ["both.csv", "both.pdf", "both.png"]

"""Tables of a study from evaluations of packings."""

import json

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.study_tables import mark, summarise, tabulate, tabulate_features
from simcore.evaluation.evaluate import evaluate
from simcore.grains.statistics import mixture_features
from simcore.models.shape_kinds import pair_shape_kinds
from simcore.models.tables import compare_predictions
from simcore.reference.columns import COLUMNS
from tests.helpers.packings import make_packing


class Line:
    """A model that predicts n = 2 x."""

    def predict(self, features):
        return 2 * features["x"].to_numpy()


@pytest.fixture
def evaluation():
    """Return the evaluation of 300 spheres of two sizes at random places in a periodic box, 0.1 m wide and high."""
    rng = np.random.default_rng(4)
    radius = np.repeat([0.008, 0.01], 150)
    position = rng.uniform(0.01, 0.1, (300, 3))
    scene = {"shapes": {"choice": "one", "grain": "G01", "kind": "polyhedron"}, "sizes": {"case": "U1"}}
    packing = make_packing(position, radius, scene=json.dumps(scene), seed=7, cpu_seconds=1.5, steps=4000, largest=0.02)
    return evaluate(packing, slice_height=2e-3)


def test_a_row_holds_the_setting_the_form_and_the_result(evaluation):
    table = tabulate("s", [{"packing": "p", "varied": {"shaking_s": 1.0}}], [evaluation])
    assert set(table) <= {column.name for column in COLUMNS}
    row = table.iloc[0]
    assert (row.study, row.packing, row.case, row.grain, row.seed, row.grains) == ("s", "p", "U1", "G01", 7, 300)
    assert (row.FL, row.sigma_EQ) == pytest.approx((1.0, 0.0))
    assert row.L == pytest.approx(0.018)
    assert (row.steps, row.cpu_s) == (4000, 1.5)
    assert (row.n, row.n_exact) == (float(evaluation.n), float(evaluation.n_exact))
    features = tabulate_features(table, [evaluation])
    assert (features.mu_EQ[0], features.kind[0], features.n[0]) == (1.0, "continuous", row.n)
    assert features["sample"][0] == "case U1, shaking_s 1.0, grain G01, kind polyhedron"
    assert set(mixture_features([2.0, 3.0], [1.0, 1.0], [0.5, 0.6]).index) <= set(features.columns)


def test_spheres_sliced_either_way_are_the_same(evaluation):
    assert float(evaluation.n) == pytest.approx(float(evaluation.n_exact), abs=1e-12)
    np.testing.assert_allclose(evaluation.profile, evaluation.profile_exact, atol=1e-12)


def runs(**columns):
    table = pd.DataFrame(columns)
    zero = dict.fromkeys(["FL", "EL", "EQ", "sigma_FL", "sigma_EL", "sigma_EQ", "n_exact", "coordination_number"], 0.0)
    return table.assign(study="s", grains=10, cpu_s=1800.0, **zero)


def test_means_are_over_the_seeds_alone():
    packings = runs(
        case=["U1"] * 3 + ["U7"] * 3, seed=[1, 2, 3] * 2, n=[0.40, 0.42, 0.44, 0.3, 0.3, 0.3], n_std_error=[0.03] * 6
    )
    table = summarise(packings, {"case": "U1", "seed": 1})
    assert table.case.tolist() == ["U1", "U7"]
    assert table.runs.tolist() == [3, 3]
    np.testing.assert_allclose(table.n, [0.42, 0.3])
    np.testing.assert_allclose(table.n_std, [0.02, 0.0], atol=1e-15)
    np.testing.assert_allclose(table.n_seed_error, [0.02 / np.sqrt(3), 0.0], atol=1e-15)
    np.testing.assert_allclose(table.n_std_error, 0.03 / np.sqrt(3))
    np.testing.assert_allclose(table.cpu_h, 1.5)  # the sum over all three packings


def test_a_setting_that_only_some_packings_have_leaves_none_out():
    packings = runs(case=["U1"] * 3, flatness=[np.nan, 0.9, 0.9], n=[0.36, 0.33, 0.35], n_std_error=[0.01] * 3)
    table = summarise(packings, {"flatness": 0.9})
    assert table.runs.tolist() == [1, 2]
    np.testing.assert_allclose(table.n, [0.36, 0.34])


def test_every_form_is_a_row_of_its_own():
    packings = runs(case=["U1"] * 2, grain=["a", "b"], n=[0.4, 0.5], n_std_error=[0.01, 0.02])
    assert summarise(packings, {"case": "U1"}).grain.tolist() == ["a", "b"]


def test_shape_kinds_are_paired_by_case_and_grain():
    meshes = pd.DataFrame({"case": ["U1"] * 3, "grain": ["a", "b", "c"], "EQ": [0.1, 0.2, 0.3], "n": [0.4, 0.5, 0.6]})
    ellipsoids = pd.DataFrame(
        {"case": ["U1"] * 3, "grain": ["c", "a", "a"], "EQ": [0.3, 0.1, 0.1], "n": [0.63, 0.4, 0.42]}
    )
    meshes, ellipsoids = (table.assign(n_std_error=0.004) for table in (meshes, ellipsoids))
    pairs = pair_shape_kinds(meshes, ellipsoids).set_index("grain")
    assert sorted(pairs.index) == ["a", "c"]
    assert pairs.loc["c", ["EQ", "n_mesh", "n_ellipsoid"]].tolist() == [0.3, 0.6, 0.63]
    assert pairs.loc["a", "n_ellipsoid"] == pytest.approx(0.41)
    # Grain a has two packings of ellipsoids.
    assert pairs.loc["a", ["n_mesh_error", "n_ellipsoid_error"]].tolist() == pytest.approx([4e-3, 4e-3 / np.sqrt(2)])


def test_predictions_leave_out_cases_without_a_model():
    table = pd.DataFrame({"case": ["U1", "U7", "U1"], "n": [0.4, 0.3, 0.5], "x": [0.2, 0.3, 0.1]})
    compared = compare_predictions({("m", "U1"): Line()}, "m", table)
    assert compared.simulated.tolist() == [0.4, 0.5]
    assert compared.predicted.tolist() == [0.4, 0.2]
    assert list(compared) == ["case", "simulated", "predicted"]


def test_predictions_keep_the_error_and_the_r22_prediction():
    table = pd.DataFrame({"case": ["U1"], "n": [0.4], "x": [0.2], "n_std_error": [0.003], "r22_n": [0.35]})
    row = compare_predictions({("m", "U1"): Line()}, "m", table).iloc[0]
    assert (row.simulated, row.predicted, row.n_std_error, row.r22_predicted) == (0.4, 0.4, 0.003, 0.35)


def test_mark_adds_test_only_to_every_row():
    table = pd.DataFrame({"n": [1, 2]})
    assert mark(table, True).note.tolist() == ["test only"] * 2
    assert list(mark(table, False)) == ["n"]

"""The rule that selects the packings to which the porosity models are fitted."""

import pandas as pd
import pytest

from simcore.models.fitting import fit_reference_models
from simcore.models.tables import over_seeds
from simcore.paths import REFERENCE
from simcore.reference.committed_rows import (
    SOURCE_OF_MIXTURES,
    fitted_forms,
    fitted_mixtures,
    read_cases_of_single_forms,
    read_mixtures,
    read_single_forms,
)
from simcore.report.committed import findings, read_rows
from tests.helpers.reference_rows import write_reference

ROWS = pd.DataFrame(
    {
        "source": ["synthetic", "synthetic", "scans", "scans"],
        "case": ["U1", "U1", "U1", "U7"],
        "representation": ["polyhedron", "ellipsoid", "polyhedron", "polyhedron"],
        "grain": ["G1"] * 4,
        "n": [0.40, 0.41, 0.42, 0.43],
    }
)


@pytest.mark.parametrize("name", ["representation", "kind"])
def test_only_polyhedra_of_the_chosen_source_and_cases_are_fitted(name):
    rows = ROWS.rename(columns={"representation": name})
    assert fitted_forms(rows).n.tolist() == [0.40, 0.42, 0.43]
    assert fitted_forms(rows, "scans").n.tolist() == [0.42, 0.43]
    assert fitted_forms(rows, "scans", cases=["U7"]).n.tolist() == [0.43]
    assert fitted_forms(rows.drop(columns=name), "synthetic").n.tolist() == [0.40, 0.41]


def test_a_grain_may_have_the_name_of_a_missing_value(tmp_path):
    rows = pd.DataFrame({"case": "U1", "grain": ["NA", "None", "B"], "EL": 0.7, "FL": [0.5, 0.6, 0.7], "n": 0.35})
    rows.to_csv(tmp_path / "single_form.csv", index=False)
    table = over_seeds(read_single_forms(tmp_path / "single_form.csv"), "grain")
    assert [name.strip() for name in table.grain] == ["NA", "None", "B"]


def test_reading_follows_the_rule_and_separates_grains_of_one_name(tmp_path):
    path = tmp_path / "single_form.csv"
    ROWS.assign(L=3.0, I=2.0, S=1.0).to_csv(path, index=False)
    table = read_single_forms(path)
    assert table.n.tolist() == [0.40, 0.42, 0.43] and table.grain.tolist() == ["synthetic G1", "scans G1", "scans G1"]
    pd.testing.assert_frame_equal(read_single_forms(path, "scans"), fitted_forms(table, "scans"))
    pd.testing.assert_frame_equal(read_cases_of_single_forms(path, ["U7"]), fitted_forms(table, cases=["U7"]))
    assert read_cases_of_single_forms(None, ["U7"]).empty


def test_packings_that_differ_in_their_seed_are_one_sample_in_the_table_of_a_study_and_in_committed_rows():
    path = REFERENCE / "form_mixture.csv"
    of_file, of_report = read_mixtures(path), fitted_mixtures(read_rows(path))
    in_order = [table.sort_values(list(of_file), ignore_index=True) for table in (of_file, of_report)]
    pd.testing.assert_frame_equal(*in_order)
    repeated = of_file.groupby(["case", "sample"]).n.size()
    assert len(repeated) < len(of_file) and repeated.sum() == len(of_file)


def test_predict_and_the_report_have_the_same_model_where_they_take_the_same_source(tmp_path):
    folder = write_reference(tmp_path)
    rows = pd.read_csv(folder / "single_form.csv").assign(n_error=0.002, grains=9, cpu_s=1.0)
    rows.to_csv(folder / "single_form.csv", index=False)
    (folder / "form_mixture.csv").unlink()
    tables, _ = findings(folder)
    for source in (SOURCE_OF_MIXTURES, "scans"):
        model = fit_reference_models(folder, source).models["single_form", "U1"]
        reported = tables["single_form"].query("source == @source and model == 'single_form'")
        # Inverses are taken in another order, so rounding differs; the sources differ by 0.01.
        assert reported.coefficient.tolist() == pytest.approx(model.coefficients, abs=1e-12)
        assert set(reported.samples) == {model.n_samples} == {20}

"""Rows of finished packings in the committed tables."""

import json

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.gathering import LEDGER, check_source, gather, not_gathered, record, rows_of, table_of, trends_of
from simcore.campaign.trend_tables import summarise_trends
from simcore.evaluation.evaluate import evaluate
from simcore.grains.sources import source_name
from simcore.models.fitting import fit_reference_models
from simcore.reference.columns import find_column
from simcore.reference.committed_rows import read_single_forms
from simcore.reference.named_tables import read_named_table
from simcore.scene.identity import result_digest
from simcore.scene.specification import resolve
from tests.helpers.packings import make_packing

SPECIFICATION = {
    "domain": {"width": "0.1 m", "height": "0.3 m"},
    "sizes": {"case": "U1"},
    "amount": {"grains": 300},
}


def specify(seed=1, **shapes):
    return resolve({**SPECIFICATION, "seed": seed, "shapes": shapes})


def evaluated(specification, axes=(0.011, 0.009, 0.007), n=None):
    """Return the evaluation of 300 grains at random places with this specification; n overrides the porosity."""
    packing = make_packing(
        np.random.default_rng(4).uniform(0.005, 0.06, (300, 3)),
        np.tile(0.5 * np.sort(axes), (300, 1)),
        width=0.05,
        scene=json.dumps(specification),
        seed=specification["seed"],
        cpu_seconds=36.04,
        steps=100,
        largest=0.011,
    )
    bed = evaluate(packing)
    return bed if n is None else bed.assign(n=n)


def test_single_forms_have_the_columns_of_their_table(tmp_path):
    rows, beds = [], []
    for grain in ("G02", "G01"):
        rows.append({"packing": grain, "varied": {"case": "U1", "seed": 1}})
        beds.append(evaluated(specify(choice="one", grain=grain)))
    table = rows_of("single_form_wide", rows, beds, "synthetic")
    assert gather(tmp_path, table_of("single_form_wide"), table) == 2
    ellipsoids = rows_of(
        "equivalent_ellipsoids",
        rows[:1],
        [evaluated(specify(kind="ellipsoid", choice="one", grain="G02"))],
        "synthetic",
    )
    assert gather(tmp_path, table_of("equivalent_ellipsoids"), ellipsoids) == 3
    written = pd.read_csv(tmp_path / "single_form.csv")
    assert ",".join(written) == "source,case,grain,representation,seed,L,I,S,n,n_error,grains,cpu_s"
    assert written.grain.tolist() == ["G01", "G02", "G02"]
    assert written.representation.tolist() == ["polyhedron", "ellipsoid", "polyhedron"]
    first = written.iloc[0]
    assert (first.L, first.I, first.S, first.grains, first.cpu_s) == (0.011, 0.009, 0.007, 300, 36.0)
    assert first.n == pytest.approx(float(beds[1].n), abs=5e-7)


def test_beds_of_size_and_form_have_the_composition_of_their_evaluated_part(tmp_path):
    varied = {"case": "U1", "width_m": 0.05, "mass_kg": 0.5, "seed": 1}
    rows = [{"packing": name, "varied": varied} for name in ("all", "one")]
    specifications = [specify(), specify(choice="one", grain="G01")]
    beds = [
        evaluated(specification).assign(sieve_bounds=(("sieve_class", "bound"), [[5.6e-3, 8e-3], [8e-3, 11.2e-3]]))
        for specification in specifications
    ]
    fractions = np.array([[[0.5, 0.5], [0.6, 0.4]], [[0.3, 0.7], [0.45, 0.55]]])
    beds = [bed.assign(sieve_fraction=(("part", "weight", "sieve_class"), fractions)) for bed in beds]
    for row, bed in zip(rows, beds, strict=True):
        gather(tmp_path, "size_and_form", rows_of("size_and_form", [row], [bed.assign_attrs(time=2.5)], "synthetic"))
    written = pd.read_csv(tmp_path / "size_and_form.csv", keep_default_na=False)
    assert sorted(written["grain"]) == ["", "G01"]
    row = written.iloc[0]
    assert (row["share_5.6-8mm"], row["share_8-11.2mm"], row["time_s"]) == (0.3, 0.7, 2.5)
    assert row["mu_EQ_evaluated"] == pytest.approx(7 / 11, abs=1e-6) and row["sigma_EQ_evaluated"] == 0.0
    assert row["coarse_lower"] == pytest.approx(float(beds[0]["coarse_share"].sel(half="lower")), abs=1e-6)
    assert row["fine_floor_error"] == pytest.approx(
        float(beds[0]["fine_share_std_error"].sel(zone="floor")), abs=1e-6, nan_ok=True
    )
    assert all(find_column("size_and_form", name) for name in written)


def test_beds_with_form_by_size_share_a_table(tmp_path):
    bed = evaluated(specify()).assign(sieve_bounds=(("sieve_class", "bound"), [[5.6e-3, 8e-3]])).assign_attrs(time=2.5)
    bed = bed.assign(sieve_fraction=(("part", "weight", "sieve_class"), np.ones((2, 2, 1))))
    for study in ("flat_coarse_grains", "flat_fine_grains"):
        row = {"packing": "seed_1", "varied": {"seed": 1}}
        gather(tmp_path, table_of(study), rows_of(study, [row], [bed], "synthetic"))
    written = pd.read_csv(tmp_path / "form_by_size.csv")
    assert written["study"].tolist() == ["flat_coarse_grains", "flat_fine_grains"]
    assert all(find_column("form_by_size", name) for name in written)


def test_an_evaluation_without_composition_is_refused():
    row = {"packing": "p", "varied": {"case": "U1", "width_m": 0.05, "mass_kg": 0.5, "seed": 1}}
    bed = evaluated(specify()).drop_vars("coarse_share_of_part").assign(sieve_fraction=0.0)
    with pytest.raises(ValueError, match="has no coarse_share_of_part; delete the file of its porosity"):
        rows_of("size_and_form", [row], [bed], "synthetic")


def test_mixtures_have_nominal_and_found_statistics(tmp_path):
    varied = {"case": "U1", "mean_FL": 0.4, "mean_EL": 0.6, "std_FL": 0.1, "std_EL": 0.2, "seed": 2}
    form = {"flatness": {"mean": 0.4, "std": 0.1}, "elongation": {"mean": 0.6, "std": 0.2}}
    bed = evaluated(specify(seed=2, choice="form_distribution", **form))
    gather(tmp_path, "form_mixture", rows_of("form_mixtures", [{"packing": "p", "varied": varied}], [bed], "synthetic"))
    text = (tmp_path / "form_mixture.csv").read_text().splitlines()
    assert text[0] == (
        "case,mu_FL_nominal,sigma_FL_nominal,mu_EL_nominal,sigma_EL_nominal,mu_EQ,sigma_EQ,mu_EL,sigma_EL,seed,"
        "n,n_error,grains,cpu_s"
    )
    assert text[1].startswith("U1,0.4,0.1,0.6,0.2,0.636364,0.0,0.818182,0.0,2,")


def test_trends_are_kept_of_what_differs_between_grains(tmp_path):
    rows = [{"packing": name, "varied": {"case": "U1", "seed": 1}} for name in ("a", "b")]
    bed = evaluated(specify(choice="one", grain="G02"))
    assert trends_of("single_form", rows[:1], [bed], "synthetic").empty, "all grains of this bed are alike"
    beds = [bed.assign(spearman_r=bed.spearman_r.where(bed["quantity"] != "angle", 0.123456))] * 2
    table = trends_of("single_form", rows, beds, "synthetic")
    assert table.quantity.tolist() == ["angle", "angle"] and (table.spearman_r == 0.1235).all()
    gather(tmp_path, "trends", table)
    gather(tmp_path, "trends", trends_of("single_form", rows[1:], beds[1:], "synthetic"))
    written = pd.read_csv(tmp_path / "trends.csv")
    assert written.packing.tolist() == ["a", "b"] and list(written)[:3] == ["source", "study", "packing"]
    summary = summarise_trends(written)
    assert summary.packings.tolist() == [2] and summary.grains[0] == 2 * written.grains[0]


def test_validation_counts_runs_and_other_studies_keep_what_they_vary():
    bed = evaluated(specify(seed=3))
    table = rows_of("validation", [{"packing": "p", "varied": {"case": "U1", "seed": 3}}], [bed], "synthetic")
    assert list(table) == ["case", "run", "n", "n_error", "grains", "cpu_s"] and table.run[0] == 3
    table = rows_of(
        "shaking_cylinder", [{"packing": "p", "varied": {"case": "U1", "shaking_s": 2.0, "seed": 3}}], [bed], "x"
    )
    assert list(table) == ["case", "shaking_s", "seed", "n", "n_error", "grains", "cpu_s"]


def test_a_study_that_varies_forms_and_kinds_has_each_column_once(tmp_path):
    """Beds of all forms, of one form and of spheres in one study, gathered one after the other."""
    for shapes in ({}, {"choice": "one", "grain": "G02"}, {"kind": "sphere"}):
        varied = {
            "case": "R4_65",
            "shape_kind": shapes.get("kind", "polyhedron"),
            "grain": shapes.get("grain"),
            "seed": 1,
        }
        table = rows_of(
            "forms_and_kinds", [{"packing": "p", "varied": varied}], [evaluated(specify(**shapes))], "synthetic"
        )
        gather(tmp_path, "forms_and_kinds", table)
    written = pd.read_csv(tmp_path / "forms_and_kinds.csv")
    assert ",".join(written) == "case,shape_kind,grain,seed,n,n_error,grains,cpu_s"
    assert sorted(written.grain.fillna("").tolist()) == ["", "", "G02"]


def test_accuracies_lie_beside_rows_that_no_campaign_has(tmp_path):
    path = tmp_path / "accuracy.csv"
    path.write_text("accuracy,case,seed,grains,n,cpu_s\nr22,U1,1,600,0.35,900.0\nof old,U1,1,600,0.34,90.0\n")
    varied = {"case": "U1", "seed": 1, "accuracy": "r22"}
    rows = rows_of("accuracy", [{"packing": "p", "varied": varied}], [evaluated(specify(), n=0.36)], "synthetic")
    gather(tmp_path, table_of("accuracy"), rows)
    assert path.read_text().splitlines()[1:] == ["of old,U1,1,600,0.34,90.0", "r22,U1,1,300,0.36,36.0"]


def test_rows_stay_until_the_same_packing_comes_again(tmp_path):
    rows = pd.DataFrame(
        {"case": ["U7", "U1"], "run": [1, 2], "n": [0.3, 0.4], "n_error": 0.01, "grains": 9, "cpu_s": 1.0}
    )
    assert gather(tmp_path, "validation", rows) == 2
    before = (tmp_path / "validation.csv").read_bytes()
    assert gather(tmp_path, "validation", rows[:1]) == 2
    assert (tmp_path / "validation.csv").read_bytes() == before
    assert gather(tmp_path, "validation", rows[:1].assign(n=0.31)) == 2
    assert pd.read_csv(tmp_path / "validation.csv").n.tolist() == [0.4, 0.31]
    with pytest.raises(ValueError, match="has the columns case, run, n"):
        gather(tmp_path, "validation", rows.drop(columns="n_error"))


def test_rows_are_sorted_by_numbers_and_then_words(tmp_path):
    for faces in ([300, 50], ["original"], [2000]):
        gather(tmp_path, "numbers", pd.DataFrame({"faces": faces, "n": 0.4}))
    assert pd.read_csv(tmp_path / "numbers.csv")["faces"].tolist() == ["50", "300", "2000", "original"]


def test_a_number_is_the_same_beside_words_and_empty_cells(tmp_path):
    """A column with an empty cell is written as 300.0, and one with a word as 300."""
    for faces in ([300, None], ["original"], [300, None]):
        gather(tmp_path, "numbers", pd.DataFrame({"faces": faces, "n": 0.4}))
    assert sorted(pd.read_csv(tmp_path / "numbers.csv")["faces"].fillna("none").str.removesuffix(".0")) == [
        "300", "none", "original",
    ]  # fmt: skip


@pytest.mark.parametrize("names", [("007", "008"), ("1e5", "NA"), ("12", "nan"), ("1", "1.0")])
def test_names_of_grains_that_look_like_numbers_are_text(tmp_path, names):
    rows, beds = [], []
    for name in names:
        rows.append({"packing": name, "varied": {"case": "U1", "seed": 1}})
        beds.append(evaluated(specify(choice="one", grain=name)))
    table = rows_of("single_form", rows, beds, "2024")
    assert [gather(tmp_path, "single_form", table) for _ in range(2)] == [2, 2]
    written = read_named_table(tmp_path / "single_form.csv")
    assert sorted(written.grain) == sorted(names) and set(written.source) == {"2024"}
    assert sorted(read_single_forms(tmp_path / "single_form.csv").grain) == sorted(f"2024 {name}" for name in names)


@pytest.mark.parametrize("source", ["2024", "NA", "synthetic"])
def test_a_source_of_any_name_is_found_in_the_ledger(tmp_path, source):
    planned = [{"row": {"packing": "1e3"}, "specification": specify(), "cpu_h": 1.0}]
    made = pd.DataFrame(
        {"packing": ["1e3"], "settings": result_digest(specify()), "cpu_s": 1.0, "grain_steps": 1, "code": "12e4567"}
    ).assign(evaluation="0123456", grain_set="")
    for _ in range(2):
        record(tmp_path, "t", "study", source, planned, made, command="c", machine="m")
        assert not_gathered(tmp_path, "study", source, planned) == []
    ledger = (tmp_path / "gathered.csv").read_text().splitlines()
    assert len(ledger) == 2 and ledger[1].endswith(",12e4567,0123456")
    assert len((tmp_path / "collected.csv").read_text().splitlines()) == 2


def test_packings_that_the_columns_do_not_distinguish_are_refused(tmp_path):
    """A study of frictions would leave one row of each grain, the last one."""
    rows = [{"packing": f"friction_{mu}", "varied": {"case": "U1", "friction": mu, "seed": 1}} for mu in (0.3, 0.9)]
    beds = [evaluated(specify(choice="one", grain="G02"))] * 2
    with pytest.raises(ValueError, match="two packings have the same row, .* grain G02, .* another name"):
        gather(tmp_path, "single_form", rows_of("single_form", rows, beds, "synthetic"))
    assert not (tmp_path / "single_form.csv").exists()
    assert gather(tmp_path, "rough", rows_of("rough", rows, beds, "synthetic")) == 2


def test_rows_of_other_grains_do_not_replace_those_of_a_table_without_a_source(tmp_path):
    planned = [{"row": {"packing": "p"}, "specification": specify(), "cpu_h": 1.0}]
    made = pd.DataFrame(
        {
            "packing": ["p"],
            "settings": "s",
            "grain_set": "",
            "cpu_s": 1.0,
            "grain_steps": 1,
            "code": "",
            "evaluation": "",
        }
    )
    rows, of_sources = pd.DataFrame(columns=["case", "seed", "n"]), pd.DataFrame(columns=["source", "case", "n"])
    check_source(tmp_path, "form_mixtures", "scans", rows)
    for study in ("form_mixtures", "single_form"):
        record(tmp_path, table_of(study), study, "synthetic", planned, made, command="c", machine="m")
        check_source(tmp_path, study, "synthetic", rows)
    check_source(tmp_path, "single_form", "scans", of_sources)
    check_source(tmp_path, "friction", "scans", rows)
    with pytest.raises(ValueError, match="form_mixture.csv has rows of grains from synthetic, and no column .* scans$"):
        check_source(tmp_path, "form_mixtures_wide", "scans", rows)
    check_source(tmp_path, "form_mixtures_wide", "scans", rows.assign(grain_source="scans"))
    with pytest.raises(ValueError, match="friction.csv has rows of grains from rhine, and no column .* scans$"):
        check_source(tmp_path, "friction", "scans", rows, other_sources=["rhine"])


def test_a_key_that_is_left_open_is_the_same_in_a_file(tmp_path):
    rows = pd.DataFrame({"case": "U1", "spacing": [None, None], "seed": [1, 2], "n": [0.3, 0.4], "grains": 9})
    assert [gather(tmp_path, "difference_x", rows) for _ in range(2)] == [2, 2]


def test_the_summary_remains_when_the_packings_are_deleted(tmp_path):
    """Packings are gathered on two machines, and the second has only those that the first left."""
    plan = [{"row": {"packing": f"p{seed}"}, "specification": specify(seed), "cpu_h": 0.5} for seed in (1, 2, 3)]

    def made(*numbers):
        rows = [(f"p{i}", result_digest(specify(i)), "", 360.0 * i, 10**9 * i, f"v{i}", "e") for i in numbers]
        return pd.DataFrame(rows, columns=LEDGER[2:])

    record(tmp_path, "single_form", "single_form", "synthetic", plan, made(1), "a", "one")
    left = not_gathered(tmp_path, "single_form", "synthetic", plan)
    assert [each["row"]["packing"] for each in left] == ["p2", "p3"]
    assert not_gathered(tmp_path, "single_form", "scans", plan) == plan
    record(tmp_path, "single_form", "equivalent_ellipsoids", "synthetic", plan, made(), "a", "one")
    record(tmp_path, "single_form", "single_form", "synthetic", plan, made(3), "a", "two")
    written = pd.read_csv(tmp_path / "collected.csv")
    assert written.study.tolist() == ["equivalent_ellipsoids", "single_form"]
    assert written.packings.tolist() == [0, 2] and written.planned.tolist() == [3, 3]
    found = written.iloc[1]
    assert (found.cpu_h, found.cpu_h_left_estimated, found.code, found.machine) == (0.4, 0.5, "v1 v3", "one; two")
    assert found.cpu_h_estimated == 1.0 and written.cpu_h_estimated[0] == 0.0
    assert pd.isna(written.machine[0]), "nothing was packed"
    assert found.r22_cpu_h == round(4e9 * 230 / (20_000 * 1.5e6), 2)
    older = pd.read_csv(tmp_path / "gathered.csv").drop(columns=["grain_steps", "evaluation"])
    older.to_csv(tmp_path / "gathered.csv", index=False)
    record(tmp_path, "single_form", "single_form", "synthetic", plan, made(2), "a", "two")
    ledger = pd.read_csv(tmp_path / "gathered.csv")
    assert ledger.grain_steps.fillna(0).tolist() == [0, 2e9, 0]
    assert ledger.evaluation.fillna("").tolist() == ["", "e", ""]


def test_a_row_of_other_settings_is_no_row_of_a_packing(tmp_path):
    plan = [{"row": {"packing": "p"}, "specification": specify(1), "cpu_h": 0.5}]
    made = pd.DataFrame([("p", result_digest(specify(2)), "", 9.0, 30_000, "v", "e")], columns=LEDGER[2:])
    record(tmp_path, "single_form", "single_form", "synthetic", plan, made, "a", "one")
    assert not_gathered(tmp_path, "single_form", "synthetic", plan) == plan
    assert pd.read_csv(tmp_path / "collected.csv").packings[0] == 0


def test_a_row_of_other_grains_of_the_same_name_is_no_row_of_a_packing(tmp_path):
    """The folder of the grains has the same name, but the digest of their files in the name of the set differs."""

    def plan(digest):
        own = specify(choice="one", grain="a")
        own["grains"]["source"] = f"results/mine/grains/gravel_{digest}/faces_100.nc"
        return [{"row": {"packing": "p"}, "specification": own, "cpu_h": 0.5}]

    old, new = plan("11111111"), plan("22222222")
    settings = result_digest(old[0]["specification"])
    assert settings == result_digest(new[0]["specification"])
    made = pd.DataFrame([("p", settings, "gravel_11111111", 9.0, 30_000, "v", "e")], columns=LEDGER[2:])
    record(tmp_path, "mine", "mine", "gravel", old, made, "a", "one")
    assert not_gathered(tmp_path, "mine", "gravel", old) == []
    assert not_gathered(tmp_path, "mine", "gravel", new) == new


def test_a_campaign_keeps_the_entry_of_another_for_a_study(tmp_path):
    """An overlay also contains the studies of the file below it, with other sizes, but gathers none of them."""

    def tell(seed, command, *made, source="synthetic"):
        plan = [{"row": {"packing": "p"}, "specification": specify(seed), "cpu_h": 0.5 * seed}]
        rows = [("p", result_digest(specify(seed)), "", 9.0, 30_000, "v", "e")] if made else []
        record(tmp_path, "t", "t", source, plan, pd.DataFrame(rows, columns=LEDGER[2:]), command, "one")
        return pd.read_csv(tmp_path / "collected.csv").set_index("source").loc[source]

    assert tell(1, "a").cpu_h_left_estimated == 0.5
    assert tell(2, "b").cpu_h_left_estimated == 0.5, "planned by a first"
    assert tell(3, "a").cpu_h_left_estimated == 1.5, "planned anew"
    found = tell(2, "b", "made")
    assert (found.packings, found.command, found.machine) == (1, "a; b", "one")
    with pytest.raises(KeyError, match="rhine"):
        tell(4, "a", source="rhine")
    assert tell(4, "a", "made", source="rhine").packings == 1


def test_the_source_is_named_by_its_folder():
    assert [source_name(s) for s in ("synthetic", "/data/scans", ["a/b.stl"])] == ["synthetic", "scans", "b.stl"]


def test_the_models_are_fitted_to_gathered_rows(tmp_path):
    """Half of a study is enough; `predict` reads the table as it is."""
    rows, beds = [], []
    for number, longest in enumerate((0.009, 0.010, 0.012, 0.013, 0.015, 0.016)):
        rows.append({"packing": str(number), "varied": {"case": "U1", "seed": 1}})
        shortest = 0.005 + 0.001 * (number % 3)
        n = 0.25 + 0.02 * longest / shortest + 0.01 * longest / 0.009
        beds.append(evaluated(specify(choice="one", grain=f"G{number}"), (longest, 0.009, shortest), n))
    gather(tmp_path, "single_form", rows_of("single_form", rows, beds, "synthetic"))
    fitted = fit_reference_models(tmp_path)
    assert fitted.models["single_form", "U1"].coefficients == pytest.approx((0.25, 0.02, 0.01), abs=1e-4)


def test_keys_that_came_later_decide_nothing_at_their_defaults():
    """Rows were committed before `grains.bodies` and `sizes.own` existed."""
    now = specify()
    before = {**now}
    for group, key in (("grains", "bodies"), ("sizes", "own")):
        before[group] = {name: value for name, value in now[group].items() if name != key}
    assert result_digest(before) == result_digest(now)
    split = {**now, "grains": {**now["grains"], "bodies": "split"}}
    assert result_digest(split) != result_digest(now)

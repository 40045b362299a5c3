"""The plan of a campaign: hours, pieces, ranks, time and memory of studies, packings left and models fitted."""

import copy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import trimesh

from simcore.campaign.estimates import describe_studies, estimate_studies, number_pieces
from simcore.campaign.plan import SMALLEST_MIXTURE_STUDY, SMALLEST_SINGLE_FORM_STUDY, Plan, is_dry_run
from simcore.campaign.plan_checks import check_shared_tables
from simcore.evaluation.interval import campaign_cut
from simcore.models.mixtures import MIXTURE
from simcore.models.regression import fewest_samples
from simcore.models.single_form import SINGLE_FORM
from simcore.packing.cost import COMPILED_MEMORY, COMPILING_MEMORY, COPIES, PackingCost, estimate
from simcore.scene.identity import result_digest
from simcore.scene.sizes import all_cases
from simcore.scene.specification import resolve

CAMPAIGN = {
    "packing": {"domain": {"width": "45 mm", "height": "0.3 m"}, "amount": {"grains": 100}, "sizes": {"case": "U1"}},
    "studies": {
        "single_form": {"varies": {"sizes.case": ["U1", "U3"]}, "forms": {"spread": 2}, "title": "One form"},
        "spheres": {
            "in_all": False,
            "fixes": {"shapes": {"kind": "sphere"}},
            "varies": {"amount.grains": [100, 400], "seed": [1, 2]},
        },
        "deposit_map": {"in_all": False, "fixes": {"shapes": {"kind": "sphere"}}},
    },
    "ranks": 4,
    "threads": 2,
    "grains_per_rank": 100,
    "mpiexec": "mpiexec -n 2",
}


def plan_of(tmp_path=None, **changes):
    """Return the Plan of CAMPAIGN with some of its groups changed."""
    raw = copy.deepcopy(CAMPAIGN) | changes
    raw["pathvars"] = {"results": str(tmp_path or "results")}
    if tmp_path is not None:
        raw["reference"] = str(tmp_path / "rows")
    return Plan(resolve(raw, "config"))


def test_pieces_are_within_their_hours_and_the_first_seed_comes_first():
    seeds = np.tile([1, 2], 10)
    hours = np.full(20, 0.5)
    pieces = number_pieces(hours, seeds, 2.0)
    assert [hours[pieces == piece].sum() for piece in range(1, 6)] == [2.0] * 5
    assert pieces[seeds == 1].max() == pieces[seeds == 2].min() == 3


def test_a_packing_longer_than_a_piece_is_one_by_itself():
    assert number_pieces([0.1, 5.0, 0.1, 0.2], [1, 1, 1, 1], 2.0).tolist() == [1, 2, 3, 3]


def test_the_hours_of_all_are_those_of_the_studies_in_it():
    steps = {"generating": 4, "shaking": 3, "damping": 3, "longest_damping": 9}
    cost = PackingCost(grains=100, batches=1, **steps, cpu_seconds=1800.0, array_bytes=0.0, time_step=1e-5)
    assert cost.steps == 10
    packings = pd.DataFrame({"study": ["a", "a", "other", "b"], "cost": [cost] * 4, "piece": [1, 2, 1, 1]})
    table = estimate_studies(packings, ["a", "b"]).set_index("study")
    assert list(table.index) == ["a", "b", "all", "other"]
    assert table.loc["all", ["packings", "grains", "cpu_h", "longest_h", "pieces"]].tolist() == [3, 300, 1.5, 0.5, 3]
    assert table.cpu_h["other"] == pytest.approx(0.5)
    text = describe_studies(table.reset_index(), 2)
    assert "all" in text and "1.50" in text and "a_piece_1" in text


def test_a_plan_has_its_studies_with_their_titles():
    plan = plan_of()
    assert plan.all_studies == ["single_form", "spheres", "deposit_map"] and plan.studies == ["single_form"]
    assert plan.titles == {"single_form": "One form"} and plan.title("spheres") == "spheres"
    assert plan.studies_named("deposit_") == ["deposit_map"]
    assert set(plan.in_report.study) == {"single_form"} and len(plan.of("spheres", "deposit_map")) == 5
    assert plan.varied("spheres") == ["grains_asked", "seed"]
    assert plan.packings.study[plan.packings.is_first].tolist() == plan.all_studies


def test_ranks_cores_time_and_memory_are_those_of_the_estimate():
    plan = plan_of()
    few, many = (plan.of("spheres").query("ranks == @ranks").packing.iloc[0] for ranks in (1, 4))
    cost = estimate(plan.of("spheres").set_index("packing").specification[many])
    assert cost.grains == 400
    assert [plan.cores("spheres", packing) for packing in (few, many)] == [2, 8]
    assert plan.mpiexec("spheres", few) == "" and plan.mpiexec("spheres", many) == "mpiexec -n 2"
    assert plan.minutes("spheres", many, 3) == 3 * cost.minutes(8)
    assert plan.memory_mb("spheres", many) == cost.memory_mb(4)
    again = plan.memory_mb("spheres", many, 2) - cost.memory_mb(4)
    assert again == pytest.approx(COPIES * 1e-6 * cost.array_bytes, abs=1.0)
    assert plan.memory_mb("spheres", many, 9) == plan.memory_mb("spheres", many, 2)  # later attempts only continue
    assert plan.nodes("spheres", many) == 1


def test_ranks_whose_step_is_compiled_first_need_less_memory_in_the_first_attempt():
    plan, first = plan_of(), plan_of(compile_first=True)
    many = plan.of("spheres").query("ranks == 4").packing.iloc[0]
    saved = 4 * 1e-6 * (COMPILING_MEMORY - COMPILED_MEMORY)
    assert plan.memory_mb("spheres", many) - first.memory_mb("spheres", many) == pytest.approx(saved, abs=1.0)
    assert plan.memory_mb("spheres", many, 2) == first.memory_mb("spheres", many, 2)


def test_memory_is_that_of_the_ranks_of_one_node():
    plan = plan_of(cores_per_node=6)  # three ranks of two threads
    many = plan.of("spheres").query("ranks == 4").packing.iloc[0]
    cost = estimate(plan.of("spheres").set_index("packing").specification[many])
    assert plan.nodes("spheres", many) == 2
    assert plan.memory_mb("spheres", many) == cost.memory_mb(3)
    assert plan_of(cores_per_node=2).nodes("spheres", many) == 4
    with pytest.raises(ValueError, match="2 threads of a rank need as many cores, but cores_per_node is 1"):
        plan_of(cores_per_node=1)


def test_time_grows_up_to_that_of_the_longest_job():
    plan = plan_of(longest_job="30 min")
    many = plan.of("spheres").query("ranks == 4").packing.iloc[0]
    minutes = plan_of().minutes("spheres", many)
    assert plan.minutes("spheres", many) == minutes < 30
    assert plan.minutes("spheres", many, 9) == 30


def test_packings_that_differ_in_seed_or_amount_are_compiled_once():
    plan = plan_of()
    assert len(plan.of("spheres")) == 4
    assert plan.compiled_with("spheres") == "spheres" and plan.compiled_with("single_form") == "all"
    (specification,) = plan.steps_to_compile("spheres")
    assert specification["shapes"]["kind"] == "sphere"
    assert {s["shapes"]["kind"] for s in plan.steps_to_compile("all")} == {"polyhedron"}


def test_pieces_hold_each_packing_once_and_the_first_seed_first():
    hours = [cost.cpu_seconds / 3600.0 for cost in plan_of().of("spheres").cost]
    plan = plan_of(piece_hours=1.01 * (min(hours) + max(hours)))
    pieces = [(piece, names) for study, piece, names in plan.pieces() if study == "spheres"]
    assert [piece for piece, _ in pieces] == [1, 2]
    of_seed = {row.packing: row.specification["seed"] for row in plan.of("spheres").itertuples()}
    assert [{of_seed[name] for name in names} for _, names in pieces] == [{1}, {2}]
    assert f"{'spheres':<24}{4:>9}{1000:>10}" in plan.description()


def test_grain_sets_are_found_by_their_names():
    plan = plan_of()
    (folder,) = plan.of("single_form").grain_folder.unique()
    assert folder == plan.grain_set and plan.grain_group(folder) == plan.campaign["grains"]
    assert plan.shows_grains and set(plan.of("spheres").grain_folder) == {""}
    spheres = {"studies": {"spheres": {"fixes": {"shapes": {"kind": "sphere"}}}}}
    assert not plan_of(**spheres).shows_grains
    with pytest.raises(KeyError):
        plan.grain_group("synthetic_00000000")


def test_what_has_a_row_of_these_settings_is_not_left(tmp_path):
    plan = plan_of(tmp_path)
    everything = plan.files_left("spheres")
    assert everything == [f"<results>/porosity/spheres/{name}.nc" for name in plan.of("spheres").packing]
    first, second = plan.planned("spheres")[:2]
    assert first["cpu_h"] == pytest.approx(estimate(first["specification"]).cpu_seconds / 3600.0)
    rows = [
        ("spheres", "synthetic", first["row"]["packing"], result_digest(first["specification"])),
        ("spheres", "synthetic", second["row"]["packing"], "of other settings"),
        ("single_form", "elsewhere", *_row(plan.planned("single_form")[0])),
        ("deposit_map", "ellipsoids", *_row(plan.planned("deposit_map")[0])),
    ]
    (tmp_path / "rows").mkdir()
    ledger = pd.DataFrame(rows, columns=["study", "source", "packing", "settings"])
    ledger.to_csv(tmp_path / "rows" / "gathered.csv", index=False)
    assert plan.files_left("spheres") == everything[1:]
    assert len(plan.files_left("single_form")) == 4
    assert plan.files_left("deposit_map") == []


def _row(planned):
    return planned["row"]["packing"], result_digest(planned["specification"])


def test_rows_of_other_studies_are_gathered_where_something_was_evaluated(tmp_path):
    assert list(plan_of(tmp_path).to_gather()) == ["single_form"]
    (tmp_path / "porosity" / "spheres").mkdir(parents=True)
    planned = plan_of(tmp_path).to_gather()
    assert list(planned) == ["single_form", "spheres"]
    assert {source: len(packings) for source, packings in planned["spheres"].items()} == {"synthetic": 4}


def test_cases_are_fitted_to_committed_rows_unless_they_are_packed():
    plan = plan_of(models={"committed": ["U7", "U3", "U1"]})
    assert plan.cases_committed == ["U7"]
    assert plan.committed_single_forms.name == "single_form.csv"
    assert plan_of(models={"committed": ["U1"]}).committed_single_forms is None


def test_the_smallest_study_of_mixtures_is_the_smallest_that_is_fitted():
    assert SMALLEST_MIXTURE_STUDY == fewest_samples(MIXTURE)


FEW = {"sizes": {"allow_few_top_grains": True}}


def mixtures(number, **varies):
    """Return a study of `number` distributions of form."""
    means = [{"shapes.flatness.mean": 0.5 + 0.02 * i, "shapes.elongation.mean": 0.7} for i in range(number)]
    deviations = {"flatness": {"mean": 0.5, "std": 0.1}, "elongation": {"mean": 0.7, "std": 0.1}}
    return {"fixes": {"shapes": {"choice": "form_distribution", **deviations}}, "varies": {"means": means, **varies}}


@pytest.mark.parametrize("number", [SMALLEST_MIXTURE_STUDY - 1, SMALLEST_MIXTURE_STUDY])
def test_a_model_of_mixtures_needs_enough_of_them(number):
    """Packings that differ in their seed are one mixture, and each sieve curve has a model of its own."""
    enough = number == SMALLEST_MIXTURE_STUDY
    assert plan_of(studies={"form_mixtures": mixtures(number, seed=[1, 2])}).fits_mixtures == enough
    cases = ["U1", "U3"]
    assert plan_of(studies={"form_mixtures": mixtures(number, **{"sizes.case": cases})}).fits_mixtures == enough
    assert not plan_of().fits_mixtures


def test_each_study_of_all_has_the_effects_of_its_settings():
    effects = plan_of().bias_effects()
    assert list(effects) == ["single_form"]
    assert [kind for kind, _ in effects["single_form"]] == [
        "settings",
        "size of the bed",
        "time of shaking",
        "insertion",
    ]


def test_a_study_has_the_question_that_it_asks():
    studies = {"asking": {"question": "Why?", "fixes": {"shapes": {"kind": "sphere"}}}}
    questions = plan_of(studies=studies).questions
    assert questions == {"asking": "Why?"}


def test_the_report_begins_with_committed_rows_if_they_have_a_study_of_the_campaign():
    assert (plan_of().committed_rows / "single_form.csv").exists()
    assert plan_of(test_only=True).committed_rows is None
    studies = {"single_form": None, "mine": {"fixes": {"shapes": {"kind": "sphere"}}}}
    assert plan_of(studies=studies).committed_rows is None


def test_other_grains_or_material_are_no_repetition_of_the_committed_rows():
    """Their report does not begin with those rows, and no model of such rows stands beside their own."""
    changed = (
        {"packing": CAMPAIGN["packing"] | {"material": {"friction": 0.3}}},
        {"grains": {"seed": 2}},
        {"grains": {"number": 40}},
    )
    models = {"committed": ["U7"]}
    assert plan_of(models=models).cases_committed == ["U7"]
    for change in changed:
        plan = plan_of(models=models, **change)
        assert plan.committed_rows is None and plan.cases_committed == []
    own = copy.deepcopy(CAMPAIGN["studies"]) | {"friction": {"fixes": FEW, "varies": {"material.friction": [0.1, 0.5]}}}
    assert plan_of(models=models, studies=own).cases_committed == ["U7"]
    own["single_form"]["fixes"] = own["single_form"].get("fixes", {}) | {"grains": {"seed": 2}}
    plan = plan_of(models=models, studies=own)
    assert plan.committed_rows is None and plan.cases_committed == []


def test_rows_of_a_campaign_of_ones_own_are_shown_if_the_report_has_their_table(tmp_path):
    rows = {"reference": str(tmp_path), "packing": CAMPAIGN["packing"] | {"material": {"friction": 0.3}}}
    assert plan_of(**rows).committed_rows is None
    (tmp_path / "spheres.csv").touch()
    assert plan_of(**rows).committed_rows is None
    (tmp_path / "single_form.csv").touch()
    assert plan_of(**rows).committed_rows == tmp_path


def test_a_bed_too_low_is_refused_with_its_name():
    study = {"low": {"fixes": {"shapes": {"kind": "sphere"}, "amount": {"grains": 8}}}}
    with pytest.raises(ValueError, match="studies.low, packing low"):
        plan_of(studies=study).check()
    plan_of(studies={"deposit_map": study["low"]}).check()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("report", "studies.report: a rule or a table of the workflow has this name; choose another name"),
        ("all", "studies.all: a rule or a table of the workflow has this name"),
        ("shape_kinds", "studies.shape_kinds: a rule or a table of the workflow has this name"),
        ("mine_piece_1", "studies.mine_piece_1: a rule or a table of the workflow has this name"),
        ("mine_left", "studies.mine_left: a rule or a table of the workflow has this name"),
        ("mine_packings", "studies.mine_packings: a rule or a table of the workflow has this name"),
        ("mine_features", "studies.mine_features: a rule or a table of the workflow has this name"),
        ("mine_trends", "studies.mine_trends: a rule or a table of the workflow has this name"),
        (
            "deposit_mine",
            "studies.deposit_mine: the name has no known family; names of deposits begin with deposit_map",
        ),
        ("Single-Form", "studies: 'Single-Form' is no name of a study; use small letters"),
    ],
)
def test_a_name_that_the_workflow_cannot_have_is_refused(name, message):
    with pytest.raises(ValueError, match=message):
        plan_of(studies=dict.fromkeys(("mine", name), {"fixes": {"shapes": {"kind": "sphere"}}})).check()


def test_an_error_of_one_packing_names_its_study():
    fixes = {"shapes": {"kind": "sphere"}, "material": {"fluid_density": "2700 kg/m3"}}
    with pytest.raises(ValueError, match="studies.mine, packing mine: material.fluid_density: 2700"):
        plan_of(studies={"mine": {"fixes": fixes}})


def test_a_study_outside_all_makes_no_model():
    study = mixtures(SMALLEST_MIXTURE_STUDY)
    assert plan_of(studies={"form_mixtures": study}).fits_mixtures
    assert not plan_of(studies={"form_mixtures": {**study, "in_all": False}}).fits_mixtures
    # Committed rows are fitted for a case that only a study outside `all` packs.
    wide = {"in_all": False, "varies": {"sizes.case": ["U5"]}, "forms": {"spread": 2}, "fixes": FEW}
    both = CAMPAIGN["studies"] | {"single_form_wide": wide}
    assert plan_of(models={"committed": ["U5"]}, studies=both).cases_committed == ["U5"]


def test_studies_of_one_table_have_the_same_settings():
    """One table and one model would mix their packings, and a row of one would replace that of the other."""
    rough = {"fixes": {"material": {"friction": 0.9}}, "varies": {"sizes.case": ["U1"]}, "forms": {"spread": 2}}
    smooth = CAMPAIGN["studies"]["single_form"]
    message = r"single_form_rough: single_form/\S* and single_form_rough/\S* have .* differ in material.friction,"
    with pytest.raises(ValueError, match=message):
        check_shared_tables(plan_of(studies={"single_form": smooth, "single_form_rough": rough}).packings)
    others = {"single_form": smooth, "single_form_rough": {**rough, "forms": ["synthetic_000001"]}}
    message = "single_form_rough: one model is fitted to its packings and to those of studies.single_form, .*friction;"
    with pytest.raises(ValueError, match=message):
        plan_of(studies=others).check()
    others["single_form_rough"]["in_all"] = False
    plan_of(studies=others).check()
    larger = {"fixes": {"domain": {"height": "0.9 m"}}, "varies": {"sizes.case": ["U1"]}, "forms": ["synthetic_000001"]}
    plan_of(studies={"single_form": smooth, "single_form_long": larger}).check()
    check_shared_tables(plan_of(studies={"single_form": smooth, "friction_single_form": rough}).packings)
    wide = {"varies": {"sizes.case": ["U5"]}, "forms": {"spread": 2}, "fixes": FEW}
    check_shared_tables(plan_of(studies={"single_form": smooth, "single_form_wide": wide}).packings)
    varied = {"form_mixtures": mixtures(2, **{"material.friction": [0.3, 0.9]})}
    with pytest.raises(ValueError, match="studies.form_mixtures: .* differ in material.friction"):
        check_shared_tables(plan_of(studies=varied).packings)


def test_two_folders_of_grains_with_one_name_are_refused(tmp_path):
    """Rows of packings have the name of the folder alone, so rows of one would be taken for those of the other."""
    for site, side in (("left", 0.009), ("right", 0.011)):
        folder = tmp_path / site / "grains"
        folder.mkdir(parents=True)
        for name in "ab":
            trimesh.creation.box((0.007, 0.008, side)).export(folder / f"{name}.stl")
    folders = [str(tmp_path / site / "grains") for site in ("left", "right")]
    grains = {"shapes": {"choice": "one"}}
    right = {"fixes": {**grains, "grains": {"source": folders[1], "unit": "m"}}, "varies": {"shapes.grain": ["a", "b"]}}
    studies = {"single_form": {"fixes": grains, "varies": {"shapes.grain": ["a", "b"]}}, "mine": right}
    with pytest.raises(ValueError, match="left/grains and .*right/grains have one name, grains, .* rename one of them"):
        plan_of(studies=studies, grains={"source": folders[0], "unit": "m"}).check()
    right["fixes"]["grains"]["source"] = str(tmp_path / "right" / ".." / "left" / "grains")
    plan_of(studies=studies, grains={"source": folders[0], "unit": "m"}).check()
    Path(folders[1]).rename(tmp_path / "right" / "others")
    right["fixes"]["grains"]["source"] = str(tmp_path / "right" / "others")
    plan_of(studies=studies, grains={"source": folders[0], "unit": "m"}).check()


def test_the_curve_of_a_listed_case_is_known_to_the_packing(monkeypatch):
    """Snakemake packs again if a sieve curve is changed, although the specification has only its name."""
    plan = plan_of()
    (first,) = plan.of("single_form").packing[:1]
    before = plan.curve("single_form", first)
    cases = dict(all_cases())
    changed = replace(cases["U1"].curve, bounds=1.1 * cases["U1"].curve.bounds)
    cases["U1"] = replace(cases["U1"], curve=changed)
    monkeypatch.setattr("simcore.scene.sizes.all_cases", lambda: cases)
    assert plan.curve("single_form", first) != before


@pytest.mark.parametrize(
    ("words", "dry"),
    [
        (["snakemake", "-n", "--cores", "2"], True),
        (["snakemake", "-np", "near_spheres"], True),
        (["snakemake", "--dry-run"], True),
        (["snakemake", "--cores", "2", "--nolock", "-p", "near_spheres"], False),
    ],
)
def test_a_dry_run_is_recognised(words, dry):
    assert is_dry_run(words) == dry


def test_models_of_single_forms_need_five_of_them_with_one_sieve_curve():
    assert SMALLEST_SINGLE_FORM_STUDY == fewest_samples(SINGLE_FORM)
    for number in (SMALLEST_SINGLE_FORM_STUDY - 1, SMALLEST_SINGLE_FORM_STUDY):
        study = copy.deepcopy(CAMPAIGN["studies"]["single_form"]) | {
            "forms": [f"G{i:02}" for i in range(1, number + 1)]
        }
        assert plan_of(studies={"single_form": study}).fits_single_forms == (number == SMALLEST_SINGLE_FORM_STUDY)
        assert not plan_of(studies={"mine": study}).fits_single_forms


def test_a_dry_run_says_that_no_model_will_be_fitted():
    study = copy.deepcopy(CAMPAIGN["studies"]["single_form"]) | {"forms": [f"G{i:02}" for i in range(1, 6)]}
    without = "No model will be fitted: a model needs a study of the target `all` with the name single_form"
    assert without in plan_of(studies={"mine": study}).description()
    assert without not in plan_of(studies={"single_form": study}).description()
    assert without not in plan_of(studies={"mine": study}, models={"committed": ["U7"]}).description()


def test_ellipsoids_are_compared_with_polyhedra_of_the_same_grain():
    study = copy.deepcopy(CAMPAIGN["studies"]["single_form"])
    ellipsoids = study | {"fixes": {"shapes": {"kind": "ellipsoid"}}}
    for forms, shared in ((["G01", "G02"], True), (["G03"], False)):
        studies = {"single_form": study | {"forms": ["G01"]}, "equivalent_ellipsoids": ellipsoids | {"forms": forms}}
        assert plan_of(studies=studies).compares_ellipsoids == shared
    assert not plan_of(studies={"single_form": study}).compares_ellipsoids


def test_cases_without_committed_rows_are_refused():
    with pytest.raises(
        ValueError, match="models.committed: there are no committed rows of u7; choose from U1, B50, U7"
    ):
        plan_of(models={"committed": ["u7", "B50"]}).check()


@pytest.mark.parametrize("amount", [{"grains": 300}, {"grains": None, "mass": "0.1 kg"}])
def test_a_bed_without_space_is_refused_before_the_first_job(amount):
    packing = {**CAMPAIGN["packing"], "domain": {"width": "20 mm", "height": "20 mm"}, "amount": amount}
    studies = {"single_form": CAMPAIGN["studies"]["single_form"]}
    with pytest.raises(ValueError, match=r"domain\.height: .* kg of grains would fill .* above its 20 mm"):
        plan_of(packing=packing, studies=studies).check()


@pytest.mark.parametrize(("domain", "refused"), [("periodic", True), ("cylinder", False)])
def test_the_cut_of_a_campaign_is_for_periodic_boxes(domain, refused):
    """A bed of 100 grains is too low to leave out 31.5 mm at both ends."""
    packing = {**CAMPAIGN["packing"], "domain": {"type": domain, "width": "45 mm", "height": "0.3 m"}}
    plan = plan_of(packing=packing, porosity={"cut": "31.5 mm"})
    if refused:
        with pytest.raises(ValueError, match="The bed will be about"):
            plan.check()
    else:
        plan.check()
    assert campaign_cut(0.0315, domain == "periodic") == (0.0315 if refused else None)

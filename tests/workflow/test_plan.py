"""What Snakemake plans, and refuses, before the first job."""

import re

import pytest

from simcore.grains.sources import set_name
from simcore.paths import ROOT
from simcore.scene.specification import resolve
from simcore.verification.outside.packings import ELASTIC_RUNS, PACKED
from tests.helpers.workplace import NULL_STUDIES, STUDIES

pytestmark = pytest.mark.workflow

SYNTHETIC = set_name(resolve({"studies": {}}, "config")["grains"])
MODELS = {"single_form_models", "form_mixture_models", "unified_model", "shape_kinds"}


def test_the_default_campaign_holds_all_studies_and_models(workplace):
    jobs = workplace.plan()
    assert {study for rule, study in jobs if rule == "packing"} == STUDIES
    assert {rule for rule, _ in jobs} >= MODELS | {"grain_report", "report"}
    assert not {rule for rule, _ in jobs} & {"verification_packings", "outside_packing", "outside_elastic"}


def test_the_smoke_campaign_has_one_packing_a_study_and_a_dozen_for_the_model(workplace):
    jobs = workplace.plan("--configfile", "config/smoke.yaml")
    packings = [study for rule, study in jobs if rule == "packing"]
    assert {study: packings.count(study) for study in STUDIES} == {**dict.fromkeys(STUDIES, 1), "single_form": 12}


def test_the_r22_campaign_has_its_number_of_packings(workplace):
    """The counts are those of the tables of Rettinger et al.: 63 shapes in three cases, 52 mixtures in two."""
    jobs = workplace.plan("--configfile", "config/r22.yaml")
    packings = [study for rule, study in jobs if rule == "packing"]
    assert {study: packings.count(study) for study in STUDIES} == {
        "mesh_resolution": 2 * 5 * 3,
        "shaking_cylinder": 2 * 4 * 3,
        "validation": 7 * 3,
        "domain_size": 2 * 3 * 3,
        "shaking_periodic": 2 * 6,
        "single_form": 3 * 63,
        "equivalent_ellipsoids": 3 * 63,
        "near_spheres": 3 * 11,
        "form_mixtures": 2 * 52,
        "application": 2 * 2,
    }


def test_a_single_study_plans_only_what_it_needs(workplace):
    jobs = workplace.plan("validation")
    assert {study for _, study in jobs if study} == {"validation"}
    rules = {rule for rule, _ in jobs}
    assert not rules & (MODELS | {"report", "grain_report", "form_order"})


NO_MESHES = """
packing: {domain: {width: 45 mm, height: 0.3 m}, amount: {grains: 300}, sizes: {case: U1}}
studies:
  spheres:
    fixes: {shapes: {kind: sphere}}
  ellipsoids:
    fixes: {shapes: {kind: ellipsoid, choice: form, flatness: 0.6, elongation: 0.7}}
"""


def test_studies_that_need_no_meshes_make_none(workplace):
    """Neither the packings nor the report of this campaign needs meshes."""
    (workplace.folder / "round.yaml").write_text(NO_MESHES + NULL_STUDIES)
    for target in ([], ["spheres"], ["ellipsoids"]):
        rules = [rule for rule, _ in workplace.plan(*target, "--configfile", "round.yaml")]
        assert rules.count("packing") == (1 if target else 2)
        assert not set(rules) & {"grain_set", "decimated_grain_set", "form_order", "grain_report"}, rules
        assert ("report" in rules) == (not target)


def test_a_campaign_of_beds_too_low_to_be_evaluated_is_refused(workplace):
    """The campaign is accepted if it cuts less from both ends."""
    low = NO_MESHES.replace("grains: 300", "grains: 60") + NULL_STUDIES
    (workplace.folder / "low.yaml").write_text(low)
    status, said = workplace.run("--dry-run", "--configfile", "low.yaml", "--", "spheres")
    assert status != 0 and "Traceback" not in said
    assert (
        "studies.spheres, packing spheres: amount: The bed will be about" in said and "set amount to at least" in said
    )
    (workplace.folder / "low.yaml").write_text(low + "\nporosity: {cut: 2 mm}\n")
    assert workplace.run("--dry-run", "--configfile", "low.yaml", "--", "spheres")[0] == 0


def test_a_key_that_an_overlay_has_twice_is_refused(workplace):
    """Snakemake would take the last one, and the first study of this name would be missing without a message."""
    (workplace.folder / "twice.yaml").write_text(NO_MESHES + "  spheres: {fixes: {shapes: {kind: sphere}}}\n")
    status, said = workplace.run("--dry-run", "--configfile", "twice.yaml", "--", "spheres")
    assert status != 0 and "Traceback" not in said
    assert "twice.yaml, line 8: spheres is given in line 4 already; remove one of them" in said


def test_a_target_asks_only_for_its_own_inputs(workplace):
    """Each file needs the rules listed beside it, and no other."""
    packing = {"grain_set", "decimated_grain_set", "packing_specification", "packing"}
    evaluated = packing | {"porosity"}
    wanted = (
        (f"results/grains/{SYNTHETIC}/faces_300.nc", {"grain_set", "decimated_grain_set"}, set()),
        ("results/grains/form_factors.csv", {"grain_set", "grain_report"}, set()),
        ("results/packings/domain_size/U1-36mm_0.05kg.yaml", {"packing_specification"}, {"domain_size"}),
        ("results/packings/single_form/U1-form01.nc", packing | {"form_order"}, {"single_form"}),
        ("results/tables/mesh_resolution.csv", evaluated | {"study_table"}, {"mesh_resolution"}),
        (
            "results/models/single_form.csv",
            evaluated | {"form_order", "study_table", "single_form_models"},
            {"single_form"},
        ),
        (
            "results/models/unified.csv",
            evaluated | {"form_order", "study_table", "unified_model"},
            {"single_form", "form_mixtures"},
        ),
        (
            "results/models/application.csv",
            evaluated | {"study_table", "form_mixture_models"},
            {"form_mixtures", "application"},
        ),
        ("results/figures/packings/validation.png", evaluated | {"study_table", "study_figures"}, {"validation"}),
    )
    jobs = workplace.jobs(*(target for target, *_ in wanted))
    by_file = {file: job for job in jobs for file in job.output}
    asked = set()
    for target, rules, studies in wanted:
        behind = _behind(target, by_file)
        assert {job.rule for job in behind} == rules, target
        assert {job.study for job in behind if job.study} == studies, target
        asked |= {job.output[0] for job in behind}
    assert asked == {job.output[0] for job in jobs if job.output}


def _behind(file, by_file):
    """Return the jobs that make a file, those that make what they read, and so on."""
    found, ahead = {}, [file]
    while ahead:
        file = ahead.pop()
        if file in by_file and file not in found:
            found[file] = by_file[file]
            ahead += by_file[file].input
    return list(found.values())


def test_work_precision_is_a_target_of_its_own(workplace):
    studies = {"one_contact_precision", "rotation_precision", "contact_query_precision", "rest"}
    studies |= {"evaluation_precision", "packing_precision"}
    jobs = workplace.plan("work_precision")
    assert {rule for rule, study in jobs if not study} - {"grain_set", "decimated_grain_set"} == studies | {
        "work_precision"
    }
    packed = {study for rule, study in jobs if rule == "packing"}
    assert packed and all(study.startswith("precision_") for study in packed)
    everything = workplace.plan()
    assert not {rule for rule, _ in everything} & (studies | {"work_precision"})
    assert not {study for _, study in everything} & (packed | {"accuracy"})


def test_a_campaign_without_a_study_of_all_names_one_as_a_target(workplace):
    aside = NO_MESHES.replace("fixes:", "in_all: false\n    fixes:")
    (workplace.folder / "aside.yaml").write_text(aside + NULL_STUDIES)
    status, said = workplace.run("--dry-run", "--configfile", "aside.yaml")
    assert status != 0 and "no study of this campaign is part of `all`; name one as the target, such as" in said


@pytest.mark.parametrize("target", ["differences", "deposits"])
def test_a_target_whose_studies_are_elsewhere_names_the_overlay(workplace, target):
    status, said = workplace.run("--dry-run", "--", target)
    assert status != 0
    assert (
        f"this campaign has no such study; use a configuration that has one: --configfile config/{target}.yaml" in said
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("grainz={source: synthetic}", "config: grainz: unknown key; did you mean 'grains'?"),
        (
            "studies={validation: {fixes: {domain: {width: 3 kg}}}}",
            "config: studies.validation.fixes.domain.width: '3 kg' is a mass; a length is needed, such as '0.2 m'",
        ),
        ("grains={source: nowhere}", "config: grains.source: 'nowhere' does not exist"),
        ("grains={unit: mm}", "config: grains.unit: it has no effect with synthetic grains"),
        (
            "studies={validation: {fixes: {grains: {source: /no/such/folder, unit: mm}}}}",
            "config: studies.validation: grains.source: '/no/such/folder' does not exist",
        ),
    ],
)
def test_bad_config_is_one_clear_error(workplace, change, message):
    status, said = workplace.run("--dry-run", "--config", change)
    assert status != 0
    assert message in said
    assert "Traceback" not in said


OWN = """
packing: {domain: {width: 45 mm, height: 0.3 m}, amount: {grains: 100}, sizes: {case: U1}}
studies:
  own:
    fixes: {grains: {unit: mm}}
    varies: {grains.source: [scans_a, scans_b]}
    forms: {spread: 2}
"""


def test_a_study_has_grain_sets_of_its_own(workplace):
    """They are in the folder of the campaign's sets, and are made again if their content changes, not their age."""
    (workplace.folder / "own.yaml").write_text(OWN + NULL_STUDIES)
    for number, name in enumerate("ab"):
        folder = workplace.folder / f"scans_{name}"
        folder.mkdir()
        (folder / "tetrahedron.xyz").write_text(f"0 0 0\n4 0 0\n0 4 0\n0 0 {number + 4}\n")
        (folder / "corner.xyz").write_text(f"0 0 0\n5 0 0\n0 4 0\n0 0 {number + 4}\n")
    arguments = ["--configfile", "own.yaml"]
    jobs = workplace.jobs("own", *arguments)
    made = {job.output[0]: job.input for job in jobs if job.rule in ("grain_set", "form_order", "decimated_grain_set")}
    sets = {path.split("/")[2] for path in made}
    assert {name.rpartition("_")[0] for name in sets} == {"scans_a", "scans_b"} and len(made) == 6
    assert SYNTHETIC not in sets
    packings = {job.output[0]: job.input for job in jobs if job.rule == "packing"}
    assert len(packings) == 4
    for path, behind in packings.items():
        (grains,) = [file for file in behind if file.endswith("faces_100.nc")]
        assert ("scans_a" in path) == ("/scans_a_" in grains)

    targets = [path for path in made if path.endswith("forms.csv")]
    specifications = [path.replace(".nc", ".yaml") for path in packings]
    status, said = workplace.run(*specifications, *arguments)
    assert status == 0, said
    texts = [(workplace.folder / path).read_text() for path in specifications]
    assert all(f"scans_{path.split('scans_')[1][0]}_" in text for path, text in zip(specifications, texts, strict=True))
    (workplace.folder / "scans_a" / "corner.xyz").touch()
    assert not workplace.jobs(*targets, *arguments)
    (workplace.folder / "scans_a" / "corner.xyz").write_text("0 0 0\n9 0 0\n0 4 0\n0 0 4\n")
    again = workplace.jobs("own", *arguments)
    assert [job.rule for job in again].count("grain_set") == 1
    assert {job.output[0].split("/")[2].rpartition("_")[0] for job in again if job.rule == "grain_set"} == {"scans_a"}


def test_a_page_shows_a_config_with_own_grains_and_sieve_curve(workplace):
    example = (ROOT / "docs/how_to/own_grains.md").read_text().split("```yaml\n")[1].split("```")[0]
    assert len(example.splitlines()) <= 10
    (workplace.folder / "mine.yaml").write_text(example)
    (workplace.folder / "my_scans").mkdir()
    (workplace.folder / "my_scans" / "pebble.xyz").write_text("0 0 0\n4 0 0\n0 4 0\n0 0 4\n")
    jobs = workplace.plan("mine", "--configfile", "mine.yaml")
    assert [job for job in jobs if job[0] == "packing"] == [("packing", "mine")]
    # The studies of config.yaml have the same grains, but more forms.
    status, said = workplace.run("--dry-run", "--configfile", "mine.yaml", "--", "single_form")
    assert status != 0
    assert re.search(r"config: studies.single_form.forms.spread: there is no form \d+ of a set of 1 grains", said)
    # Snakemake makes texts of the number and of the null, which are values of the configuration all the same.
    options = ["--config", "studies={single_form: {forms: {spread: 1}}}", "grains={names: null}"]
    status, said = workplace.run("--dry-run", "--configfile", "mine.yaml", *options, "--", "single_form")
    assert status == 0, said


def test_packings_with_known_outcomes_are_a_target_of_their_own(workplace):
    jobs = [rule for rule, _ in workplace.plan("verification_packings")]
    assert jobs.count("outside_packing") == len(PACKED)
    assert jobs.count("outside_elastic") == len(ELASTIC_RUNS)
    assert set(jobs) == {
        "outside_dice",
        "outside_specification",
        "outside_packing",
        "outside_elastic",
        "verification_packings",
    }

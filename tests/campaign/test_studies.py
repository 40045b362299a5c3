"""A study expands to the product of its varied settings; a wrong one is refused before the first job."""

import re

import numpy as np
import pandas as pd
import pytest
import yaml

from simcore.campaign.studies import _column, choose_form, expand, specification_text, study_title
from simcore.grains.sources import set_name
from simcore.grains.spread import read_spread, spread_order, spread_table
from simcore.grains.synthetic import synthetic_grains
from simcore.reference.columns.studies import COLUMN_OF_KEY, COLUMNS
from simcore.scene.identity import result_digest
from simcore.scene.setup import set_up
from simcore.scene.specification import CONFIG, read_presets, read_schema, resolve

SYNTHETIC = set_name(resolve({"studies": {}}, "config")["grains"])
FORMS = {"mean": 0.4, "std": 0.1}
STUDY = {
    "fixes": {"domain": {"width": "0.2 m", "height": "1 m"}, "amount": {"mass": "16 kg"}},
    "varies": {"sizes.case": ["U1", "U7"]},
}


def campaign(**changes):
    """Return the resolved campaign of one study `s`, with changed keys of the study or of the campaign."""
    study = {**STUDY, **{key: changes.pop(key) for key in ("fixes", "varies", "forms", "leaves_out") if key in changes}}
    return resolve({"studies": {"s": study}, **changes}, "config")


def test_packings_are_the_product_of_all_axes():
    table = expand(campaign(varies={"sizes.case": ["U1", "U7"], "shaking.duration": ["1 s", "2 s"], "seed": [1, 2, 3]}))
    assert len(table) == 12
    assert table.packing.is_unique
    assert table.packing[0] == "U1-duration_1s-seed_1"
    last = table.iloc[-1]
    assert last.row["varied"] == {"case": "U7", "shaking_s": 2.0, "seed": 3}
    spec = last.specification
    assert (spec["sizes"]["case"], spec["shaking"]["duration"], spec["seed"]) == ("U7", 2.0, 3)


def test_a_study_leaves_out_packings_by_name():
    varies = {"sizes.case": ["U1", "U7"], "seed": [1, 2]}
    whole = expand(campaign(varies=varies))
    rest = expand(campaign(varies=varies, leaves_out=["U7-seed_1"]))
    assert list(rest.packing) == ["U1-seed_1", "U1-seed_2", "U7-seed_2"]
    kept = whole[whole.packing != "U7-seed_1"].reset_index(drop=True)
    pd.testing.assert_frame_equal(rest, kept)
    title = study_title("s", {"title": "Sieve curves", "leaves_out": ["U7-seed_1"]})
    assert title == "Sieve curves (without U7-seed_1)"


@pytest.mark.parametrize(
    "names, message",
    [
        (["U7-seed_1"], "studies.s.leaves_out: there is no packing 'U7-seed_1'; the packings are U1, U7"),
        (["U1", "U7"], "these are all packings of the study; leave out fewer, or set studies.s to null"),
    ],
)
def test_packings_left_out_must_exist_and_others_remain(names, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        expand(campaign(leaves_out=names))


def test_settings_of_a_group_vary_together():
    groups = [
        {"domain.width": "0.1 m", "amount.mass": "4 kg"},
        {"domain": {"width": "0.3 m"}, "amount": {"mass": "36 kg"}},
    ]
    table = expand(campaign(varies={"sizes.case": ["U7"], "size": groups}))
    assert [(spec["domain"]["width"], spec["amount"]["mass"]) for spec in table.specification] == [(0.1, 4), (0.3, 36)]
    assert [row["varied"] for row in table.row] == [
        {"case": "U7", "width_m": 0.1, "mass_kg": 4.0},
        {"case": "U7", "width_m": 0.3, "mass_kg": 36.0},
    ]


def test_lists_of_groups_vary_with_short_names_and_their_text():
    forms = {"flatness": FORMS, "elongation": FORMS}
    lists = [[{"below": "8 mm", **forms}, forms], [{"below": "9 mm", **forms}, forms]]
    fixes = {**STUDY["fixes"], "sizes": {"case": "U7"}, "shapes": {"choice": "form_by_size"}}
    table = expand(campaign(fixes=fixes, varies={"shapes.by_size": lists}))
    assert table.packing.is_unique and max(map(len, table.packing)) < 30
    assert ['"below": 0.009' in row["varied"]["by_size"] for row in table.row] == [False, True]


def test_groups_that_set_different_keys_are_named_by_all_of_them():
    """Otherwise a mean over the seeds would combine different packings."""
    groups = [{"faces": 300}, {"shapes.kind": "ellipsoid"}, {"generation.fill": "r22"}]
    rows = [row["varied"] for row in expand(campaign(varies={"sizes.case": ["U7"], "change": groups})).row]
    assert [row["faces"] for row in rows] == [300, 100, 100]
    assert [row["shape_kind"] for row in rows] == ["polyhedron", "ellipsoid", "polyhedron"]
    assert [row["fill"] for row in rows] == ["bed", "bed", "r22"]


def test_a_study_goes_over_the_common_settings_and_these_over_the_defaults():
    table = expand(
        campaign(
            packing={"faces": 200, "shaking": {"duration": "3 s"}},
            varies={"faces": [50]},
            fixes={**STUDY["fixes"], "sizes": {"case": "U1"}},
        )
    )
    spec = table.specification[0]
    assert table.grain_set[0] == f"{SYNTHETIC}/faces_50"
    assert spec["grains"]["source"] == f"results/grains/{SYNTHETIC}/faces_50.nc"
    assert (spec["shaking"]["duration"], spec["shaking"]["period"]) == (3.0, 0.025)


def test_a_preset_overrides_its_settings_of_a_layer_below():
    table = expand(
        campaign(
            packing={"accuracy": "standard", "faces": 60},
            fixes={**STUDY["fixes"], "sizes": {"case": "U1"}, "numerics": {"contact_time": "3 ms"}},
            varies={"accuracy": ["draft", "r22"], "shaking.duration": ["7 s"]},
        )
    )
    for spec, accuracy in zip(table.specification, ["draft", "r22"], strict=True):
        alone = resolve({**STUDY["fixes"], "sizes": {"case": "U1"}, "accuracy": accuracy})
        assert spec["numerics"] == alone["numerics"]
        assert spec["shaking"]["duration"] == 7.0
        faces = read_presets("accuracy")[accuracy]["faces"]
        assert spec["grains"]["source"] == f"results/grains/{SYNTHETIC}/faces_{faces}.nc"


@pytest.mark.parametrize(
    "shapes, needed",
    [
        ({"kind": "sphere"}, False),
        ({"kind": "ellipsoid", "choice": "form", "flatness": 0.6, "elongation": 0.7}, False),
        ({"kind": "ellipsoid"}, True),
        ({"kind": "polyhedron"}, True),
    ],
)
def test_shapes_that_are_no_grains_need_no_grain_set(shapes, needed):
    table = expand(campaign(varies={"sizes.case": ["U1"]}, fixes={**STUDY["fixes"], "shapes": shapes}))
    assert table.grain_set[0] == (f"{SYNTHETIC}/faces_100" if needed else "")
    assert (table.specification[0]["grains"]["source"] == "synthetic") != needed


def test_null_drops_a_study_and_an_axis():
    config = campaign(varies={"sizes.case": ["U1"], "seed": None})
    config["studies"]["other"] = None
    assert list(expand(config).packing) == ["U1"]


def test_spread_forms_carry_their_rank_and_the_name_follows():
    table = expand(campaign(varies={"sizes.case": ["U1"]}, forms={"spread": 3}))
    assert list(table.form) == [1, 2, 3]
    names = ["G07", "G01", "G33"]
    chosen = [choose_form(s, f, names)["shapes"] for s, f in zip(table.specification, table.form, strict=True)]
    assert [shapes["grain"] for shapes in chosen] == names
    assert {shapes["choice"] for shapes in chosen} == {"one"}
    with pytest.raises(ValueError, match="form 3 of a set of 2 grains"):
        choose_form(table.specification[2], 3, names[:2])


def test_the_text_of_a_packing_names_its_grain_and_reads_as_the_same_packing(tmp_path):
    grains = synthetic_grains(seed=1, n=21)
    spread_table(grains).to_csv(tmp_path / "forms.csv", index=False)
    names = read_spread(tmp_path / "forms.csv")
    order = spread_order([grain.flatness for grain in grains], [grain.elongation for grain in grains])
    assert names == [grains[k].name for k in order] != [grain.name for grain in grains]
    (specification,) = expand(campaign(varies={"sizes.case": ["U1"]}, forms={"spread": 1})).specification
    read = resolve(yaml.safe_load(specification_text(specification, 1, names)))
    assert read == choose_form(specification, 1, names) and read["shapes"]["grain"] == names[0]


def test_named_forms(tmp_path):
    for name in ("pebble a", "b"):
        (tmp_path / f"{name}.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    grains = {"source": str(tmp_path), "unit": "mm"}
    table = expand(campaign(varies={"sizes.case": ["U1"]}, forms=["pebble a", "b"], grains=grains))
    assert list(table.packing) == ["U1-pebblea", "U1-b"]
    assert [spec["shapes"]["grain"] for spec in table.specification] == ["pebble a", "b"]


def test_forms_that_do_not_exist_are_found_before_grains_are_read(scans):
    grains = {"source": scans[0], "unit": "mm"}
    for forms, message in (
        ({"spread": 3}, r"studies\.s\.forms\.spread: there is no form 3 of a set of 2 grains; give 2, or less"),
        (
            ["three"],
            r"studies\.s, packing U1-three: shapes\.grain: no grain is called 'three'; the 2 grains are one, two",
        ),
    ):
        table = expand(campaign(varies={"sizes.case": ["U1"]}, forms=forms, grains=grains))
        assert re.fullmatch(message, table.fault.iloc[-1])
        assert not table.fault.iloc[:-1].any()
    synthetic = expand(campaign(varies={"sizes.case": ["U1"]}, forms={"spread": 64}))
    assert synthetic.fault.iloc[-1] == (
        "studies.s.forms.spread: there is no form 64 of a set of 63 grains; give 63, or less"
    )
    # Several bodies of a file become grains whose number is not known before they are read.
    grains["bodies"] = "split"
    assert not expand(campaign(varies={"sizes.case": ["U1"]}, forms=["one_3"], grains=grains)).fault.any()


def test_packings_with_the_same_settings_are_found():
    table = expand(campaign(varies={"sizes.case": ["U1"], "shaking.duration": ["0.5 s", "500 ms", "1 s"]}))
    message = (
        "studies.s: the packings U1-duration_0.5s and U1-duration_500ms have the same settings; remove one of them"
    )
    assert table.fault.tolist() == ["", message, ""]


def test_keys_of_a_group_may_be_those_below_its_name(scans):
    """`grains: [{source: ..., seed: 1}]` sets the keys of the grains, not those of the packing."""
    groups = [{"source": "synthetic", "seed": 7}, {"source": scans[0], "unit": "mm"}]
    table = expand(campaign(varies={"sizes": [{"case": "U1"}], "grains": groups}))
    assert [(group["source"], group["seed"]) for group in table.grains] == [("synthetic", 7), (scans[0], 1)]
    assert [spec["seed"] for spec in table.specification] == [1, 1]
    assert [row["varied"]["grains_seed"] for row in table.row] == [7, 1]
    fixes = {**STUDY["fixes"], "sizes": {"case": "U1"}, "shapes": {"choice": "form_distribution", "elongation": FORMS}}
    table = expand(campaign(fixes=fixes, varies={"shapes.flatness": [{"mean": 0.5, "std": 0.1}]}))
    assert table.row[0]["varied"] == {"mean_FL": 0.5, "std_FL": 0.1}


def test_each_key_has_a_column_of_its_own():
    """Settings with the same column would be averaged as if they were seeds, or be lost behind a result."""

    def keys(node, path=""):
        for key, child in node.get("properties", {}).items():
            yield from [f"{path}{key}"] if "properties" not in child else keys(child, f"{path}{key}.")
            if "properties" in child and "number" in child["type"]:  # a number, or a group
                yield f"{path}{key}"

    columns = pd.Series({key: _column(key) for key in keys(read_schema("packing"))})
    assert len(columns) > 80
    assert columns[columns.duplicated(keep=False)].to_dict() == {}
    results = {column.name for column in COLUMNS} - {*COLUMN_OF_KEY.values()}
    described = {"flatness", "elongation", "choice", "faces", "accuracy", "grain", "seed"}  # the settings themselves
    assert set(columns) & results == described


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"varies": {"sizes.cas": ["U1"]}}, r"studies\.s\.varies\.sizes\.cas: unknown key; did you mean 'case'\?"),
        ({"varies": {"sizes.case": "U1"}}, r"studies\.s\.varies\.sizes\.case: 'U1' is not a list"),
        ({"varies": {"sizes.case": ["U9"]}}, r"studies\.s, packing U9: sizes\.case: 'U9' is unknown; the cases are U1"),
        ({"varies": {"sizes.case": ["U1"], "seed": [1, 1]}}, r"studies\.s\.varies: the packing U1-seed_1 .* twice"),
        ({"varies": {"sizes.case": ["U1"], "seed": 0}}, r"studies\.s\.varies\.seed: 0 is not a list"),
        ({"varies": {"sizes.case": ["U1"], "seed": []}}, r"studies\.s\.varies\.seed: the list is empty"),
        (
            {"varies": {"sizes.case": ["U1"], "seed": [1], "change": [{"seed": 2}]}},
            r"studies\.s\.varies: two lists set seed; set it in one of them",
        ),
        ({"varies": {"name": ["a", "b"]}}, r"studies\.s\.varies\.name: packings are named by what varies"),
        ({"packing": {"faces": "few"}}, r"studies\.s\.faces: 'few' is wrong"),
        ({"fixes": {"domain": {"width": "3 kg", "height": "1 m"}}}, r"fixes\.domain\.width: '3 kg' is a mass"),
        ({"forms": {"spred": 6}}, r"studies\.s\.forms\.spred: unknown key; did you mean 'spread'\?"),
        ({"grains": {"source": "no/such/folder", "unit": "mm"}}, r"grains\.source: 'no/such/folder' does not exist"),
        ({"grains": {"source": "."}}, r"grains\.unit is missing"),
        ({"grainz": {}}, r"grainz: unknown key; did you mean 'grains'\?"),
        (
            {"packing": {"shapes": {"flatness": FORMS, "elongation": FORMS}}},
            r"^packing\.shapes\.flatness: it has no effect while shapes\.choice is random",
        ),
        (
            {"fixes": {**STUDY["fixes"], "shapes": {"flatness": FORMS, "elongation": FORMS}}},
            r"studies\.s\.fixes\.shapes\.flatness: it has no effect while shapes\.choice is random",
        ),
        (
            {
                "fixes": {**STUDY["fixes"], "shapes": {"kind": "ellipsoid"}},
                "varies": {"sizes.case": ["U1"], "faces": [50, 90]},
            },
            r"studies\.s\.varies\.faces: it has no effect while shapes\.kind is ellipsoid",
        ),
        (
            {"fixes": {**STUDY["fixes"], "shapes": {"kind": "sphere"}}, "forms": {"spread": 3}},
            r"studies\.s\.forms: .* shapes\.kind is sphere",
        ),
        (
            {"fixes": {**STUDY["fixes"], "shapes": {"kind": "sphere"}, "grains": {"source": "synthetic"}}},
            r"studies\.s\.fixes\.grains: it has no effect with these shapes",
        ),
        (
            {"fixes": {**STUDY["fixes"], "grains": {"source": "/no/such/folder", "unit": "mm"}}},
            r"studies\.s: grains\.source: '/no/such/folder' does not exist",
        ),
        ({"packing": {"grains": {"source": "synthetic"}}}, r"packing\.grains: move it one level up"),
        ({"porosity": {"slice_height": "1 s"}}, r"porosity\.slice_height: '1 s' is a time; a length is needed"),
    ],
)
def test_bad_campaigns_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        expand(campaign(**changes))


def test_fewer_than_five_grains_of_the_top_class_are_refused_unless_allowed_by_name():
    """3 kg of U7 have 0.04 · 3 kg / (2650 kg/m³ · π/6 · (31.5³ - 22.4³) / (3 ln(31.5 / 22.4)) mm³) = 4.4 grains."""
    fixes = {**STUDY["fixes"], "amount": {"mass": "3 kg"}}
    with pytest.raises(ValueError, match=r"studies\.s, packing U7: .* 4\.4 grains of the coarsest class"):
        expand(campaign(fixes=fixes))
    allowed = {**fixes, "sizes": {"allow_few_top_grains": True}}
    assert len(expand(campaign(fixes=allowed))) == 2


def test_a_key_that_some_packings_of_a_study_use_is_no_mistake():
    """Neither is a common key of the studies that none of them uses."""
    forms = {"flatness": FORMS, "elongation": FORMS}
    fixes = {**STUDY["fixes"], "shapes": forms, "sizes": {"case": "U1"}}
    table = expand(campaign(fixes=fixes, varies={"shapes.choice": ["random", "form_distribution"]}))
    assert [spec["shapes"]["flatness"] for spec in table.specification] == [FORMS, FORMS]
    shared = {"faces": 50, "numerics": {"polyhedron_contact": "point"}}
    expand(campaign(packing=shared, fixes={**STUDY["fixes"], **shared, "shapes": {"kind": "sphere"}}))


@pytest.fixture
def scans(tmp_path):
    """Return two folders of grains."""
    for name in ("a", "b"):
        folder = tmp_path / f"scans_{name}"
        folder.mkdir()
        for grain in ("one", "two"):
            (folder / f"{grain}.xyz").write_text(f"0 0 0\n1 0 0\n0 1 0\n0 0 {name == 'a'}.5\n")
    return [str(tmp_path / f"scans_{name}") for name in ("a", "b")]


def test_a_study_takes_its_own_grains(scans):
    """Grains are set under `fixes`, under `varies` or by the campaign; each grain set has its own folder."""
    studies = {
        "own": {**STUDY, "fixes": {**STUDY["fixes"], "grains": {"source": scans[0], "unit": "mm"}}},
        "both": {**STUDY, "varies": {"sizes.case": ["U1"], "grains.source": scans}, "forms": {"spread": 2}},
        "common": STUDY,
    }
    studies["both"]["fixes"] = {**STUDY["fixes"], "grains": {"unit": "mm"}}
    table = expand(resolve({"studies": studies, "grains": {"seed": 3}}, "config"))
    of = {study: rows for study, rows in table.groupby("study")}
    assert {group["source"] for group in of["own"].grains} == {scans[0]}
    assert [group["source"] for group in of["both"].grains] == [scans[0], scans[0], scans[1], scans[1]]
    assert [row["varied"]["grain_source"] for row in of["both"].row] == [scans[0], scans[0], scans[1], scans[1]]
    assert {(group["source"], group["seed"]) for group in of["common"].grains} == {("synthetic", 3)}
    sets = {row.study + str(row.grains["source"]): row.grain_set for row in table.itertuples()}
    assert sets["own" + scans[0]] == sets["both" + scans[0]]
    assert len(set(sets.values())) == 3
    for row in table.itertuples():
        assert row.specification["grains"]["source"] == f"results/grains/{row.grain_set}.nc"


def test_a_unit_of_the_campaign_holds_for_the_grains_of_its_studies(scans):
    config = campaign(grains={"source": scans[0], "unit": "mm", "voxel_spacing": "0.1 mm"})
    assert {group["voxel_spacing"] for group in expand(config).grains} == {1e-4}


def test_the_content_of_files_makes_the_name_of_a_set(scans, tmp_path):
    group = {**resolve({"studies": {}}, "config")["grains"], "source": scans[0], "unit": "mm"}
    first = set_name(group)
    assert first.startswith("scans_a_") and first != set_name({**group, "source": scans[1]})
    assert first != set_name({**group, "unit": "m"}) and first == set_name({**group, "seed": 7})
    elsewhere = tmp_path / "copy" / "scans_a"
    elsewhere.mkdir(parents=True)
    for grain in ("one.xyz", "two.xyz"):
        (elsewhere / grain).write_text((tmp_path / "scans_a" / grain).read_text())
    (elsewhere / "._one.xyz").write_text("hidden")
    assert set_name({**group, "source": str(elsewhere)}) == first
    (elsewhere / "one.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n0 0 2\n")
    assert set_name({**group, "source": [str(elsewhere)]}) != first


def test_spread_is_nested_and_takes_the_farthest():
    rng = np.random.default_rng(1)
    points = rng.uniform(size=(40, 2))
    order = spread_order(*points.T)
    assert sorted(order) == list(range(40))
    for taken in range(1, 40):
        gaps = np.linalg.norm(points[:, None] - points[None, order[:taken]], axis=2).min(axis=1)
        assert np.isclose(gaps[order[taken]], gaps.max())


def test_spread_covers_more_than_chance():
    """The smallest distance among 16 of 63 points taken by the rule exceeds that of 200 random choices."""
    rng = np.random.default_rng(2)
    points = rng.uniform(size=(63, 2))

    def smallest(indices):
        chosen = points[indices]
        return min(np.linalg.norm(a - b) for i, a in enumerate(chosen) for b in chosen[:i])

    random = max(smallest(rng.choice(63, 16, replace=False)) for _ in range(200))
    assert smallest(spread_order(*points.T)[:16]) > random


def test_near_spheres_are_a_sphere_and_ten_ellipsoids_up_to_twice_as_long_as_thick():
    """The study is that of the default campaign; the axes are those of the grains that it draws."""
    config = yaml.safe_load((CONFIG / "config.yaml").read_text())
    campaign = resolve({**config, "studies": {"near_spheres": config["studies"]["near_spheres"]}}, "config")
    specifications = list(expand(campaign).specification)
    assert [specification["shapes"]["kind"] for specification in specifications] == ["sphere"] + 10 * ["ellipsoid"]
    ratios = []
    for specification in specifications:
        sample = set_up(specification, None).sample(np.arange(3))  # these shapes need no grains, so none are loaded
        ratios.append(sample.L / sample.S)
        np.testing.assert_allclose(sample.L / sample.I, sample.I / sample.S)
    # FL = EL = (L/S)^-1/2 is rounded to four digits, so the error of L/S is at most 2 (L/S)^1.5 0.5e-4.
    np.testing.assert_allclose(ratios, np.repeat(np.linspace(1.0, 2.0, 11)[:, None], 3, axis=1), atol=3e-4)


def test_own_sizes_of_grains_are_refused_in_a_study():
    with pytest.raises(ValueError, match=r"studies\.s, packing .*: sizes\.own is only for single packings"):
        expand(campaign(varies={"seed": [1]}, fixes={**STUDY["fixes"], "sizes": {"own": True}}))


def test_bodies_of_the_files_are_settled_in_the_grain_set():
    table = expand(campaign(grains={"bodies": "split"}))
    assert {spec["grains"]["bodies"] for spec in table.specification} == {"one"}


def test_names_and_degree_of_the_files_do_not_change_the_digest_of_a_row(scans):
    plain = expand(campaign(grains={"source": scans[0], "unit": "mm"}))
    cut = expand(campaign(grains={"source": scans[0], "unit": "mm", "degree": 10, "names": ["one"]}))
    assert set(plain.grain_set) != set(cut.grain_set)
    assert [*map(result_digest, plain.specification)] == [*map(result_digest, cut.specification)]


def test_names_of_grains_that_a_file_name_cannot_have_stay_apart(tmp_path):
    """If names are equal or empty without some characters, a digest is added to them."""
    for name in ("石", "岩", "a,b", "ab", "a b"):
        (tmp_path / f"{name}.xyz").write_text("\n".join(f"{x} {y} {z}" for x in (0, 3) for y in (0, 2) for z in (0, 1)))
    grains = {"source": str(tmp_path), "unit": "mm"}
    table = expand(campaign(varies={"sizes.case": ["U1"]}, forms=["石", "岩", "a,b", "ab", "a b"], grains=grains))
    names = table.packing.tolist()
    assert len(set(names)) == 5 and names[3] == "U1-ab" and "ab-" in names[2] and "ab-" in names[4]
    assert all(name.isascii() for name in names)


@pytest.mark.parametrize(
    "packing, fault",
    [
        ({"domain": {"width": "45 furlong"}}, "packing.domain.width: '45 furlong'"),
        ({"domain": {"width": [1, 2]}}, "packing.domain.width"),
        ({"shaking": {"duration": "1 kg"}}, "packing.shaking.duration: '1 kg' is a mass"),
    ],
)
def test_settings_of_all_packings_are_checked_also_where_every_study_overrides_them(packing, fault):
    study = {"fixes": {"domain": {"width": "45 mm", "height": "0.3 m"}, "shaking": {"duration": "1 s"}}}
    study["fixes"] |= {"sizes": {"case": "U1"}, "amount": {"grains": 100}}
    with pytest.raises(ValueError, match=re.escape(fault)):
        expand(resolve({"packing": packing, "studies": {"mine": study}}, "config"))
    assert len(expand(resolve({"packing": {"domain": {"width": "45 m"}}, "studies": {"mine": study}}, "config"))) == 1

"""Studies: the product of what they vary, and what is refused before the first job."""

import numpy as np
import pytest
import yaml

from simcore.campaign.studies import expand
from simcore.grains.spread import choose_form, spread_order
from simcore.scene.setup import set_up
from simcore.scene.specification import CONFIG, read_presets, resolve

STUDY = {
    "fixes": {"domain": {"width": "0.2 m", "height": "1 m"}, "amount": {"mass": "16 kg"}},
    "varies": {"sizes.case": ["U1", "U7"]},
}


def campaign(**changes):
    """Resolved campaign of one study `s`, with other keys of it, or of the campaign."""
    study = {**STUDY, **{key: changes.pop(key) for key in ("fixes", "varies", "forms") if key in changes}}
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


def test_groups_that_set_different_keys_are_told_apart_by_all_of_them():
    """Else a mean over the seeds would take them for one."""
    groups = [{"faces": 300}, {"shapes.kind": "ellipsoid"}, {"generation.fill": "study"}]
    rows = [row["varied"] for row in expand(campaign(varies={"sizes.case": ["U7"], "change": groups})).row]
    assert [row["faces"] for row in rows] == [300, 100, 100]
    assert [row["shape_kind"] for row in rows] == ["mesh", "ellipsoid", "mesh"]
    assert [row["fill"] for row in rows] == ["bed", "bed", "study"]


def test_a_study_goes_over_the_common_settings_and_these_over_the_defaults():
    table = expand(
        campaign(
            packing={"faces": 200, "shaking": {"duration": "3 s"}},
            varies={"faces": [50]},
            fixes={**STUDY["fixes"], "sizes": {"case": "U1"}},
        )
    )
    spec = table.specification[0]
    assert (table.grain_set[0], spec["grains"]["source"]) == ("faces_50", "results/grains/faces_50.nc")
    assert (spec["shaking"]["duration"], spec["shaking"]["period"]) == (3.0, 0.025)


def test_an_accuracy_goes_over_the_settings_it_stands_for_of_a_layer_below():
    table = expand(
        campaign(
            packing={"accuracy": "standard", "faces": 60},
            fixes={**STUDY["fixes"], "sizes": {"case": "U1"}, "numerics": {"contact_time": "3 ms"}},
            varies={"accuracy": ["draft", "paper"], "shaking.duration": ["7 s"]},
        )
    )
    for spec, accuracy in zip(table.specification, ["draft", "paper"], strict=True):
        alone = resolve({**STUDY["fixes"], "sizes": {"case": "U1"}, "accuracy": accuracy})
        assert spec["numerics"] == alone["numerics"]
        assert spec["shaking"]["duration"] == 7.0
        assert spec["grains"]["source"] == f"results/grains/faces_{read_presets('accuracy')[accuracy]['faces']}.nc"


@pytest.mark.parametrize(
    "shapes, needed",
    [
        ({"kind": "sphere"}, False),
        ({"kind": "ellipsoid", "choice": "form", "flatness": 0.6, "elongation": 0.7}, False),
        ({"kind": "ellipsoid"}, True),
        ({"kind": "mesh"}, True),
    ],
)
def test_shapes_that_are_no_grains_ask_for_none(shapes, needed):
    table = expand(campaign(varies={"sizes.case": ["U1"]}, fixes={**STUDY["fixes"], "shapes": shapes}))
    assert table.grain_set[0] == ("faces_100" if needed else "")
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


def test_named_forms():
    table = expand(campaign(varies={"sizes.case": ["U1"]}, forms=["pebble a", "b"]))
    assert list(table.packing) == ["U1-pebblea", "U1-b"]
    assert [spec["shapes"]["grain"] for spec in table.specification] == ["pebble a", "b"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"varies": {"sizes.cas": ["U1"]}}, r"studies\.s\.sizes\.cas: unknown key; did you mean 'case'\?"),
        ({"varies": {"sizes.case": "U1"}}, r"studies\.s\.varies\.sizes\.case: 'U1' is wrong; a list"),
        ({"varies": {"sizes.case": ["U9"]}}, r"studies\.s, packing U9: sizes\.case: 'U9' is unknown; the cases are U1"),
        ({"varies": {"sizes.case": ["U1"], "seed": [1, 1]}}, r"studies\.s\.varies: the packing U1-seed_1 .* twice"),
        ({"packing": {"faces": "few"}}, r"studies\.s\.faces: 'few' is wrong"),
        ({"fixes": {"domain": {"width": "3 kg", "height": "1 m"}}}, r"studies\.s\.domain\.width: '3 kg' is a mass"),
        ({"forms": {"spread": 64}}, r"studies\.s\.forms\.spread: 64 forms of a set of 63 grains"),
        ({"forms": {"spred": 6}}, r"studies\.s\.forms\.spred: unknown key; did you mean 'spread'\?"),
        ({"grains": {"source": "no/such/folder", "unit": "mm"}}, r"grains\.source: 'no/such/folder' does not exist"),
        ({"grains": {"source": "."}}, r"grains\.unit is missing"),
        ({"grainz": {}}, r"grainz: unknown key; did you mean 'grains'\?"),
        ({"porosity": {"slice_height": "1 s"}}, r"porosity\.slice_height: '1 s' is a time; a length is needed"),
    ],
)
def test_bad_campaigns_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        expand(campaign(**changes))


def test_fewer_than_five_grains_of_the_top_class_are_refused_unless_allowed_by_name():
    """3 kg of U7: 0.04 · 3 kg / (2650 kg/m³ · π/6 · (22.4 · 31.5) ** 1.5 mm³) = 4.6 grains."""
    fixes = {**STUDY["fixes"], "amount": {"mass": "3 kg"}}
    with pytest.raises(ValueError, match=r"studies\.s, packing U7: .* 4\.6 grains of its top class"):
        expand(campaign(fixes=fixes))
    allowed = {**fixes, "sizes": {"allow_few_top_grains": True}}
    assert len(expand(campaign(fixes=allowed))) == 2


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
    """What the default campaign sets beside the ellipsoids of the grains, by the axes of the grains it draws."""
    config = yaml.safe_load((CONFIG / "config.yaml").read_text())
    campaign = resolve({**config, "studies": {"near_spheres": config["studies"]["near_spheres"]}}, "config")
    specifications = list(expand(campaign).specification)
    assert [specification["shapes"]["kind"] for specification in specifications] == ["sphere"] + 10 * ["ellipsoid"]
    ratios = []
    for specification in specifications:
        sample = set_up(specification, None).sample(np.arange(3))  # of no grain: none is loaded
        ratios.append(sample.L / sample.S)
        np.testing.assert_allclose(sample.L / sample.I, sample.I / sample.S)
    # The four digits of FL = EL = (L/S)^-1/2 leave L/S within 2 (L/S)^1.5 0.5e-4.
    np.testing.assert_allclose(ratios, np.repeat(np.linspace(1.0, 2.0, 11)[:, None], 3, axis=1), atol=3e-4)


def test_own_sizes_of_grains_are_refused_in_a_study():
    with pytest.raises(ValueError, match=r"studies\.s, packing .*: sizes\.own is for single packings"):
        expand(campaign(varies={"seed": [1]}, fixes={**STUDY["fixes"], "sizes": {"own": True}}))


def test_bodies_of_the_files_are_settled_in_the_grain_set():
    table = expand(campaign(grains={"bodies": "split"}))
    assert {spec["grains"]["bodies"] for spec in table.specification} == {"one"}

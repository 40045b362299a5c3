"""A key that has no effect beside the other settings is refused by name, and accepted where it has an effect."""

import pytest
import yaml

from simcore.__main__ import main
from simcore.campaign.studies import merge
from simcore.scene.setup import shape_choice
from simcore.scene.specification import express, read_schema, resolve
from simcore.scene.unused import given_keys, is_shared, why_unused

BED = {"domain": {"width": "36 mm", "height": "0.4 m"}, "sizes": {"case": "U1"}, "amount": {"grains": 100}}
SPHERES = {"shapes": {"kind": "sphere"}}
ELLIPSOIDS = {"shapes": {"kind": "ellipsoid"}}
MIXTURE = {
    "choice": "form_distribution",
    "flatness": {"mean": 0.6, "std": 0.1},
    "elongation": {"mean": 0.7, "std": 0.1},
}
BY_SIZE = {
    "choice": "form_by_size",
    "by_size": [
        {"below": "7 mm", **{key: MIXTURE[key] for key in ("flatness", "elongation")}},
        {"flatness": {"mean": 0.5, "std": 0.1}, "elongation": {"mean": 0.6, "std": 0.1}},
    ],
}
RATIOS = {"kind": "ellipsoid", "choice": "ratios", "eta": 1.6, "zeta": {"mean": 1.2, "std": 0.1}}
FILES = {"grains": {"source": "scans", "unit": "mm"}}
BETA = {"sizes": {"case": None, "beta": {"radius": "3 mm", "spread": 0.2}}}
HERTZ = {"material": {"law": "hertz", "youngs_modulus": "5 MPa"}}
SLIDING = {"material": {"friction_law": "viscous"}}
STRANGE = {"generation": {"placement": "random"}}
SETTLED = {"convergence": {"rule": "settled"}}
# For each key that needs others: a setting of it, settings beside which it has no effect, and ones beside which it has.
CASES = {
    "grains": ({"grains": {"source": "synthetic"}}, SPHERES, ELLIPSOIDS),
    "grains.unit": ({"grains": {"unit": "mm"}}, {}, FILES),
    "grains.bodies": ({"grains": {"bodies": "split"}}, {}, FILES),
    "grains.voxel_spacing": (
        {"grains": {"voxel_spacing": "0.1 mm"}},
        {"grains": {**FILES["grains"], "source": "a.stl"}},
        FILES,
    ),
    "grains.degree": ({"grains": {"degree": 10}}, {"grains": {**FILES["grains"], "source": ["a.stl", "b.npy"]}}, FILES),
    "grains.names": ({"grains": {"names": ["a"]}}, {}, FILES),
    "grains.number": ({"grains": {"number": 30}}, FILES, {}),
    "grains.seed": ({"grains": {"seed": 2}}, FILES, {}),
    "faces": ({"faces": 50}, ELLIPSOIDS, {}),
    "shapes.ellipsoid_share": ({"shapes": {"ellipsoid_share": 0.5}}, {}, {"shapes": {"kind": "mixed"}}),
    "shapes.choice": ({"shapes": {"choice": "random"}}, SPHERES, ELLIPSOIDS),
    "shapes.grain": ({"shapes": {"grain": "G01"}}, {}, {"shapes": {"choice": "one"}}),
    "shapes.flatness": ({"shapes": {"flatness": MIXTURE["flatness"]}}, {}, {"shapes": MIXTURE}),
    "shapes.elongation": ({"shapes": {"elongation": MIXTURE["elongation"]}}, ELLIPSOIDS, {"shapes": MIXTURE}),
    "shapes.by_size": ({"shapes": {"by_size": BY_SIZE["by_size"]}}, {"shapes": MIXTURE}, {"shapes": BY_SIZE}),
    "shapes.eta": ({"shapes": {"eta": 1.6}}, {"shapes": MIXTURE}, {"shapes": RATIOS}),
    "shapes.zeta": ({"shapes": {"zeta": 1.6}}, {}, {"shapes": RATIOS}),
    "sizes.beta.alpha": ({"sizes": {"beta": {"alpha": 2}}}, merge(BETA, {"sizes": {"beta": {"spread": 0}}}), BETA),
    "sizes.beta.beta": ({"sizes": {"beta": {"beta": 2}}}, merge(BETA, {"sizes": {"beta": {"spread": 0}}}), BETA),
    "sizes.allow_few_top_grains": ({"sizes": {"allow_few_top_grains": True}}, BETA, {}),
    "material.poisson_ratio": ({"material": {"poisson_ratio": 0.3}}, SLIDING, merge(SLIDING, HERTZ)),
    "material.friction": ({"material": {"friction": 0.4}}, SLIDING, {}),
    "material.friction_law": ({"material": {"friction_law": "preloaded"}}, {"material": {"friction": 0}}, {}),
    "material.restitution_speed": ({"material": {"restitution_speed": "2 m/s"}}, {}, HERTZ),
    "material.sliding_time": ({"material": {"sliding_time": "20 ms"}}, {}, SLIDING),
    "generation.spacing": (
        {"generation": {"spacing": "20 mm"}},
        {"generation": {"placement": "random", "drop_height": "5 mm"}},
        STRANGE,
    ),
    "generation.drop_height": ({"generation": {"drop_height": "5 mm"}}, {"generation": {"fill": "r22"}}, STRANGE),
    "generation.solid_fraction": (
        {"generation": {"solid_fraction": 0.1}},
        STRANGE,
        {"generation": {"placement": "filled"}},
    ),
    "generation.stretch_x": ({"generation": {"stretch_x": 0.8}}, {"generation": {"placement": "random"}}, {}),
    "generation.stretch_z": ({"generation": {"stretch_z": 2}}, {"generation": {"placement": "filled"}}, {}),
    "generation.orientation": ({"generation": {"orientation": "random"}}, SPHERES, ELLIPSOIDS),
    "shaking.period": ({"shaking": {"period": "20 ms"}}, {"shaking": {"amplitude": "0 m"}}, {}),
    "convergence.kinetic_energy": ({"convergence": {"kinetic_energy": 1e-4}}, {}, SETTLED),
    "convergence.compaction": ({"convergence": {"compaction": 1e-4}}, {}, SETTLED),
    "convergence.window": ({"convergence": {"window": "0.2 s"}}, {}, SETTLED),
    "convergence.height_change": ({"convergence": {"height_change": "1e-6 m"}}, SETTLED, {}),
    "convergence.max_speed": ({"convergence": {"max_speed": "1 cm/s"}}, SETTLED, {}),
    "convergence.max_unbalanced_force": ({"convergence": {"max_unbalanced_force": 0.1}}, SETTLED, {}),
    "numerics.contact_time": ({"numerics": {"contact_time": "1 ms"}}, HERTZ, {}),
    "numerics.polyhedron_contact": ({"numerics": {"polyhedron_contact": "point"}}, ELLIPSOIDS, {}),
    "numerics.ellipsoid_contact": ({"numerics": {"ellipsoid_contact": "potential"}}, {}, ELLIPSOIDS),
}


def marked(schema, above=""):
    """Yield the dotted paths of all keys that need others."""
    for key, sub in schema.get("properties", {}).items():
        if "x-used-with" in sub:
            yield f"{above}{key}"
        yield from marked(sub, f"{above}{key}.")


def test_there_is_a_case_of_every_key_that_needs_others():
    assert set(CASES) == set(marked(read_schema("packing")))


@pytest.mark.parametrize("key", CASES)
def test_a_key_that_is_not_used_is_refused_by_name(key):
    given, without, having = CASES[key]
    with pytest.raises(ValueError, match=rf"^{key}: it has no effect (while|with).*; leave it out"):
        resolve(merge(BED, without, given), unused="refuse")
    resolve(merge(BED, having, given), unused="refuse")
    # Without `unused="refuse"` the specification is accepted, and the key is named as unused.
    assert why_unused(next(given_keys(given)), resolve(merge(BED, without, given)), read_schema("packing"))[0] == key


def test_packings_of_a_study_may_share_the_share_of_ellipsoids():
    for kind, share in (("mixed", 0.5), ("polyhedron", None)):
        resolved = resolve(merge(BED, {"shapes": {"kind": kind, "ellipsoid_share": 0.5}}))
        assert shape_choice(resolved["shapes"]).ellipsoid_share == share


def test_settings_of_an_accuracy_are_not_given():
    resolve({**BED, **ELLIPSOIDS, "accuracy": "draft"}, unused="refuse")
    with pytest.raises(ValueError, match=r"^faces: it has no effect while shapes\.kind is ellipsoid"):
        resolve({**BED, **ELLIPSOIDS, "accuracy": "draft", "faces": 100}, unused="refuse")


def test_null_is_not_given():
    resolve(merge(BED, SPHERES, {"shapes": {"grain": None, "flatness": None}}), unused="refuse")


def test_keys_of_a_specification_that_was_written_out_are_no_choices():
    """The workflow writes every key, whether or not it has an effect."""
    resolved = resolve(merge(BED, ELLIPSOIDS, {"faces": 50, "numerics": {"polyhedron_contact": "point"}}))
    assert resolve(express(resolved), unused="refuse") == resolved
    written = express(resolved)
    del written["damping"]["factor"]
    with pytest.raises(ValueError, match=r"^grains\.bodies: it has no effect"):
        resolve(written, unused="refuse")


def test_an_overlap_at_rest_replaces_the_elastic_constants():
    """The stiffness is then that of the overlap, and without springs Poisson's ratio changes nothing."""
    hertz = {"law": "hertz", "overlap_at_rest": 1e-4, "poisson_ratio": 0.3}
    with pytest.raises(
        ValueError, match="material.poisson_ratio: it has no effect without friction, or with a friction_l"
    ):
        resolve(merge(BED, {"material": {**hertz, "friction_law": "viscous"}}), unused="refuse")
    resolve(merge(BED, {"material": hertz, "numerics": {"dashpot": "explicit"}}), unused="refuse")


def test_what_studies_have_in_common():
    schema = read_schema("packing")
    assert {key for key in marked(schema) if is_shared(key, schema)} == {
        "faces",
        "numerics.contact_time",
        "numerics.polyhedron_contact",
    }


@pytest.mark.parametrize(
    "changes, message",
    [
        (
            {"shapes": {"flatness": {"mean": 0.3, "std": 0.1}, "elongation": {"mean": 0.4, "std": 0.1}}},
            "shapes.flatness: it has no effect while shapes.choice is random; leave it out, or set shapes.choice to "
            "form or form_distribution",
        ),
        (
            {"sizes": {"case": None, "bounds": ["4 mm", "6 mm", "9 mm"], "mass_fractions": [0.4, 1.0]}},
            "sizes: mass_fractions [0.4, 1] sum to 1.4, not to 1; they look cumulative: give the share retained in "
            "each class, [0.4, 0.6]",
        ),
        (
            {"sizes": {"case": None, "bounds": ["4 mm", "6 mm", "9 mm"], "mass_fractions": [40, 60]}},
            "sizes.mass_fractions[0]: 40.0 is out of bounds; it must be at most 1 (give fractions, not percent)",
        ),
    ],
)
def test_a_file_is_refused_in_one_line_that_names_it(tmp_path, capsys, changes, message):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(merge(BED, changes), sort_keys=False))
    for command in (["explain", str(path)], ["pack", str(path), str(tmp_path / "bed.nc")]):
        assert main(command) == 2
        text = capsys.readouterr()
        assert text.err == f"scree {command[0]}: {path}: {message}\n" and text.out == ""

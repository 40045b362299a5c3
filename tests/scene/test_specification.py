"""Specifications: what is accepted, what is filled in, and the one clear error of each bad input."""

import copy
import math

import jsonschema
import numpy as np
import pytest
import yaml

from simcore.scene.quantity import parse_quantity
from simcore.scene.specification import express, read_presets, read_schema, read_specification, resolve, resolve_written

MINIMAL = {
    "domain": {"width": "0.2 m", "height": "80 cm"},
    "sizes": {"case": "U1"},
    "amount": {"mass": "16 kg"},
}


def specification(path, value):
    """Return MINIMAL with `value` at the dotted `path`."""
    raw = copy.deepcopy(MINIMAL)
    *parents, last = path.split(".")
    group = raw
    for key in parents:
        group = group.setdefault(key, {})
    group[last] = value
    return raw


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("31.5 mm", "m", 0.0315),
        ("300 µm", "m", 3e-4),
        ("5e-6 s", "s", 5e-6),
        ("0.2 ms", "s", 2e-4),
        ("2 min", "s", 120.0),
        ("16kg", "kg", 16.0),
        ("250 g", "kg", 0.25),
        ("2.65 g/cm3", "kg/m3", 2650.0),
        ("-1 m/s", "m/s", -1.0),
        ("9.81 m/s²", "m/s2", 9.81),
        ("9.81 m/s^2", "m/s2", 9.81),
    ],
)
def test_quantity_is_the_float_nearest_to_what_was_written(text, unit, expected):
    assert parse_quantity(text, unit) == expected


def test_defaults_are_the_parameters_of_r22():
    """The values are those of Rettinger et al. (2022), as listed in results/reference/r22/README.md."""
    spec = resolve(MINIMAL)
    assert spec["domain"] == {"type": "periodic", "width": 0.2, "height": 0.8}
    assert spec["material"] == {
        "density": 2650.0,
        "fluid_density": 1000.0,
        "gravity": 9.81,
        "restitution": 0.1,
        "poisson_ratio": 0.22,
        "friction": 0.5,
        "end_of_contact": "attractive",
        "law": "spring_dashpot",
        "youngs_modulus": None,
        "overlap_at_rest": None,
        "restitution_speed": 1.0,
        "friction_law": "static",
        "sliding_time": 0.01,
    }
    assert (spec["shaking"]["amplitude"], spec["shaking"]["period"]) == (3e-4, 0.025)
    assert (spec["damping"]["factor"], spec["convergence"]["height_change"]) == (1e-3, 1e-5)
    numerics = spec["numerics"]
    assert math.isclose(numerics["contact_time"] / numerics["steps_per_contact_time"], 5e-6)
    assert (spec["generation"]["velocity_z"], spec["generation"]["velocity_angular"]) == (-1.0, 0.1)


def test_the_input_is_left_alone():
    raw = copy.deepcopy(MINIMAL)
    resolve(raw)
    assert raw == MINIMAL


def test_values_of_numpy_and_paths_are_those_of_yaml():
    given = specification("sizes", {"bounds": ("2.8 mm", "4 mm"), "mass_fractions": np.array([1.0])})
    given |= {
        "seed": np.int32(3),
        "shapes": {"kind": "ellipsoid", "choice": "form", "flatness": np.float64(0.6), "elongation": 0.7},
    }
    plain = copy.deepcopy(given)
    plain["sizes"] = {"bounds": ["2.8 mm", "4 mm"], "mass_fractions": [1.0]}
    plain["seed"], plain["shapes"]["flatness"] = 3, 0.6
    assert resolve_written(given) == resolve_written(plain)
    with pytest.raises(ValueError, match="seed: 2.5 is wrong; a whole number is needed"):
        resolve_written(given | {"seed": np.float64(2.5)})


def test_express_is_the_inverse_of_resolve():
    spec = resolve(specification("sizes", {"bounds": ["2.8 mm", "4 mm"], "mass_fractions": [1.0]}))
    assert resolve(express(spec)) == spec


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("domain.widht", "1 m", r"domain\.widht: unknown key; did you mean 'width'\?"),
        ("friction", 0.3, r"friction: unknown key; did you mean 'material\.friction'\?"),
        ("graims", {}, r"graims: unknown key; did you mean 'grains'\?"),
        (
            "domain.width",
            "0.2 kg",
            r"domain\.width: '0\.2 kg' is a mass; a length is needed, such as '0\.2",
        ),
        ("domain.width", 0.2, r"domain\.width: 0\.2 has no unit; a length is needed"),
        ("domain.width", "0.2", r"domain\.width: '0\.2' has no unit"),
        ("domain.width", "nan m", r"domain\.width: 'nan m' is not a number with a unit"),
        ("domain.width", "1e999 m", r"domain\.width: '1e999 m' is not finite"),
        ("domain.width", "-1e999 m", r"domain\.width: '-1e999 m' is not finite"),
        ("domain.width", "-2 mm", r"domain\.width: -0\.002 m is out of bounds; it must be more than 0 m"),
        ("domain.width", None, r"domain\.width is empty; a length is needed"),
        (
            "domain.type",
            "cilinder",
            r"domain\.type: 'cilinder' is not a choice; choose one of periodic",
        ),
        ("domain", "0.2 m", r"domain: '0\.2 m' is wrong; a group of keys is needed"),
        ("material.density", "2650 lb/m3", r"material\.density: '2650 lb/m3': unknown unit 'lb/m3'"),
        ("material.friction", float("nan"), r"material\.friction: nan is not a finite number"),
        (
            "material.friction",
            "1e-5",
            r"material\.friction: '1e-5' .*YAML reads it as text: write 1\.0e-05",
        ),
        ("material.restitution", 1.5, r"material\.restitution: 1\.5 is out of bounds; it must be at most 1"),
        ("seed", 1.5, r"seed: 1\.5 is wrong; a whole number is needed"),
        ("seed", True, r"seed: True is wrong; a whole number is needed"),
        ("amount.grains", 300, r"amount: give either a mass, such as 16 kg, or a number of grains"),
        ("amount", {}, r"amount: give either a mass"),
        ("sizes", {"bounds": ["1 mm", "2 mm"]}, r"sizes: give either a case, such as U1, or both bounds"),
        ("sizes", {"bounds": ["1 mm", 2], "mass_fractions": [1.0]}, r"sizes\.bounds\[1\]: 2 has no unit"),
        ("shapes.choice", "one", r"shapes\.grain: choice \"one\" needs the name of a grain"),
        (
            "shapes",
            {"kind": "polyhedron", "choice": "form", "flatness": 0.5, "elongation": 0.5},
            r"shapes\.kind: choice \"form\" works only with kind \"ellipsoid\"",
        ),
        ("shapes.kind", "mixed", r"shapes\.ellipsoid_share: kind \"mixed\" needs a number from 0 to 1"),
        (
            "shapes",
            {"kind": "mixed", "ellipsoid_share": 1.5},
            r"shapes\.ellipsoid_share: 1\.5 is out of bounds; it must be at most 1",
        ),
        (
            "shapes",
            {"kind": "mixed", "ellipsoid_share": 0.5, "choice": "one"},
            r"shapes\.grain: choice \"one\" needs the name of a grain",
        ),
        (
            "shapes",
            {"choice": "form_distribution", "flatness": {"mean": 0.5, "sd": 0.1}},
            r"shapes\.flatness\.sd: unknown key; did you mean 'std'\?",
        ),
        ("shapes", {"choice": "form_distribution", "flatness": {"mean": 0.5}}, r"flatness\.std is missing"),
        ("faces", "orig", r"faces: 'orig' is wrong"),
        ("name", "../escape", r"name: '\.\./escape' has other characters than letters, digits"),
        ("seed", 2**64, r"seed: 18446744073709551616 is out of bounds; it must be at most 9223372036854775807"),
    ],
)
def test_bad_input_is_refused_with_the_path_of_the_key(path, value, message):
    with pytest.raises(ValueError, match=message):
        resolve(specification(path, value))


def test_a_missing_key_is_named():
    with pytest.raises(ValueError, match=r"^domain\.height is missing; a length is needed"):
        resolve({**MINIMAL, "domain": {"width": "1 m"}})


def test_the_path_starts_with_where():
    with pytest.raises(ValueError, match=r"^studies\.single_form\.amount: give either"):
        resolve({**MINIMAL, "amount": {}}, where="studies.single_form")


def test_errors_of_a_file_name_the_file(tmp_path):
    path = tmp_path / "mine.yaml"
    with pytest.raises(ValueError, match=r"mine\.yaml: there is no such file"):
        read_specification(path)
    path.write_text("studies: {mine: {fixes: {amount: {grains: 40}}}}")
    with pytest.raises(ValueError, match=r"mine\.yaml is the file of a campaign, .* under `fixes` there"):
        read_specification(path)
    path.write_text("domain: {width: 0.2 m")
    with pytest.raises(ValueError, match=r"mine\.yaml is not valid YAML"):
        read_specification(path)
    path.write_text("domain: {width: 0.2 m, height: 1 m}\nsizes: {case: U1}\namount: {mass: 2 m}\n")
    with pytest.raises(ValueError, match=r"mine\.yaml: amount\.mass: '2 m' is a length; a mass is needed"):
        read_specification(path)


TEXT = "domain: {width: 0.2 m, height: 1 m}\nsizes: {case: U1}\namount: {mass: 2 kg}\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_file_may_be_saved_as_unicode(tmp_path, encoding):
    path = tmp_path / "mine.yaml"
    path.write_text(f"# Körnung\n{TEXT}", encoding=encoding)
    assert read_specification(path)["domain"]["height"] == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("amount: {mass: 3 kg}\n", r"mine\.yaml, line 4: amount is given in line 3 already; remove one of them"),
        ("faces: 50\nshapes: {kind: polyhedron,\n  kind: sphere}\n", r"line 6: kind is given in line 5 already"),
        (f"faces: {3000 * '['}", "mine.yaml is not valid YAML: it is nested too deeply"),
        ("name: 2001-99-99\n", "mine.yaml is not valid YAML: month must be in"),
        ("seed: 010\n", "mine.yaml, line 4: YAML reads 010 as an octal number; write 10, or in quotation marks"),
        ("seed: 1:30\n", "mine.yaml, line 4: YAML reads 1:30 as a number to the base 60; write a number, or a time"),
        ("shaking: &x {duration: *x}\n", "mine.yaml, line 4: a group contains itself by its alias; write out"),
        ("seed: -010\n", "mine.yaml, line 4: YAML reads -010 as an octal number; write -10, or"),
        ("seed: !!timestamp abc\n", "mine.yaml, line 4: the tag !!timestamp of 'abc' has no use here; remove it"),
        ("seed: !!int ''\n", "mine.yaml, line 4: the tag !!int of '' has no use here; remove it"),
        ("seed: !!int '010'\n", "mine.yaml, line 4: the tag !!int of '010' has no use here"),
        (f"seed: 0x{5000 * 'f'}\n", "mine.yaml: seed: the number is too large; correct it"),
        ("shaking: {duration: 1e308 km}\n", "shaking.duration"),
        (f"material: {{friction: 1{400 * '0'}}}\n", "material.friction: the number is too large; correct it"),
        ("grains: {unit: 1e-999999999 m}\n", "grains.unit"),
        (
            "x0: &x0 [1]\n" + "".join(f"x{i}: &x{i} [{9 * ('*x' + str(i - 1) + ', ')}]\n" for i in range(1, 9)),
            "mine.yaml: it has more than 1000000 values with all aliases; write fewer of them",
        ),
        ('name: "bed\\n"\n', "name: 'bed.n' has other characters than letters"),
    ],
)
def test_what_yaml_takes_silently_or_stumbles_over_is_refused(tmp_path, text, message):
    path = tmp_path / "mine.yaml"
    path.write_text(TEXT + text)
    with pytest.raises(ValueError, match=message):
        read_specification(path)


def test_merged_groups_may_override_keys(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(TEXT.replace("domain: {", "domain: {<<: {").replace("1 m}", "1 m}, height: 2 m}"))
    assert read_specification(path)["domain"]["height"] == 2.0


def leaves(schema, path=""):
    for key, sub in schema.get("properties", {}).items():
        if sub.get("type") == "object":
            yield from leaves(sub, f"{path}{key}.")
        else:
            yield f"{path}{key}", sub


@pytest.mark.parametrize("name", ["packing"])
def test_every_key_has_a_meaning_and_every_group_refuses_unknown_keys(name):
    schema = read_schema(name)
    assert all("description" in sub for _, sub in leaves(schema))
    groups = [schema, *(sub for sub in schema["properties"].values() if sub.get("type") == "object")]
    assert all(group.get("additionalProperties") is False for group in groups)


def test_accuracy_lays_its_settings_under_what_is_given():
    study = resolve({**MINIMAL, "accuracy": "r22"})
    assert study["faces"] == 300
    assert study["shaking"]["duration"] == 6.0
    assert study["numerics"]["contact_time"] == 2e-4
    mine = resolve({**MINIMAL, "accuracy": "draft", "faces": 50, "numerics": {"contact_time": "3 ms"}})
    draft = resolve({**MINIMAL, "accuracy": "draft"})
    assert (mine["faces"], mine["numerics"]["contact_time"]) == (50, 3e-3)
    assert mine["numerics"]["steps_per_contact_time"] == draft["numerics"]["steps_per_contact_time"]
    assert mine["shaking"] == draft["shaking"]
    assert resolve(express(mine)) == mine


@pytest.mark.parametrize("choice", ["draft", "standard", "wide", "r22"])
def test_each_accuracy_gives_a_whole_specification(choice):
    """Every choice sets the same keys, so that changing from one to another leaves nothing of it behind."""
    presets = read_presets("accuracy")
    assert {key: list(group) if isinstance(group, dict) else None for key, group in presets[choice].items()} == {
        key: list(group) if isinstance(group, dict) else None for key, group in presets["r22"].items()
    }
    assert resolve({**MINIMAL, "accuracy": choice})["accuracy"] == choice


def test_an_accuracy_that_is_not_there_is_refused():
    with pytest.raises(ValueError, match=r"accuracy: 'papr' is not a choice; choose one of draft, standard, wide, r22"):
        resolve({**MINIMAL, "accuracy": "papr"})


@pytest.mark.parametrize(
    "given, message",
    [
        ({"accuracy": "paper"}, "accuracy: 'paper' is called 'r22' now; write the new name"),
        ({"generation": {"fill": "study"}}, "generation.fill: 'study' is called 'r22' now; write the new name"),
        ({"shapes": {"kind": "mesh"}}, "shapes.kind: 'mesh' is called 'polyhedron' now; write the new name"),
        (
            {"numerics": {"contact_region": "point"}},
            "numerics.contact_region: this key is called polyhedron_contact now; rename it",
        ),
    ],
)
def test_former_names_are_refused_with_the_present_ones(given, message):
    with pytest.raises(ValueError) as error:
        resolve({**MINIMAL, **given})
    assert str(error.value) == message


LIMITED = {
    "type": "object",
    "additionalProperties": False,
    "required": ["few"],
    "properties": {
        "few": {"type": "object", "properties": {"n": {"type": "number", "maximum": 3}}},
        "many": {"type": "object", "properties": {"n": {"type": "number", "maximum": 9}}},
        "limit": {"type": "number", "exclusiveMinimum": 0},
    },
    "allOf": [{"if": {"properties": {"limit": {"const": 5}}, "required": ["limit"]}, "then": {"required": ["many"]}}],
}


def test_a_group_that_was_checked_in_one_place_is_not_valid_in_another(tmp_path):
    """Groups are checked once; what is accepted is compared with a check of the whole, each specification twice."""
    (tmp_path / "limited.schema.yaml").write_text(yaml.safe_dump(LIMITED))
    rng = np.random.default_rng(2)
    accepted = 0
    for _ in range(300):
        n, raw = int(rng.integers(1, 6)), {}
        for name in rng.permutation(["few", "many", "limit", "other"])[: rng.integers(2, 4)]:
            raw[str(name)] = int(rng.integers(-1, 7)) if name == "limit" else {"n": n}
        valid = jsonschema.Draft202012Validator(LIMITED).is_valid(raw)
        for _ in range(2):
            try:
                assert resolve(raw, tmp_path / "limited.schema.yaml") == raw and valid
                accepted += 1
            except ValueError:
                assert not valid
    assert 50 < accepted < 500

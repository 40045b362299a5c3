"""Schemas for editors accept what users write and reject errors that an editor can detect."""

import copy
import json

import jsonschema
import pytest
import yaml

from simcore.__main__ import main
from simcore.paths import CONFIG, ROOT
from simcore.scene.editor_schema import editor_schema
from simcore.scene.specification import express, read_specification

EXAMPLES = sorted((ROOT / "examples").glob("*.yaml"))
CAMPAIGNS = sorted(
    path for path in CONFIG.glob("*.yaml") if not path.name.endswith("schema.yaml") and path.name != "accuracy.yaml"
)


def read(path):
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def errors(content, name):
    """Return the paths of the errors that a validator of plain JSON Schema reports."""
    found = jsonschema.Draft202012Validator(editor_schema(name)).iter_errors(content)
    return [".".join(map(str, error.absolute_path)) for error in found]


def test_the_schemas_are_valid_and_have_no_keyword_of_ours():
    for name in ("packing", "config"):
        schema = editor_schema(name)
        jsonschema.Draft202012Validator.check_schema(schema)
        assert '"x-' not in json.dumps(schema)
        assert "$ref" not in json.dumps(schema)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_accepted_as_written_and_with_all_defaults(path):
    assert errors(read(path), "packing") == []
    assert errors(express(read_specification(path)), "packing") == []


@pytest.mark.parametrize("path", CAMPAIGNS, ids=lambda path: path.stem)
def test_campaigns_are_accepted(path):
    content = {"studies": {}, **read(path)}  # an overlay may have none
    assert errors(content, "config") == []


def test_the_campaign_of_the_page_on_own_grains_is_accepted():
    text = (ROOT / "docs/how_to/own_grains.md").read_text(encoding="utf-8").split("```yaml\n")[1].split("```")[0]
    assert errors(yaml.safe_load(text), "config") == []


@pytest.mark.parametrize(
    "change, place",
    [
        ({"domain": {"type": "periodic", "width": 0.042, "height": "0.3 m"}}, "domain.width"),
        ({"domain": {"type": "periodic", "width": "42", "height": "0.3 m"}}, "domain.width"),
        ({"sizes": {"bounds": ["7 mm", 8], "mass_fractions": [1]}}, "sizes.bounds.1"),
        ({"seed": "one"}, "seed"),
        ({"sead": 1}, ""),
        ({"shapes": {"kind": "spere"}}, "shapes.kind"),
    ],
)
def test_wrong_units_types_keys_and_choices_are_marked(change, place):
    content = copy.deepcopy(read(ROOT / "examples/spheres.yaml")) | change
    assert errors(content, "packing") == [place]


def test_descriptions_tell_unit_and_bounds():
    width = editor_schema()["properties"]["domain"]["properties"]["width"]
    assert "A length, such as '0.2 m'; " in width["description"]
    assert "more than 0 m and at most 100 m" in width["description"]


@pytest.mark.parametrize("name", ["packing", "config"])
def test_the_committed_schemas_are_those_of_the_command(name, capsys):
    assert main(["schema", name]) == 0
    path = CONFIG / "editor" / f"{name}.json"
    assert path.read_text(encoding="utf-8") == capsys.readouterr().out, f"run: scree schema {name} > {path}"

"""Specifications: the settings of a YAML file, checked against a schema and converted to SI numbers.

Only the schema (config/<name>.schema.yaml, JSON Schema with additional keywords) defines the keys, with their units,
bounds, defaults and meanings. The additional keywords are:

x-unit       marks a quantity: text with a unit in YAML, a float in SI once it is resolved; bounds are in SI
x-error      message that replaces that of a rule
x-hint       text that is added to the message of a bound
x-used-with  settings without which a key has no effect (unused.py)
x-shared     marks a key that studies may share even if only some of them use it (unused.py)
x-renamed    former names of keys or choices, which are refused with the present name
x-presets    marks a key at the top level that selects a group of settings in the file named; settings that are given
             override those of the group
"""

import difflib
import functools
import math
import re
import sys
from os import PathLike
from pathlib import Path

import jsonschema
import numpy as np
import yaml

from simcore.paths import CONFIG
from simcore.scene.quantity import NUMBER, describe_quantity, parse_quantity
from simcore.scene.sizes import size_curve
from simcore.scene.unused import check_used
from simcore.scene.yaml_nodes import UnsuitableYAML, check_nodes


def resolve(raw, schema="packing", where="", unused="keep"):
    """Return the specification `raw` with every key checked, defaults filled in and quantities as floats in SI.

    raw: nested dict as read from YAML; it is not changed. schema: "packing", "config", or the path of a schema. where:
    prefix of the path in messages, such as "studies.single_form". unused: "refuse" or "keep" keys that have no effect
    with the others; "refuse" is for specifications that a user wrote, "keep" for settings that many packings share.
    ValueError names the path of the first key that is unknown, missing, of the wrong type or unit, out of bounds or not
    finite, or, with "refuse", has no effect.
    """
    given = raw
    raw = with_presets(raw, schema)
    schema = read_schema(schema)
    resolved = _convert(raw, schema, where)
    _check_rules(resolved, schema, where)
    if unused == "refuse":
        check_used(given, resolved, schema, where)
    return resolved


def check_values(raw, schema="packing", where=""):
    """Raise ValueError if a given key is unknown, or a value has another type or unit; keys may be missing.

    Arguments: as in `resolve`. Bounds and rules between keys are not checked.
    """
    _convert(raw, _optional(read_schema(schema)), where)


def _optional(schema):
    """Return a schema without its required keys."""
    properties = {key: _optional(node) for key, node in schema.get("properties", {}).items()}
    rest = {key: value for key, value in schema.items() if key != "required"}
    return {**rest, "properties": properties} if properties else rest


def express(resolved, schema="packing"):
    """Return a resolved specification as a nested dict for YAML, with quantities as text; the inverse of `resolve`."""
    return _express(resolved, read_schema(schema))


def resolve_written(raw, schema="packing"):
    """Return the resolved specification that a user wrote; ValueError also for a key without effect or wrong sizes.

    raw: as for `resolve`; numpy's numbers and arrays, tuples and paths are as good as Python's numbers, lists and text.
    """
    resolved = resolve(_plain(raw), schema, unused="refuse")
    if schema == "packing" and not resolved["sizes"]["own"]:  # own sizes follow from the grains, which are read later
        size_curve(resolved["sizes"])
    return resolved


def _plain(value):
    """Return a value with the types that a YAML file gives."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    return str(value) if isinstance(value, PathLike) else value


def read_specification(path, schema="packing"):
    """Read the YAML file at `path` and return its resolved specification; ValueError names the file and the key."""
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path}: this is a folder; give the file of a specification")
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file; correct the path")
    raw = read_yaml(path)
    if schema == "packing" and isinstance(raw, dict) and "studies" in raw:
        raise ValueError(
            f"{path} is the file of a campaign, as it has the key `studies`; give the file of one packing, with the "
            "keys that are under `fixes` there"
        )
    try:
        return resolve_written(raw if raw is not None else {}, schema)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def read_yaml(path):
    """Return the content of the YAML file at `path`, in UTF-8, or UTF-16 with a byte order mark.

    ValueError if it is not valid YAML, if a key occurs twice in a group, or if the YAML would surprise: whole numbers
    with a leading 0 or a colon, tags, and aliases that contain themselves or expand without end.
    """
    data = path.read_bytes()
    try:
        document = yaml.compose(data, Loader=yaml.SafeLoader)
        check_nodes(path, document)
        return yaml.safe_load(data)
    except yaml.YAMLError as error:
        raise ValueError(f"{path} is not valid YAML: {' '.join(str(error).split())}") from None
    except RecursionError:
        raise ValueError(f"{path} is not valid YAML: it is nested too deeply") from None
    except UnsuitableYAML:
        raise
    except ValueError as error:  # a date that does not exist
        raise ValueError(f"{path} is not valid YAML: {' '.join(str(error).split())}") from None


def read_schema(schema):
    """Return the schema with the name (or path) `schema` as a dict, with references to other schema files resolved."""
    path = Path(schema)
    if path.suffix != ".yaml":
        path = CONFIG / f"{schema}.schema.yaml"
    return _load(path.resolve())


@functools.cache
def _load(path):
    # libyaml reads the schemas of a campaign in a tenth of the time; PyYAML may be installed without it.
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    return _inline(yaml.load(path.read_text(encoding="utf-8"), loader), path.parent)


def _inline(node, folder):
    """Replace {$ref: file#/a/b, ...} by the node at that place; keys next to $ref override those of the node."""
    if isinstance(node, list):
        return [_inline(item, folder) for item in node]
    if not isinstance(node, dict):
        return node
    node = {key: _inline(value, folder) for key, value in node.items()}
    if "$ref" not in node:
        return node
    file, _, pointer = node.pop("$ref").partition("#")
    target = _load((folder / file).resolve())
    for key in filter(None, pointer.split("/")):
        target = target[key]
    return {**target, **node}


def read_presets(key, schema="packing"):
    """Return the settings of every choice of a key marked x-presets, a dict from choice to nested dict."""
    return _load((CONFIG / read_schema(schema)["properties"][key]["x-presets"]).resolve())


def with_presets(raw, schema="packing"):
    """Return a new dict of the settings that the presets in `raw` (`x-presets`) select, overridden by those in `raw`.

    Values that are not choices are left to the checks.
    """
    if not isinstance(raw, dict):
        return raw
    for key, sub in read_schema(schema).get("properties", {}).items():
        if "x-presets" in sub and isinstance(raw.get(key), str):
            raw = _override(_load((CONFIG / sub["x-presets"]).resolve()).get(raw[key], {}), raw)
    return raw


def _override(base, overlay):
    if not (isinstance(base, dict) and isinstance(overlay, dict)):
        return overlay
    return {**base, **{key: _override(base.get(key), value) for key, value in overlay.items()}}


def _convert(value, schema, path):
    """Check keys and types, parse quantities and fill in defaults, below `path`; bounds are checked later, in SI."""
    types = _types(schema)
    if value is None:
        any_type = not ({"type", "enum", "x-unit"} & schema.keys())
        if any_type or "null" in types or None in schema.get("enum", ()):
            return None
        raise ValueError(f"{_name_path(path)} is empty; {_describe_needed(schema)}")
    if "x-unit" in schema:
        try:
            return parse_quantity(value, schema["x-unit"])
        except ValueError as error:
            raise ValueError(f"{_name_path(path)}: {error}") from None
    if isinstance(value, dict) and ("object" in types or not types):
        return _convert_object(value, schema, path)
    if isinstance(value, list) and ("array" in types or not types):
        items = schema.get("items", {})
        return [_convert(item, items, f"{path}[{number}]") for number, item in enumerate(value)]
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise ValueError(f"{_name_path(path)}: the number is too large; correct it")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{_name_path(path)}: {value} is not a finite number; {_describe_needed(schema)}")
    if types and not any(_is_type(value, name) for name in types):
        hint = ""
        if isinstance(value, str) and re.fullmatch(NUMBER, value):
            hint = (
                f" (YAML reads it as text: write {yaml.safe_dump(float(value)).split()[0]})"
                if "number" in types
                else ""
            )
        raise ValueError(f"{_name_path(path)}: {value!r} is wrong{hint}; {_describe_needed(schema)}")
    return float(value) if "number" in types and _is_type(value, "number") else value


def _convert_object(value, schema, path):
    properties, others = schema.get("properties", {}), schema.get("additionalProperties", True)
    for key in value:
        if not isinstance(key, str):
            raise ValueError(f"{_name_path(path)}: the key {key!r} must be text; write it in quotation marks")
        if key in schema.get("x-renamed", {}):
            raise ValueError(f"{_join(path, key)}: this key is called {schema['x-renamed'][key]} now; rename it")
        if key not in properties and others is False:
            raise ValueError(f"{_join(path, key)}: unknown key{_guess(key, properties)}")
    converted = {}
    for key, sub in properties.items():
        if key in value:
            converted[key] = _convert(value[key], sub, _join(path, key))
        elif key in schema.get("required", ()):
            raise ValueError(f"{_join(path, key)} is missing; {_describe_needed(sub)}")
        elif "default" in sub:
            converted[key] = _convert(sub["default"], sub, _join(path, key))
    for key in value.keys() - properties.keys():
        sub = others if isinstance(others, dict) else {}
        converted[key] = _convert(value[key], sub, _join(path, key))
    return {key: converted[key] for key in [*properties, *value] if key in converted}


def _check_rules(resolved, schema, where):
    """Check bounds, choices and rules between keys, by JSON Schema on the SI values; ValueError if one is violated."""
    if _follows_rules(resolved, schema):
        return
    errors = jsonschema.Draft202012Validator(schema).iter_errors(resolved)
    error = min(errors, key=lambda error: [str(part) for part in error.absolute_path], default=None)
    if error is None:
        return
    path = where
    for part in error.absolute_path:
        path = f"{path}[{part}]" if isinstance(part, int) else _join(path, part)
    raise ValueError(f"{_name_path(path)}: {_explain(error)}")


_checked = {}  # schemas of the groups that follow their rules, by the identity of the schema and the text of the group


def _follows_rules(resolved, schema):
    """Return whether no rule is violated; packings of a campaign share most groups, and each group is checked once."""
    properties = schema.get("properties", {})
    if not isinstance(resolved, dict):
        return False
    without_groups = {**schema, "properties": dict.fromkeys(properties, True)}
    if not jsonschema.Draft202012Validator(without_groups).is_valid(resolved):
        return False
    for name in properties.keys() & resolved.keys():
        group = properties[name]
        key = id(group), repr(resolved[name])
        if key not in _checked:
            if not jsonschema.Draft202012Validator(group).is_valid(resolved[name]):
                return False
            _checked[key] = group  # a schema that is kept keeps its identity
    return True


def _explain(error):
    rule, bound, value, schema = error.validator, error.validator_value, error.instance, error.schema
    if "x-error" in schema and rule == "pattern":
        return f"{value!r} {schema['x-error']}"
    if "x-error" in schema and rule in ("oneOf", "const", "type"):
        return schema["x-error"]
    unit = f" {schema['x-unit']}" if "x-unit" in schema else ""
    bounds = {
        "minimum": "at least",
        "maximum": "at most",
        "exclusiveMinimum": "more than",
        "exclusiveMaximum": "less than",
    }
    if rule in bounds:
        hint = f" ({schema['x-hint']})" if "x-hint" in schema else ""
        return f"{value}{unit} is out of bounds; it must be {bounds[rule]} {bound}{unit}{hint}"
    if rule == "enum" and isinstance(value, str) and value in schema.get("x-renamed", {}):
        return f"{value!r} is called {schema['x-renamed'][value]!r} now; write the new name"
    if rule == "enum":
        return f"{value!r} is not a choice; choose one of {_join_names(bound)}"
    if rule == "pattern":
        return f"{value!r} is wrong; {_describe_needed(schema)}"
    if rule == "minItems":
        return f"{len(value)} elements are too few; at least {bound} are needed"
    return error.message


def _express(value, schema):
    if "x-unit" in schema and value is not None:
        return f"{value!r} {schema['x-unit']}"
    if isinstance(value, dict):
        properties, others = schema.get("properties", {}), schema.get("additionalProperties")
        others = others if isinstance(others, dict) else {}
        return {key: _express(item, properties.get(key, others)) for key, item in value.items()}
    if isinstance(value, list):
        return [_express(item, schema.get("items", {})) for item in value]
    return value


def _types(schema):
    types = schema.get("type", ())
    return (types,) if isinstance(types, str) else tuple(types)


def _is_type(value, name):
    kinds = {
        "string": str,
        "integer": int,
        "number": (int, float),
        "boolean": bool,
        "object": dict,
        "array": list,
    }
    if isinstance(value, bool):
        return name == "boolean"
    return name in kinds and isinstance(value, kinds[name])


def _describe_needed(schema):
    """Describe the value that a key needs."""
    if "x-unit" in schema:
        return describe_quantity(schema["x-unit"])
    if "enum" in schema:
        return f"choose one of {_join_names(schema['enum'])}"
    words = {"string": "text", "integer": "a whole number", "number": "a number", "boolean": "true or false"}
    words |= {"object": "a group of keys", "array": "a list", "null": "null"}
    kinds = " or ".join(words[name] for name in _types(schema)) or "a value"
    description = schema.get("description")
    return f"{kinds} is needed" + (f": {description.rstrip('.')}" if description else "")


def _guess(word, names):
    close = difflib.get_close_matches(str(word), [str(item) for item in names if item is not None], n=1)
    if close:
        return f"; did you mean '{close[0]}'?"
    groups = [key for key, sub in names.items() if word in sub.get("properties", ())] if isinstance(names, dict) else []
    if groups:
        return f"; did you mean '{groups[0]}.{word}'?"
    return f"; the keys here are {_join_names(names)}" if isinstance(names, dict) else ""


def _join_names(items):
    return ", ".join("null" if item is None else str(item) for item in items)


def _join(path, key):
    return f"{path}.{key}" if path else key


def _name_path(path):
    return path or "the specification"

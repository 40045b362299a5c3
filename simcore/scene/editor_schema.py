"""Schemas for editors: plain JSON Schema of what a user writes, with quantities as text with a unit.

The schemas in config/ describe the resolved values, in SI units and as numbers, with keywords of their own. An editor
that knows only JSON Schema would mark "25 mm" as wrong there.
"""

from simcore.scene.quantity import NUMBER, describe_quantity
from simcore.scene.specification import read_schema

# Keywords of groups of subschemas, which describe relations between resolved values.
_RULES = ("allOf", "anyOf", "oneOf", "not", "if", "then", "else")


def editor_schema(name: str = "packing") -> dict:
    """Return the JSON Schema (draft 2020-12) of the YAML files of a packing ("packing") or of a campaign ("config").

    It accepts each file that `read_specification` accepts. It does not contain the bounds of quantities and the rules
    between keys, which are checked when a file is read.
    """
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **_outside(read_schema(name))}


def _outside(node):
    """Return a schema without the keywords that only hold for resolved values; quantities are text."""
    if isinstance(node, list):
        return [_outside(item) for item in node]
    if not isinstance(node, dict):
        return node
    if "x-unit" in node:
        return _quantity(node)
    kept = {key: value for key, value in node.items() if not key.startswith("x-") and key not in _RULES}
    if "properties" in kept:
        kept["properties"] = {key: _outside(value) for key, value in kept["properties"].items()}
    for key in ("additionalProperties", "items", "propertyNames"):
        if key in kept:
            kept[key] = _outside(kept[key])
    return kept


def _quantity(node):
    needed = describe_quantity(node["x-unit"]).replace(" is needed, such as", ", such as")
    text = {"type": "string", "pattern": rf"^\s*{NUMBER}\s*[A-Za-zµμ]", "description": _describe(node, needed)}
    if "null" in node.get("type", ()):
        text["type"] = ["string", "null"]
    if "default" in node:
        text["default"] = node["default"]
    return text


def _describe(node, needed):
    bounds = {
        "minimum": "at least",
        "exclusiveMinimum": "more than",
        "maximum": "at most",
        "exclusiveMaximum": "less than",
    }
    limits = " and ".join(f"{words} {node[key]} {node['x-unit']}" for key, words in bounds.items() if key in node)
    quantity = f"{needed[0].upper()}{needed[1:]}" + (f"; {limits}." if limits else ".")
    sentences = [node.get("description", "").strip(), quantity]
    return " ".join(filter(None, sentences))

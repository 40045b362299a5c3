"""Pages of the settings: all keys of a packing and of a campaign with unit, bounds, default and meaning.

The schemas in config/ define the keys; `settings` walks through one.
"""

import json
import re
from typing import NamedTuple

from docs.generate.markdown import code, sentence, table
from simcore.paths import CONFIG, ROOT
from simcore.scene.quantity import describe_quantity
from simcore.scene.specification import read_presets, read_schema

EXAMPLE = "examples/polyhedra.yaml"
_LIMITS = {
    "minimum": "at least",
    "exclusiveMinimum": "more than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
    "minItems": "at least",
    "maxItems": "at most",
}
_TYPES = {
    "integer": "whole number",
    "number": "number",
    "string": "text",
    "boolean": "true or false",
    "array": "list",
    "object": "group of keys",
}
_HEAD = (
    "Every quantity is text with a unit, such as `8 mm`; bounds are in SI units. A key that is unknown, out of bounds, "
    "or without effect beside the others is refused before anything runs. Your file needs only the keys that are "
    "required and those that differ from their defaults."
)


class Setting(NamedTuple):
    """A key of a schema: its dotted path, its node, and whether the group that contains it requires it."""

    path: str
    node: dict
    required: bool

    @property
    def is_group(self):
        """Whether the key is only a group of other keys."""
        return self.node.get("type") == "object" and bool(_inner(self.node))


def settings(schema, above=""):
    """Return the Settings of a schema (a dict) below the path `above`, groups before their keys.

    Keys that a user names, such as those of studies, are called NAME.
    """
    listed = []
    for key, node in _inner(schema).items():
        setting = Setting(f"{above}{key}", node, key in schema.get("required", ()))
        listed += [setting, *settings(node, f"{setting.path}.")]
    return listed


def packing_page():
    """Return the page of the settings of a packing."""
    head = (
        "# Settings of a packing\n\nA specification is a YAML file with these keys. Commands such as `scree pack` and "
        "`scree explain` read it, and `simcore.pack` also takes a dict of them. The studies of a campaign set the same "
        f"keys under `packing`, `fixes` and `varies` ([settings of a campaign](campaign_settings.md)). {_HEAD}\n"
    )
    example = (ROOT / EXAMPLE).read_text(encoding="utf-8").strip()
    return f"{head}\n`{EXAMPLE}`:\n\n```yaml\n{example}\n```\n\n{_body('packing')}"


def campaign_page():
    """Return the page of the settings of a campaign."""
    head = (
        "# Settings of a campaign\n\nA campaign is a table of packings that Snakemake makes. `config/config.yaml` has "
        "these keys, and an overlay (`--configfile`) overrides them. The keys of a single packing are on the page "
        f"[settings of a packing](packing_settings.md). {_HEAD}\n"
    )
    return head + "\n" + _body("config")


def curves_page():
    """Return the page of the sieve curves that have a name."""
    parts = [
        "# Named sieve curves",
        "These are the choices of [`sizes.case`](packing_settings.md#sizes.case). A number is the share of the mass in "
        "a sieve class. Curves of one family are left out together when models of size and form are compared.",
    ]
    sources = {
        "cases.tsv": "Sieve curves of Rettinger et al. (2022)",
        "curves.tsv": "Sieve curves of the study of size and form",
    }
    for name, title in sources.items():
        lines = [line for line in (CONFIG / name).read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        header, *rows = [line.split("\t") for line in lines if line.strip()]
        words = {"case": "name", "generation_spacing [mm]": "spacing of the lattice at insertion [mm]"}
        parts += [f"## {title}", table([words.get(cell, cell) for cell in header], rows)]
    return "\n\n".join(parts) + "\n"


def _body(name):
    schema = read_schema(name)
    parts = []
    for setting in settings(schema):
        level = "##" if "." not in setting.path else "###"
        parts += [f"{level} {setting.path} {{#{setting.path}}}", *_described(setting, name)]
    return "\n\n".join(parts) + "\n"


def _described(setting, name):
    node = setting.node
    facts = [", ".join([_value(node), *_limits(node)]), "required" if setting.required else "", _default(node)]
    parts = [] if setting.is_group else ["*" + "; ".join(filter(None, facts)) + "*"]
    parts.append(_meaning(node))
    parts += ["\n".join(f"- {line}" for line in _conditions(node))]
    if "x-presets" in node:
        parts.append(_presets(setting.path, name))
    if messages := _rules(node):
        parts += ["These rules are checked:", "\n".join(f"- {message}" for message in messages)]
    return list(filter(None, parts))


def _meaning(node):
    """Return the description of a key; if it explains each choice after a dash, the choices are a list."""
    text = sentence(node["description"])
    head, dash, rest = text.partition(" - ")
    choices = [choice for choice in node.get("enum", ()) if isinstance(choice, str)]
    starts = "|".join(map(re.escape, choices))
    parts = re.split(rf"; (?=(?:{starts})\b)", rest) if dash and choices else []
    if [re.match(rf"({starts})\b", part) is not None for part in parts] != [True] * max(len(choices), 1):
        return text
    items = [re.sub(rf"^({starts})\b(:|,)? *", r"`\1`: ", part).rstrip(".") for part in parts]
    return "\n".join([f"{head}:", "", *(f"- {item}." for item in items)])


def _inner(node):
    """Return the keys below a node: dict from name to node."""
    keys = dict(node.get("properties", {}))
    others = node.get("additionalProperties")
    if isinstance(others, dict):
        keys["NAME"] = others
    return keys


def _types(node):
    types = node.get("type", [])
    return [types] if isinstance(types, str) else types


def _value(node):
    if "x-unit" in node:
        quantity = describe_quantity(node["x-unit"]).split(" is needed")[0]
        return f"{quantity} [{node['x-unit']}]"
    if "enum" in node:
        return " or ".join(code(_yaml(choice)) for choice in node["enum"] if choice is not None)
    words = [_TYPES[name] for name in _types(node) if name in _TYPES]
    if "array" in _types(node) and "items" in node and "object" not in _types(node):
        words[words.index("list")] = f"list of {_plural(node['items'])}"
    if node.get("pattern") == "^original$":
        words[words.index("text")] = "`original`"
    return " or ".join(words)


def _plural(items):
    if "x-unit" in items:
        return f"quantities [{items['x-unit']}]"
    return {"number": "numbers", "string": "names"}.get(items.get("type"), "values")


def _limits(node):
    unit = f" {node['x-unit']}" if "x-unit" in node else ""
    for key, words in _LIMITS.items():
        if key in node and not (key == "minItems" and node[key] == 1):
            yield f"{words} {node[key]:g}{' entries' if 'Items' in key else unit}"


def _default(node):
    if "default" not in node or node["default"] == {}:
        return ""
    return "no default" if node["default"] is None else f"default {code(_yaml(node['default']))}"


def _yaml(value):
    if isinstance(value, str):
        return value or '""'
    return json.dumps(value)


def _conditions(node):
    for path, allowed in node.get("x-used-with", {}).items():
        if isinstance(allowed, list):
            yield f"It has an effect only with `{path}` {' or '.join(code(_yaml(value)) for value in allowed)}."
        else:
            reason = allowed.get("x-error") or next(iter(_messages(allowed)))
            yield sentence(reason.partition(";")[0])


def _rules(node):
    """Return the messages of the rules between the keys of a group, each once."""
    messages = []
    for word in ("allOf", "anyOf", "oneOf", "if", "then", "else"):
        messages += _messages(node.get(word, []))
    if "x-error" in node and "oneOf" in node:
        messages.append(node["x-error"])
    return list(dict.fromkeys(sentence(message) for message in messages))


def _messages(node):
    """Yield the messages (x-error) of a node and of all nodes inside it."""
    if isinstance(node, dict):
        if isinstance(node.get("x-error"), str):
            yield node["x-error"]
        for value in node.values():
            yield from _messages(value)
    elif isinstance(node, list):
        for value in node:
            yield from _messages(value)


def _presets(path, name):
    presets = read_presets(path, name)
    keys = dict.fromkeys(key for preset in presets.values() for key in _flat(preset))
    rows = [[code(key), *(_flat(preset).get(key, "") for preset in presets.values())] for key in keys]
    return table(["key", *(code(preset) for preset in presets)], rows)


def _flat(group, above=""):
    flat = {}
    for key, value in group.items():
        flat |= _flat(value, f"{above}{key}.") if isinstance(value, dict) else {f"{above}{key}": value}
    return flat

"""Keys that are given but have no effect, such as a flatness where grains are drawn at random.

`x-used-with` of a key in a schema names the settings that the key needs: a path from the root of the specification, and
the list of values, or the JSON Schema, that the setting there must have. The path may name a group.
"""

import jsonschema


def why_unused(path, resolved, schema):
    """Return (key, reason) where the key at the dotted `path`, or a group it is in, has no effect; else None.

    resolved: the specification in SI; schema: its schema, read. What the specification does not have is no condition.
    """
    keys, node = [], schema
    for key in path.split("."):
        node = node.get("properties", {}).get(key)
        if node is None:
            return None
        keys.append(key)
        for setting, allowed in node.get("x-used-with", {}).items():
            there, value = _look_up(resolved, setting)
            if there and not _is_allowed(value, allowed):
                return ".".join(keys), _reason(setting, value, allowed)
    return None


def needed_settings(path, schema):
    """Return the settings (dotted paths) that the key at the dotted `path`, or a group it is in, needs."""
    settings, node = set(), schema
    for key in path.split("."):
        node = node.get("properties", {}).get(key, {})
        settings |= set(node.get("x-used-with", {}))
    return settings


def is_shared(path, schema):
    """Whether studies may have the key at the dotted `path` in common, used by some of them only (x-shared)."""
    for key in path.split("."):
        schema = schema.get("properties", {}).get(key, {})
        if schema.get("x-shared", False):
            return True
    return False


def given_keys(raw, above=""):
    """Dotted paths of all values in the nested dict `raw`; null is none, for it stands for what is not given."""
    for key, value in raw.items():
        if isinstance(value, dict):
            yield from given_keys(value, f"{above}{key}.")
        elif value is not None:
            yield f"{above}{key}"


def check_used(raw, resolved, schema, where=""):
    """ValueError at the first key of `raw`, as it was given, that has no effect in `resolved`.

    A specification that gives every key there is was written by a program (`express`) and tells no choices: it passes.
    """
    if _gives_everything(raw, schema):
        return
    for path in given_keys(raw):
        unused = why_unused(path, resolved, schema)
        if unused:
            key, reason = unused
            raise ValueError(f"{where}.{key}: {reason}" if where else f"{key}: {reason}")


def _gives_everything(raw, schema):
    def gives(key, sub):
        is_group = sub.get("type") == "object"
        return key in raw and (not is_group or (isinstance(raw[key], dict) and _gives_everything(raw[key], sub)))

    return all(gives(key, sub) for key, sub in schema.get("properties", {}).items())


def _look_up(resolved, path):
    for key in path.split("."):
        if not isinstance(resolved, dict) or key not in resolved:
            return False, None
        resolved = resolved[key]
    return True, resolved


def _is_allowed(value, allowed):
    if isinstance(allowed, list):
        return value in allowed
    return jsonschema.Draft202012Validator(allowed).is_valid(value)


def _reason(setting, value, allowed):
    if not isinstance(allowed, list):
        return allowed["x-error"]
    *others, last = allowed
    words = f"{', '.join(others)} or {last}" if others else last
    return f"it has no effect while {setting} is {value}; leave it out, or set {setting} to {words}"

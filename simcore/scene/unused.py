"""Finds keys that are given but have no effect, such as a flatness if grains are drawn at random.

`x-used-with` of a key in a schema lists the settings that the key needs: for each, its path from the root of the
specification, and the list of values, or the JSON Schema, that it must have. The path may be that of a group.
"""

import jsonschema


def why_unused(path, resolved, schema):
    """Return (key, reason) if the key at the dotted `path`, or a group that contains it, has no effect, else None.

    resolved: the specification in SI; schema: its schema as a dict. Settings that the specification does not have are
    not a condition.
    """
    keys, node = [], schema
    for key in path.split("."):
        node = node.get("properties", {}).get(key)
        if node is None:
            return None
        keys.append(key)
        for setting, allowed in node.get("x-used-with", {}).items():
            exists, value = _look_up(resolved, setting)
            if exists and not _is_allowed(value, allowed):
                return ".".join(keys), _reason(setting, value, allowed)
    return None


def needed_settings(path, schema):
    """Return the settings (dotted paths) that the key at the dotted `path`, or a group that contains it, needs."""
    settings, node = set(), schema
    for key in path.split("."):
        node = node.get("properties", {}).get(key, {})
        settings |= set(node.get("x-used-with", {}))
    return settings


def is_shared(path, schema):
    """Return whether studies may share the key at the dotted `path` even if only some of them use it (x-shared)."""
    for key in path.split("."):
        schema = schema.get("properties", {}).get(key, {})
        if schema.get("x-shared", False):
            return True
    return False


def given_keys(raw, above=""):
    """Yield the dotted paths of all values in the nested dict `raw` but null, which means that a key is not given."""
    for key, value in raw.items():
        if isinstance(value, dict):
            yield from given_keys(value, f"{above}{key}.")
        elif value is not None:
            yield f"{above}{key}"


def check_used(raw, resolved, schema, where=""):
    """Raise ValueError at the first key of `raw`, the specification as given, that has no effect in `resolved`.

    A specification with every key of the schema is accepted: a program wrote it (`express`), so its keys are not
    choices of a user.
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
    choices = f"{', '.join(others)} or {last}" if others else last
    return f"it has no effect while {setting} is {value}; leave it out, or set {setting} to {choices}"

"""Studies: tables of packings. A study is the cartesian product of its varied settings, over its fixed settings."""

import copy
import hashlib
import itertools
import json
import re

import pandas as pd
import yaml

from simcore.grains.sources import check_source, known_names, needs_grains, set_name
from simcore.grains.text_lists import join_first
from simcore.reference.columns import COLUMN_OF_KEY
from simcore.scene.identity import deciding_but_seed
from simcore.scene.sizes import check_top_class
from simcore.scene.specification import check_values, express, read_schema, resolve, with_presets
from simcore.scene.unused import given_keys, is_shared, needed_settings, why_unused


def expand(config):
    """Return all packings of all studies of a resolved campaign, as a DataFrame with one row per packing.

    Columns:
    study
    packing: its name within the study
    grains: the resolved group `grains` for its shapes; None if they need no grain
    grain_set: the set of these grains, such as "synthetic_1b2c3d4e/faces_100", or empty
    form: the rank of its grain in the spread of forms, or 0
    fault: the reason if it cannot be packed, otherwise empty. Either its grain does not exist, or an earlier packing in
    the same table has its settings. It is an error only if the packing is requested
    specification: resolved, with the grain set as its source
    row: dict of packing (its name), varied (the varied settings by column), and is_base (whether the packing is what
    the fixed settings alone would give, for any seed)

    The campaign's packing and grains, the study's fixed settings and its varied settings are merged in this order, each
    with all settings that a choice such as `accuracy` in it implies. ValueError names the study and the wrong key. A
    key is also wrong if none of its packings uses it, unless it is a key that studies have in common.
    """
    check_source(config["grains"])
    if "grains" in config["packing"]:
        raise ValueError("packing.grains: move it one level up, to `grains`, or to the `fixes` of a study")
    check_values(config["packing"], where="packing")  # also those that every study overrides
    tables = [expand_study(name, study, config) for name, study in config["studies"].items() if study]
    if not tables:
        raise ValueError("studies: there is no study; a campaign needs at least one")
    table = pd.concat(tables, ignore_index=True)
    _check_used({key: list(table.specification) for key in given_keys(config["packing"])}, "packing")
    return table


def expand_study(name, study, config):
    """Return the rows of one study of `config`; see `expand`."""
    where, folder = f"studies.{name}", config["pathvars"]["results"]
    axes = [_axis(key, values, f"{where}.varies") for key, values in study["varies"].items() if values is not None]
    check_values(study["fixes"], where=f"{where}.fixes")
    for axis in axes:
        for part in axis:
            check_values(_lay_over({}, (part,), where), where=f"{where}.varies")
    axes += [_forms(study["forms"])] if study["forms"] else []
    common = express({"grains": config["grains"]}, "config")
    fixed = merge(with_presets(config["packing"]), common, with_presets(study["fixes"]))
    base = _base(fixed)
    # All keys that any group of an axis sets, since a group may differ from another only by a key that it does not set.
    columns = [key for axis in axes for part in axis if not part.get("is_form") for key in part["settings"]]
    columns = list(dict.fromkeys(columns))
    _check_apart(axes, f"{where}.varies")
    rows, resolved, varied = [], [], {}
    for combination in itertools.product(*axes):
        packing = "-".join(part["label"] for part in combination if part["label"]) or name
        spec = resolve({**_lay_over(fixed, combination, where), "name": packing}, where=where)
        if spec["sizes"]["own"]:
            raise ValueError(
                f"{where}, packing {packing}: sizes.own is only for single packings (`scree pack`), as "
                "grains are not read when a campaign is planned. Give a case, bounds or beta."
            )
        check_top_class(spec, f"{where}, packing {packing}")
        form = next((part["form"] for part in combination if "form" in part), 0)
        grains, grain_set = _grain_set(spec, where)
        rows.append(
            {
                "study": name,
                "packing": packing,
                "grains": grains,
                "grain_set": grain_set,
                "form": form,
                "fault": _fault(grains, spec, form, where),
                "specification": _with_grain_set(spec, f"{folder}/grains/{grain_set}.nc") if grain_set else spec,
                "row": {
                    "packing": packing,
                    "varied": {_column(key): _value(spec, key) for key in columns},
                    "is_base": deciding_but_seed(spec) == base,
                },
            }
        )
        resolved.append(spec)
        for part in combination:
            for key, value in part["settings"].items():
                at = f"{where}.forms" if part.get("is_form") else f"{where}.varies"
                varied.setdefault((key, at), []).extend([] if value is None else [spec])
    table = pd.DataFrame(rows)
    repeated = table.packing[table.packing.duplicated()]
    if len(repeated):
        raise ValueError(f"{where}.varies: the packing {repeated.iloc[0]} is listed twice; remove one")
    table = _without(table, study["leaves_out"], where)
    _note_equal(table, where)
    # Studies that are not part of `all` are defined in every campaign, so they may have keys that its settings exclude.
    campaign_keys = set() if study["in_all"] else set(given_keys(config["packing"]))
    _check_used({key: resolved for key in given_keys(study["fixes"])}, f"{where}.fixes", campaign_keys=campaign_keys)
    for (key, at), given in varied.items():
        _check_used({key: given}, at, may_share=False, campaign_keys=campaign_keys)
    return table


def study_title(name, study):
    """Return the title of a study, or its name without one, and the packings that it leaves out."""
    title, left_out = study["title"] or name, study["leaves_out"]
    return f"{title} (without {join_first(left_out, 3)})" if left_out else title


def _without(table, names, where):
    """Return the rows of a study except those with these names of packings."""
    packings = list(table.packing)
    for name in names:
        if name not in packings:
            raise ValueError(
                f"{where}.leaves_out: there is no packing {name!r}; the packings are {join_first(packings, 10)}"
            )
    table = table[~table.packing.isin(names)].reset_index(drop=True)
    if table.empty:
        raise ValueError(
            f"{where}.leaves_out: these are all packings of the study; leave out fewer, or set {where} to null"
        )
    return table


def _check_apart(axes, where):
    """Raise ValueError if two axes set the same key, since one would replace the values of the other."""
    seen = set()
    for axis in axes:
        keys = {key for part in axis for key in part["settings"]}
        if shared := sorted(seen & keys):
            raise ValueError(f"{where}: two lists set {shared[0]}; set it in one of them, or make two studies")
        seen |= keys


def _note_equal(table, where):
    """Give a packing a fault if it differs from an earlier one of its study only in its name: both would count."""
    names = {}
    for row in table.itertuples():
        key = json.dumps({**row.specification, "name": ""}, sort_keys=True), row.form
        if key in names and not row.fault:
            table.loc[row.Index, "fault"] = (
                f"{where}: the packings {names[key]} and {row.packing} have the same settings; remove one of them"
            )
        names.setdefault(key, row.packing)


def _lay_over(fixed, combination, where):
    """Return the unresolved settings of one packing: those of the axes laid over the `fixed` ones."""
    settings = {key: value for part in combination for key, value in part["settings"].items()}
    raw = merge(fixed, with_presets({key: value for key, value in settings.items() if "." not in key}))
    for key, value in settings.items():
        _put(raw, key, value, where)
    return raw


def _check_used(specifications, where, may_share=True, campaign_keys=frozenset()):
    """Raise ValueError at the first key that has no effect in any of its specifications.

    specifications: dict from dotted key to the resolved specifications for which it is given. may_share: whether keys
    that studies have in common are accepted. campaign_keys: settings of the campaign; a key that needs one of them is
    accepted.
    """
    schema = read_schema("packing")
    for path, given in specifications.items():
        if (may_share and is_shared(path, schema)) or needed_settings(path, schema) & campaign_keys:
            continue
        unused = None
        for specification in given:
            unused = why_unused(path, specification, schema)
            if unused is None:
                break
        if unused:
            key, reason = unused
            raise ValueError(f"{where}: {reason}" if where.endswith(".forms") else f"{where}.{key}: {reason}")


def _base(raw):
    """Return the deciding settings without variation; None if the settings are not a complete specification."""
    try:
        return deciding_but_seed(resolve(raw))
    except ValueError:
        return None


def merge(*groups):
    """Return one nested dict in which later groups override earlier ones; the groups are not changed."""
    merged = {}
    for group in groups:
        for key, value in group.items():
            nested = isinstance(value, dict) and isinstance(merged.get(key), dict)
            merged[key] = merge(merged[key], value) if nested else copy.deepcopy(value)
    return merged


def _axis(key, values, where):
    """Return one axis of the product, a list of {settings, label}; a value sets `key`, or is a group of settings."""
    if not isinstance(values, list):
        raise ValueError(f"{where}.{key}: {values!r} is not a list; give a list of the values to vary over")
    if not values:
        raise ValueError(f"{where}.{key}: the list is empty; give the values to vary over, or null to remove the key")
    if key == "name":
        raise ValueError(f"{where}.name: packings are named by what varies; leave it out")
    name = "" if key == "sizes.case" else "_".join(key.split(".")[1:] or [key])
    parts = []
    for value in values:
        if isinstance(value, dict):
            settings = {_whole_key(key, inner): setting for inner, setting in _flatten(value)}
            words = settings.values()
        else:
            settings, words = {key: value}, [name, value]
        parts.append({"settings": settings, "label": "_".join(filter(None, map(_slug, words)))})
    return parts


def _whole_key(axis, key):
    """Return the key of a setting in a group: below the key of its axis if the schema has it there."""
    node = read_schema("packing")
    for part in (*axis.split("."), *key.split(".")):
        node = node.get("properties", {}).get(part)
        if node is None:
            return key
    return f"{axis}.{key}"


def _flatten(group, prefix=""):
    for key, value in group.items():
        if isinstance(value, dict):
            yield from _flatten(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _forms(forms):
    """Return the axis of single forms: ranks in the spread over the Zingg diagram, or named grains."""
    if isinstance(forms, list):
        return [
            {
                "settings": {"shapes.choice": "one", "shapes.grain": name},
                "label": label,
                "is_form": True,
            }
            for name, label in zip(forms, _grain_labels(forms), strict=True)
        ]
    # The name is set when the grains are read (choose_form); until then this text replaces it.
    return [
        {
            "settings": {"shapes.choice": "one", "shapes.grain": f"form {rank} of the spread"},
            "label": f"form{rank:02d}",
            "form": rank,
            "is_form": True,
        }
        for rank in range(1, forms["spread"] + 1)
    ]


def choose_form(specification, form, names):
    """Return the specification with grain names[form - 1]; form 0 leaves it unchanged. names (n,): in rank order."""
    if form == 0:
        return specification
    if form > len(names):
        raise ValueError(
            f"packing {specification['name']}: there is no form {form} of a set of {len(names)} grains; "
            f"give forms.spread: {len(names)}, or less"
        )
    return {**specification, "shapes": {**specification["shapes"], "grain": names[form - 1]}}


def specification_text(specification, form, names):
    """Return the specification of a packing as YAML with units and the grain of rank `form`; see `choose_form`."""
    return yaml.safe_dump(express(choose_form(specification, form, names)), sort_keys=False, allow_unicode=True)


def _grain_labels(names):
    """Return the names of grains as parts of file names.

    If leaving out characters makes names equal or empty, these names have a digest (6 hex digits).
    """
    labels = [_slug(name) for name in names]
    digests = [hashlib.sha256(str(name).encode()).hexdigest()[:6] for name in names]
    return [
        f"{label}-{end}".lstrip("-") if label != name and (not label or labels.count(label) > 1) else label
        for name, label, end in zip(names, labels, digests, strict=True)
    ]


def _slug(value):
    """Return a value as part of a file name; a digest (8 hex digits) of a list of groups, whose text is too long."""
    if isinstance(value, list) and any(isinstance(item, dict) for item in value):
        return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:8]
    return re.sub(r"[^A-Za-z0-9_.+-]", "", str(value))


def _grain_set(spec, where):
    """Return the group `grains` of a specification and the name of its grain set; None and "" without grains."""
    grains = spec["grains"]
    if not needs_grains(spec["shapes"]):
        return None, ""
    try:
        check_source(grains)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    faces = "original" if spec["faces"] == "original" else f"faces_{spec['faces']}"
    return grains, f"{set_name(grains)}/{faces}"


def _fault(grains, spec, form, where):
    """Return why the grain of a packing does not exist, or "" if it does or if only reading the grains would tell."""
    if grains is None or spec["shapes"]["choice"] != "one":
        return ""
    try:
        names = known_names(grains)
    except ValueError as error:
        return f"{where}: {error}"
    if names is None:
        return ""
    if form > len(names):
        number = len(names)
        return f"{where}.forms.spread: there is no form {form} of a set of {number} grains; give {number}, or less"
    grain = spec["shapes"]["grain"]
    if form or grain in names:
        return ""
    return (
        f"{where}, packing {spec['name']}: shapes.grain: no grain is called {grain!r}; the {len(names)} grains are "
        f"{join_first(names, 10)}"
    )


def _with_grain_set(spec, path):
    # The set is already decimated, its grains are in metres, and the options of the reader have been applied.
    settled = {"source": path, "unit": None, "bodies": "one", "degree": None, "names": None}
    return {**spec, "grains": {**spec["grains"], **settled}, "faces": "original"}


def _column(key):
    """Return the column of a varied key: the one in COLUMN_OF_KEY, or the last part of the key."""
    return COLUMN_OF_KEY.get(key, key.split(".")[-1])


def _put(raw, path, value, where):
    *parents, last = path.split(".")
    for key in parents:
        raw = raw.setdefault(key, {})
        if not isinstance(raw, dict):
            raise ValueError(f"{where}.varies: '{path}' is not possible, since '{key}' has no keys below it")
    raw[last] = value


def _value(spec, path):
    value = _get(spec, path)
    if not isinstance(value, list):
        return value
    return " ".join(value) if all(isinstance(item, str) for item in value) else json.dumps(value)


def _get(spec, path):
    for key in path.split("."):
        spec = spec.get(key) if isinstance(spec, dict) else None
    return spec

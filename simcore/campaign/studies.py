"""Studies: tables of packings. A study is the cartesian product of what it varies over what it fixes."""

import copy
import itertools
import re

import pandas as pd

from simcore.grains.sources import check_source, needs_grains
from simcore.scene.sizes import check_top_class
from simcore.scene.specification import resolve, with_presets

# Columns of what a study varies, with their units; others have the last part of their key as their name.
_COLUMNS = {
    "sizes.case": "case",
    "domain.width": "width_m",
    "domain.height": "height_m",
    "amount.mass": "mass_kg",
    "amount.grains": "grains_asked",
    "shaking.duration": "shaking_s",
    "shapes.kind": "shape_kind",
    "shapes.flatness.mean": "mean_FL",
    "shapes.flatness.std": "std_FL",
    "shapes.elongation.mean": "mean_EL",
    "shapes.elongation.std": "std_EL",
    "numerics.contact_time": "contact_time_s",
}


def expand(config):
    """All packings of all studies of a resolved campaign, as a DataFrame with one row a packing.

    Columns: study; packing, its name within the study; grain_set, "original" or "faces_100", empty where the shapes
    need no grain; form, the rank of its grain in the spread of forms, or 0; specification, resolved, with that grain
    set as its source; row, a dict of its name, of what the study varies, by column, and of is_base: whether it is what
    the study's fixed settings alone would give, for any seed. The campaign's packing, the study's fixed settings and
    what it varies lie over each other in this order, each with all that a choice such as `accuracy` in it stands for.
    ValueError names the study and the key at fault.
    """
    check_source(config["grains"])
    tables = [expand_study(name, study, config) for name, study in config["studies"].items() if study]
    if not tables:
        raise ValueError("studies: none is left; a campaign needs at least one")
    return pd.concat(tables, ignore_index=True)


def expand_study(name, study, config):
    """The rows of one study of `config`; see `expand`."""
    where, folder = f"studies.{name}", config["pathvars"]["results"]
    axes = [_axis(key, values, f"{where}.varies") for key, values in study["varies"].items() if values]
    axes += [_forms(study["forms"], config["grains"], where)] if study["forms"] else []
    fixed = merge(with_presets(config["packing"]), with_presets(study["fixes"]), {"grains": config["grains"]})
    base = _base(fixed)
    # All that any group of an axis sets: groups that leave a key as it was would else be told apart by nothing.
    columns = [key for axis in axes for part in axis if not part.get("is_form") for key in part["settings"]]
    columns = list(dict.fromkeys(columns))
    rows = []
    for combination in itertools.product(*axes):
        settings = {key: value for part in combination for key, value in part["settings"].items()}
        raw = merge(fixed, with_presets({key: value for key, value in settings.items() if "." not in key}))
        for key, value in settings.items():
            _put(raw, key, value, where)
        packing = "-".join(part["label"] for part in combination if part["label"]) or name
        spec = resolve({**raw, "name": packing}, where=where)
        if spec["sizes"]["own"]:
            raise ValueError(
                f"{where}, packing {packing}: sizes.own is for single packings (`python -m simcore pack`), as grains "
                "are not read when a campaign is planned; give a case, bounds or beta"
            )
        check_top_class(spec, f"{where}, packing {packing}")
        grain_set = _grain_set(spec)
        rows.append(
            {
                "study": name,
                "packing": packing,
                "grain_set": grain_set,
                "form": next((part["form"] for part in combination if "form" in part), 0),
                "specification": _with_grain_set(spec, f"{folder}/grains/{grain_set}.nc") if grain_set else spec,
                "row": {
                    "packing": packing,
                    "varied": {_column(key): _get(spec, key) for key in columns},
                    "is_base": _but_for_seed(spec) == base,
                },
            }
        )
    table = pd.DataFrame(rows)
    twice = table.packing[table.packing.duplicated()]
    if len(twice):
        raise ValueError(f"{where}.varies: the packing {twice.iloc[0]} stands there twice")
    return table


def _base(raw):
    """What the settings give without anything varied; None where they are not a whole specification."""
    try:
        return _but_for_seed(resolve(raw))
    except ValueError:
        return None


def _but_for_seed(spec):
    return {key: value for key, value in spec.items() if key not in ("name", "seed")}


def merge(*groups):
    """One dict of all given nested dicts, later ones laid over earlier ones; none is changed."""
    merged = {}
    for group in groups:
        for key, value in group.items():
            both = isinstance(value, dict) and isinstance(merged.get(key), dict)
            merged[key] = merge(merged[key], value) if both else copy.deepcopy(value)
    return merged


def _axis(key, values, where):
    """One axis of the product, a list of {settings, label}; a value sets `key`, or is a group of settings."""
    if not isinstance(values, list):
        raise ValueError(f"{where}.{key}: {values!r} is wrong; a list of what it varies over is needed")
    name = "" if key == "sizes.case" else "_".join(key.split(".")[1:] or [key])
    parts = []
    for value in values:
        if isinstance(value, dict):
            settings = dict(_flatten(value))
            words = settings.values()
        else:
            settings, words = {key: value}, [name, value]
        parts.append({"settings": settings, "label": "_".join(filter(None, map(_slug, words)))})
    return parts


def _flatten(group, above=""):
    for key, value in group.items():
        if isinstance(value, dict):
            yield from _flatten(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _forms(forms, grains, where):
    """The axis of single forms: ranks in the spread over the Zingg diagram, or named grains."""
    if isinstance(forms, list):
        return [
            {
                "settings": {"shapes.choice": "one", "shapes.grain": name},
                "label": _slug(name),
                "is_form": True,
            }
            for name in forms
        ]
    number = forms["spread"]
    if grains["source"] == "synthetic" and number > grains["number"]:
        raise ValueError(f"{where}.forms.spread: {number} forms of a set of {grains['number']} grains")
    # The name follows when the grains are read (choose_form); until then the text stands for it.
    return [
        {
            "settings": {"shapes.choice": "one", "shapes.grain": f"form {rank} of the spread"},
            "label": f"form{rank:02d}",
            "form": rank,
            "is_form": True,
        }
        for rank in range(1, number + 1)
    ]


def _slug(value):
    return re.sub(r"[^A-Za-z0-9_.+-]", "", str(value))


def _grain_set(spec):
    if not needs_grains(spec["shapes"]):
        return ""
    return "original" if spec["faces"] == "original" else f"faces_{spec['faces']}"


def _with_grain_set(spec, path):
    # The set is decimated already, its grains are in metres and each is one body.
    return {**spec, "grains": {**spec["grains"], "source": path, "unit": None, "bodies": "one"}, "faces": "original"}


def _column(key):
    return _COLUMNS.get(key, key.split(".")[-1])


def _put(raw, path, value, where):
    *parents, last = path.split(".")
    for key in parents:
        raw = raw.setdefault(key, {})
        if not isinstance(raw, dict):
            raise ValueError(f"{where}.varies: '{path}' goes through '{key}', which holds no keys")
    raw[last] = value


def _get(spec, path):
    for key in path.split("."):
        spec = spec.get(key) if isinstance(spec, dict) else None
    return spec

"""Defines when two packings are the same, by three relations between resolved specifications.

same_bits      the same bits of positions and contacts, with any threads and ranks: they share checkpoints
same_result    the same porosity, of packings of one name: a committed row of one is a row of the other
same_but_seed  the same bits, but for different random numbers: their scatter gives a standard error over seeds
"""

import hashlib
import json

from simcore.grains.sources import source_name

# Keys that do not change a bit of a run: its name, the interval of its reports, a preset whose settings are in the
# other keys once it is resolved, a key that only allows a run to start, and the maximum time of damping, after which a
# run fails, so that it resumes from its checkpoint once this time is longer.
WITHOUT_EFFECT = (
    ("name",),
    ("accuracy",),
    ("numerics", "progress_interval"),
    ("sizes", "allow_few_top_grains"),
    ("damping", "max_time"),
)
# Keys that do not change the porosity of a committed row: the name; the grain, because rows of a spread are identified
# by its rank; the interval of reports; the maximum time of damping.
WITHOUT_RESULT = (("name",), ("shapes", "grain"), ("numerics", "progress_interval"), ("damping", "max_time"))
BY_CHANCE = (*WITHOUT_EFFECT, ("seed",))
# Keys that were added after rows had been committed, with the value that corresponds to earlier packings. A
# specification with this value is the same as one without the key.
ADDED = {
    ("grains", "bodies"): "one",
    ("grains", "degree"): None,
    ("grains", "names"): None,
    ("sizes", "own"): False,
    ("sizes", "draw"): "random",
    ("shapes", "by_size"): None,
    ("generation", "solid_fraction"): 0.2,
    ("generation", "stretch_x"): 1.0,
    ("generation", "stretch_z"): 1.0,
}
# Keys and values that were renamed after rows had been committed. Digests use the former names, as those rows do.
FORMER_KEYS = {("numerics", "polyhedron_contact"): "contact_region"}
FORMER_VALUES = {
    ("accuracy",): {"r22": "paper"},
    ("generation", "fill"): {"r22": "study"},
    ("shapes", "kind"): {"polyhedron": "mesh"},
}


def same_bits(first: dict, second: dict) -> bool:
    """Return whether two resolved specifications give the same bits, with the same grains and the same code."""
    return deciding_bits(first) == deciding_bits(second)


def same_result(first: dict, second: dict) -> bool:
    """Return whether two resolved specifications of one packing name give the same porosity.

    The folder of their grains does not matter.
    """
    return deciding_result(first) == deciding_result(second)


def same_but_seed(first: dict, second: dict) -> bool:
    """Return whether two resolved specifications differ only in their seed and in what changes no bit."""
    return deciding_but_seed(first) == deciding_but_seed(second)


def deciding_bits(specification: dict) -> dict:
    """Return the part of a resolved specification on which the bits depend."""
    return without(specification, WITHOUT_EFFECT)


def deciding_result(specification: dict) -> dict:
    """Return the part of a resolved specification on which its porosity depends, in the types that JSON has."""
    part = _without_added(with_former_names(without(specification, WITHOUT_RESULT)))
    if "grains" in part:
        part = {**part, "grains": {**part["grains"], "source": source_name(part["grains"]["source"])}}
    return json.loads(json.dumps(part))


def _without_added(specification):
    """Return a specification without the keys of ADDED that have the value by which they change nothing."""
    for path, value in ADDED.items():
        if _get(specification, path) == value:
            specification = without(specification, (path,))
    return specification


def deciding_but_seed(specification: dict) -> dict:
    """Return the part of a resolved specification that packings of one scene share, of any version of this program."""
    return _without_added(with_former_names(without(specification, BY_CHANCE)))


def shown_but_seed(specification: dict) -> dict:
    """Return deciding_but_seed with the present names of keys and values, to be shown to people."""
    return with_present_names(deciding_but_seed(specification))


def result_digest(specification: dict) -> str:
    """Return the digest (12 hex digits) of deciding_result; it identifies committed rows."""
    text = json.dumps(deciding_result(specification), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def differing_keys(first: dict, second: dict, path: str = "") -> list[str]:
    """Return the names, such as "sizes.case", of the keys in which two nested specifications differ, sorted."""
    names = []
    for key in sorted({*first, *second}):
        a, b = first.get(key), second.get(key)
        if isinstance(a, dict) and isinstance(b, dict):
            names += differing_keys(a, b, f"{path}{key}.")
        elif a != b:
            names.append(f"{path}{key}")
    return names


def without(group: dict, paths, above: tuple = ()) -> dict:
    """Return a nested dict without the keys at these paths, tuples such as ("sizes", "case")."""
    return {
        key: without(value, paths, (*above, key)) if isinstance(value, dict) else value
        for key, value in group.items()
        if (*above, key) not in paths
    }


def with_former_names(group, above=()):
    """Return the nested dict with the former names of renamed keys and values; former names remain unchanged."""
    renamed = {}
    for key, value in group.items():
        path = (*above, key)
        if isinstance(value, dict):
            value = with_former_names(value, path)
        elif path in FORMER_VALUES:
            value = FORMER_VALUES[path].get(value, value)
        renamed[FORMER_KEYS.get(path, key)] = value
    return renamed


def with_present_names(group, above=()):
    """Return a nested dict from with_former_names with the present names of renamed keys and values."""
    present = {}
    for key, value in group.items():
        key = next((path[-1] for path, former in FORMER_KEYS.items() if (*path[:-1], former) == (*above, key)), key)
        path = (*above, key)
        if isinstance(value, dict):
            value = with_present_names(value, path)
        elif path in FORMER_VALUES:
            value = {former: name for name, former in FORMER_VALUES[path].items()}.get(value, value)
        present[key] = value
    return present


def _get(group, path):
    for key in path:
        group = group.get(key) if isinstance(group, dict) else None
    return group

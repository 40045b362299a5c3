"""When two packings are the same: relations between resolved specifications, in one place.

Three relations, from the strictest to the loosest:

    same_bits      the same bits of positions and contacts, on any threads and ranks: checkpoints are shared
    same_result    the same porosity, of packings of one name in one study: a committed row is of this packing
    same_but_seed  packings of one scene that differ by chance alone: their scatter is an error over seeds
"""

import hashlib
import json

from simcore.grains.sources import source_name

# Keys that change no bit of a run: its name, how often it reports, a choice whose settings are in the other keys once
# it is resolved, and what only allows a run to start.
WITHOUT_EFFECT = (
    ("name",),
    ("accuracy",),
    ("numerics", "progress_interval"),
    ("sizes", "allow_few_top_grains"),
)
# Keys that change no porosity of a packing of one name: the name of the grain that has a rank in a spread of forms (the
# packing is named by the rank), and limits that a bed at rest did not reach.
WITHOUT_RESULT = (("name",), ("shapes", "grain"), ("numerics", "progress_interval"), ("damping", "max_time"))
BY_CHANCE = (("name",), ("seed",))
# Keys that were added after rows had been committed, with the value that packings had before. A specification with this
# value is the one without the key.
ADDED = {("grains", "bodies"): "one", ("sizes", "own"): False, ("sizes", "draw"): "random"}
# Keys and values that were renamed after rows had been committed: the digests of those rows are of the former names.
FORMER_KEYS = {("numerics", "polyhedron_contact"): "contact_region"}
FORMER_VALUES = {
    ("accuracy",): {"r22": "paper"},
    ("generation", "fill"): {"r22": "study"},
    ("shapes", "kind"): {"polyhedron": "mesh"},
}


def same_bits(first: dict, second: dict) -> bool:
    """Whether two resolved specifications give the same bits, of the same grains by the same code."""
    return deciding_bits(first) == deciding_bits(second)


def same_result(first: dict, second: dict) -> bool:
    """Whether two resolved specifications of one packing name give the same porosity, wherever grains are stored."""
    return deciding_result(first) == deciding_result(second)


def same_but_seed(first: dict, second: dict) -> bool:
    """Whether two resolved specifications differ in nothing but seed and name."""
    return deciding_but_seed(first) == deciding_but_seed(second)


def deciding_bits(specification: dict) -> dict:
    """The part of a resolved specification on which the bits depend."""
    return without(specification, WITHOUT_EFFECT)


def deciding_result(specification: dict) -> dict:
    """The part of a resolved specification on which its porosity depends, as JSON stores it."""
    part = with_former_names(without(specification, WITHOUT_RESULT))
    for path, value in ADDED.items():
        if _get(part, path) == value:
            part = without(part, (path,))
    if "grains" in part:
        part = {**part, "grains": {**part["grains"], "source": source_name(part["grains"]["source"])}}
    return json.loads(json.dumps(part))


def deciding_but_seed(specification: dict) -> dict:
    """The part of a resolved specification that packings of one scene share."""
    return without(specification, BY_CHANCE)


def result_digest(specification: dict) -> str:
    """Digest (12 hex digits) of what decides the porosity; committed rows are recognised by it."""
    text = json.dumps(deciding_result(specification), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def differing_keys(first: dict, second: dict, path: str = "") -> list[str]:
    """Names such as "sizes.case" of the keys in which two nested specifications differ, in alphabetical order."""
    names = []
    for key in sorted({*first, *second}):
        a, b = first.get(key), second.get(key)
        if isinstance(a, dict) and isinstance(b, dict):
            names += differing_keys(a, b, f"{path}{key}.")
        elif a != b:
            names.append(f"{path}{key}")
    return names


def without(group: dict, paths, above: tuple = ()) -> dict:
    """A nested dict without the keys at these paths, tuples such as ("sizes", "case")."""
    return {
        key: without(value, paths, (*above, key)) if isinstance(value, dict) else value
        for key, value in group.items()
        if (*above, key) not in paths
    }


def with_former_names(group, above=()):
    """The nested dict under the names that it had before they were changed; one under former names stays as it is."""
    renamed = {}
    for key, value in group.items():
        path = (*above, key)
        if isinstance(value, dict):
            value = with_former_names(value, path)
        elif path in FORMER_VALUES:
            value = FORMER_VALUES[path].get(value, value)
        renamed[FORMER_KEYS.get(path, key)] = value
    return renamed


def _get(group, path):
    for key in path:
        group = group.get(key) if isinstance(group, dict) else None
    return group

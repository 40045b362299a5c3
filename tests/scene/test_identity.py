"""When two packings are the same: each relation ignores some keys and depends on all others."""

import copy

import pytest

from simcore.scene.identity import (
    ADDED,
    deciding_but_seed,
    differing_keys,
    result_digest,
    same_bits,
    same_but_seed,
    same_result,
    shown_but_seed,
    with_former_names,
)
from simcore.scene.specification import resolve

SPECIFICATION = resolve(
    {
        "name": "one",
        "domain": {"width": "40 mm", "height": "0.3 m"},
        "sizes": {"case": "U1"},
        "amount": {"grains": 100},
        "shapes": {"choice": "one", "grain": "G02"},
    }
)


def changed(path, value):
    """Return SPECIFICATION with one key changed, such as "damping.max_time"."""
    other = copy.deepcopy(SPECIFICATION)
    *groups, key = path.split(".")
    group = other
    for name in groups:
        group = group[name]
    assert group[key] != value
    group[key] = value
    return other


@pytest.mark.parametrize(
    "path, value, relations",
    [
        ("name", "other", {same_bits, same_result, same_but_seed}),
        ("seed", 2, {same_but_seed}),
        ("accuracy", "standard", {same_bits, same_but_seed}),
        ("numerics.progress_interval", 1.0, {same_bits, same_result, same_but_seed}),
        ("damping.max_time", 99.0, {same_bits, same_result, same_but_seed}),
        ("shapes.grain", "G03", {same_result}),
        ("grains.source", "elsewhere/synthetic", {same_result}),
        ("sizes.allow_few_top_grains", True, {same_bits, same_but_seed}),
        ("material.friction", 0.3, set()),
        ("numerics.contact_time", 1.0, set()),
    ],
)
def test_each_relation_ignores_its_keys_and_no_other(path, value, relations):
    other = changed(path, value)
    assert {relation for relation in (same_bits, same_result, same_but_seed) if relation(SPECIFICATION, other)} == (
        relations
    )
    assert (result_digest(other) == result_digest(SPECIFICATION)) == (same_result in relations)


def test_keys_that_differ_are_named_with_their_groups():
    other = changed("material.friction", 0.3)
    other["seed"] = 7
    assert differing_keys(SPECIFICATION, other) == ["material.friction", "seed"]


def test_a_key_that_was_added_later_changes_no_digest_at_its_earlier_value():
    """Specifications of committed rows do not have this key."""
    assert ADDED
    for path, value in ADDED.items():
        *groups, key = path
        earlier = copy.deepcopy(SPECIFICATION)
        group = earlier
        for name in groups:
            group = group[name]
        group[key] = value
        without = copy.deepcopy(earlier)
        group = without
        for name in groups:
            group = group[name]
        del group[key]
        assert result_digest(earlier) == result_digest(without), path


@pytest.mark.parametrize(
    "path, present, former",
    [("accuracy", "r22", "paper"), ("generation.fill", "r22", "study"), ("shapes.kind", "polyhedron", "mesh")],
)
def test_a_renamed_choice_is_the_same_packing(path, present, former):
    *groups, key = path.split(".")
    new, old = copy.deepcopy(SPECIFICATION), copy.deepcopy(SPECIFICATION)
    for specification, value in ((new, present), (old, former)):
        group = specification[groups[0]] if groups else specification
        group[key] = value
    assert same_result(new, old) and result_digest(new) == result_digest(old)
    assert not same_result(new, changed("seed", 7))


def test_settings_are_shown_by_their_present_names():
    old = copy.deepcopy(SPECIFICATION)
    old["numerics"]["contact_region"] = old["numerics"].pop("polyhedron_contact")
    old["shapes"]["kind"] = "mesh"
    for specification in (old, SPECIFICATION):
        shown = shown_but_seed(specification)
        assert shown["numerics"]["polyhedron_contact"] == SPECIFICATION["numerics"]["polyhedron_contact"]
        assert shown["shapes"]["kind"] == "polyhedron" and "contact_region" not in shown["numerics"]
        assert with_former_names(shown) == deciding_but_seed(specification)


def test_a_renamed_key_is_the_same_packing():
    old = copy.deepcopy(SPECIFICATION)
    old["numerics"]["contact_region"] = old["numerics"].pop("polyhedron_contact")
    assert same_result(SPECIFICATION, old)
    old["numerics"]["contact_region"] = "point"
    assert not same_result(SPECIFICATION, old)


def test_a_packing_of_an_earlier_version_differs_in_the_seed_only():
    present, former = copy.deepcopy(SPECIFICATION), changed("seed", 2)
    for (*groups, key), value in ADDED.items():
        for specification in (present, former):
            group = specification
            for name in groups:
                group = group[name]
            group[key] = value
        del group[key]  # of the former one
    assert present["seed"] != former["seed"] and same_but_seed(present, former)

"""Lists in messages name the first items and count the others."""

from simcore.grains.text_lists import join_first


def test_the_first_items_and_the_number_of_others():
    assert join_first(["a", "b"], 2) == "a, b"
    assert join_first(["a", "b", "c", "d"], 2) == "a, b and 2 more"
    assert join_first(["a", "b", "c"], 2, "; ") == "a; b and 1 more"

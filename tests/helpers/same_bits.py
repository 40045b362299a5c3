"""Comparison of packings to the bit."""


def arrays_of(bodies, candidates):
    """Return all arrays of bodies, contacts and walls, a dict from "body.name", "contact.name" and "wall.name"."""
    return {
        f"{group}.{name}": array
        for group, fields in (("body", bodies), ("contact", candidates.contacts), ("wall", candidates.walls))
        for name, array in fields._asdict().items()
    }


def assert_same_bits(first, second):
    """Assert that two dicts of arrays have the same names, types, shapes and bits."""
    assert first.keys() == second.keys()
    for name, array in first.items():
        assert array.dtype == second[name].dtype and array.shape == second[name].shape, name
        assert array.tobytes() == second[name].tobytes(), name
        assert second[name].flags.c_contiguous, name

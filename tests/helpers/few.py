"""A few spheres in a small box: the smallest packing that has all phases, for tests that need some packing."""

from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

FEW = {
    "name": "few",
    "domain": {"width": "25 mm", "height": "0.2 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
    "amount": {"grains": 40},
    "shaking": {"duration": "0.1 s"},
    "numerics": {"contact_time": "1 ms"},
}


def few(**changes) -> dict:
    """FEW with some keys changed; of a group, the given keys of it."""
    specification = dict(FEW)
    for key, value in changes.items():
        specification[key] = {**specification.get(key, {}), **value} if isinstance(value, dict) else value
    return specification


def set_up_few(**changes):
    """Setup of `few`."""
    return set_up(resolve(few(**changes)), lambda group: [])

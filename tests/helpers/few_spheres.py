"""A few spheres in a small box: the smallest packing that has all phases, for tests that need some packing."""

from simcore.packing.process import pack
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

FEW_SPHERES = {
    "name": "few",
    "domain": {"width": "25 mm", "height": "0.2 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
    "amount": {"grains": 40},
    "shaking": {"duration": "0.1 s"},
    "numerics": {"contact_time": "1 ms"},
}


def specify_few_spheres(**changes) -> dict:
    """Return FEW_SPHERES with some keys changed; a dict changes only the given keys of its group."""
    specification = dict(FEW_SPHERES)
    for key, value in changes.items():
        specification[key] = {**specification.get(key, {}), **value} if isinstance(value, dict) else value
    return specification


def set_up_few_spheres(**changes):
    """Return the setup of `specify_few_spheres`."""
    return set_up(resolve(specify_few_spheres(**changes)), lambda group: [])


def pack_few_spheres(**changes):
    """Return the finished packing of `specify_few_spheres`."""
    setup = set_up_few_spheres(**changes)
    return pack(setup.scene, setup.bases, setup.draw)

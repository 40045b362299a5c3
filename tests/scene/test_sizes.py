"""Amounts: a mass of more grains than can be packed is refused before any of them is drawn."""

import pytest

from simcore.scene.setup import set_up
from simcore.scene.sizes import MAX_GRAINS
from simcore.scene.specification import read_schema, resolve


def specification(mass):
    sizes = {"bounds": ["1 mm", "2 mm"], "mass_fractions": [1.0]}
    domain = {"width": "100 m", "height": "1000 m"}
    return resolve({"domain": domain, "sizes": sizes, "amount": {"mass": mass}, "shapes": {"kind": "sphere"}})


def test_a_mass_of_too_many_grains_is_refused():
    # Spheres of 2650 kg/m³ between 1 and 2 mm, uniform in log D, have 4.67 mg each, so that ten million have 46.7 kg.
    with pytest.raises(ValueError, match=r"amount\.mass: 1e\+09 kg are about 2\.1e\+14 grains.*at most 46\.7 kg"):
        set_up(specification("1e9 kg"), load_grains=None)
    with pytest.raises(ValueError, match="more than 10000000"):
        set_up(specification("47 kg"), load_grains=None)
    assert set_up(specification("46 kg"), load_grains=None).scene.amount_mass == 46.0


def test_a_mass_may_be_that_of_as_many_grains_as_a_number():
    assert read_schema("packing")["properties"]["amount"]["properties"]["grains"]["maximum"] == MAX_GRAINS

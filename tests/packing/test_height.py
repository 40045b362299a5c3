"""What is found before the first step: beds higher than their domain, rare grains, and shaking that is too fast."""

import pytest

from simcore.grains.sources import load_grains
from simcore.packing.expectation import expect
from simcore.packing.forecast_text import check_setup, setup_warnings
from simcore.scene.height import in_mm
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve


def set_up_spheres(grains, **changes):
    """Return the Setup of this number of spheres of 8 mm in a box of 60 mm that is 0.2 m high."""
    specification = {
        "domain": {"width": "60 mm", "height": "0.2 m"},
        "shapes": {"kind": "sphere"},
        "sizes": {"bounds": ["7.9 mm", "8.1 mm"], "mass_fractions": [1]},
        "amount": {"grains": grains},
    }
    return set_up(resolve(specification | changes), load_grains)


@pytest.mark.parametrize("fill, fits, doubtful, refused", [("bed", 1500, 1750, 2200), ("r22", 1100, 1350, 1700)])
def test_beds_above_the_domain_are_warned_of_or_refused(fill, fits, doubtful, refused):
    generation = {"generation": {"fill": fill}}
    for grains, warned in ((fits, False), (doubtful, True)):
        setup = set_up_spheres(grains, **generation)
        check_setup(setup)
        assert any(text.startswith("domain.height: The bed will be about") for text in setup_warnings(setup)) == warned
    with pytest.raises(ValueError, match="domain.height: The bed will be about .* in a domain of 200 mm.*raise domain"):
        check_setup(set_up_spheres(refused, **generation))


def test_lengths_in_mm_have_two_digits():
    assert [in_mm(length) for length in (0.2974, 0.0095, 0.00944, 1.2e-3, 6.2e-5)] == [
        "297",
        "10",
        "9.4",
        "1.2",
        "0.062",
    ]


def test_the_law_of_hertz_does_not_depend_on_the_seed():
    """The first thousand grains of a wide curve have a mean mass that depends much on the few coarse ones."""
    wide = {"sizes": {"bounds": ["2 mm", "8 mm", "64 mm"], "mass_fractions": [0.5, 0.5]}, "amount": {"mass": "20 kg"}}
    wide |= {"domain": {"width": "0.4 m", "height": "1 m"}, "accuracy": "standard"}
    wide |= {"material": {"law": "hertz", "overlap_at_rest": 1e-4}, "numerics": {"dashpot": "explicit"}}
    moduli = {set_up_spheres(100, seed=seed, **wide).scene.hertzian.modulus for seed in (1, 2, 3)}
    assert len(moduli) == 1


def test_a_rare_long_grain_is_found():
    sizes = {"bounds": ["2 mm", "4 mm", "62 mm", "64 mm"], "mass_fractions": [0.3, 0, 0.7]}
    changes = {"sizes": sizes | {"allow_few_top_grains": True}, "domain": {"width": "60 mm", "height": "2 m"}}
    setup = set_up_spheres(20000, seed=2, **changes)
    assert expect(setup.scene, setup.bases, setup.draw).longest > 0.06


def test_shaking_that_the_time_steps_do_not_resolve_is_refused():
    with pytest.raises(ValueError, match="shaking.period: 0.0002 s are fewer than 20 time steps of"):
        set_up_spheres(100, accuracy="standard", shaking={"period": "0.2 ms"})

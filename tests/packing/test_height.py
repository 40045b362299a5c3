"""What is found before the first step: beds higher than their domain, rare grains, and shaking that is too fast."""

import pytest

from simcore.dem.from_scene import compose
from simcore.grains.sources import load_grains
from simcore.packing.expectation import expect, warnings
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


@pytest.mark.parametrize("placement, room", [("filled", "8.1 mm"), ("random", "39 mm")])
def test_insertion_needs_room_above_the_bed(placement, room):
    """A bed of 1500 spheres is about 170 mm high; above it a batch needs a grain, or a zone at random places."""
    setup = set_up_spheres(1500, generation={"placement": placement, "drop_height": "20 mm"})
    needed = in_mm(0.02 + 1e-3 * float(room.split()[0]))
    (line,) = [text for text in setup_warnings(setup) if text.startswith("domain.height")]
    assert f"in a domain of 200 mm, of which insertion needs {needed} mm above the bed; raise domain.height" in line
    raised = float(line.split("to at least ")[1].split(" mm")[0])
    higher = {"domain": {"width": "60 mm", "height": f"{raised} mm"}}
    setup = set_up_spheres(1500, generation={"placement": placement, "drop_height": "20 mm"}, **higher)
    assert not any(text.startswith("domain.height") for text in setup_warnings(setup))


def test_a_batch_at_random_places_is_no_larger_than_the_packing():
    """150 grains are one batch, which is inserted above the floor and needs 130 mm; a batch of 2000 would need 1 m."""
    few = {"placement": "random", "batch_grains": 2000, "drop_height": "10 mm"}
    for height, fits in (("135 mm", True), ("125 mm", False)):
        setup = set_up_spheres(150, generation=few, domain={"width": "60 mm", "height": height})
        assert any(text.startswith("domain.height") for text in setup_warnings(setup)) != fits
    setup = set_up_spheres(3000, generation=few, domain={"width": "60 mm", "height": "0.8 m"})
    assert any("or lower generation.batch_grains (now 2000)" in text for text in setup_warnings(setup))


def test_a_clearance_that_fills_the_domain_is_named():
    with pytest.raises(
        ValueError, match=r"insertion needs 492 mm above the bed; .* or lower generation.drop_height \(n"
    ):
        check_setup(set_up_spheres(300, generation={"drop_height": "0.5 m"}))


def test_grains_that_are_inserted_fast_are_to_be_inserted_more_slowly():
    for speed, advice in (("-5 m/s", "raise generation.velocity_z, which is -5 m/s"), ("0 m/s", "lower domain.height")):
        setup = set_up_spheres(300, generation={"velocity_z": speed}, numerics={"contact_time": "20 ms"})
        (line,) = [
            text for text in warnings(setup.scene, expect(setup.scene, setup.bases, setup.draw)) if "falls" in text
        ]
        assert advice in line and "A packing stops with an error" in line


def test_sliding_that_the_time_steps_do_not_resolve_is_refused():
    changes = {"accuracy": "r22", "convergence": {"rule": "settled"}}
    for time, fits in ((0.1, True), (0.01, False)):  # [ms]; a step is 0.005 ms, and 2.5 times it is the limit
        material = {"friction_law": "dynamic", "sliding_time": f"{time} ms"}
        if fits:
            compose(set_up_spheres(300, material=material, **changes).scene)
            continue
        message = r"material.sliding_time: 1e-05 s is too short for 40 steps .* at least 1.3e-05 s, .* at least 50\."
        with pytest.raises(ValueError, match=message):
            compose(set_up_spheres(300, material=material, **changes).scene)

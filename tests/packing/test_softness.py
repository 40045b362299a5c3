"""Soft contacts under the weight of a bed: the expected overlap, the measured one, and the warnings about both."""

import numpy as np
import pytest

import simcore
from simcore.grains.sources import load_grains
from simcore.packing.explanation import draw_batches
from simcore.packing.forecast import grains_of
from simcore.packing.softness import expected_overlap, expected_warnings
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve_written

STIFF, SOFT = 0.2, 0.8  # contact times [ms]


def specification(contact_time):
    """Return 500 spheres of about 1 mm, a bed of 20 mm, whose grains overlap by 1 % at 0.8 ms under five times g."""
    return {
        "accuracy": "draft",
        "domain": {"type": "periodic", "width": "5 mm", "height": "0.1 m"},
        "shapes": {"kind": "sphere"},
        "sizes": {"bounds": ["1 mm", "1.2 mm"], "mass_fractions": [1]},
        "amount": {"grains": 500},
        "material": {"gravity": "49 m/s^2"},
        "generation": {"velocity_z": "-0.1 m/s"},
        "shaking": {"duration": "0.05 s"},
        "numerics": {"contact_time": f"{contact_time} ms"},
    }


@pytest.fixture(scope="module", params=[STIFF, SOFT])
def packed(request):
    """Return contact time [ms], Scene, its Grains and the packing."""
    spec = specification(request.param)
    setup = set_up(resolve_written(spec), load_grains)
    return request.param, setup.scene, grains_of(setup, draw_batches(setup)[0]), simcore.pack(spec, force=True)


def test_the_overlap_of_a_bed_is_as_expected(packed):
    time, scene, grains, bed = packed
    measured = bed.attrs["mean_overlap_in_diameters"]
    assert 1 / 1.4 < measured / expected_overlap(scene, grains) < 1.4
    overlap, bodies = bed["contact_overlap"].values, bed["contact_body"].values
    between = (bodies >= 0).all(axis=1) & (overlap > 0.0)
    diameter = np.cbrt(6.0 * bed["volume"].values / np.pi)
    np.testing.assert_allclose(measured, (overlap[between] / diameter[bodies[between]].mean(axis=1)).mean(), rtol=1e-9)


def test_only_soft_contacts_are_warned_of_before_and_after(packed):
    time, scene, grains, bed = packed
    lines = expected_warnings(scene, grains)
    if time == STIFF:
        assert lines == [] and "on average" not in bed.attrs["warnings"]
        return
    assert lines[0] in bed.attrs["warnings"].splitlines()
    assert lines[0].startswith("The weight of the bed will press grains into each other by about ")
    assert "At rest grains overlap by " in bed.attrs["warnings"]
    # The advice halves the limit, so that the bed it leads to has no warning.
    advised = float(lines[0].split("to at most ")[1].split(" s.")[0]) * 1e3
    assert expected_warnings(set_up(resolve_written(specification(advised)), load_grains).scene, grains) == []
    assert advised > STIFF

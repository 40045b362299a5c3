"""Scenes of campaigns that stopped with ten steps per contact time: a warning names a number that suffices."""

import numpy as np
import pytest

from benchmarks.studies.thrown_beds import SCENES, thrown_bed
from simcore.grains.sources import load_grains
from simcore.packing.expectation import expect, warnings
from simcore.scene.setup import set_up


def expected_steps(scene, **options):
    """Return the expected steps of a scene of SCENES, and the warnings about its steps."""
    setup = set_up(thrown_bed(scene, **options), load_grains)
    expected = expect(setup.scene, setup.bases, setup.draw)
    return expected.stability.expected, [text for text in warnings(setup.scene, expected) if "per contact" in text]


@pytest.mark.parametrize("scene", SCENES)
def test_ten_steps_are_warned_of_and_fourteen_are_not(scene):
    """Beds of all of them came to rest with 14 steps. Without a number that suffices, a warning would not help."""
    expected, texts = expected_steps(scene)
    assert 10.0 < expected <= 14.0
    assert len(texts) == 1 and f"to at least {np.ceil(expected):.0f}" in texts[0]
    assert expected_steps(scene, steps=14)[1] == []

"""The mean and the least volume of a grain, on which stiffness, time step and height check depend, are those drawn."""

import numpy as np
import pytest

from simcore.grains.form import equal_volume_diameter
from simcore.grains.sources import load_grains
from simcore.scene.setup import _volumes, set_up
from simcore.scene.specification import resolve

BETA = {"beta": {"radius": "5 mm", "spread": 0.3}}
CURVE = {"bounds": ["2 mm", "4 mm", "8 mm", "16 mm"], "mass_fractions": [0.2, 0.3, 0.5], "allow_few_top_grains": True}
SLABS = {"flatness": {"mean": 0.2, "std": 0.02}, "elongation": {"mean": 0.9, "std": 0.02}}
RODS = {"flatness": {"mean": 0.9, "std": 0.02}, "elongation": {"mean": 0.4, "std": 0.02}}
BY_SIZE = {"choice": "form_by_size", "by_size": [{"below": "6 mm", **SLABS}, RODS]}
FLAT = {"choice": "form", "flatness": 0.3, "elongation": 0.3}


def made(sizes, shapes):
    return set_up(
        resolve(
            {
                "domain": {"width": "100 mm", "height": "2 m"},
                "sizes": sizes,
                "shapes": shapes,
                "amount": {"grains": 1000},
            }
        ),
        load_grains,
    )


@pytest.mark.parametrize(
    ("sizes", "shapes"),
    [
        (BETA, {"kind": "ellipsoid", **FLAT}),
        (BETA, {"kind": "polyhedron", "choice": "random"}),
        (CURVE, {"kind": "ellipsoid", **FLAT}),
        (CURVE, {"kind": "ellipsoid", **BY_SIZE}),
        (CURVE, {"kind": "polyhedron", **BY_SIZE}),
        (CURVE, {"kind": "polyhedron", "choice": "random"}),
    ],
)
def test_they_are_those_of_the_grains_that_are_drawn(sizes, shapes):
    setup = made(sizes, shapes)
    mean, least = _volumes(setup.curve, setup.sample, 1000)
    drawn = setup.sample(np.arange(200_000)).volume
    assert mean == pytest.approx(drawn.mean(), rel=0.03)
    assert 0.8 * drawn.min() < least <= drawn.min() * (1.0 + 1e-9)


@pytest.mark.parametrize(
    "shapes",
    [
        {"kind": "polyhedron", "choice": "random"},
        {"kind": "polyhedron", "choice": "form_distribution", **SLABS},
        {"kind": "mixed", "choice": "random", "ellipsoid_share": 0.5},
        {"kind": "ellipsoid", **FLAT},
    ],
)
def test_grains_of_one_volume_have_one_volume(shapes):
    """With sizes.beta a size is the diameter of the sphere of the grain's volume, of polyhedra too."""
    drawn = made({"beta": {"radius": "5 mm", "spread": 0}}, shapes).sample(np.arange(500))
    np.testing.assert_allclose(equal_volume_diameter(drawn.volume), 0.01, rtol=1e-12)
    if shapes["kind"] != "mixed":
        np.testing.assert_allclose(drawn.D, np.sqrt((drawn.I**2 + drawn.S**2) / 2), rtol=1e-9)

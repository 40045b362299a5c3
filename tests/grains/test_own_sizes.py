"""Grains that keep the size they were measured with."""

import numpy as np
import pytest
import trimesh
import yaml

from simcore.grains.own_sizes import OwnSizes
from simcore.grains.sampling import ShapeChoice, sample_grains
from simcore.grains.sources import load_grains
from simcore.packing.cost import estimate
from simcore.scene.setup import set_up
from simcore.scene.sizes import UPRIGHT_REACH
from simcore.scene.specification import express, read_specification, resolve


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder of scans of five ellipsoids of 4 to 12 mm."""
    place = tmp_path_factory.mktemp("scans")
    for number, size in enumerate((2.0, 3.0, 4.0, 5.0, 6.0)):
        mesh = trimesh.creation.icosphere(3, size)
        mesh.vertices *= [1.0, 0.8, 0.6 + 0.05 * number]
        mesh.export(place / f"s{number}.stl")
    return place


def specification(folder, sizes=None, **shapes):
    return resolve(
        {
            "domain": {"width": "60 mm", "height": "1 m"},
            "grains": {"source": str(folder), "unit": "mm"},
            "sizes": {"own": True} if sizes is None else sizes,
            "shapes": shapes,
            "amount": {"grains": 400},
            "faces": 100,
        }
    )


@pytest.mark.parametrize("kind", ["polyhedron", "ellipsoid", "mixed"])
def test_each_grain_is_packed_at_its_own_size(folder, kind):
    shapes = {"kind": kind} | ({"ellipsoid_share": 0.5} if kind == "mixed" else {})
    spec = specification(folder, **shapes)
    setup, grains = set_up(spec, load_grains), load_grains(spec["grains"])
    ids = np.arange(2000)
    sample = setup.sample(ids)
    # The axes of decimated hulls differ from those of the grain by up to half a percent.
    own = np.array([[grain.L, grain.I, grain.S] for grain in grains])
    drawn = np.column_stack([sample.L, sample.I, sample.S])
    nearest = np.abs(drawn[:, None] / own - 1).max(axis=2)
    assert nearest.min(axis=1).max() < (1e-12 if kind == "ellipsoid" else 0.01)
    if kind == "polyhedron":
        assert (sample.scale == 1).all()
        volumes = np.array([grain.volume for grain in grains])
        np.testing.assert_allclose(sample.volume, volumes[sample.shape], rtol=1e-12)
    counts = np.bincount(nearest.argmin(axis=1), minlength=5)
    assert np.abs(counts - 400).max() < 4 * np.sqrt(400 * 0.8)  # four standard errors of equal chances
    # Any subset of ids, in any order, gives the same grains.
    np.testing.assert_array_equal(setup.sample(ids[700:650:-7]).D, sample.D[700:650:-7])
    assert setup.scene.generation.spacing == pytest.approx(UPRIGHT_REACH * setup.curve.largest)


@pytest.mark.parametrize("kind", ["polyhedron", "ellipsoid"])
def test_one_grain_keeps_its_size(folder, kind):
    setup = set_up(specification(folder, kind=kind, choice="one", grain="s3"), load_grains)
    (grain,) = (grain for grain in load_grains(specification(folder)["grains"]) if grain.name == "s3")
    np.testing.assert_allclose(setup.sample(np.arange(50)).D, grain.sieve_size, rtol=5e-3)
    assert setup.curve.least == setup.curve.largest


def test_the_grains_of_a_sieve_curve_stay_as_they_were(folder):
    """With one very narrow class all grains have its size, whatever their own."""
    spec = specification(folder, {"bounds": ["5 mm", "5.0001 mm"], "mass_fractions": [1.0]})
    np.testing.assert_allclose(set_up(spec, load_grains).sample(np.arange(50)).D, 5e-3, rtol=1e-4)


def test_moments_are_those_of_the_grains():
    sizes = OwnSizes(np.array([1.0, 2.0, 4.0]))
    assert (sizes.least, sizes.largest) == (1.0, 4.0)
    assert sizes.mean(3) == pytest.approx(73 / 3) and sizes.mean(1) == pytest.approx(7 / 3)


FORM = {"mean": 0.6, "std": 0.1}


@pytest.mark.parametrize(
    "shapes, reason",
    [
        ({"kind": "sphere"}, "no size of their own"),
        (
            {"choice": "form_distribution", "flatness": FORM, "elongation": FORM},
            "choice form_distribution have no size",
        ),
    ],
)
def test_shapes_without_a_size_are_refused(folder, shapes, reason):
    with pytest.raises(ValueError, match=rf"sizes\.own: .*{reason}"):
        set_up(specification(folder, **shapes), load_grains)


@pytest.mark.parametrize("more", [{"case": "U1"}, {"bounds": ["1 mm", "2 mm"], "mass_fractions": [1.0]}])
def test_own_sizes_beside_others_are_refused(folder, more):
    with pytest.raises(ValueError, match=r"sizes: give either a case.*own: true"):
        specification(folder, {"own": True, **more})


def test_what_reads_no_grains_refuses_own_sizes(folder):
    with pytest.raises(ValueError, match=r"sizes\.own: the grains are not read at this point"):
        estimate(specification(folder))


def test_an_empty_set_is_refused():
    with pytest.raises(ValueError, match="needs a grain set"):
        sample_grains(np.arange(3), 1, OwnSizes(np.array([1.0])), ShapeChoice(), [])


def test_a_file_may_have_own_sizes(folder, tmp_path):
    (tmp_path / "own.yaml").write_text(yaml.safe_dump(express(specification(folder))))
    assert read_specification(tmp_path / "own.yaml")["sizes"]["own"] is True

"""The composition of a bed: shares by volume and number of the whole and a part, and warnings of separated sizes."""

import numpy as np
import pytest

from simcore.evaluation.composition import composition, separation_warnings
from simcore.evaluation.evaluate import evaluate
from simcore.provenance.code_name import name_of_sources
from tests.helpers.packings import make_packing, sphere_lattice


def bed(radius, z, seed=1, bounds=None):
    """Return spheres of these radii and heights, at random places of a wide box, with the classes of a sieve curve."""
    radius, z = np.asarray(radius, float), np.asarray(z, float)
    place = np.random.default_rng(seed).uniform(size=(len(z), 2))
    packing = make_packing(np.column_stack([place, z]), np.repeat(radius[:, None], 3, axis=1))
    if bounds is not None:
        packing["sieve_bounds"] = (("sieve_class", "bound"), np.column_stack([bounds[:-1], bounds[1:]]), {"units": "m"})
    return packing


def mixed_bed(seed, lift=0.0, n=600):
    """Return a bed of two sizes, 1 m high; lift raises the lowest coarse grains."""
    rng = np.random.default_rng(seed)
    coarse = rng.random(n) < 0.15
    z = np.where(coarse, rng.uniform(lift, 1.0, n), rng.uniform(0.0, 1.0, n))
    return bed(np.where(coarse, 0.02, 0.01), z, seed)


def test_shares_by_volume_and_number_of_the_bed_and_its_evaluated_part():
    packing = bed([0.01, 0.01, 0.01, 0.02], [0.1, 0.5, 0.5, 0.5], bounds=np.array([0.01, 0.03, 0.05]))
    result = composition(packing, 0.3, 0.7)
    share = result["sieve_fraction"]
    np.testing.assert_allclose(share.sel(part="bed", weight="number"), [0.75, 0.25])
    np.testing.assert_allclose(share.sel(part="bed", weight="volume"), [3 / 11, 8 / 11])
    np.testing.assert_allclose(share.sel(part="evaluated", weight="number"), [2 / 3, 1 / 3])
    np.testing.assert_allclose(share.sel(part="evaluated", weight="volume"), [0.2, 0.8])
    np.testing.assert_array_equal(result["sieve_bounds"], [[0.01, 0.03], [0.03, 0.05]])


def test_a_grain_that_a_plane_cuts_counts_with_its_part():
    packing = bed([0.01, 0.01], [0.3, 0.5])
    packing["S"][1] *= 0.5
    result = composition(packing, 0.3, 0.7).sel(part="evaluated", weight="number", ratio="FL")
    assert float(result["form_mean"]) == pytest.approx((0.5 * 1.0 + 1.0 * 0.5) / 1.5)
    assert float(result["form_std"]) == pytest.approx(np.sqrt((0.5 * (1 / 3) ** 2 + (1 / 6) ** 2) / 1.5))


def test_form_moments_are_those_of_the_grains():
    rng = np.random.default_rng(5)
    scale = np.sort(rng.uniform(0.01, 0.03, (50, 3)), axis=1)
    packing = make_packing(np.column_stack([rng.random((50, 2)), rng.uniform(0.2, 0.8, 50)]), scale)
    whole = composition(packing, 0.0, 1.0)
    ratios = np.array([scale[:, 0] / scale[:, 1], scale[:, 1] / scale[:, 2], scale[:, 0] / scale[:, 2]])
    for part in ("bed", "evaluated"):
        by_number = whole.sel(part=part, weight="number")
        np.testing.assert_allclose(by_number["form_mean"], ratios.mean(axis=1), rtol=1e-9)
        np.testing.assert_allclose(by_number["form_std"], ratios.std(axis=1), rtol=1e-9)
        volumes = scale.prod(axis=1)
        by_volume = np.average(ratios, weights=volumes, axis=1)
        np.testing.assert_allclose(whole.sel(part=part, weight="volume")["form_mean"], by_volume, rtol=1e-9)


def test_beds_without_separation_are_warned_of_as_often_as_chance_has_it():
    """Each of the two rules gives a false warning with a probability of at most 0.3 %."""
    count = sum(bool(separation_warnings(composition(mixed_bed(seed), 0.1, 0.9))) for seed in range(300))
    assert count <= 6


def test_coarse_grains_above_are_warned_of():
    (line,) = separation_warnings(composition(mixed_bed(1, lift=0.5), 0.1, 0.9))
    assert line.startswith("Sizes separate: coarse grains are ") and "of the upper half" in line


def test_sizes_that_separate_completely_are_warned_of():
    """Shares of 0 and 1 have no standard error in which their difference could be stated."""
    rng = np.random.default_rng(4)
    z = np.concatenate([rng.uniform(0.55, 1.0, 40), rng.uniform(0.0, 0.45, 320)])
    lines = separation_warnings(composition(bed(np.repeat([0.02, 0.01], [40, 320]), z), 0.1, 0.9))
    assert lines == [
        "Sizes separate: coarse grains are 0 % of the lower and 100 % of the upper half of the evaluated part."
    ]


def test_fine_grains_on_the_floor_are_warned_of():
    rng = np.random.default_rng(2)
    radius = np.concatenate([np.full(300, 0.02), np.full(300, 0.01)])
    z = np.concatenate([rng.uniform(0.02, 1.0, 300), rng.uniform(0.0, 0.3, 300)])
    lines = separation_warnings(composition(bed(radius, z), 0.3, 0.9))
    assert any(line.startswith("Fine grains gather on the floor: they are ") for line in lines)


def test_overlaps_with_the_floor_are_no_layer_below_the_evaluated_part():
    """Light grains sink deepest into the floor, which is no separation of sizes."""
    rng = np.random.default_rng(2)
    radius = np.concatenate([np.full(300, 0.02), np.full(300, 0.01)])
    z = np.concatenate([rng.uniform(0.02, 1.0, 300), rng.uniform(0.009, 1.0, 300)])
    result = composition(bed(radius, z), 0.0, 0.9)
    assert np.isnan(result["fine_share"][0]) and separation_warnings(result) == []


def test_shares_of_coarse_grains_of_the_bed_and_of_its_evaluated_part():
    """Large spheres are above small ones, so the share in the evaluated part follows from the volumes it contains."""
    radius, z = np.r_[np.full(10, 0.02), np.full(80, 0.01)], np.r_[np.full(10, 0.5), np.full(80, 0.1)]
    result = composition(bed(radius, z), 0.0, 1.0)
    np.testing.assert_allclose(result["coarse_share_of_part"], [0.5, 0.5])
    result = composition(bed(radius, z), 0.3, 1.0)
    np.testing.assert_allclose(result["coarse_share_of_part"], [0.5, 1.0])


def test_grains_of_one_size_have_nothing_to_separate():
    rng = np.random.default_rng(3)
    result = composition(bed(np.full(100, 0.01), rng.uniform(0, 1, 100)), 0.2, 0.8)
    assert separation_warnings(result) == []


def test_an_empty_evaluated_part_is_refused():
    with pytest.raises(ValueError, match="no grain reaches into the evaluated part from 2 m to 3 m"):
        composition(bed([0.01], [0.5]), 2.0, 3.0)


def test_the_evaluation_of_a_packing_has_its_composition_and_its_warning():
    centres, width = sphere_lattice("fcc", 4, 12)
    size = np.where(centres[:, 2] > centres[:, 2].mean(), 8e-3, 6e-3)
    packing = make_packing(1e-2 * centres, np.repeat(0.5 * size[:, None], 3, axis=1), width=1e-2 * width)
    packing["sieve_bounds"] = (("sieve_class", "bound"), np.array([[5e-3, 7e-3], [7e-3, 9e-3]]), {"units": "m"})
    packing.attrs["warnings"] = "Another warning."
    result = evaluate(packing, cut=1e-2)
    assert result.attrs["evaluation_code"] == name_of_sources("simcore/evaluation/evaluate.py")
    lines = result.attrs["warnings"].split("\n")
    assert lines[0] == "Another warning." and lines[1].startswith("Sizes separate: ") and len(lines) == 2
    assert result["sieve_fraction"].sel(part="bed", weight="number").sum() == pytest.approx(1.0)
    assert dict(result["fine_share"].sizes) == {"zone": 2} and dict(result["coarse_share"].sizes) == {"half": 2}

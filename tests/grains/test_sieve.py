"""Sieve curves: what is refused, mass to number, the table of cases."""

from pathlib import Path

import numpy as np
import pytest

from simcore.grains.sieve import SieveCurve, read_cases

CASES = Path(__file__).parents[2] / "config" / "cases.tsv"


@pytest.mark.parametrize(
    "bounds, fractions, reason",
    [
        ([1e-3, 2e-3, 4e-3], [0.5, 0.4], "sum to 0.9"),
        ([1e-3, 2e-3, 4e-3], [1.5, -0.5], ">= 0"),
        ([1e-3, 4e-3, 2e-3], [0.5, 0.5], "increasing"),
        ([0.0, 1e-3], [1.0], "positive"),
        ([1e-3, 2e-3], [0.5, 0.5], "one bound more"),
        ([1e-3, np.nan], [1.0], "increasing"),
        ([1e-3, 2e-3], [np.nan], ">= 0"),
    ],
)
def test_bad_curves_are_refused_by_name(bounds, fractions, reason):
    with pytest.raises(ValueError, match=f"'my curve'.*{reason}"):
        SieveCurve(bounds, fractions, "my curve")


def test_mass_fractions_come_back_from_numbers():
    curve = SieveCurve([1e-3, 2e-3, 4e-3, 8e-3], [0.2, 0.5, 0.3])
    mass = curve.number_fractions() * curve.class_diameters**3
    np.testing.assert_allclose(mass / mass.sum(), [0.2, 0.5, 0.3], rtol=1e-14)
    # 1 g of each class in spheres of its geometric mean size
    numbers = curve.expected_numbers(1e-3, 2650)
    np.testing.assert_allclose(numbers * 2650 * np.pi / 6 * curve.class_diameters**3, [2e-4, 5e-4, 3e-4])


def test_largest_is_that_of_the_largest_class_with_mass():
    assert SieveCurve([1e-3, 2e-3, 4e-3], [1.0, 0.0]).largest == 2e-3


def test_top_class_needs_five_grains():
    curve = SieveCurve([1e-3, 2e-3, 4e-3, 8e-3], [0.5, 0.5, 0.0], "two")
    needed = 5 * 2650 * np.pi / 6 * (2e-3 * 4e-3) ** 1.5 / 0.5
    curve.check_top_class(needed * 1.001, 2650)
    with pytest.raises(ValueError, match=r"'two'.* 5 grains.*4 mm.*0\.000314 kg.*allow_few_top_grains"):
        curve.check_top_class(needed * 0.999, 2650)


def test_cases_are_table_3():
    cases = read_cases(CASES)
    assert list(cases) == ["U1", "U3", "U5", "U7", "B30", "B50", "B70"]
    assert cases["U1"].curve.largest == pytest.approx(8e-3)
    assert cases["B30"].generation_spacing == pytest.approx(0.020)
    np.testing.assert_allclose(cases["U7"].curve.bounds, np.array([2.8, 4, 5.6, 8, 11.2, 16, 22.4, 31.5]) * 1e-3)
    np.testing.assert_allclose(cases["B70"].curve.mass_fractions, [0.18, 0.29, 0.18, 0.06, 0.08, 0.13, 0.08])


def test_bad_tables_are_refused_with_their_path(tmp_path):
    path = tmp_path / "cases.tsv"
    with pytest.raises(ValueError, match=r"cases\.tsv does not exist"):
        read_cases(path)
    good = CASES.read_text()
    for text, reason in [
        (good.replace("0.21\t0.58", "0.21\t0.5"), "'U3'.*sum"),
        (good.replace("generation_spacing [mm]", "spacing"), "needs"),
        (good.replace("5.6-8 mm", "6-8 mm"), "must begin"),
        (good.replace("0.58", "much"), "much"),
    ]:
        path.write_text(text)
        with pytest.raises(ValueError, match=rf"(?s)cases\.tsv.*{reason}"):
            read_cases(path)

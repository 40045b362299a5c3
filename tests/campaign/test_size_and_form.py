"""The packings of the study size_and_form meet the requirements of docs/appendices/size_and_form_plan.md."""

import pytest

from benchmarks.studies.size_and_form import beds_table, planned
from simcore.scene.sizes import all_cases

FAMILIES = {"binary_2_to_3", "binary_4_to_8", "log_normal", "fractal", "two_modes", "skewed_and_gap"}


@pytest.fixture(scope="module")
def beds():
    return beds_table()


def test_beds_are_wide_deep_and_of_enough_grains(beds):
    assert len(beds) == 75 and beds["cpu_h_sum"].iloc[-1] == pytest.approx(beds["cpu_h"].sum())
    assert (beds["width"] >= 4).all() and (beds["depth"] >= 5.4).all()
    assert (beds["top_grains"][beds["top_share"] >= 0.2] >= 30).all()
    assert (beds["top_grains"][beds["top_share"] >= 0.05] >= 10).all() and (beds["top_grains"] >= 5).all()
    widest = beds["curve"].str.startswith("R8")
    assert (beds["effective"][~widest] >= 220).all() and (beds["effective"][widest] >= 125).all()


def test_every_family_has_beds_and_every_form_its_base(beds):
    wide, bases = beds[beds["family"] != "one_class"], beds[beds["family"] == "one_class"]
    assert set(wide["family"]) == FAMILIES and set(bases["curve"]) == {"U1"}
    assert (wide[wide["form"] != "sphere"].groupby("family").size() >= 3).all()
    assert set(wide["form"]) == {"all", "sphere", "G50", "G08", "G59"} <= set(bases["form"])
    # Each form occurs in three families, beside other forms.
    for form in ("G50", "G08", "G59"):
        assert wide["family"][wide["form"] == form].nunique() == 3


def test_a_stop_leaves_bases_first_and_then_several_families(beds):
    assert (beds["family"].iloc[:8] == "one_class").all() and (beds["seed"].iloc[:-8] == 1).all()
    assert set(beds["family"].iloc[8:15]) == {"binary_2_to_3", "log_normal"}
    assert set(beds["family"].iloc[8:21]) == FAMILIES
    assert set(beds["curve"].iloc[-17:]) >= {"R8_85", "R8_70", "LN135"}


def test_all_beds_have_one_process():
    """Packings differ only in curve, form, contact of polyhedra, size of the bed, spacing and seed."""
    processes = set()
    for specification in planned().values():
        numerics = specification["numerics"]
        processes.add(
            str([specification[group] for group in ("material", "shaking", "damping", "convergence")])
            + str({key: value for key, value in numerics.items() if key != "polyhedron_contact"})
            + str({key: value for key, value in specification["generation"].items() if key != "spacing"})
            + specification["sizes"]["draw"]
        )
    assert len(processes) == 1


def test_ratios_of_binary_curves_are_those_of_their_names():
    ratios = {"R2": 2.0, "R3": 2.83, "R4": 4.0, "R6": 5.66, "R8": 8.0}
    binary = {name: case for name, case in all_cases().items() if case.family.startswith("binary")}
    assert len(binary) == 18
    for name, case in binary.items():
        curve, (kind, coarse) = case.curve, name.split("_")
        centres = (curve.bounds[1:] * curve.bounds[:-1]) ** 0.5
        fine, top = centres[curve.mass_fractions > 0]
        assert top / fine == pytest.approx(ratios[kind], rel=0.01)
        assert curve.mass_fractions[curve.mass_fractions > 0][1] == pytest.approx(int(coarse) / 100)
        assert case.family == ("binary_2_to_3" if ratios[kind] < 3 else "binary_4_to_8")
        assert curve.numbers_by == "mean_volume"

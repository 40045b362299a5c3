"""The numbers in docs/explanation/unequal_grains.md are those of the committed table."""

import pandas as pd
import pytest

from benchmarks.studies.contact_law import EXPONENTS, MASS_RATIOS
from simcore.paths import REFERENCE, ROOT

PAGE = (ROOT / "docs" / "explanation" / "unequal_grains.md").read_text(encoding="utf-8")
WORDS = " ".join(PAGE.split())
TABLE = pd.read_csv(REFERENCE / "contact_law.csv")
COLUMNS = (1.0, 1.5, 2.0, 3.0, 0.5)  # exponents, in the order of the page


def over_linear(table, column="step_s"):
    """Return `column` over that of the linear law at rest with the same dashpot and masses, one value for each row.

    Rows with the overlap of equals are compared with the linear law at this overlap.
    """
    keys = ["dashpot", "overlap_of", "mass_ratio"]
    linear = TABLE[TABLE.exponent == 1.0].set_index(keys)[column]
    compared = table[keys].replace({"overlap_of": {"impact": "linear"}})
    return table[column].to_numpy() / linear[pd.MultiIndex.from_frame(compared)].to_numpy()


def stated_range(table, column="step_s"):
    ratios = over_linear(table, column)
    return f"{ratios.min():.2f} to {ratios.max():.2f}"


def test_the_table_has_all_rows_of_both_dashpots():
    counted = TABLE.groupby(["dashpot", "overlap_of"]).size()
    expected = {"linear": len(MASS_RATIOS) * len(EXPONENTS), "equals": (len(MASS_RATIOS) - 1) * len(EXPONENTS)}
    expected["impact"] = len(MASS_RATIOS) * (len(EXPONENTS) - 1)
    assert counted.to_dict() == {(d, of): n for d in ("implicit", "explicit") for of, n in expected.items()}


@pytest.mark.parametrize("of", ["linear", "equals"])
@pytest.mark.parametrize("ratio", MASS_RATIOS)
def test_longest_steps(of, ratio):
    rows = TABLE.query("dashpot == 'implicit' and overlap_of == @of and mass_ratio == @ratio").set_index("exponent")
    if of == "equals" and ratio == 1.0:
        assert rows.empty
        return
    name = {"linear": "of the linear law", "equals": "of equals"}[of]
    times = [*rows.step_s[list(COLUMNS)], rows.two_contact_bound_s[1.0]]
    cells = [name, f"{ratio:g}", f"{100 * rows.relative_overlap[1.0]:.2g} %", *(f"{1e6 * x:.3g} µs" for x in times)]
    assert f"| {' | '.join(cells)} |" in PAGE


def test_no_stiffening_law_has_a_longer_step_at_the_same_static_overlap():
    at_rest = TABLE[TABLE.overlap_of != "impact"]
    stiffening = at_rest[at_rest.exponent > 1.0]
    assert (over_linear(stiffening) < 1.0).all()
    implicit = stiffening[stiffening.dashpot == "implicit"]
    hertz, cubic = implicit[implicit.exponent == 1.5], implicit[implicit.exponent == 3.0]
    assert f"is {stated_range(hertz)} of the linear one, that of d³ {stated_range(cubic)}." in WORDS
    for rows, stated in ((hertz, 0.85), (cubic, 0.63)):
        assert over_linear(rows, "loaded_step_s") == pytest.approx(stated, abs=0.01)
    assert "the ratios are 0.85 and 0.63" in WORDS


def test_bounds_hold_and_are_compared_with_the_linear_law():
    stiff = TABLE[TABLE.exponent >= 1.0]
    assert (stiff.loaded_step_s < stiff.two_contact_bound_s).all() and (stiff.step_s <= stiff.loaded_step_s).all()
    linear = stiff.query("dashpot == 'implicit' and exponent == 1.0")
    ratios = linear.step_s / linear.two_contact_bound_s
    assert f"The linear steps are {ratios.min():.2f} to {ratios.max():.2f} of the bound" in WORDS


def test_cost_of_stones_that_sink_no_deeper_than_equals():
    rows = TABLE.query("dashpot == 'implicit' and exponent == 1.0").set_index(["overlap_of", "mass_ratio"]).step_s
    ten, thousand = (rows["linear", ratio] / rows["equals", ratio] for ratio in (10.0, 1000.0))
    assert f"a factor of {ten:.1f} under a grain of ten times the mass, and of {thousand:.0f} under" in WORDS


def test_softening_law():
    rows = TABLE.query("dashpot == 'implicit' and exponent == 0.5 and overlap_of != 'impact'")
    equals, heavier = rows[rows.mass_ratio == 1.0], rows[rows.mass_ratio > 1.0]
    assert f"longer by {100 * (over_linear(equals)[0] - 1):.0f} % for equals" in WORDS
    assert (over_linear(heavier) < 1.0).all() and (heavier.step_s == heavier.alone_step_s).all()


def test_the_same_overlap_in_the_impact():
    rows = TABLE.query("overlap_of == 'impact' and exponent > 1.0")
    assert over_linear(rows, "relative_impact_overlap") == pytest.approx(1.0, abs=2e-3)
    hertz = rows.query("dashpot == 'implicit' and exponent == 1.5")
    static = over_linear(hertz, "relative_overlap")
    assert f"Hertzian step is {stated_range(hertz)} of the linear one" in WORDS
    assert f"its static overlap is {static.min():.1f} to {static.max():.1f} times as large" in WORDS
    longer = rows[over_linear(rows) > 1.01]
    assert (longer.dashpot == "explicit").all() and (longer.mass_ratio == 1.0).all()
    assert longer.exponent.tolist() == [1.5, 2.0]
    by = [f"{100 * (ratio - 1):.0f} %" for ratio in over_linear(longer)]
    assert f"d^1.5 and d² allow steps longer by {' and '.join(by)}." in WORDS


def test_restitution_and_overlaps():
    assert f"and {TABLE.restitution.min():.2f} to {TABLE.restitution.max():.2f} at a fifth" in WORDS
    (row,) = TABLE.query(
        "dashpot == 'implicit' and exponent == 1.0 and overlap_of == 'linear' and mass_ratio == 1000"
    ).itertuples()
    at_rest, in_impact = 100 * row.relative_overlap, 100 * row.relative_impact_overlap
    assert f"by {at_rest:.1f} % of its diameter at rest, and by {in_impact:.0f} % in the impact" in WORDS

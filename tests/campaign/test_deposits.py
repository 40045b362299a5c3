"""Tables of deposits and their analysis, from made-up rows with a given maximum, differences and symmetry."""

import json

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.deposit_findings import crossings, diagonal_fabrics, maxima, spread_fabrics, symmetry
from simcore.campaign.deposits import (
    RESULTS,
    add_family,
    deposit_rows,
    experiment_differences,
    family,
    figures_of_fabrics,
    means,
    read_deposits,
    tabulate_deposits,
)
from simcore.evaluation.deposit import deposit
from tests.helpers.packings import make_packing, sphere_lattice, touching_pairs

PEAK = 1.6


def made_up(eta, zeta, seed, study="deposit_map", change="", noise=0.0, **other):
    """Return a row whose solid fraction and contacts are parabolas in ln eta and ln zeta with the maximum at PEAK."""
    x, y = np.log(eta / PEAK), np.log(zeta / PEAK)
    value = 0.72 - 0.2 * (x**2 + y**2) + noise
    row = {"study": study, "packing": f"{eta}_{zeta}-seed_{seed}", "eta": eta, "zeta": zeta, "seed": seed}
    row |= {"std_eta": 0.0, "std_zeta": 0.0, "spread": 0.0, "law": "hertz", "shaking_s": 0.0, "change": change}
    row |= {name: 0.0 for name in RESULTS} | {"solid_fraction": value, "coordination_number": 10.0 * value}
    return row | {"mean_overlap": 1e-3, "time_s": 1.0, "steps": 10, "grains": 1000, "cpu_s": 60.0} | other


def campaign(noise=0.0):
    """Return a table of all families: five seeds of the curves, one of the map; noise is the scatter over seeds."""
    rng = np.random.default_rng(3)
    ratios = [1.0, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 2.0, 2.5]
    rows = []
    for seed in range(1, 6):
        for r in ratios:
            for study, eta, zeta in (("diagonal", r, r), ("prolate", r, 1.0), ("oblate", 1.0, r)):
                rows.append(made_up(eta, zeta, seed, f"deposit_{study}", noise=noise * rng.normal()))
    rows += [made_up(eta, zeta, 6, noise=noise * rng.normal()) for eta in ratios[::3] for zeta in ratios[::3]]
    return add_family(pd.DataFrame(rows))


def test_maxima_of_parabolas_are_found_exactly():
    found = maxima(campaign()).set_index(["of", "family"])
    top = found.loc[("solid_fraction", "diagonal")]
    # The tolerances are the rounding errors of a fit to values near 1 over a range of 0.6 in ln(ratio).
    assert top.ratio == pytest.approx(PEAK, abs=1e-9) and top.value == pytest.approx(0.72, abs=1e-12)
    assert top.ratio_error < 1e-9
    # The other ratio of spheroids is 1, so their maximum is lower by 0.2 ln²(PEAK).
    assert found.loc[("solid_fraction", "prolate"), "value"] == pytest.approx(0.72 - 0.2 * np.log(PEAK) ** 2, abs=1e-9)
    assert found.loc[("coordination_number", "diagonal"), "value"] == pytest.approx(7.2, abs=1e-9)


def test_too_few_forms_have_no_maximum():
    assert maxima(campaign().query("eta == 1.0 and zeta == 1.0")).empty


def test_the_diagonal_above_the_spheroids_in_standard_errors():
    found = maxima(campaign(noise=0.002)).set_index(["of", "family"])
    top, other = (found.loc[("solid_fraction", name)] for name in ("diagonal", "prolate"))
    z = (top.value - other.value) / np.hypot(top.value_error, other.value_error)
    assert top.above_prolate == pytest.approx(z) and z > 5.0
    assert np.isnan(other.above_prolate)


def test_symmetry_separates_a_difference_from_scatter():
    table = campaign(noise=0.002)
    even = symmetry(table).set_index("of").loc["solid_fraction"]
    # The pairs are spheroids of nine ratios, and three pairs of the 4 x 4 map that are not spheroids.
    assert even.pairs == 9 + 3
    assert abs(even["mean"]) < 3.0 * even.mean_error
    assert even.rms == pytest.approx(even.expected_rms, rel=3.0 / np.sqrt(2 * even.pairs))
    leaning = table.assign(solid_fraction=table.solid_fraction + 0.02 * (table.eta > table.zeta))
    assert symmetry(leaning).set_index("of").loc["solid_fraction", "mean"] == pytest.approx(even["mean"] + 0.02)


def test_means_over_seeds_and_changes_paired_by_seed():
    rows = [
        made_up(1.6, 1.6, seed, "deposit_change", change, noise=0.001 * seed + effect * (1 + 0.1 * seed))
        for change, effect in (("none", 0.0), ("friction_law static", -0.02))
        for seed in (1, 2, 3)
    ]
    table = add_family(pd.DataFrame(rows))
    mean = means(table).set_index("change")
    assert mean.loc["none", "solid_fraction"] == pytest.approx(0.722)
    assert mean.loc["none", "solid_fraction_error"] == pytest.approx(0.001 / np.sqrt(3))
    assert mean.loc["none", "cpu_s"] == 180.0
    (change,) = experiment_differences(table).itertuples()
    assert (change.change, change.pairs) == ("friction_law static", 3)
    assert change.solid_fraction == pytest.approx(-0.02 * 1.2)
    assert change.solid_fraction_error == pytest.approx(0.002 / np.sqrt(3))


def test_the_family_is_read_from_the_name_of_the_study():
    assert family("deposit_map_long") == "map"
    with pytest.raises(ValueError, match="studies.deposit_moon: .* names of deposits begin with deposit_map"):
        family("deposit_moon")


def deposit_of_lattice(seed, ratio=1.3, spread=0.0):
    """Return deposit() of a lattice of touching spheres whose specification has eta = zeta = ratio."""
    centres, width = sphere_lattice("sc", 4, 9)
    pairs, images = touching_pairs(centres, width)
    scene = {
        "seed": seed,
        "shapes": {"eta": ratio, "zeta": ratio},
        "sizes": {"beta": {"radius": 0.5, "spread": spread}},
        "material": {"law": "hertz"},
        "shaking": {"duration": 0.0},
    }
    attrs = dict(scene=json.dumps(scene), seed=seed, steps=7, time=0.5, last_insertion=0.2, cpu_seconds=3.0)
    bed = make_packing(centres, 0.5, width=width, contacts=pairs, images=images, **attrs)
    bed["contact_overlap"] = ("contact", np.full(bed.sizes["contact"], 2e-3))
    return deposit(bed)


def test_a_row_has_the_settings_and_results_of_its_deposit():
    rows = [
        {"packing": f"p{seed}", "varied": {"eta": 1.3, "seed": seed, "width_m": width}}
        for seed, width in ((1, 4.0), (2, 8.0))
    ]
    deposits = [deposit_of_lattice(1), deposit_of_lattice(2)]
    table = deposit_rows("deposit_change", rows, deposits, rows[0])
    row = table.iloc[0]
    assert (row.eta, row.zeta, row.spread, row.seed, row.grains, row.steps, row.cpu_s) == (1.3, 1.3, 0, 1, 144, 7, 3.0)
    assert row.solid_fraction == pytest.approx(np.pi / 6, rel=0.02) and row.coordination_number == 6
    # One of three normals of a simple cubic lattice is vertical.
    assert row.P2_contact_normal == pytest.approx(0.0, abs=1e-12) and np.isnan(row.P2_long_axis)
    # The overlap is divided by the diameter, which is 1.
    assert row.mean_overlap == pytest.approx(2e-3)
    assert list(table.change) == ["none", "width_m 8"]
    assert set(deposit_rows("deposit_diagonal", rows, deposits, rows[0]).change) == {""}


def test_fabrics_of_the_diagonal_are_means_over_seeds():
    studies = ["deposit_diagonal", "deposit_diagonal", "deposit_map"]
    deposits = [deposit_of_lattice(seed) for seed in (1, 2, 3)]
    fabrics = diagonal_fabrics(studies, deposits)
    assert list(fabrics) == ["η = ζ = 1.3"] and fabrics["η = ζ = 1.3"].attrs["packings"] == 2
    assert crossings(studies, deposits).angle.isna().all()


def test_fabrics_over_the_spread_of_sizes_are_of_the_form_with_most_spreads():
    of = [(1.0, 0.0), (1.0, 0.5), (2.2, 0.2), (1.6, 0.5), (1.6, 0.0), (1.6, 0.0)]
    deposits = [deposit_of_lattice(seed, *settings) for seed, settings in enumerate(of)]
    fabrics = spread_fabrics(["deposit_sizes"] * 6, deposits)
    assert list(fabrics) == ["S = 0", "S = 0.5"] and fabrics["S = 0"].attrs["packings"] == 2
    assert fabrics["S = 0.5"] is deposits[3]
    assert list(spread_fabrics(["deposit_sizes"] * 2, deposits[:2])) == ["S = 0", "S = 0.5"]
    assert spread_fabrics(["deposit_map"], deposits[:1]) == {}


def test_a_campaign_has_the_figures_of_fabrics_that_its_deposits_allow():
    def specify(eta, beta):
        return {"shapes": {"eta": eta, "zeta": eta}, "sizes": {"beta": beta}}

    one, spread = specify(1.2, None), specify(1.2, {"spread": 0.2})
    assert figures_of_fabrics([], []) == []
    assert figures_of_fabrics(["deposit_map"], [one]) == []
    assert figures_of_fabrics(["deposit_diagonal"], [specify({"mean": 1.2, "std": 0.1}, None)]) == []
    assert figures_of_fabrics(["deposit_sizes"], [one]) == [], "a sieve curve has no spread"
    both = ["histograms", "histograms_over_sizes"]
    assert figures_of_fabrics(["deposit_diagonal", "deposit_sizes"], [one, spread]) == both


def test_deposits_are_tabulated_study_by_study():
    """Each packing is compared with the first one of its own study, whatever the order of the packings."""
    studies = ["deposit_change", "deposit_map", "deposit_change"]
    widths = (4.0, 6.0, 8.0)
    rows = [{"packing": f"p{width:g}", "varied": {"eta": 1.3, "width_m": width}} for width in widths]
    table = tabulate_deposits(studies, rows, [deposit_of_lattice(seed) for seed in (1, 2, 3)])
    assert list(table.packing) == ["p4", "p8", "p6"] and list(table.seed) == [1, 3, 2]
    assert list(table.family) == ["change", "change", "map"] and list(table.change) == ["none", "width_m 8", ""]


def test_committed_rows_of_deposits_keep_what_is_none(tmp_path):
    rows = pd.DataFrame([made_up(1.0, 1.0, 1), made_up(1.0, 1.2, 1, study="deposit_change", change="none")])
    rows.to_csv(tmp_path / "deposits.csv", index=False)
    table = read_deposits(tmp_path / "deposits.csv")
    assert list(table.change) == ["", "none"] and list(table.family) == ["map", "change"]

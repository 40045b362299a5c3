"""Differences to a reference and the choice of settings, on numbers whose answer is known."""

import numpy as np
import pandas as pd
import pytest

from simcore.verification.packings import (
    base_setting,
    change_errors,
    cheapest_settings,
    compare,
    name_changes,
    porosity_errors,
    study_errors,
    work_precision_of_studies,
    work_precision_runs,
)
from simcore.verification.work_precision import settings_table


def packings(shifts, costs, seeds=(1, 2, 3, 4), study="made", scatter=0.01):
    """Return a study with porosity 0.4 plus an effect of the seed, equal in all settings, plus the shift."""
    of_seed = dict(zip(seeds, scatter * np.random.default_rng(1).standard_normal(len(seeds)), strict=True))
    return pd.DataFrame(
        [
            {"study": study, "seed": seed, "step": step, "n": 0.4 + of_seed[seed] + shift, "cpu_s": cost}
            for (step, shift), cost in zip(shifts.items(), costs, strict=True)
            for seed in seeds
        ]
    )


def test_what_a_seed_does_to_both_is_taken_out():
    table = porosity_errors(packings({40: 0.0, 20: 0.003}, (10.0, 5.0)), ["seed", "step"])
    assert list(table.setting) == ["40", "20"]
    assert table.difference.to_numpy() == pytest.approx([0.0, 0.003])
    assert table.difference_std_error.to_numpy() == pytest.approx([0.0, 0.0], abs=1e-15)
    assert table.n_std_error.min() > 1e-3  # the seed's own scatter stays visible
    assert table.cpu_ratio.to_numpy() == pytest.approx([1.0, 0.5])


def test_without_common_seeds_both_scatter():
    one, other = pd.Series([0.40, 0.42], [1, 2]), pd.Series([0.38, 0.40, 0.42], [3, 4, 5])
    difference, error = compare(one, other)
    assert difference == pytest.approx(0.01)
    assert error == pytest.approx(np.sqrt(2e-4 / 2 + 4e-4 / 3))


def test_a_single_seed_is_no_study():
    with pytest.raises(ValueError, match="study made: 40 has one seed"):
        study_errors([packings({40: 0.0, 20: 0.003}, (10.0, 5.0), seeds=(1,))], [[{"varied": ["seed", "step"]}]])


def test_as_a_table_of_work_precision_the_noise_is_the_reference_s_error():
    table = packings({40: 0.0, 20: 0.003}, (10.0, 5.0))
    table.loc[4:, "n"] += [0.001, -0.001, 0.001, -0.001]
    errors = porosity_errors(table, ["seed", "step"])
    runs = work_precision_runs(errors, {"made": "Made"}, {"made": "20"})
    noise = np.sqrt(4e-6 / 3) / 2  # of four differences of ±0.001
    assert runs.reference_error.to_numpy() == pytest.approx([noise, noise])
    assert runs.error.to_numpy() == pytest.approx([noise, 0.003])
    assert runs.default.tolist() == [False, True]
    assert settings_table(runs).on_front.tolist() == [True, True]


def test_the_cheapest_settings_share_the_wished_error():
    """By hand: 0.006 + 0.002 fits into 0.01, 0.001 + 0.002 into 0.005, and within 0.002 only one may be coarse."""
    steps = porosity_errors(
        packings({40: 0.0, 20: 0.001, 10: -0.006}, (10.0, 5.0, 2.0), study="steps"), ["seed", "step"]
    )
    faces = porosity_errors(
        packings({300: 0.0, 100: 0.002, 50: 0.02}, (10.0, 8.0, 6.0), study="faces"), ["seed", "step"]
    )
    chosen = cheapest_settings(pd.concat([steps, faces]), wished=(0.01, 0.005, 0.002))
    assert chosen[["steps", "faces"]].to_numpy().tolist() == [["10", "100"], ["20", "100"], ["20", "300"]]
    assert chosen.cpu_ratio.to_numpy() == pytest.approx([0.16, 0.4, 0.5])
    assert chosen.error_bound.to_numpy() == pytest.approx([0.008, 0.003, 0.001])


def test_a_change_is_named_by_what_is_otherwise_than_in_the_first():
    table = packings({"bed": 0.0, "r22": 0.003}, (10.0, 5.0), seeds=(1, 2)).rename(columns={"step": "fill"})
    table["drop_height"] = [np.nan, np.nan, 0.1, 0.1]
    named = name_changes(table, ["seed", "fill", "drop_height"])
    assert list(named) == ["ours", "ours", "fill r22, drop_height 0.1", "fill r22, drop_height 0.1"]
    assert list(porosity_errors(table.assign(change=named), ["change"]).setting) == ["ours", named.iloc[-1]]


def test_a_setting_that_is_not_set_is_the_default():
    """A table read from a file has nan for it, and the plan has None."""
    rows = pd.DataFrame({"study": "s", "seed": [1, 2] * 2, "skin": [np.nan, np.nan, 0.1, 0.1], "n": 0.4, "cpu_s": 9.0})
    planned = [{"varied": {"skin": 0.1, "seed": 1}, "is_base": False}, {"varied": {"skin": None}, "is_base": True}]
    assert base_setting(planned) == porosity_errors(rows, ["skin", "seed"]).setting[0] == "not set"


def test_each_grain_has_its_own_reference():
    """The grains differ by more than the change, so only differences within a grain are counted."""
    parts = [
        packings({40: 0.0, 20: shift}, (10.0, 5.0)).assign(grain=name) for name, shift in (("a", 0.01), ("b", 0.02))
    ]
    parts[1]["n"] += 0.2
    whole = packings({"x": 0.0, "y": -0.004}, (10.0, 5.0), study="other")
    table = change_errors([pd.concat(parts, ignore_index=True), whole], [["seed", "step"], ["step", "seed"]])
    assert list(table.grain.fillna("")) == ["a", "a", "b", "b", "", ""]
    assert table.difference.to_numpy() == pytest.approx([0.0, 0.01, 0.0, 0.02, 0.0, -0.004])
    assert list(table.setting) == ["ours", "step 20", "ours", "step 20", "ours", "step y"]


def test_beds_of_other_sieve_curves_and_forms_are_no_changes():
    """A bed of one seed has a difference without an error, and a bed with one setting has nothing to compare."""
    u1 = packings({40: 0.0, 20: 0.003}, (10.0, 5.0), seeds=(1,)).assign(case="U1", mean_FL=0.5)
    u7 = packings({40: -0.08, 20: -0.07}, (10.0, 5.0)).assign(case="U7", mean_FL=0.5)
    flat = packings({40: 0.05}, (10.0,)).assign(case="U7", mean_FL=0.3)
    table = change_errors([pd.concat([u1, u7, flat], ignore_index=True)], [["seed", "mean_FL", "step"]])
    assert list(table.case) == ["U1", "U1", "U7", "U7"] and list(table.setting) == ["ours", "step 20"] * 2
    assert table.difference.to_numpy() == pytest.approx([0.0, 0.003, 0.0, 0.01])
    assert table.difference_std_error.isna().tolist() == [True, True, False, False]
    with pytest.raises(ValueError, match="made have one setting of each bed, so that there is no difference"):
        change_errors([flat], [["seed", "mean_FL", "step"]])


def test_the_errors_of_several_studies_have_their_own_defaults():
    steps = packings({40: 0.0, 20: 0.003}, (10.0, 5.0), study="steps")
    faces = packings({300: 0.0, 100: 0.001}, (9.0, 3.0), study="faces").rename(columns={"step": "faces"})
    rows = [
        [{"varied": {"seed": 1, "step": step}, "is_base": step == 20} for step in (40, 20)],
        [{"varied": {"seed": 1, "faces": count}, "is_base": count == 300} for count in (300, 100)],
    ]
    errors = study_errors([steps, faces], rows)
    assert list(errors.study) == ["steps"] * 2 + ["faces"] * 2 and list(errors.varied[::2]) == ["step", "faces"]
    runs = work_precision_of_studies(errors, ["steps", "faces"], {"steps": "Steps", "faces": "Faces"}, rows)
    assert dict(zip(runs.setting, runs.default, strict=True)) == {"40": False, "20": True, "300": True, "100": False}

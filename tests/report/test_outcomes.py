"""Sentences about the outcome of a study."""

import numpy as np
import pandas as pd
import pytest

from simcore.reference.columns import COLUMN_OF_KEY, setting_column
from simcore.reference.columns.headings import find_heading
from simcore.reference.r22_comparison import add_reference
from simcore.report.outcomes import outcome, shows_more


def table(**columns):
    return pd.DataFrame({"case": "U1", "runs": 1, "n_std_error": 0.004} | columns)


def test_a_comparison_with_the_experiment_counts_the_near_ones():
    rows = add_reference(table(case=["U1", "U3"], n=[0.384, 0.39], study="validation"), "validation")
    first, published, difference = outcome(rows)
    percent = 100 * (np.array([0.384 / 0.371, 0.39 / 0.356]) - 1)
    assert f"by +{percent[0]:.1f} to +{percent[1]:.1f} %; 1 of 2 sieve curves are within 5 %" in first
    assert "Rettinger et al." in published and "+3.3 to +3.8 %" in published
    assert "2 settings differ by +0.011 on average" in difference


def test_settings_and_not_curves_are_counted_if_another_setting_varies():
    rows = table(case=["U1", "U1", "U3", "U3"], friction=[0.1, 0.9] * 2, n=[0.30, 0.384, 0.30, 0.39])
    rows = add_reference(
        rows[["case", "friction", "runs", "n", "n_std_error"]].assign(study="validation"), "validation"
    )
    assert "1 of 4 settings are within 5 %" in outcome(rows)[0]


def test_one_value_of_the_publication_among_several_rows_names_its_setting():
    rows = table(width_m=[0.07, 0.1], mass_kg=[1.4, 4.0], n=[0.293, 0.293], difference=[np.nan, 0.002], z=[np.nan, 0.5])
    rows = rows[["case", "width_m", "mass_kg", "runs", "n", "n_std_error", "difference", "z"]]
    *_, last = outcome(rows)
    assert last == "The porosity for width 100 mm, mass 4 kg is +0.002 ± 0.004 from the value of Rettinger et al."
    assert outcome(rows[1:])[-1].startswith("This is +0.002 ± 0.004 from")


def test_forms_are_compared_at_equal_other_settings():
    """Form has no effect, and friction has one."""
    rows = table(friction=[0.1, 0.1, 0.9, 0.9], grain=["a", "b"] * 2, EQ=[0.8, 0.25] * 2, n=[0.3, 0.3, 0.4, 0.4])
    rows = rows[["case", "friction", "grain", "runs", "n", "n_std_error", "EQ"]]
    smooth, rough = outcome(rows)
    heading = find_heading("friction").words
    assert smooth.startswith(f"{heading[0].upper()}{heading[1:]} 0.1: the porosity rises from 0.300")
    assert "to 0.300" in smooth and rough.split(": ")[1].startswith("the porosity rises from 0.400")
    near = rows.drop(columns="grain").assign(flatness=[1.0, 0.8] * 2, elongation=[1.0, 0.8] * 2)
    near = near[["case", "friction", "flatness", "elongation", "runs", "n", "n_std_error"]]
    assert [text.split(":")[0] for text in outcome(near)] == [f"{heading} 0.1", f"{heading} 0.9"]


def test_an_end_of_a_sweep_without_porosity_is_left_out():
    rows = table(shaking_s=[0.5, 2.0, 6.0], n=[0.35, 0.33, np.nan])
    assert "nan" not in " ".join(outcome(rows)) and "changes by ," not in " ".join(outcome(rows))


@pytest.mark.parametrize(("end", "verdict"), [(0.30, "−0.050 ± 0.006, more than"), (0.345, "−0.005 ± 0.006, not more")])
def test_the_change_over_a_setting_is_compared_with_its_error(end, verdict):
    rows = table(shaking_s=[2.0, 0.5, 1.0], n=[end, 0.35, 0.2])
    (sentence,) = outcome(rows)
    assert sentence.startswith(f"U1: from 0.5 s of shaking to 2 s of shaking the porosity changes by {verdict}")


def test_a_sweep_without_sieve_curves_is_a_sentence():
    (sentence,) = outcome(table(shaking_s=[2.0, 0.5], n=[0.30, 0.35]).drop(columns="case"))
    assert sentence.startswith("From 0.5 s of shaking to 2 s of shaking the porosity changes by −0.050")


def test_words_among_numbers_come_last_and_widths_are_in_millimetres():
    (sentence,) = outcome(table(faces=["original", "50"], n=[0.38, 0.4]))
    assert "from 50 faces to original faces the porosity changes by −0.020" in sentence
    (sentence,) = outcome(table(width_m=[0.036, 0.06], n=[0.35, 0.37]))
    assert "from 36 mm to 60 mm" in sentence


def test_a_sweep_over_which_another_setting_varies_is_the_mean_of_its_changes():
    """Shaking has no effect; the rows with the least and the greatest friction differ by 0.07."""
    rows = table(shaking_s=[1.0, 6.0, 1.0, 6.0], friction=[0.1, 0.1, 0.9, 0.9], n=[0.33, 0.33, 0.40, 0.40])
    (sentence,) = outcome(rows[["case", "shaking_s", "friction", "runs", "n", "n_std_error"]])
    assert "the porosity changes by 0.000 ± 0.004 on average over 2 settings of" in sentence
    assert sentence.endswith("not more than twice its standard error.")


def test_settings_that_vary_together_with_the_sweep_belong_to_it():
    """The mean form differs too, because the grains are drawn at random."""
    rows = table(width_m=[0.036, 0.06], mass_kg=[0.1, 0.4], n=[0.35, 0.37], EQ=[0.428, 0.434])
    (sentence,) = outcome(rows[["case", "width_m", "mass_kg", "runs", "n", "n_std_error", "EQ"]])
    assert sentence == (
        "U1: from 36 mm to 60 mm the porosity changes by +0.020 ± 0.006, more than twice its standard error."
    )


def test_without_standard_errors_there_is_no_verdict():
    (sentence,) = outcome(table(shaking_s=[1.0, 6.0], n=[0.36, 0.32], n_std_error=np.nan))
    assert sentence.endswith("the porosity changes by −0.040.")
    rows = table(friction_law=["a", "b"], n=[0.35, 0.38], n_std_error=np.nan)
    assert "twice" not in outcome(rows[["case", "friction_law", "runs", "n", "n_std_error"]])[0]


@pytest.mark.parametrize(("last", "verdict"), [(0.349, "errors explain the"), (0.38, "differ by more than chance")])
def test_many_settings_are_tested_together(last, verdict):
    """The greatest of many differences is often more than twice its error."""
    rows = table(friction_law=list("abcdefgh"), n=[0.34, 0.351, 0.345, 0.344, 0.346, 0.347, 0.343, last])
    (sentence,) = outcome(rows[["case", "friction_law", "runs", "n", "n_std_error"]])
    assert "among the 8 settings" in sentence and verdict in sentence


def test_sieve_curves_are_not_compared_with_spheres_of_another_one():
    rows = table(case=["U1", "U1", "U7", "U7"], n=[0.36, 0.3599, 0.30, 0.31])
    rows = rows.assign(flatness=[1.0, 0.5, 0.8, 0.9], elongation=[1.0, 1.0, 0.8, 0.9])
    lowest, spheres, other = outcome(rows)
    assert lowest.startswith("U1: the porosity is lowest for L/S = 2.0") and other.startswith("U7: the porosity is")
    assert spheres.endswith("which is 0.000 ± 0.006 more, not more than twice its standard error.")


def test_the_densest_form_near_the_sphere_is_named():
    rows = table(shape_kind=["sphere", "ellipsoid", "ellipsoid"], n=[0.36, 0.32, 0.33])
    rows = rows.assign(flatness=[1.0, 0.8, 0.7], elongation=[1.0, 0.8, 0.7])
    lowest, spheres = outcome(rows)
    assert "lowest for L/S = 1.6: 0.320 ± 0.004" in lowest and "0.040 ± 0.006 more, more than twice its" in spheres
    (alone,) = outcome(rows[1:2])
    assert alone == "The porosity for L/S = 1.6 is 0.320 ± 0.004."


def test_forms_have_the_range_of_each_source_and_the_difference_to_the_published_model():
    rows = table(grain=["a", "b"] * 2, source=["scans"] * 2 + ["synthetic"] * 2, n=[0.3, 0.4, 0.31, 0.39])
    rows = rows.assign(EQ=[0.8, 0.25] * 2, difference=[0.01, -0.01, 0.01, -0.01])
    scans, _, difference = outcome(rows)
    assert scans.startswith("Scanned grains: the porosity rises from 0.300 ± 0.004 (L/S = 1.2) to 0.400")
    assert "4 settings differ by 0.000 on average and by 0.010 root mean square" in difference


def test_polyhedra_are_compared_with_their_ellipsoids():
    pairs = pd.DataFrame({"case": "U1", "n_mesh": [0.36, 0.33, 0.36], "n_ellipsoid": [0.35, 0.33, 0.34]})
    (sentence,) = outcome(pairs)
    assert "+0.010 ± 0.006 on average over 3 forms; polyhedra are looser for 2 of them" in sentence


def test_any_other_study_has_its_range_with_its_settings_and_one_setting_its_value():
    rows = table(friction_law=["a", "b"], n=[0.35, 0.38])[["case", "friction_law", "runs", "n", "n_std_error"]]
    (sentence,) = outcome(rows)
    assert "between 0.350 ± 0.004 (law of friction a) and 0.380 ± 0.004 (law of friction b)" in sentence
    assert "the difference is 0.030 ± 0.006, more than twice its standard error." in sentence
    assert outcome(rows[:1]) == ["The porosity is 0.350 ± 0.004."]
    assert outcome(rows.assign(n=np.nan)) == ["The table has no porosities."]
    assert not shows_more(rows) and shows_more(pd.concat([rows, rows]))


def test_settings_without_a_column_have_their_unit_and_a_default_is_named():
    rows = table(amplitude=[0.001, 0.002], n=[0.34, 0.38])[["case", "amplitude", "runs", "n", "n_std_error"]]
    assert "(amplitude 0.002 m)" in " ".join(outcome(rows))
    assert setting_column("amplitude").unit == "m" and setting_column("amplitude").meaning
    assert setting_column("std") is None, "several keys end so"
    rows = table(spacing=[np.nan, 0.008], n=[0.34, 0.38])[["case", "spacing", "runs", "n", "n_std_error"]]
    words = find_heading("spacing").words
    three = table(spacing=[np.nan, 0.008, 0.010], n=[0.34, 0.36, 0.38])[["case", "spacing", "runs", "n", "n_std_error"]]
    assert f"({words} by default)" in " ".join(outcome(three)) and "()" not in " ".join(outcome(three))
    forms = table(
        spacing=[np.nan, np.nan, 0.008, 0.008], grain=["a", "b"] * 2, EQ=[0.8, 0.25] * 2, n=[0.3, 0.3, 0.4, 0.4]
    )
    assert "nan" not in " ".join(outcome(forms[["case", "spacing", "grain", "runs", "n", "n_std_error", "EQ"]]))
    (text,) = outcome(rows)
    assert f"({words} by default)" in text and f"({words} 8 mm)" in text


def test_a_box_and_a_cylinder_are_domains():
    rows = table(domain_type=["periodic", "cylinder"], n=[0.34, 0.38])
    text = " ".join(outcome(rows[["case", "domain_type", "runs", "n", "n_std_error"]]))
    assert "domain periodic" in text and "domain cylinder" in text
    assert COLUMN_OF_KEY["domain.type"] == "domain_type"


def test_a_curve_of_the_study_itself_is_not_named_own():
    rows = table(case="own", shaking_s=[0.0, 1.0], n=[0.38, 0.34])[["case", "shaking_s", "runs", "n", "n_std_error"]]
    assert outcome(rows)[0].startswith("From 0 s of shaking to 1 s of shaking")

"""Tables as the page shows them."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.form import FORM_FACTORS
from simcore.models.feature_words import feature_in_words
from simcore.reference.columns import campaign, models, page, studies
from simcore.reference.columns.headings import ERRORS, HEADINGS
from simcore.report.tables import show_table
from simcore.report.words import formula_markup, value_in_words

# No table of the page has these columns, or a pattern describes their names.
NOT_SHOWN = {
    "note",
    "code",
    "evaluation",
    "table",
    "command",
    "machine",
    "settings",
    "grain_set",
    "with_term",
    "covariance",
    "hull_ratio",
    "sphericity",
}


def texts(shown, name):
    (place,) = [k for k, column in enumerate(shown.columns) if column.name == name]
    return [row[place].text for row in shown.rows]


def test_each_column_of_the_page_has_a_heading_in_words():
    groups = (studies.COLUMNS, campaign.COST, campaign.LEDGERS, campaign.BIASES, campaign.GRAINS, models.MODELS)
    groups += (models.APPLICATION, models.MEAN_FORM, page.PAGE)
    names = {column.name for group in groups for column in group if not column.name.endswith(("_mm", "_mm3", "*"))}
    assert names - set(HEADINGS) - set(FORM_FACTORS) <= NOT_SHOWN
    assert all("_" not in heading.words for heading in HEADINGS.values())
    assert set(ERRORS) | set(ERRORS.values()) <= set(HEADINGS)


def test_a_number_is_rounded_to_its_error_and_both_are_in_one_cell():
    rows = pd.DataFrame({"case": ["U1", "U7"], "n": [0.39843, 0.3761], "n_std_error": [0.00457, np.nan]})
    shown = show_table(rows, "tables/validation")
    assert [column.name for column in shown.columns] == ["case", "n"]
    assert texts(shown, "n") == ["0.398 ± 0.005", "0.376"]
    assert [row[1].key for row in shown.rows] == ["0.39843", "0.3761"], "columns are sorted by all digits"
    assert "after ±: sampling error of the porosity" in shown.columns[1].meaning


def test_meanings_have_headings_instead_of_names():
    rows = pd.DataFrame({"difference": [0.1, 0.2], "unified_abs_error": [0.1, 0.2]})
    meanings = [column.meaning for column in show_table(rows, "models/application").columns]
    assert meanings[0] == "the porosity minus porosity, Rettinger et al."
    assert meanings[1] == "absolute difference of porosity, unified model to simulated"


def test_the_error_of_a_difference_follows_from_z():
    shown = show_table(pd.DataFrame({"difference": [0.0154, -0.0286], "z": [3.2, -2.5]}), "tables/validation")
    assert texts(shown, "difference") == ["+0.015 ± 0.005", "−0.029 ± 0.011"]
    assert texts(shown, "z") == ["+3.2", "−2.5"]


def test_lengths_are_in_millimetres_and_angles_in_degrees():
    shown = show_table(pd.DataFrame({"width_m": [0.036, 0.06], "n": 0.36}), "tables/domain_size")
    assert texts(shown, "width_m") == ["36", "60"] and shown.columns[0].unit == "mm"
    shown = show_table(pd.DataFrame({"quantity": ["angle"], "isotropic": [1.0]}), "campaign/trends")
    assert texts(shown, "isotropic") == ["57.3"] and shown.columns[1].unit == "°"
    assert texts(shown, "quantity") == ["angle of the long axis"]


def test_what_is_the_same_in_all_rows_is_said_once():
    rows = pd.DataFrame({"study": "s", "case": "U1", "runs": 1, "seed": [1, 2], "n": 0.36, "r22_n": np.nan})
    shown = show_table(rows, "tables/s")
    assert [column.name for column in shown.columns] == ["seed", "n"]
    assert shown.same == [("sieve curve", "U1"), ("packings", "1")]
    assert show_table(rows[:1], "tables/s").same == []


def test_details_come_last_and_are_hidden_at_first():
    rows = pd.DataFrame({"grains": [1, 2], "n_exact": [0.3, 0.4], "n": [0.3, 0.4], "difference": [0.0, 0.1]})
    shown = show_table(rows, "tables/s")
    assert [(column.name, column.is_detail) for column in shown.columns] == [
        ("n", False),
        ("difference", False),
        ("grains", True),
        ("n_exact", True),
    ]
    # In tables without porosities these columns are results, not details.
    others = show_table(pd.DataFrame({"source": ["a", "b"], "sigma_FL": [0.1, 0.2], "cpu_h": [1.0, 2.0]}), "grains/x")
    assert not any(column.is_detail for column in others.columns)


def test_rounding_noise_is_no_component_and_large_numbers_are_short():
    rows = pd.DataFrame({"component": ["PC1", "PC13"], "explained": [0.56643, 4e-33], "ASF": [0.3172, 1e-14]})
    shown = show_table(rows, "grains/principal_components")
    assert [row[0].text for row in shown.rows] == ["PC1"] and texts(shown, "explained") == ["56.6"]
    assert shown.factors == [("ASF", "Aschenbrenner shape factor, L*S/I^2")] and texts(shown, "ASF") == ["+0.32"]
    assert texts(show_table(pd.DataFrame({"grain_steps": [5.56545e7]}), "campaign/cost"), "grain_steps") == ["5.57·10⁷"]


def test_a_feature_is_named_in_words_and_its_factors_are_explained():
    shown = show_table(pd.DataFrame({"feature": ["EQ_inv", "mu_1/JFF_inv"], "r": [0.9, 0.8]}), "models/x_correlations")
    assert texts(shown, "feature") == ["L/S", "1/(mean 1/JFF)"]
    assert ("JFF", "Janke form factor, S/sqrt((L^2+I^2+S^2)/3)") in shown.factors
    assert feature_in_words("sigma_EL_inv") == "1/std. dev. EL" and feature_in_words("intercept") == "intercept"


@pytest.mark.parametrize(
    ("column", "value", "words"),
    [
        ("choice", "form_distribution", "drawn from a distribution"),
        ("source", "[17]", "Rettinger et al., reference 17"),
        ("source", "paper Fig. 2", "Rettinger et al., Fig. 2"),
        ("measure", "facet_share_300", "share of the surface in the ten largest facets, at most 300 faces"),
        ("kept", True, "yes"),
        ("kind", "polyhedron", "polyhedra"),
        ("case", "U1", "U1"),
    ],
)
def test_values_of_text_columns_are_words(column, value, words):
    assert value_in_words(column, value) == words


def test_a_formula_has_indices_and_fractions():
    marked = formula_markup("n = 0.28 + 0.03 µ_EQ⁻¹ − 0.0521 (σ_EQ/µ_EQ)²")
    assert "0.03 / µ<sub>EQ</sub></span>" in marked and "(σ<sub>EQ</sub>/µ<sub>EQ</sub>)<sup>2</sup>" in marked
    assert marked.count('<span class="term">') == 3
    assert "&lt;b&gt;" in formula_markup("n = <b>") and formula_markup(None) == ""

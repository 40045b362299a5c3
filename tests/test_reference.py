"""The source study's values beside ours; expected values are read off its tables by hand."""

import numpy as np
import pandas as pd
import pytest

from simcore.reference import add_reference


def beside(study, **columns):
    return add_reference(pd.DataFrame(columns), study)


def test_faces_stand_for_at_most_so_many():
    table = beside("mesh_resolution", case=["U7", "B50", "U3"], faces=["original", 300, 300])
    assert table.study_n.tolist()[:2] == [0.309, 0.278]
    assert np.isnan(table.study_n[2])


def test_shaking_time_as_a_float():
    table = beside("shaking_cylinder", case=["U7", "B50"], shaking_s=[0.0, 3.0])
    assert table.study_n.tolist() == [0.323, 0.277]
    assert table.study_n_std.tolist() == [0.001, 0.004]


def test_a_setting_that_the_study_does_not_have_stays_empty():
    assert beside("shaking_periodic", case=["U7"], shaking_s=[0.5]).study_n.isna().all()
    assert beside("shaking_periodic", case=["U7"]).study_n.isna().all()
    assert beside("a_study_of_ones_own", case=["U1"]).study_n.isna().all()


def test_single_forms_take_the_fitted_model():
    """Eq. 17 for EQ = 0.5 and EL = 0.8: 0.278 + 0.019 / 0.5 + 0.014 / 0.8 = 0.3335."""
    form = {"EQ": [0.5, 0.5], "EL": [0.8, 0.8], "sigma_EQ": [0.0, 0.0], "sigma_EL": [0.0, 0.0]}
    table = beside("single_form", case=["U1", "own"], **form)
    assert table.study_n[0] == pytest.approx(0.3335)
    assert np.isnan(table.study_n[1])


def test_mixtures_take_the_fitted_model():
    """Eq. 24 at EQ 0.4 ± 0.1, EL 0.8 ± 0.2: 0.239 + 0.024/0.4 − 0.003/0.1 + 0.002/0.8 + 0.001/0.2 = 0.2765."""
    table = beside("form_mixtures", case=["U7"], EQ=[0.4], EL=[0.8], sigma_EQ=[0.1], sigma_EL=[0.2])
    assert table.study_n[0] == pytest.approx(0.2765)


def test_application_tells_drawn_from_continuous_forms():
    table = beside("application", case=["U1", "U7"], choice=["random", "form_distribution"])
    assert table.study_n.tolist() == [0.353, 0.288]

"""The sands of Beard and Weyl (1973): the data, log-normal curves, and the committed table."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.sorted_sands import (
    CUT,
    DATA,
    FROM_ABSTRACT,
    OTHER_CUTS,
    OURS,
    TABLE,
    deviation,
    log_normal,
    mean_ratios,
    one_class_of,
    predicted,
    read_sands,
    rms_errors,
    sands_figure,
    sands_table,
)
from simcore.models.packing_models.curves import log2_deviation, quantile
from simcore.models.size_and_form.candidates import predict
from simcore.paths import REFERENCE


def test_the_data_are_42_sands_of_seven_sizes_and_two_means():
    sands = read_sands()
    assert len(sands) == 42 and (sands.groupby("grain_size").size() == 6).all()
    np.testing.assert_allclose(sands["log_deviation"].unique(), [0.076, 0.219, 0.411, 0.830, 1.337, 2.246], atol=6e-4)
    data = pd.read_csv(REFERENCE / DATA)
    assert data["source"].str.contains("Beard and Weyl").all()
    # If the means of the abstract are those of eight sands, the omitted sand must be in the range of the others.
    for mean in data[data["grain_size"] == FROM_ABSTRACT].itertuples():
        others = sands.loc[sands["sorting"] == mean.sorting, "n"]
        assert others.min() - 0.02 < 8 * mean.n - others.sum() < others.max()


@pytest.mark.parametrize("trask_sorting", [1.05, 1.7, 4.2])
def test_a_log_normal_curve_has_its_sorting_and_its_width(trask_sorting):
    for size in (*OTHER_CUTS, CUT, 4.0):
        curve = log_normal(deviation(trask_sorting, size), size)
        quartiles = np.log(quantile(curve, 0.75) / quantile(curve, 0.25))
        assert 0.5 * quartiles == pytest.approx(np.log(trask_sorting), rel=0.04)  # classes of up to half a deviation
    assert log2_deviation(curve) * np.log(2) == pytest.approx(deviation(trask_sorting, 4.0), rel=0.04)
    cut = log_normal(deviation(trask_sorting))
    assert np.log(cut.largest / cut.least) == pytest.approx(4 * deviation(trask_sorting))
    assert np.exp(np.diff(np.log(cut.bounds))).max() <= 2 ** (1 / 8) + 1e-12


def test_the_best_sorted_sand_keeps_its_porosity():
    def porosity(curve, one_class):
        return predict("L", curve, one_class, {"m0": 1.0, "kappa": 0.0}, law="mass")

    curve = log_normal(0.3)
    assert porosity(curve, one_class_of(porosity, curve, 0.38)) == pytest.approx(0.38, abs=1e-8)
    assert np.isnan(one_class_of(porosity, curve, 0.7))  # no one-class porosity in its range gives this
    sands = read_sands().query("grain_size == 'lower fine'")
    n = predicted(porosity, sands)
    assert n[0] == pytest.approx(sands["n"].iloc[0], abs=1e-8) and (np.diff(n) < 0).all()


def test_what_a_model_refuses_has_no_number():
    def porosity(curve, one_class):
        if curve.largest > 1e-2:
            raise ValueError("too wide")
        return one_class

    sands = read_sands().query("grain_size == 'upper fine'")
    n = predicted(porosity, sands)
    assert np.isfinite(n[:4]).all() and np.isnan(n[-1])


def test_the_committed_table_is_that_of_today():
    """If this test fails, run python -m benchmarks.studies.sorted_sands --write."""
    today = sands_table((OURS, "linear"))
    today["outside"] = today["outside"].replace("", np.nan)
    pd.testing.assert_frame_equal(pd.read_csv(REFERENCE / TABLE)[list(today)], today, atol=1.5e-4, check_dtype=False)


def test_ratios_begin_at_one_and_the_figure_has_every_model():
    table = pd.read_csv(REFERENCE / TABLE)
    means = mean_ratios(table)
    np.testing.assert_allclose(means.iloc[0][["measured", *means.columns[3:]]].astype(float), 1.0, atol=5e-4)
    assert means["measured"].is_monotonic_decreasing and len(means) == 6
    ours = table["predicted_linear"] - table["n"]
    assert rms_errors(table)["linear"] == pytest.approx(
        np.sqrt((ours[table["sorting"] != "extremely well"] ** 2).mean())
    )
    labels = sands_figure(table).axes[0].get_legend_handles_labels()[1]
    assert len(labels) == len(means.columns[3:]) + 1

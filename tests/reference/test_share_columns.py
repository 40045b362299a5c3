"""Columns with the share of each sieve class: what is written is read as the same curve."""

import numpy as np
import pandas as pd

from simcore.reference.share_columns import realised_curve, share_columns


def test_the_curve_of_a_row_is_the_one_that_was_written():
    bounds = [(6.3e-5, 1e-3), (1e-3, 2.8e-3), (2.8e-3, 64e-3)]
    columns = share_columns(bounds, [0.1, 0.2, 0.7])
    assert columns == {"share_0.063-1mm": 0.1, "share_1-2.8mm": 0.2, "share_2.8-64mm": 0.7}
    curve = realised_curve(pd.Series({"case": "U1", "n": 0.3, **columns}), "c")
    assert curve.name == "c"
    np.testing.assert_allclose(curve.bounds, [6.3e-5, 1e-3, 2.8e-3, 64e-3], rtol=1e-12)
    np.testing.assert_allclose(curve.mass_fractions, [0.1, 0.2, 0.7], rtol=1e-12)


def test_shares_that_were_rounded_are_divided_by_their_sum():
    row = pd.Series({"share_1-2mm": 0.2, "share_2-4mm": 0.6})
    np.testing.assert_allclose(realised_curve(row, "c").mass_fractions, [0.25, 0.75])

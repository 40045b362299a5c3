"""The model of size and form that `predict --sieve` uses: a candidate, its parameters and its errors.

As long as no candidate is fitted to beds of many curves, it is candidate H with no effect of form on size ratios and
the compaction index of de Larrard for poured grains, 4.1. Of the candidates without fitted parameters it has the
smallest error over SETS (benchmarks.studies.size_and_form_validation), and that error is stated: on six gravels with
wide curves that Rettinger et al. (2022) measured, and on our packings of them, from the porosity of the seventh, U1.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.known_beds import MEASURED, PACKED, known_beds
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY
from simcore.paths import REFERENCE
from simcore.scene.sizes import all_cases

SETS = (MEASURED, PACKED)  # beds whose errors the model states
CANDIDATE, UNFITTED = "H", {"K": 4.1, "m0": 1.0, "kappa": 0.0}
OF_FORM = ("U7", "B50")  # cases for which Rettinger et al. published models of single forms


class SizedModel(NamedTuple):
    """A model of size and form with its errors.

    error: standard error of the decrease of porosity from one class to the curve, relative to the decrease; freedom:
    its degrees of freedom. form_error: largest part of the effect of form that the model may carry over wrongly, per
    relative decrease of porosity by the sizes. widest: largest ratio of sieve sizes for which errors are known.
    """

    candidate: str
    parameters: dict
    law: str  # how mass is distributed within a sieve class, see simcore.models.packing_models.curves
    error: float
    freedom: int
    form_error: float
    widest: float
    behind: str  # what the errors rest on

    def predict(self, curve, one_class, forms=None):
        """Return the porosity of beds with this SieveCurve; arguments as in size_and_form.candidates.predict."""
        return predict(self.candidate, curve, one_class, self.parameters, forms, self.law)


@cache
def unfitted_model() -> SizedModel:
    """Return the candidate without fitted parameters, with its errors on measured gravels and on packings of them."""
    beds = known_beds()
    beds = beds[beds["set"].isin(SETS)]
    curves = {case: all_cases()[case].curve for case in beds["case"]}
    predicted = [
        predict(CANDIDATE, curves[bed.case], bed.n_one_class, UNFITTED, law="mass") for bed in beds.itertuples()
    ]
    errors, decreases = np.array(predicted) - beds["n"], beds["n_one_class"] - beds["n"]
    return SizedModel(
        candidate=CANDIDATE,
        parameters=UNFITTED,
        law="mass",
        error=float(np.sqrt(np.mean(errors**2) / np.mean(decreases**2))),
        freedom=len(beds),
        form_error=_form_error(curves),
        widest=max(curve.largest / curve.least for curve in curves.values()),
        behind=f"no parameter is fitted; its error is that on {len(beds)} beds of known porosity.",
    )


def _form_error(curves):
    """Return how much more of the effect of form it carries over than the published models, per relative decrease.

    Both slopes are over the 63 synthetic forms, in size_models_measured.csv.
    """
    slopes = pd.read_csv(REFERENCE / "size_models_measured.csv")
    ours = slopes[(slopes["model"] == f"candidate {CANDIDATE} without stretch") & (slopes["K"] == UNFITTED["K"])].iloc[
        0
    ]
    published = slopes[slopes["model"] == "single forms of Rettinger et al."].iloc[0]
    ratios = []
    for case in OF_FORM:
        decrease = 1.0 - predict(CANDIDATE, curves[case], REFERENCE_POROSITY, UNFITTED, law="mass") / REFERENCE_POROSITY
        ratios.append((ours[f"slope_{case}"] - published[f"slope_{case}"]) / decrease)
    return float(np.mean(ratios))

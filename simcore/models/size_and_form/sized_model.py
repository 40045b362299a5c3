"""The model of size and form that `predict --sieve` uses: a candidate, its parameters and its errors.

It is the candidate that is chosen on packed beds of many curves (results/reference/models/size_and_form_*.csv), as soon
as these meet the conditions of docs/appendices/size_and_form_plan.md. Its stated error is that on beds which are
predicted without their family of curves.

Until then it is candidate H with no effect of form on size ratios and the compaction index 4.1, which is attributed to
de Larrard (1999) for poured grains; it was not read in the publication. Of the candidates without fitted parameters it
has the smallest error over SETS (benchmarks.studies.size_and_form_validation), and that error is stated: on six gravels
with wide curves that Rettinger et al. (2022) measured, and on our packings of them, from the porosity of the seventh,
U1.
"""

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.models.packing_models.curves import span
from simcore.models.packing_models.literature import POURED_COMPACTION
from simcore.models.size_and_form.candidates import CANDIDATES, predict
from simcore.models.size_and_form.known_beds import MEASURED, OF_ONE_FORM, PACKED, known_beds
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY
from simcore.paths import REFERENCE
from simcore.scene.sizes import all_cases

SETS = (MEASURED, PACKED)  # beds whose errors the model states
CANDIDATE, UNFITTED = "H", {"K": POURED_COMPACTION, "m0": 1.0, "kappa": 0.0}
NOT_FITTED = f"{CANDIDATE}, not fitted"  # its name in the table of candidates
ANY = 1e9  # limit of a ratio that is not limited
SINGLE_FORMS_OF_R22 = "single forms of Rettinger et al."  # in size_models_measured.csv
ENDS = (0.32, 0.38)  # one-class porosities between which the effect of form is compared, about that of the 63 forms
# Families of sieve curves of config/curves.tsv and config/cases.tsv, without that of the bases
WIDE_FAMILIES = {"binary_2_to_3", "binary_4_to_8", "log_normal", "two_modes", "fractal", "skewed_and_gap"}


class SizedModel(NamedTuple):
    """A model of size and form with its errors.

    error: standard error of the decrease of porosity from one class to the curve, relative to the decrease; freedom:
    its degrees of freedom. form_error: largest part of the effect of form that the model may carry over wrongly, per
    relative decrease of porosity by the sizes. widest, gap: largest `span` and `gap` of sieve curves for which errors
    are known; one_class: least and largest one-class porosity of these beds.
    """

    candidate: str
    parameters: dict
    law: str  # how mass is distributed within a sieve class, see simcore.models.packing_models.curves
    error: float
    freedom: int
    form_error: float
    widest: float
    behind: str  # what the errors rest on
    gap: float = ANY  # unknown in files of earlier versions, as one_class
    one_class: tuple = (0.0, 1.0)

    def predict(self, curve, one_class, forms=None, reference=REFERENCE_POROSITY):
        """Return the porosity of beds with this SieveCurve; arguments as in size_and_form.candidates.predict."""
        return predict(self.candidate, curve, one_class, self.parameters, forms, self.law, reference)


@cache
def current_model(folder=REFERENCE) -> SizedModel:
    """Return the fitted model if its tables meet the conditions of the plan, else the unfitted one."""
    return fitted_model(folder) or unfitted_model()


def fitted_model(folder=REFERENCE) -> SizedModel | None:
    """Return the candidate that the tables size_and_form_*.csv in models/ of this folder choose.

    None without these tables, if a family of wide curves has no bed in them, if candidate H without fitted parameters
    has the smaller error, or if a model of the literature is chosen.
    """
    tables = Path(folder) / "models"
    if not (tables / "size_and_form_candidates.csv").exists():
        return None
    candidates, beds, parameters = (
        pd.read_csv(tables / f"size_and_form_{name}.csv") for name in ("candidates", "beds", "parameters")
    )
    if WIDE_FAMILIES - set(beds["family"]):
        return None
    chosen = candidates[candidates["chosen"] == "yes"].iloc[0]
    unfitted = candidates[candidates["model"] == NOT_FITTED].iloc[0]
    name = chosen["model"]
    if name not in CANDIDATES or chosen["error_by_family"] >= unfitted["error_by_family"]:
        return None
    values = parameters[parameters["model"] == name]
    values = dict(zip(values["parameter"], values["value"].astype(float), strict=True))
    families = beds["family"].nunique()
    return SizedModel(
        candidate=name,
        parameters=values,
        law="mass",
        error=relative_error(beds[f"predicted_{name}"], beds["n"], beds["n_one_class"]),
        freedom=families - 1,
        form_error=_form_error(name, values),
        widest=float(beds["widest"].max()),
        behind=f"fitted to {len(beds)} packed beds of {families} families of sieve curves.",
        gap=float(beds["gap"].max()),
        one_class=(float(beds["n_one_class"].min()), float(beds["n_one_class"].max())),
    )


def relative_error(predicted, n, one_class) -> float:
    """Return the root mean square error of predictions, relative to that of the decrease of porosity by the sizes.

    predicted, n, one_class: arrays (beds,) of predicted, known and one-class porosity.
    """
    return float(np.sqrt(np.mean(np.square(predicted - n)) / np.mean(np.square(one_class - n))))


@cache
def unfitted_model() -> SizedModel:
    """Return the candidate without fitted parameters, with its errors on measured gravels and on packings of them."""
    beds = known_beds()
    beds = beds[beds["set"].isin(SETS)]
    curves = {case: all_cases()[case].curve for case in beds["case"]}
    predicted = [
        predict(CANDIDATE, curves[bed.case], bed.n_one_class, UNFITTED, law="mass") for bed in beds.itertuples()
    ]
    return SizedModel(
        candidate=CANDIDATE,
        parameters=UNFITTED,
        law="mass",
        error=relative_error(np.array(predicted), beds["n"], beds["n_one_class"]),
        freedom=len(beds),
        form_error=_form_error(CANDIDATE, UNFITTED),
        widest=max(span(curve) for curve in curves.values()),
        behind=f"no parameter is fitted; its error is that on {len(beds)} beds of known porosity.",
    )


def _form_error(candidate, parameters):
    """Return by how much the effect of form that it carries over differs from published ones, per relative decrease.

    Slopes are those of the porosity of a curve against that of one class; the published ones are over the 63 synthetic
    forms, in size_models_measured.csv. The larger difference of U7 and B50 counts.
    """
    table = pd.read_csv(REFERENCE / "size_models_measured.csv")
    published = table[table["model"] == SINGLE_FORMS_OF_R22].iloc[0]
    ratios = []
    for case in OF_ONE_FORM:
        dense, loose, mean = (
            predict(candidate, all_cases()[case].curve, one_class, parameters, law="mass")
            for one_class in (*ENDS, REFERENCE_POROSITY)
        )
        slope, decrease = (loose - dense) / (ENDS[1] - ENDS[0]), 1.0 - mean / REFERENCE_POROSITY
        ratios.append((slope - published[f"slope_{case}"]) / decrease)
    return float(np.max(np.abs(ratios)))

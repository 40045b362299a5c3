"""What the page needs to predict the porosity of a sieve curve that its user gives, as plain data for JSON."""

from dataclasses import asdict

import pandas as pd

from simcore.evaluation.confidence import student_quantile
from simcore.grains.class_labels import BELOW, NO_PHI, class_patterns
from simcore.grains.sieve_table import table_rules
from simcore.models.packing_models.curves import IN_GAP, TAIL, WIDEST
from simcore.models.packing_models.empirical import PREDICTORS
from simcore.models.packing_models.literature import LITERATURE, VIBRATED_COMPACTION
from simcore.models.packing_models.rods import LARGEST_FACTOR, RODS, SMALLEST_FACTOR
from simcore.models.size_and_form import skeletons
from simcore.models.size_and_form.bed_prediction import (
    ABOVE,
    COLUMNS,
    MORE_MASS,
    STICKY,
    STICKY_SHARE,
    TOO_LOW,
    TOO_WIDE,
    WIDE_CLASS,
    WIDE_SHARE,
    rhine_sample,
    states,
)
from simcore.models.size_and_form.bed_prediction_text import CHECK_BY_CLASS, MORE_OUTSIDE, OTHER_BEDS, STATE
from simcore.models.size_and_form.candidates import CANDIDATES, FIXED_Q
from simcore.models.size_and_form.forms_by_class import BY_CLASS
from simcore.models.size_and_form.one_class import LARGEST, LEAST
from simcore.models.size_and_form.sized_model import current_model
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY
from simcore.packing import sieve_specification
from simcore.packing.forecast import BY_SPREAD, LARGEST_SOLID, ONE_CLASS
from simcore.paths import REFERENCE

COMPRESSIBLE, LINEAR, RODS_ON_A_LINE = "compressible", "linear", "rods"
# Candidates that simcore/page/static/skeletons.js evaluates: skeleton, and whether the effect of form is damped.
PORTED = {
    "H": (COMPRESSIBLE, False),
    "H_free": (COMPRESSIBLE, False),
    "L": (LINEAR, False),
    "L_free": (LINEAR, False),
    "F": (RODS_ON_A_LINE, False),
    "D_H": (COMPRESSIBLE, True),
    "D_F": (RODS_ON_A_LINE, True),
}


def curve_data(levels, model=None):
    """Return the model of size and form and what it needs, dict of plain values.

    levels: probabilities of the prediction intervals. model: SizedModel; None: the current one. ValueError if the page
    has no port of its candidate.
    """
    model = model or current_model()
    return {
        "classes": class_patterns() | {"below": BELOW, "no_phi": NO_PHI, "by_class": BY_CLASS, "check": CHECK_BY_CLASS},
        "state": STATE,
        "other_beds": OTHER_BEDS,
        "more_outside": MORE_OUTSIDE,
        "model": model_data(model, levels),
        "reference": {
            "bounds": [1e3 * float(bound) for bound in skeletons.REFERENCE.bounds],
            "mass_fractions": skeletons.REFERENCE.mass_fractions.tolist(),
            "porosity": REFERENCE_POROSITY,
        },
        "one_class": {"least": LEAST, "largest": LARGEST},
        "parts": WIDEST,
        "fixed_q": FIXED_Q,
        "rods": {"number": RODS, "smallest": SMALLEST_FACTOR, "largest": LARGEST_FACTOR},
        "compaction": VIBRATED_COMPACTION,
        "more_mass": MORE_MASS,
        "tail": TAIL,
        "in_gap": IN_GAP,
        "above": ABOVE,
        "sticky": 1e3 * STICKY,
        "sticky_share": STICKY_SHARE,
        "too_wide": TOO_WIDE,
        "too_low": TOO_LOW,
        "wide_class": WIDE_CLASS,
        "wide_share": WIDE_SHARE,
        "states": states()._asdict(),
        "rhine": asdict(rhine_sample()),
        "columns": COLUMNS,
        "predictors": [predictor.name for predictor in PREDICTORS],
        "rms": _measured_errors(),
        "reading": table_rules(),
        "specification": {
            "density": sieve_specification.DENSITY,
            "width": sieve_specification.WIDTH,
            "height": sieve_specification.HEIGHT,
            "domain": sieve_specification.DOMAIN,
            "least_domain": sieve_specification.LEAST_DOMAIN,
            "faces": sieve_specification.FACES,
            "speed": sieve_specification.SPEED,
            "process": sieve_specification.PROCESS,
            "largest_grains": sieve_specification.LARGEST_GRAINS,
            "many": sieve_specification.MANY,
            "too_many": sieve_specification.TOO_MANY,
            "solid": ONE_CLASS,
            "by_spread": BY_SPREAD,
            "largest_solid": LARGEST_SOLID,
        },
    }


def _measured_errors():
    """Return the root mean square error of LITERATURE and PREDICTORS on six measured gravels, dict by name."""
    rows = pd.read_csv(REFERENCE / "size_models_measured.csv").query("classes == 'one size' or given == 'curve'")
    names = rows["model"] + rows["K"].map(lambda K: "" if pd.isna(K) else f", K = {K:g}")
    errors = dict(zip(names, rows["rms_error"].astype(float), strict=True))
    return {name: errors[name] for name in [*LITERATURE, *(predictor.name for predictor in PREDICTORS)]}


def model_data(model, levels):
    """Return a SizedModel with Student's t at each of the levels; ValueError if its candidate has no port."""
    if model.candidate not in PORTED:
        raise ValueError(
            f"scree page: the model of size and form is candidate {model.candidate}, which simcore/page/static/"
            f"skeletons.js does not evaluate; add it there and to PORTED, or choose one of {', '.join(PORTED)}"
        )
    skeleton, damped = PORTED[model.candidate]
    candidate = CANDIDATES[model.candidate]
    start = {key: parameter.start for key, parameter in candidate.parameters.items()}
    nodes, logs = skeletons.rods_factors() if skeleton == RODS_ON_A_LINE else ((), ())
    return {
        "candidate": model.candidate,
        "title": candidate.title,
        "skeleton": skeleton,
        "damped": damped,
        "parameters": start | model.parameters,
        "factors": [list(map(float, nodes)), list(map(float, logs))],
        "law": model.law,
        "error": model.error,
        "form_error": model.form_error,
        "widest": model.widest,
        "gap": model.gap,
        "one_class": list(model.one_class),
        "behind": model.behind,
        "quantiles": {f"{level:g}": student_quantile(level, model.freedom) for level in levels},
    }

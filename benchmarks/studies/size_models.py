"""Packing models and river predictors on the seven measured gravels of Rettinger et al. (2022), nothing fitted.

    python -m benchmarks.studies.size_models
    python -m benchmarks.studies.size_models --write   # into results/reference/size_models_measured.csv

A packing model gets the measured porosity of U1 as its one-class porosity and predicts the six others; a river
predictor gets the sieve curve alone. Each row has, for one model: its name, the compaction index K if it has one, its
input, how a sieve class enters ("one size": its geometric mean, as the models are published; "divided": parts with mass
uniform in log D, calibrated so that U1 has its porosity), predicted minus measured porosity of each gravel, and the
root mean square of the errors of U3 to B70. K has three values, none of them chosen by these gravels, and the stretch
of log size of the candidates is 1.

slope_U7 and slope_B50 are the change of the porosity of that curve over the change of the one-class porosity, from 0.32
to 0.38: how much of the effect of form a model carries over to wide curves. The last row has what the models of
Rettinger et al. for beds of one form give over our 63 synthetic forms, by linear regression. It takes seconds.
"""

import argparse

import numpy as np
import pandas as pd

from simcore.grains.sieve import read_cases
from simcore.models.packing_models.compressible import compressible
from simcore.models.packing_models.empirical import PREDICTORS
from simcore.models.packing_models.linear import filling, linear, occupying
from simcore.models.packing_models.linear_mixture import linear_mixture
from simcore.models.packing_models.literature import POURED_COMPACTION, VIBRATED_COMPACTION, one_size
from simcore.models.packing_models.rods import rods
from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.known_beds import OF_ONE_FORM, known_forms
from simcore.models.size_and_form.sized_model import ENDS, SINGLE_FORMS_OF_R22
from simcore.paths import CONFIG, REFERENCE
from simcore.reference.r22_tables import read_r22_table

BASE = "U1"
INDICES = (POURED_COMPACTION, VIBRATED_COMPACTION, 9.0)
TABLE = "size_models_measured.csv"
FLAT = (filling, occupying)


def measured():
    """Return the SieveCurves and the measured porosities of the gravels, two dicts by name."""
    table = read_r22_table("table3_cases").set_index("case")["n_exp"]
    cases = read_cases(CONFIG / "cases.tsv")
    return {name: cases[name].curve for name in table.index}, table.to_dict()


def divided(candidate, **parameters):
    """Return predict(curve, one_class) of a candidate without stretch, with mass uniform in log D in a class."""
    values = {"m0": 1.0, "kappa": 0.0} | parameters
    return lambda curve, one_class: predict(candidate, curve, one_class, values, law="mass")


def packing_models():
    """Return the rows of the packing models: (name, K or None, classes, predict)."""
    return [
        ("linear", None, "one size", one_size(linear)),
        ("linear mixture", None, "one size", one_size(linear_mixture)),
        *[("compressible", K, "one size", one_size(_at(compressible, K))) for K in INDICES],
        *[
            ("compressible with f and g of linear", K, "one size", one_size(_at(compressible, K, FLAT)))
            for K in INDICES
        ],
        ("rods", None, "one size", one_size(rods)),
        ("candidate L without stretch", None, "divided", divided("L")),
        *[("candidate H without stretch", K, "divided", divided("H", K=K)) for K in INDICES],
        ("candidate F without stretch", None, "divided", divided("F")),
    ]


def _at(model, K, functions=None):
    options = {} if functions is None else {"functions": functions}
    return lambda sizes, fractions, porosity: model(sizes, fractions, porosity, K, **options)


def size_models_table():
    """Return one row per model: model, K, given, classes, error_U1 to error_B70, rms_error (of U3 to B70), slopes."""
    curves, porosities = measured()
    rows = []
    for model, K, classes, porosity in packing_models():
        errors = {name: porosity(curves[name], porosities[BASE]) - n for name, n in porosities.items()}
        row = {"model": model, "K": K, "given": f"curve and porosity of {BASE}", "classes": classes} | _named(errors)
        for name in OF_ONE_FORM:
            dense, loose = (porosity(curves[name], n1) for n1 in ENDS)
            row[f"slope_{name}"] = (loose - dense) / (ENDS[1] - ENDS[0])
        rows.append(row)
    for predictor in PREDICTORS:
        errors = {name: predictor.porosity(curves[name]) - n for name, n in porosities.items()}
        rows.append({"model": predictor.name, "given": "curve", "classes": "divided"} | _named(errors))
    rows.append({"model": SINGLE_FORMS_OF_R22, "given": "form", **single_form_slopes()})
    return pd.DataFrame(rows).round(4)


def single_form_slopes():
    """Return the slopes of the published porosities of U7 and B50 against those of U1, over our 63 synthetic forms."""
    n = known_forms()
    return {f"slope_{case}": np.polyfit(n["n_one_class"], n[f"n_{case}"], 1)[0] for case in OF_ONE_FORM}


def _named(errors):
    others = [error for name, error in errors.items() if name != BASE]
    columns = {f"error_{name}": 0.0 if abs(error) < 5e-5 else error for name, error in errors.items()}
    return columns | {"rms_error": np.sqrt(np.mean(np.square(others)))}


def main(arguments=None) -> None:
    """Print the table, or write it with --write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"write results/reference/{TABLE}")
    table = size_models_table()
    if parser.parse_args(arguments).write:
        table.to_csv(REFERENCE / TABLE, index=False, lineterminator="\n", float_format="%.4g")
    else:
        print(table.to_string(index=False, float_format="%.4f", na_rep=""))


if __name__ == "__main__":
    main()

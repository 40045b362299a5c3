"""The model of size and form on beds whose porosity is known; nothing is fitted to them.

    python -m benchmarks.studies.size_and_form_validation            # prints the table
    python -m benchmarks.studies.size_and_form_validation --write    # into results/reference/size_and_form_known.csv

Each bed is predicted from its sieve curve and the porosity of U1 of the same set (simcore.models.size_and_form.
known_beds), by the candidates without fitted parameters, of which `predict --sieve` uses the one with the smallest
error over the sets `measured` and `packed`, and by the packing models of the literature. At the end it prints the root
mean square error of each set. Seconds.
"""

import argparse

import numpy as np
import pandas as pd

from simcore.models.packing_models.literature import LITERATURE
from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.known_beds import known_beds
from simcore.models.size_and_form.sized_model import unfitted_model
from simcore.paths import REFERENCE
from simcore.scene.sizes import all_cases

TABLE = "size_and_form_known.csv"
OURS = "size and form"
# Other candidates without fitted parameters: name, parameters.
OTHERS = {"L": ("L", {}), "F": ("F", {}), "H, K = 4.75": ("H", {"K": 4.75}), "H, K = 9": ("H", {"K": 9.0})}


def known_table():
    """Return the known beds with `predicted` and, by each model, predicted minus known porosity (`error_<model>`)."""
    beds, model = known_beds(), unfitted_model()
    curves = [all_cases()[case].curve for case in beds["case"]]
    models = {OURS: model.predict} | {name: _unfitted(*others) for name, others in OTHERS.items()} | LITERATURE
    errors = {
        f"error_{name}": [
            float(porosity(curve, n1)) - n for curve, n1, n in zip(curves, beds["n_one_class"], beds["n"], strict=True)
        ]
        for name, porosity in models.items()
    }
    table = beds.assign(predicted=beds["n"] + errors[f"error_{OURS}"], **errors)
    return table.round(4)


def _unfitted(name, parameters):
    return lambda curve, n1: predict(name, curve, n1, parameters | {"m0": 1.0, "kappa": 0.0}, law="mass")


def rms_errors(table):
    """Return the root mean square error of each model over each set, one row per set."""
    columns = [name for name in table if name.startswith("error_")]
    return table.groupby("set", sort=False)[columns].agg(lambda error: np.sqrt(np.mean(error**2)))


def main(arguments=None) -> None:
    """Print the table and the root mean squares, or write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"write results/reference/{TABLE}")
    options = parser.parse_args(arguments)
    table = known_table()
    if options.write:
        table.to_csv(REFERENCE / TABLE, index=False, lineterminator="\n")
    with pd.option_context("display.width", 200):
        print(table.to_string(index=False))
        print(rms_errors(table).to_string(float_format="%.4f"))


if __name__ == "__main__":
    main()

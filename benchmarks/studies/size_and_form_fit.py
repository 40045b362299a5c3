"""The candidates for size and form, fitted to the packed beds, beside the packing models of the literature.

    python -m benchmarks.studies.size_and_form_fit            # prints the comparisons
    python -m benchmarks.studies.size_and_form_fit --write    # and writes them to results/reference/models

It reads results/reference/size_and_form.csv and base_time.csv, and follows docs/appendices/size_and_form_plan.md: beds
that are flagged are left out and named, all candidates are fitted, and every bed is predicted by fits without its
family of curves and without its form. All is done for both shifts of the one-class porosity of beds of all forms
(column `shift`). Beds of spheres are fitted separately, as a check that is printed only. Tables:

    size_and_form_candidates.csv   one row per model: its errors, and which one is chosen
    size_and_form_parameters.csv   one row per fitted parameter
    size_and_form_beds.csv         one row per bed: one-class porosity, predictions by each model without its family

Minutes of CPU time. ValueError while there are too few beds: two families of curves and two forms are needed.
"""

import argparse

import numpy as np
import pandas as pd

from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.beds import ALL_BASES, SHIFTS, flags, form_labels, read_beds
from simcore.models.size_and_form.comparison import compare, parameter_rows
from simcore.models.size_and_form.fit import fit_candidate
from simcore.paths import REFERENCE
from simcore.scene.sizes import all_cases

ROWS = REFERENCE / "size_and_form.csv"
BASE_TIME = REFERENCE / "base_time.csv"
TABLES = ("candidates", "parameters", "beds")
SPHERES_BY, FEWEST_SPHERES = ("L", "F", "H"), 4


def read_rows():
    """Return the rows of the packed beds; ValueError if there are none."""
    if not ROWS.exists():
        raise ValueError(
            f"{ROWS}: there are no packed beds yet; pack them with snakemake --cores 1 --configfile "
            "config/size_and_form.yaml -- size_and_form_piece_1, and then the target collect"
        )
    return pd.read_csv(ROWS)


def usable_beds(rows, shift=ALL_BASES, spheres=False):
    """Return the Beds of real forms, or of spheres, of the rows; shift: one of SHIFTS."""
    families = {name: case.family for name, case in all_cases().items()}
    longer = pd.read_csv(BASE_TIME) if BASE_TIME.exists() else None
    return read_beds(rows, fit_reference_models().models["unified", "U1"], families, longer, shift, spheres)


def left_out(rows) -> list[str]:
    """Return one line for each reason why beds are left out, with their names."""
    reasons = flags(rows)
    return [
        f"left out, {reason}: {', '.join(of_reason['case'] + ' ' + form_labels(of_reason))}"
        for reason, of_reason in rows[reasons != ""].groupby(reasons)
    ]


def beds_table(beds, comparison):
    """Return one row per bed: bed, family, form, n_one_class, n, n_error, widest, predicted_<model> without its family.

    widest: ratio of the largest to the smallest sieve size.
    """
    widest = [curve.largest / curve.least for curve in beds.curves]
    columns = {"bed": beds.names, "family": beds.family, "form": beds.form, "n_one_class": beds.one_class}
    columns |= {"n": beds.n, "n_error": beds.error, "widest": widest}
    predictions = {f"predicted_{name}": values for name, values in comparison.by_family.items()}
    return pd.DataFrame(columns | predictions)


def compare_shifts(rows):
    """Return the tables of TABLES, dict of DataFrame, and print each comparison."""
    tables = {name: [] for name in TABLES}
    for shift in SHIFTS:
        beds = usable_beds(rows, shift)
        comparison = compare(beds)
        print(f"\nOne-class porosity of beds of all forms: unified model, shifted to the {shift}")
        print(comparison.table.to_string(index=False, float_format="%.4f"))
        print(f"{len(beds.n)} beds; scatter between beds {comparison.scatter:.4f}; chosen: {comparison.chosen}")
        parts = (comparison.table, parameter_rows(comparison.fits), beds_table(beds, comparison))
        for of_kind, part in zip(tables.values(), parts, strict=True):
            part.insert(0, "shift", shift)
            of_kind.append(part)
    return {name: pd.concat(parts, ignore_index=True) for name, parts in tables.items()}


def describe_spheres(rows) -> list[str]:
    """Return one line for each of L, F and H, fitted to the beds of spheres; no line if there are fewer than four.

    Spheres have one form, so that m0 stands for the whole stretch.
    """
    beds = usable_beds(rows, spheres=True)
    lines = []
    for name in SPHERES_BY if len(beds.n) >= FEWEST_SPHERES else ():
        fit = fit_candidate(name, beds, 0.0, fixed={"kappa": 0.0})
        errors = fit.std_errors()
        values = ", ".join(f"{key} = {value:.3f} ± {errors[key]:.3f}" for key, value in fit.parameters.items())
        rms = np.sqrt(np.mean((fit.predicted - beds.n) ** 2))
        lines.append(f"spheres, candidate {name}: {values}; rms residual {rms:.4f} over {len(beds.n)} beds")
    return lines


def main(arguments=None) -> None:
    """Print the comparisons, and write them if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the tables to results/reference/models")
    options = parser.parse_args(arguments)
    rows = read_rows()
    print(*left_out(rows), sep="\n")
    tables = compare_shifts(rows)
    print("", *describe_spheres(rows), sep="\n")
    if options.write:
        for name, table in tables.items():
            path = REFERENCE / "models" / f"size_and_form_{name}.csv"
            table.round(6).to_csv(path, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()

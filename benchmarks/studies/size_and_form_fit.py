"""The candidates for size and form, fitted to the packed beds, beside the packing models of the literature.

    python -m benchmarks.studies.size_and_form_fit            # prints the comparison
    python -m benchmarks.studies.size_and_form_fit --write    # and writes it to results/reference

It reads results/reference/size_and_form.csv and base_time.csv, and follows docs/appendices/size_and_form_plan.md: beds
that are flagged are left out and named, all candidates are fitted, and every bed is predicted by fits without its
family of curves and without its form. Tables: size_and_form_candidates.csv, one row per model; size_and_form_beds.csv,
one row per bed with its one-class porosity and its prediction by each model without its family. Minutes of CPU time.
ValueError while there are too few beds: two families of curves and two forms are needed.
"""

import argparse

import pandas as pd

from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.beds import flags, form_labels, read_beds
from simcore.models.size_and_form.comparison import compare
from simcore.paths import REFERENCE
from simcore.scene.sizes import all_cases

ROWS = REFERENCE / "size_and_form.csv"
BASE_TIME = REFERENCE / "base_time.csv"


def read_rows():
    """Return the rows of the packed beds; ValueError if there are none."""
    if not ROWS.exists():
        raise ValueError(
            f"{ROWS}: there are no packed beds yet; pack them with snakemake --cores 1 --configfile "
            "config/size_and_form.yaml -- size_and_form_piece_1, and then the target collect"
        )
    return pd.read_csv(ROWS)


def usable_beds(rows):
    """Return the Beds of the rows, and print which are left out."""
    for reason, of_reason in rows[flags(rows) != ""].groupby(flags(rows)):
        names = of_reason["case"] + " " + form_labels(of_reason)
        print(f"left out, {reason}: {', '.join(names)}")
    families = {name: case.family for name, case in all_cases().items()}
    longer = pd.read_csv(BASE_TIME) if BASE_TIME.exists() else None
    return read_beds(rows, fit_reference_models().models["unified", "U1"], families, longer)


def beds_table(beds, comparison):
    """Return one row per bed: bed, family, form, n_one_class, n, n_error, and predicted_<model> without its family."""
    columns = {"bed": beds.names, "family": beds.family, "form": beds.form, "n_one_class": beds.one_class}
    columns |= {"n": beds.n, "n_error": beds.error}
    predictions = {f"predicted_{name}": values for name, values in comparison.by_family.items()}
    return pd.DataFrame(columns | predictions)


def main(arguments=None) -> None:
    """Print the comparison, and write it if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the tables to results/reference")
    options = parser.parse_args(arguments)
    beds = usable_beds(read_rows())
    comparison = compare(beds)
    print(comparison.table.to_string(index=False, float_format="%.4f"))
    print(f"{len(beds.n)} beds; scatter between beds {comparison.scatter:.4f}; chosen: {comparison.chosen}")
    if options.write:
        comparison.table.round(5).to_csv(REFERENCE / "size_and_form_candidates.csv", index=False, lineterminator="\n")
        table = beds_table(beds, comparison).round(5)
        table.to_csv(REFERENCE / "size_and_form_beds.csv", index=False, lineterminator="\n")


if __name__ == "__main__":
    main()

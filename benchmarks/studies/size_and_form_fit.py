"""The candidates for size and form, fitted to the packed beds, beside the packing models of the literature.

    python -m benchmarks.studies.size_and_form_fit            # prints the comparisons
    python -m benchmarks.studies.size_and_form_fit --write    # and writes them to results/reference/models

It reads results/reference/size_and_form.csv and base_process.csv (bases with another process) and follows
docs/appendices/size_and_form_plan.md: beds that are flagged are left out and named, all candidates are fitted, and
every bed is predicted by fits without its family of curves and without its form. Two checks are only printed: errors of
the fits on the flagged beds and on beds of known porosity, and fits to beds of spheres. The tables are:

    size_and_form_candidates.csv   one row per model: its errors, and which one is chosen
    size_and_form_parameters.csv   one row per fitted parameter, with its 95 % interval
    size_and_form_covariance.csv   one row per pair of fitted parameters of a candidate
    size_and_form_beds.csv         one row per bed: one-class porosity, predictions by each model without its family

It takes minutes of CPU time. It raises ValueError if there are too few beds: two families of curves and two forms are
needed.
"""

import argparse

import numpy as np
import pandas as pd
import yaml

from simcore.campaign.gathering import table_of
from simcore.models.fitting import fit_reference_models
from simcore.models.packing_models.curves import gap, span
from simcore.models.size_and_form.bases import PROCESS, fit_bases
from simcore.models.size_and_form.beds import ALL_FORMS, BASE, flags, form_labels, read_beds
from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.comparison import compare, covariance_rows, parameter_rows
from simcore.models.size_and_form.fit import fit_candidate, predict_beds
from simcore.models.size_and_form.known_beds import known_beds
from simcore.models.size_and_form.stretch import REFERENCE_EL, REFERENCE_EQ
from simcore.packing.insertion.random_placement import fall_time
from simcore.paths import CONFIG, REFERENCE
from simcore.scene.scene import Material
from simcore.scene.sizes import all_cases
from simcore.scene.specification import resolve

STUDY, OTHER_BASES = "size_and_form", "base_process"
CONFIGURATION = CONFIG / "size_and_form.yaml"
TABLES = ("candidates", "parameters", "covariance", "beds")
UNSTRETCHED = {"m0": 1.0, "kappa": 0.0}
SPHERES_BY, FEWEST_SPHERES = ("L", "F", "H"), 4


def read_rows(study=STUDY, configuration=CONFIGURATION):
    """Return the rows of the packed beds of a study; ValueError if there are none.

    They have width_m, mass_kg, and after_s and fall_s as in simcore.models.size_and_form.bases. configuration: path
    of the configuration that has the study.
    """
    path = REFERENCE / f"{table_of(study)}.csv"
    if not path.exists():
        raise ValueError(
            f"{path}: there are no packed beds yet; pack them with snakemake --cores 1 --configfile "
            f"config/{configuration.name} -- {study}_piece_1, and then the target collect"
        )
    rows = pd.read_csv(path)
    if "study" in rows:  # of several studies
        rows = rows[rows["study"] == study].reset_index(drop=True)
        if rows.empty:
            raise ValueError(f"{path} has no bed of {study} yet; pack it")
    fixed = yaml.safe_load(configuration.read_text(encoding="utf-8"))["studies"][study]["fixes"]
    # Any curve, form, amount and width where the rows have them: they have no effect on what is read here.
    sizes, amount = {"case": BASE} | fixed.get("sizes", {}), {"mass": "1 kg"} | fixed.get("amount", {})
    domain = {"width": "63 mm"} | fixed["domain"]
    settings = resolve(fixed | {"sizes": sizes, "shapes": {}, "amount": amount, "domain": domain}, "packing")
    shaking = pd.Series(np.nan, rows.index) if "shaking_s" not in rows else rows["shaking_s"]
    rows["after_s"] = shaking.fillna(settings["shaking"]["duration"])
    gravity = Material(**settings["material"]).effective_gravity
    rows["fall_s"] = fall_time(settings["domain"]["height"], -settings["generation"]["velocity_z"], gravity)
    if "width_m" not in rows:
        rows["width_m"] = settings["domain"]["width"]
    if "mass_kg" not in rows:
        rows["mass_kg"] = settings["amount"]["mass"]
    return rows


def read_other_bases():
    """Return the rows of the bases with another process, or None if there are none."""
    return read_rows(OTHER_BASES) if (REFERENCE / f"{OTHER_BASES}.csv").exists() else None


def usable_beds(rows, spheres=False, flagged=False):
    """Return the Beds of real forms, or of spheres, of the rows, or those that are flagged; ValueError by read_beds."""
    families = {name: case.family for name, case in all_cases().items()}
    unified = fit_reference_models().models["unified", "U1"]
    return read_beds(rows, unified, families, read_other_bases(), spheres=spheres, flagged=flagged)


def left_out(rows) -> list[str]:
    """Return one line for each reason why beds are left out, with their names."""
    reasons = flags(rows)
    return [
        f"left out, {reason}: {', '.join(of_reason['case'] + ' ' + form_labels(of_reason))}"
        for reason, of_reason in rows[reasons != ""].groupby(reasons)
    ]


def beds_table(beds, comparison):
    """Return one row per bed: bed, family, form, n_one_class, n, n_error, widest, gap, predicted_<model> without its
    family.

    widest, gap: `span` and `gap` of the sieve curve.
    """
    widths = {"widest": [span(curve) for curve in beds.curves], "gap": [gap(curve) for curve in beds.curves]}
    columns = {"bed": beds.names, "family": beds.family, "form": beds.form, "n_one_class": beds.one_class}
    columns |= {"n": beds.n, "n_error": beds.error} | widths
    predictions = {f"predicted_{name}": values for name, values in comparison.by_family.items()}
    return pd.DataFrame(columns | predictions)


def describe_bases(bases) -> str:
    """Return one line with the effect of the process on the one-class porosity; bases: rows as of read_rows.

    The standard deviation of the residuals has as many degrees of freedom as there are bases beyond the coefficients.
    """
    fitted = fit_bases(bases.assign(form=form_labels(bases)), PROCESS)
    slopes = [f"{name} {slope:+.4f} ± {fitted.std_errors[name]:.4f}" for name, slope in fitted.slopes.items()]
    forms = form_labels(bases)
    residuals = bases["n"] - forms.map(fitted.constants) - fitted.effect(bases)
    freedom = len(bases) - len(fitted.constants) - len(fitted.slopes)
    scatter = f"{np.sqrt(np.sum(residuals**2) / freedom):.4f}" if freedom > 0 else "not known"
    return (
        f"{len(bases)} bases, change of porosity per factor e: {', '.join(slopes) or 'none'}; "
        f"standard deviation of the residuals {scatter}"
    )


def compare_all(rows):
    """Return the tables of TABLES, dict of DataFrame, and print the comparison."""
    others, bases = read_other_bases(), rows[rows["case"] == BASE]
    print(describe_bases(bases if others is None else pd.concat([bases, others], ignore_index=True)))
    beds = usable_beds(rows)
    comparison = compare(beds)
    print(comparison.table.to_string(index=False, float_format="%.4f"))
    print(f"{len(beds.n)} beds; scatter between beds {comparison.scatter:.4f}; chosen: {comparison.chosen}")
    parameters = parameter_rows(comparison.fits, len(np.unique(beds.family)) - 1)
    print("\nFitted parameters with their 95 % intervals")
    print(parameters.to_string(index=False, float_format="%.4f"))
    print("\nMean absolute errors of L, and of L without its stretch, to which nothing is fitted")
    print(unstretched_errors(beds, comparison).to_string(float_format="%.4f"))
    print("\nErrors of the fits on the flagged beds, which they do not contain")
    print(flagged_errors(rows, comparison.fits).to_string(index=False, float_format="%.4f"))
    print("\nRoot mean square errors of the fits on beds of known porosity, from their own one-class porosity")
    print(known_errors(comparison.fits).to_string(float_format="%.4f"))
    parts = (comparison.table, parameters, covariance_rows(comparison.fits), beds_table(beds, comparison))
    return dict(zip(TABLES, parts, strict=True))


def unstretched_errors(beds, comparison) -> pd.DataFrame:
    """Return the errors of L without its stretch beside those of L without the family of each bed.

    The weighted mean absolute errors (as in `compare`) over all Beds, those of one form and those of all forms: rows L
    and "L without stretch", columns all, one form, all forms.
    """
    weights = 1.0 / (beds.error**2 + comparison.scatter**2)
    one_form = np.array(beds.form) != ALL_FORMS
    groups = {"all": np.ones(len(one_form), bool), "one form": one_form, "all forms": ~one_form}
    predictions = {"L": comparison.by_family["L"], "L without stretch": predict_beds("L", beds, UNSTRETCHED)}
    rows = {
        name: {
            group: float(np.average(np.abs(predicted - beds.n)[chosen], weights=weights[chosen]))
            for group, chosen in groups.items()
        }
        for name, predicted in predictions.items()
    }
    return pd.DataFrame(rows).T


def flagged_errors(rows, fits) -> pd.DataFrame:
    """Return one row per flagged bed: bed, n, n_error, and predicted minus packed porosity by each of the Fits."""
    beds = usable_beds(rows, flagged=True)
    errors = {name: predict_beds(name, beds, fit.parameters) - beds.n for name, fit in fits.items()}
    return pd.DataFrame({"bed": beds.names, "n": beds.n, "n_error": beds.error} | errors)


def known_errors(fits) -> pd.DataFrame:
    """Return the root mean square error of each of the Fits on beds of known porosity: rows are sets, columns Fits.

    The sets are those of simcore.models.size_and_form.known_beds, with the mean form of the Rhine; no bed is fitted.
    """
    beds, forms = known_beds(), (REFERENCE_EQ, REFERENCE_EL)
    curves = [all_cases()[case].curve for case in beds["case"]]
    errors = {
        name: [
            predict(name, curve, one_class, fit.parameters, forms, "mass", one_class) - n
            for curve, one_class, n in zip(curves, beds["n_one_class"], beds["n"], strict=True)
        ]
        for name, fit in fits.items()
    }
    return np.square(pd.DataFrame(errors)).groupby(beds["set"], sort=False).mean() ** 0.5


def describe_halves(rows) -> str:
    """Return one line on the shares of coarse grains in the halves of the beds, in standard errors of their difference.

    Beds of one class, whose halves have about the same sizes, do not count. By chance the mean is 0 ± 1/√beds and the
    root mean square 1.
    """
    rows = rows[rows["case"] != BASE]
    errors = np.hypot(rows["coarse_upper_error"], rows["coarse_lower_error"])
    share = rows["coarse_upper"] - rows["coarse_lower"]
    z = share / errors
    return (
        f"coarse grains of {len(z)} wide beds, upper less lower half: mean {z.mean():+.2f} ± {1 / np.sqrt(len(z)):.2f} "
        f"standard errors, rms {np.sqrt((z**2).mean()):.2f}; of the volume {share.mean():+.3f} ± {share.sem():.3f}"
    )


def describe_spheres(rows) -> list[str]:
    """Return one line for each of L, F and H, fitted to the beds of spheres; no line if there are fewer than four.

    Spheres have one form, so that m0 is the whole stretch.
    """
    beds = usable_beds(rows, spheres=True)
    lines = []
    for name in SPHERES_BY if len(beds.n) >= FEWEST_SPHERES else ():
        fit = fit_candidate(name, beds, 0.0, fixed={"kappa": 0.0})
        errors = fit.std_errors()
        values = ", ".join(f"{key} = {value:.3f} ± {errors[key]:.3f}" for key, value in fit.parameters.items())
        freedom = len(beds.n) - len(errors)
        scatter = np.sqrt(np.sum((fit.predicted - beds.n) ** 2) / freedom)
        lines.append(
            f"spheres, candidate {name}: {values}; standard deviation of the residuals {scatter:.4f} over "
            f"{len(beds.n)} beds"
        )
    return lines


def main(arguments=None) -> None:
    """Print the comparisons and, with --write, write them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the tables to results/reference/models")
    options = parser.parse_args(arguments)
    rows = read_rows()
    print(*left_out(rows), describe_halves(rows), sep="\n")
    tables = compare_all(rows)
    print("", *describe_spheres(rows), sep="\n")
    if options.write:
        for name, table in tables.items():
            path = REFERENCE / "models" / f"size_and_form_{name}.csv"
            table.round(6).to_csv(path, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()

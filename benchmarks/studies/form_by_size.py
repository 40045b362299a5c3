"""Beds in which form depends on size, predicted from the forms by sieve class and from those of all grains together.

    python -m benchmarks.studies.form_by_size

The beds are the studies flat_coarse_grains and flat_fine_grains of config/size_and_form.yaml (form_by_size.csv); no
model is fitted to them. docs/appendices/size_and_form_plan.md has the rule: predictions by class are confirmed if the
mean squared error of both beds by class is not larger than that from all grains together. The effect of form on the
one-class porosity is that of beds that are a rain, as these are (benchmarks.studies.base_forms), and beside it that of
beds on lattices, which `predict` uses. Printed are the errors of the model of `predict --sieve`, and of the fitted
candidates of size_and_form_parameters.csv. It takes seconds.
"""

import numpy as np
import pandas as pd
import yaml

from benchmarks.studies.base_forms import evaluated_statistics, of_all_forms, rain_model
from benchmarks.studies.size_and_form_fit import CONFIGURATION, OTHER_BASES, STUDY, read_rows
from simcore.grains.statistics import STATISTICS, equancy_statistics
from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.bases import fit_bases
from simcore.models.size_and_form.beds import ALL_FORMS, BASE, form_labels
from simcore.models.size_and_form.candidates import predict
from simcore.models.size_and_form.sized_model import current_model
from simcore.models.unified import unified_features
from simcore.paths import REFERENCE
from simcore.reference.share_columns import realised_curve
from simcore.scene.specification import resolve

STUDIES = ("flat_coarse_grains", "flat_fine_grains")
CANDIDATES = ("L", "F", "H")  # all of them have a stretch by looseness
USED = "predict"


def ranges(study) -> list[dict]:
    """Return the ranges of size of a study, fine to coarse: below [m], inf for the last one, and the forms in it."""
    fixed = yaml.safe_load(CONFIGURATION.read_text(encoding="utf-8"))["studies"][study]["fixes"]
    by_size = resolve(fixed, "packing")["shapes"]["by_size"]
    return [{"below": np.inf} | {key: value for key, value in part.items() if value is not None} for part in by_size]


def statistics_by_class(curve, parts) -> pd.DataFrame:
    """Return the specified STATISTICS of the grains of each class of the SieveCurve; parts: of `ranges`."""
    rows = []
    for middle in np.sqrt(curve.bounds[1:] * curve.bounds[:-1]):
        form = next(part for part in parts if middle < part["below"])
        values = [form[name][kind] for name in ("flatness", "elongation") for kind in ("mean", "std")]
        rows.append(dict(zip(STATISTICS, (*equancy_statistics(*values), *values[2:]), strict=True)))
    return pd.DataFrame(rows)


def models() -> dict:
    """Return porosity(curve, one_class, reference) -> float by name."""
    fitted = pd.read_csv(REFERENCE / "models" / "size_and_form_parameters.csv")
    porosities = {USED: lambda curve, n1, n_ref: current_model().predict(curve, n1, reference=n_ref)}
    for name in CANDIDATES:
        rows = fitted[fitted["model"] == name]
        values = dict(zip(rows["parameter"], rows["value"], strict=True))
        porosities[name] = lambda curve, n1, n_ref, name=name, values=values: predict(
            name, curve, n1, values, law="mass", reference=n_ref
        )
    return porosities


def comparison(names=STUDIES, of_form=None) -> pd.DataFrame:
    """Return one row per bed: study, n, n_error, and the errors by_class_<model> and together_<model>.

    Errors are predicted minus packed porosity. names: those of the studies. of_form: PorosityModel of beds of one
    class, for the effect of form; None: that of beds that are a rain. ValueError if a bed is not packed.
    """
    of_form = of_form or rain_model()
    beds_of_plan = read_rows(STUDY)
    bases = pd.concat([beds_of_plan[beds_of_plan["case"] == BASE], read_rows(OTHER_BASES)], ignore_index=True)
    bases = bases.assign(form=form_labels(bases))
    fitted = fit_bases(bases)
    # The specified forms of classes are by number, those of the evaluated parts by volume; so are those of the base.
    of_base = (
        of_form.predict(unified_features(of_all_forms().to_frame().T)).mean(),
        of_form.predict(unified_features(evaluated_statistics(bases[bases["form"] == ALL_FORMS]))).mean(),
    )
    rows = []
    for name in names:
        beds = read_rows(name)
        for effect, (_, bed) in zip(fitted.effect(beds), beds.iterrows(), strict=True):
            curve, reference = realised_curve(bed, name), fitted.constants[ALL_FORMS] + effect
            forms = statistics_by_class(curve, ranges(name)), evaluated_statistics(bed.to_frame().T.infer_objects())
            by_class, together = (
                reference + of_form.predict(unified_features(form)) - base
                for form, base in zip(forms, of_base, strict=True)
            )
            row = {"study": name, "n": bed["n"], "n_error": bed["n_error"]}
            for model, porosity in models().items():
                row[f"by_class_{model}"] = float(np.squeeze(porosity(curve, by_class[None], reference))) - bed["n"]
                row[f"together_{model}"] = float(porosity(curve, float(together[0]), reference)) - bed["n"]
            rows.append(row)
    return pd.DataFrame(rows)


def confirmed(table, model=USED) -> bool:
    """Return whether the predictions by class of a table of `comparison` err no more than those of all grains."""
    by_class, together = (np.mean(np.square(table[f"{kind}_{model}"])) for kind in ("by_class", "together"))
    return bool(by_class <= together)


def main() -> None:
    """Print the errors, and whether predictions by class are confirmed."""
    try:
        tables = {
            "inserted as a rain": comparison(),
            "inserted on lattices": comparison(of_form=fit_reference_models().models["unified", BASE]),
        }
    except ValueError as error:
        raise SystemExit(f"form by size: {error}") from None
    for process, table in tables.items():
        print(f"\nThe effect of form on the one-class porosity is that of beds {process}")
        print(table.set_index("study").T.to_string(float_format="%.4f"))
        for model in (USED, *CANDIDATES):
            print(f"{model}: predictions by class are {'' if confirmed(table, model) else 'not '}confirmed")


if __name__ == "__main__":
    main()

"""The first parts of a campaign's page: its answer in words, how sure it is, and a check against other packings."""

from pathlib import Path

import numpy as np
import pandas as pd

from simcore.campaign.biases import SIZE
from simcore.evaluation.confidence import error_of_mean, student_quantile
from simcore.evaluation.rounding import rounded
from simcore.grains.sieve import read_cases
from simcore.models.formulas import BEDS, formulas
from simcore.models.scatter import line_of_row, scatter_of
from simcore.paths import CONFIG
from simcore.reference.named_tables import read_named_table
from simcore.reference.r22_tables import rhine_statistics
from simcore.report.page import bullets, folded, paragraph, rows_table
from simcore.report.tables import read_table
from simcore.report.words import formula_markup

MEAN_FORM = "mean form of the Rhine gravel of Rettinger et al."
LIMITS = (
    "The numbers are for clean gravel that is poured into a box and shaken. A river bed may be imbricated, looser or "
    "denser, and may have sand in its pores; its porosity can differ by more than the errors given here.",
    "Grains are convex. Their size does not depend on their form, unless a study gives each size its own forms.",
    "A model is valid for forms inside its fitted range, and for its own sieve curve: the wider the curve, the lower "
    "the porosity.",
)
FORMULAS = (
    "Formulas of the models. The error is the mean error of porosity for beds that were left out of the fit "
    "(cross-validation). L ≥ I ≥ S are the axes; µ and σ are mean and standard deviation over the grains of a bed."
)
BIASES = (
    "Effects on the porosity of settings, size of the bed, duration of shaking and insertion height, measured on "
    "separate packings. They may not be added, because they can depend on each other. draft, standard and r22 are "
    "presets of numerical settings; those of r22 are as in Rettinger et al."
)
CLEAR = 3.0  # standard errors, beyond which a campaign differs from the committed one
# Columns by which settings of one study are the same in two campaigns
_KEYS = (
    *("case", "grain", "mean_FL", "std_FL", "mean_EL", "std_EL", "flatness", "elongation"),
    *("shape_kind", "choice", "faces", "shaking_s", "width_m"),
)


def by_stem(paths):
    """Return these paths as a dict by stem."""
    return {Path(path).stem: path for path in paths}


def answer(models):
    """Return the parts that answer how porous gravel is: a sentence, a table of examples, and the formulas.

    models: dict from names such as single_form to the paths of tables of coefficients; empty without a formula.
    """
    rows = [read_named_table(models[name]) for name in BEDS if name in models]
    written = pd.concat([formulas(table) for table in rows], ignore_index=True) if rows else pd.DataFrame()
    if written.empty:
        return []
    columns = {"beds": "kind_of_bed", "porosity": "formula", "error": "mean_absolute_error", "range": "fitted_range"}
    shown = written.rename(columns=columns | {"r22": "r22_formula"})
    for name in {"formula", "r22_formula"} & set(shown):
        shown[name] = [formula_markup(text) or None for text in shown[name]]
    parts = _examples(one_form_models(models)) if "single_form" in models else []
    leading = [
        name for name in ("kind_of_bed", "case", "formula", "r22_formula", "mean_absolute_error") if name in shown
    ]
    shown = shown[[*leading, *shown.columns.drop(leading)]]
    return [*parts, rows_table(shown, FORMULAS, "report/formulas", details=("samples", "fitted_range"))]


def one_form_models(models):
    """Return the coefficients of the models of one form, a dict from the case to a DataFrame indexed by term."""
    rows = read_named_table(models["single_form"])
    rows = rows[rows["model"] == "single_form"]
    if "source" in rows and rows["source"].nunique() > 1:
        rows = rows[rows["source"] == rows["source"].iloc[0]]
    return {case: terms.set_index("term") for case, terms in rows.groupby("case", sort=False)}


def predict_form(terms, flatness, elongation):
    """Return (porosity, standard deviation about the model) of grains of one form; nan outside the fitted range.

    terms: of one case, from one_form_models.
    """
    features = {"EQ_inv": 1.0 / (flatness * elongation), "EL_inv": 1.0 / elongation}
    fitted = terms.drop(index="intercept")
    if not set(fitted.index) <= set(features):
        return np.nan, np.nan
    values = pd.Series(features)[fitted.index]
    if ((values < fitted["feature_min"]) | (values > fitted["feature_max"])).any():
        return np.nan, np.nan
    scatter = float(terms["scatter"].iloc[0]) if "scatter" in terms else np.nan
    scatter = scatter_of(np.array([[1.0, *values]]), scatter, line_of_row(terms.iloc[0]))[0]
    return float(terms.loc["intercept", "coefficient"] + (fitted["coefficient"] * values).sum()), scatter


def _example_forms():
    """Return the forms of which the page gives the porosity, a list of (words, flatness S/I, elongation I/L)."""
    rhine = rhine_statistics()
    return [
        ("nearly round", 0.9, 0.9),
        (MEAN_FORM, rhine["mu_FL"], rhine["mu_EL"]),
        ("flat", 0.4, 0.8),
        ("long", 0.8, 0.4),
        ("flat and long", 0.55, 0.5),
    ]


def _examples(models):
    """Return a sentence and a table of the porosity of gravels with typical forms."""
    rows, numbers, forms = [], {}, _example_forms()
    for words, flatness, elongation in forms:
        row = {"example": words}
        for case, terms in models.items():
            n, scatter = predict_form(terms, flatness, elongation)
            numbers[case, words] = n
            row[f"porosity_{case}"] = rounded(n, scatter) or "outside the fit"
        rows.append(row | {"flatness": flatness, "elongation": elongation})
    example_case = next(iter(models), None)
    named = {words: n for (case, words), n in numbers.items() if case == example_case and np.isfinite(n)}
    if not named:
        return []
    densest, loosest = min(named, key=named.get), max(named, key=named.get)
    ends = " and ".join(
        f"{named[words]:.2f} if the grains are {words}" if words != MEAN_FORM else f"{named[words]:.2f} at the {words}"
        for words in dict.fromkeys((densest, loosest))
    ).removesuffix(".")
    sentence = f"Gravel of the sieve curve {describe_case(example_case)}, poured and shaken, has a porosity of {ends}."
    ratios = {words: 1.0 / (flatness * elongation) for words, flatness, elongation in forms}
    if ratios[densest] < ratios[loosest]:
        sentence += " The flatter and longer the grains, the looser the bed."
    caption = (
        "Porosity of beds whose grains all have one form. After ± is the standard deviation of beds about the model. "
        f"Sieve curves: {'; '.join(describe_case(case) for case in models)}."
    )
    return [paragraph(sentence, "answer"), rows_table(pd.DataFrame(rows), caption, "report/examples")]


def describe_case(name):
    """Return the name of a sieve curve with the number and the range of its classes."""
    cases = read_cases(CONFIG / "cases.tsv")
    if name not in cases:
        return str(name)
    curve = cases[name].curve
    filled = np.flatnonzero(curve.mass_fractions)
    low, high = 1e3 * curve.bounds[filled[0]], 1e3 * curve.bounds[filled[-1] + 1]
    classes = "one sieve class" if len(filled) == 1 else f"{len(filled)} sieve classes"
    return f"{name} ({classes}, {low:g} to {high:g} mm)"


def how_sure(tables):
    """Return the parts on the errors of the models and of a packing, the measured biases, and the limits.

    tables: dict from names of tables to their paths; those that are absent have no sentence.
    """
    parts = [paragraph(text, "answer") for text in _in_short(tables)]
    sentences = [*_left_out(tables), *_published_models(tables), *unseen(tables), *_sampling(tables)]
    parts.append(bullets([*sentences, *LIMITS]))
    if "biases" in tables:
        rows = read_table(tables["biases"]).drop(columns=["source", "inserted"], errors="ignore")
        shown = rows_table(rows, BIASES, "committed/biases", path=str(tables["biases"]))
        parts.append(folded("Effects of the settings on the porosity", [shown]))
    return parts


def _in_short(tables):
    """Return a text on the scatter of new beds about the model, and on the measured porosities."""
    sentences = []
    if "single_form" in tables:
        for case, terms in list(one_form_models(tables).items())[:1]:
            rhine = rhine_statistics()
            scatter = predict_form(terms, rhine["mu_FL"], rhine["mu_EL"])[1]
            beds = float(terms["samples"].iloc[0])
            if np.isfinite(scatter) and beds > len(terms):
                # The mean form is near the middle of the fitted forms, where only the error of their mean adds.
                half = student_quantile(0.95, beds - len(terms)) * scatter * np.sqrt(1.0 + 1.0 / beds)
                sentences.append(
                    f"About 95 % of new beds of one form, the mean one, and of the sieve curve {case}, poured and "
                    f"shaken in the same way, have a porosity within {half:.3f} of the model."
                )
    if "validation" in tables:
        rows = read_named_table(tables["validation"])
        if "experiment_n" in rows and rows["experiment_n"].notna().any():
            error = (rows["n"] - rows["experiment_n"]).abs()
            of_several = f" on average and by {error.max():.3f} at most" if len(error.dropna()) > 1 else ""
            sentences.append(
                f"Porosities measured in the laboratory differ from those of our packings by {error.mean():.3f}"
                f"{of_several}."
            )
    return [" ".join(sentences)] if sentences else []


def _left_out(tables):
    """Return a sentence on the cross-validated errors of our models."""
    errors = []
    for name in set(BEDS) & set(tables):
        rows = read_named_table(tables[name])
        errors += list(rows.loc[rows["model"] == name, "mean_absolute_error"].dropna())
    if not errors:
        return []
    low, high = f"{min(errors):.4f}", f"{max(errors):.4f}"
    between = f"between {low} and {high}" if low != high else low
    return [f"For beds that were left out of the fit, the mean error of porosity of the models above is {between}."]


def _published_models(tables):
    if "unified_feature_sets" not in tables:
        return []
    rows = read_named_table(tables["unified_feature_sets"])
    rows = rows[rows["model"] == "r22"]
    return [
        f"The two published models of Rettinger et al., applied to our packings of {row.case}, have a mean error of "
        f"{row.mean_absolute_error:.4f}."
        for row in rows.itertuples()
    ]


def unseen(tables):
    """Return a sentence on packings to which no model was fitted, in a list; it is empty without their predictions."""
    if "application_predictions" not in tables:
        return []
    rows = read_named_table(tables["application_predictions"])
    name = "unified_abs_error" if rows.get("unified_abs_error", pd.Series(dtype=float)).notna().any() else "abs_error"
    if name not in rows or rows[name].isna().all():
        return []
    model = "unified model" if name.startswith("unified") else "model of mixtures"
    return [
        f"Beds of the study `application`, to which no model was fitted: the largest error of the {model} is "
        f"{rows[name].max():.4f}."
    ]


def replaced_by_ellipsoids(tables):
    """Return a sentence on grains that are replaced by their ellipsoids, in a list; it is empty without that table."""
    if "shape_kinds" not in tables:
        return []
    return [
        f"{row.case}: the porosity of polyhedra minus that of their ellipsoids is "
        f"{rounded(row.mean_difference, decimals=4, sign='+')} on average and {row.rms_difference:.4f} root mean "
        f"square over {row.forms} forms."
        for row in read_named_table(tables["shape_kinds"]).itertuples()
    ]


def _sampling(tables):
    """Return a sentence on the typical sampling error of a packing of one form, with the most frequent sieve curve."""
    path = tables.get("single_form_porosities")
    if path is None:
        return []
    rows = read_named_table(path)
    if not {"n_std_error", "grains", "runs", "case"} <= set(rows):
        return []
    of_case = rows[rows["case"] == rows["case"].mode()[0]]
    error = (of_case["n_std_error"] * np.sqrt(of_case["runs"])).median()  # that of a row is of the mean of its runs
    return [
        f"The porosity of a packing of {of_case['grains'].median():.0f} grains of one form with the sieve curve "
        f"{of_case['case'].iloc[0]} has a sampling error of {error:.4f}, the median over the forms."
    ]


def check(own, committed, titles, committed_biases=None):
    """Return the parts that compare the packings of this campaign with committed ones of the same settings.

    own, committed: dicts from names of studies to the paths of their tables. titles: titles of the studies by name.
    committed_biases: path of the table of biases, for the effect of the size of the bed, or None.
    """
    rows, sizes = [], []
    for study, path in own.items():
        if study in committed:
            compared = _same_settings(read_named_table(path), read_named_table(committed[study]))
            if len(compared):
                errors = np.hypot(compared["n_std_error_own"], compared["n_std_error_committed"])
                error = error_of_mean(errors)
                if "grains_own" in compared:
                    sizes += list(compared["grains_own"] / compared["grains_committed"])
                difference = (compared["n_own"] - compared["n_committed"]).mean()
                row = {"study_title": titles[study], "compared": len(compared), "own_n": compared["n_own"].mean()}
                row |= {"committed_n": compared["n_committed"].mean(), "difference": difference}
                rows.append(row | {"difference_std_error": error, "z": difference / error})
    if not rows:
        return []
    caption = (
        "Mean porosity of the settings that this campaign has in common with the committed one. Settings that the "
        f"tables do not list, such as the material and the preset, may differ.{_sizes_in_words(sizes)}"
    )
    clear = sum(abs(row["z"]) > CLEAR for row in rows)
    unknown = sum(np.isnan(row["z"]) for row in rows)
    sentence = (
        f"Studies that have settings in common with the committed campaign: {len(rows)}. The mean porosity differs by "
        f"more than {CLEAR:g} standard errors in {clear} of them."
    )
    sentence += f" In {unknown} of them the standard error is unknown." if unknown else ""
    parts = [paragraph(sentence, "outcome"), rows_table(pd.DataFrame(rows), caption, "report/check")]
    return [*parts, *_effect_of_size(committed_biases)]


def _sizes_in_words(ratios):
    """Return a sentence on beds with fewer or more grains than the committed ones, "" if all have about as many."""
    if not ratios or 0.9 < min(ratios) and max(ratios) < 1.1:
        return ""
    ends = " to ".join(dict.fromkeys(f"{ratio:.2g}" for ratio in (min(ratios), max(ratios))))
    return (
        f" The beds of this campaign have {ends} times as many grains, so differences contain the effect of the size "
        "of the bed."
    )


def _effect_of_size(path):
    """Return a paragraph on the measured effect of small beds, in a list that is empty without a table of biases."""
    rows = pd.DataFrame({"of": []}) if path is None else read_named_table(path)
    rows = rows[rows["of"] == SIZE]
    if rows.empty:
        return []
    listed = "; ".join(
        f"{row.setting} {rounded(row.difference, row.difference_std_error, sign='+')}" for row in rows.itertuples()
    )
    against = rows["against"].iloc[0]
    text = f"Measured effect of the size of the bed, compared with {against} and for single forms: {listed}."
    return [paragraph(text, "text")]


def _same_settings(own, committed):
    """Return the rows of both tables with equal settings, their porosities with the suffixes _own and _committed.

    Rows of one table that differ in another setting are not compared, nor are the committed packings with themselves.
    """
    if "source" in committed:
        committed = committed[committed["source"] == "synthetic"]
    keys = [name for name in _KEYS if name in own and name in committed]
    if not keys or "n" not in own or "n" not in committed:
        return pd.DataFrame()
    columns = [name for name in ("n", "n_std_error", "grains") if name in own and name in committed]
    parts = [part[columns].assign(key=[_key(row) for row in part[keys].to_numpy()]) for part in (own, committed)]
    parts = [part.drop_duplicates("key", keep=False) for part in parts]
    compared = parts[0].merge(parts[1], on="key", suffixes=("_own", "_committed"))
    return compared[:0] if (compared["n_own"] == compared["n_committed"]).all() else compared


def _key(values):
    """Return settings as one text, in which numbers have six digits; spheres have no flatness."""
    return "|".join(
        f"{value:.6g}" if isinstance(value, float) and np.isfinite(value) else str(value) for value in values
    )

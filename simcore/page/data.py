"""What the page needs from the fitted models and the published tables, as plain data for JSON."""

from pathlib import Path

from simcore.evaluation.confidence import student_quantile
from simcore.grains import cell_numbers, form_notices, grain_counts, measured_forms, table_head
from simcore.grains.form_columns import MEANS, NEEDED, NO_DEVIATIONS, SAMPLE_NAMES, all_patterns
from simcore.grains.sieve import read_cases
from simcore.grains.statistics import STATISTICS
from simcore.grains.summary_rows import label_patterns
from simcore.models import prediction
from simcore.models.feature_words import feature_in_words
from simcore.models.few_grains import ENOUGH_GRAINS, MOST_FREEDOM, RELATIVE_STEP
from simcore.models.fitted_range import FAR, NEAR, WIDENING
from simcore.models.formulas import SYMBOLS
from simcore.models.measured_file import MEASURED
from simcore.models.nearly_round import LEAST_RATIO, describe_nearly_round
from simcore.models.packing_models.empirical import PREDICTORS
from simcore.models.prediction_text import FEW_WORDS, SINGLE_GRAIN
from simcore.models.two_axes import WITHOUT_FEW_GRAINS
from simcore.packing.sieve_specification import SYNTHETIC, sieve_specification
from simcore.page.curve_data import curve_data
from simcore.paths import CONFIG, R22_TABLES
from simcore.provenance.version import VERSION
from simcore.reference.r22_tables import read_r22_models, read_r22_table, rhine_statistics

LEVELS = (0.5, 0.8, 0.9, 0.95, 0.99)  # probabilities of the prediction intervals that the page offers
# The page puts the form of the sample here.
SHAPES = "@SHAPES@"


def page_data(fitted, r22_tables=R22_TABLES):
    """Return all that the page needs to predict as `predict` does, dict of plain values.

    fitted: FittedModels. r22_tables: folder of the tables of Rettinger et al. (2022).
    """
    behind = [text for (name, _), text in fitted.behind.items() if name == MEASURED]
    behind += [fitted.curve.behind] if fitted.curve is not None else []
    if behind:
        raise ValueError(
            f"scree page: {behind[0]}: the page does not evaluate models of measured beds; write it without --models, "
            "and use `scree predict --models`"
        )
    published = _published(r22_tables)
    cases = sorted({*fitted.cases(), *published})
    curves = read_cases(CONFIG / "cases.tsv")
    return {
        "version": VERSION,
        "one_class": {"name": prediction.ONE_CLASS, "case": prediction.model_case(prediction.ONE_CLASS)},
        "cases": [_case(name, curves.get(name)) for name in cases],
        "fitted_cases": fitted.cases(),
        "levels": list(LEVELS),
        "models": [_model(name, model, fitted.behind[name, case]) for (name, case), model in fitted.models.items()],
        "r22": published,
        "symbols": SYMBOLS,
        "words": {name: feature_in_words(name) for name in _quantities(fitted, published)},
        "shapes": SHAPES,
        "few_grains": {
            "statistics": STATISTICS,
            "relative_step": RELATIVE_STEP,
            "fewest": measured_forms.FEWEST_FOR_ERRORS,
            "enough": ENOUGH_GRAINS,
            "without": WITHOUT_FEW_GRAINS,
            "rhine": {name: float(rhine_statistics(r22_tables)[name]) for name in ("sigma_FL", "sigma_EL")},
            "quantiles": {f"{level:g}": _quantiles(level) for level in LEVELS},
        },
        "rule": {"near": NEAR, "far": FAR, "widening": WIDENING},
        "nearly_one_form": prediction.NEARLY_ONE_FORM * prediction.R22_MIXTURES["sigma"][0],
        "smallest_porosity": prediction.SMALLEST_PRINTED,
        "no_model": prediction.NO_MODEL,
        "kinds_of_bed": list(prediction.KINDS_OF_BED),
        "reading": _reading(),
        "curve": curve_data(LEVELS),
        "nearly_round": {"least_ratio": LEAST_RATIO, "text": f"{describe_nearly_round()}."},
        "flatness": read_r22_table("table2_form_statistics", r22_tables)[["mu_FL", "sigma_FL"]].to_numpy().tolist(),
    }


def _reading():
    """Return what the reader of tables needs."""
    return {
        "patterns": all_patterns(),
        "head": {"patterns": table_head.head_patterns(), "most_numbers": table_head.MAX_NUMBERS},
        "labels": label_patterns(),
        "date": cell_numbers.DATE.pattern,
        "longest": measured_forms.LONGEST,
        "slip": form_notices.SLIP,
        "small_deviation": form_notices.SMALL_DEVIATION,
        "max_grains": grain_counts.MAX_GRAINS,
        "fewest_ids": grain_counts.FEWEST_IDS,
        "rows_by_sample": grain_counts.ROWS_BY_SAMPLE,
        "alike": measured_forms.ALIKE,
        "shown": form_notices.SHOWN,
        "mean_rows": {
            "last": form_notices.LAST,
            "fewest_above": form_notices.FEWEST_ABOVE,
            "rounded": form_notices.ROUNDED,
            "spread": form_notices.SPREAD,
        },
        "single_grain": SINGLE_GRAIN,
        "few_grains": [{"grains": grains, "words": words} for grains, words in FEW_WORDS.items()],
        "needed": NEEDED,
        "no_deviations": NO_DEVIATIONS,
        "sample_names": list(SAMPLE_NAMES),
        "means": list(MEANS),
    }


def _model(name, model, behind):
    """Return a PorosityModel with Student's t at each of LEVELS."""
    keys = ("case", "features", "coefficients", "covariance", "minimum", "maximum", "n_samples")
    return {
        "model": name,
        **{key: getattr(model, key) for key in keys},
        "scatter_line": model.scatter_line[:2] if model.scatter_line else (model.scatter, 0.0),
        "least_scatter": model.scatter_line[2] if model.scatter_line else model.scatter,
        "error": model.mean_absolute_error,
        "error_of_mixtures": model.error_of_mixtures,
        "behind": behind,
        "quantiles": {f"{level:g}": student_quantile(level, model.freedom) for level in LEVELS},
    }


def _quantities(fitted, published):
    """Return the names of all quantities that have a range in a model, sorted."""
    of_ours = (name for model in fitted.models.values() for name in model.features)
    of_theirs = (key for models in published.values() for model in models for key, _, _ in model["ranges"])
    return sorted({*of_ours, *of_theirs})


def _published(folder):
    """Return the models of Rettinger et al., dict from case to a list of models."""
    models = {}
    for (name, case), model in read_r22_models(folder).items():
        ranges = prediction.r22_ranges(name, model.slopes.index, folder)
        models.setdefault(case, []).append(
            {
                "model": name,
                "equation": int(model.equation),
                "intercept": model.intercept,
                "features": list(model.slopes.index),
                "slopes": model.slopes.tolist(),
                "ranges": [[key, *map(float, limits)] for key, limits in ranges],
            }
        )
    return models


def _case(name, case):
    """Return a case: its sieve curve, its specification, and the predictors that need nothing else.

    A case of a campaign that config/cases.tsv does not list (None) has only its name.
    """
    if case is None:
        return {"name": name, "bounds": [], "mass_fractions": [], "specification": "", "predictors": []}
    curve = case.curve.without_empty_ends()
    text, _ = sieve_specification(curve, Path(name), draw=False)
    text = text.replace(SYNTHETIC, SHAPES)
    text = text.replace(
        f"# Packs the sieve curve of {name}.", f"# Packs the sieve curve {name} with the measured form."
    )
    return {
        "name": name,
        "bounds": [1e3 * float(bound) for bound in curve.bounds],
        "mass_fractions": curve.mass_fractions.tolist(),
        "specification": text,
        "predictors": [
            {"name": predictor.name, "range": predictor.range, "n": float(predictor.porosity(curve))}
            for predictor in PREDICTORS
        ],
    }


def _quantiles(level):
    """Return Student's t of 1, 2, ... MOST_FREEDOM degrees of freedom."""
    return [round(student_quantile(level, freedom), 8) for freedom in range(1, MOST_FREEDOM + 1)]

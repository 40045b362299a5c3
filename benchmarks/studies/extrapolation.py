"""How often a model's prediction interval contains packings outside the range to which the model was fitted.

    python -m benchmarks.studies.extrapolation

For each model and feature, the 10 to 50 % of the packings with the largest or the smallest values are left out of the
fit and predicted. It prints one CSV row per model and class of distance (see simcore.models.fitted_range): the number
of predictions, their root mean square error, and the shares that the 95 % intervals contain by least squares alone and
with the widening of that rule.
"""

import sys

import numpy as np
import pandas as pd

from simcore.models.fitted_range import widening
from simcore.models.mixtures import MIXTURE
from simcore.models.regression import fit
from simcore.models.single_form import SINGLE_FORM
from simcore.models.tables import over_seeds
from simcore.models.unified import UNIFIED, single_form_statistics, unified_features
from simcore.paths import REFERENCE
from simcore.reference.committed_rows import read_mixtures, read_single_forms

CASE = "U1"
LEFT_OUT = (0.1, 0.2, 0.3, 0.4, 0.5)
CLASSES = (0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0)


def predictions(features, porosity):
    """Predict the packings beyond the fit, for each feature, end and share left out: columns distance, error, half.

    features (n, m), porosity (n,): DataFrame and array. half: half-width of the 95 % interval by least squares alone.
    """
    tables = []
    for name in features:
        order = np.argsort(features[name].to_numpy(), kind="stable")
        for ascending in (order, order[::-1]):
            for share in LEFT_OUT:
                kept = round((1 - share) * len(order))
                inner, outer = ascending[:kept], ascending[kept:]
                if (np.ptp(features.iloc[inner].to_numpy(), axis=0) == 0).any():
                    continue  # only packings of one form are left: nothing to fit their spread to
                model = fit(features.iloc[inner], porosity[inner])
                beyond = features.iloc[outer]
                n, _, upper = model.predict_interval(beyond)
                distance = model.distance_outside(beyond)
                half = (upper - n) / widening(distance)
                tables.append(pd.DataFrame({"distance": distance, "error": n - porosity[outer], "half": half}))
    return pd.concat(tables, ignore_index=True)


def by_distance(predicted):
    """Return one row per class of distance, from the table of `predictions`."""
    contained = np.abs(predicted.error) <= predicted.half
    widened = np.abs(predicted.error) <= predicted.half * widening(predicted.distance)
    table = predicted.assign(by_least_squares=contained, widened=widened, square=predicted.error**2)
    labels = ["inside", *(f"from {low:g}" for low in CLASSES)]
    classes = pd.cut(table.distance, [-1e-9, *CLASSES, np.inf], labels=labels)
    groups = table.groupby(classes, observed=True)
    rows = groups[["by_least_squares", "widened"]].mean().assign(rms_error=np.sqrt(groups.square.mean()))
    return rows.assign(predictions=groups.size()).reset_index(names="distance")


def campaign(folder):
    """Return (features, porosity) of each model's packings with sieve curve CASE in `folder`, by the model's name."""
    forms = over_seeds(read_single_forms(folder / "single_form.csv").query("case == @CASE"), "grain")
    mixtures = over_seeds(read_mixtures(folder / "form_mixture.csv").query("case == @CASE"), "sample")
    single = pd.DataFrame(dict(zip(SINGLE_FORM, (forms.L / forms.S, forms.L / forms.I), strict=True)))
    of_forms = unified_features(single_form_statistics(forms.L, forms.I, forms.S))
    of_mixtures = unified_features(mixtures)
    both = pd.concat([of_forms[list(UNIFIED)], of_mixtures[list(UNIFIED)]], ignore_index=True)
    n, mixed = forms.n.to_numpy(), mixtures.n.to_numpy()
    return {
        "single_form": (single, n),
        "form_mixture": (of_mixtures[list(MIXTURE)], mixed),
        "unified": (both, np.concatenate([n, mixed])),
    }


def main():
    tables = [
        by_distance(predictions(features, porosity)).assign(model=name)
        for name, (features, porosity) in campaign(REFERENCE).items()
    ]
    table = pd.concat(tables)[["model", "distance", "predictions", "rms_error", "by_least_squares", "widened"]]
    table.to_csv(sys.stdout, index=False, float_format="%.4g")


if __name__ == "__main__":
    main()

"""Score of the candidates on packed beds, and the rule by which one is chosen (docs/appendices/size_and_form_plan.md).

Every bed is predicted by fits in which its group was left out: the family of its sieve curve, or its form. A model of
the literature has no fitted parameter; it is scored on the same beds. Weights are 1 / (σ² + τ²) with the sampling error
σ of a bed and the scatter τ between beds, the same for all candidates.
"""

from typing import NamedTuple

import numpy as np

KEPT_WITHIN = 2.0  # standard errors above the best candidate, up to which the model in use is kept


class Score(NamedTuple):
    """Score of one candidate."""

    error: float  # weighted mean absolute error over the left-out beds
    excess: float  # error minus that of the best candidate
    excess_std_error: float  # standard error of the excess, groups counted as independent


def score(errors, weights, groups):
    """Return the Score of each candidate, dict by name; the best has an excess of 0 with the standard error 0.

    errors: dict from name to predicted minus packed porosity (n,), each from fits without the bed's group. weights
    (n,): of the beds. groups (n,): labels of what was left out together. ValueError if arrays differ in length, an
    error is not finite, or there are fewer than two groups.
    """
    weights, groups = np.asarray(weights, float), np.asarray(groups)
    labels = np.unique(groups)
    if len(labels) < 2:
        raise ValueError("score: beds of one group alone cannot be left out; give beds of two groups or more")
    sizes = {}
    for name, values in errors.items():
        sizes[name] = np.abs(np.asarray(values, float))
        if sizes[name].shape != weights.shape or weights.shape != groups.shape:
            raise ValueError(f"score: candidate {name} has {len(values)} errors for {len(weights)} beds; give one each")
        if not np.all(np.isfinite(sizes[name])):
            raise ValueError(f"score: candidate {name} has no prediction for every bed; leave the bed out for all")
    weights = weights / weights.sum()
    means = {name: float(weights @ size) for name, size in sizes.items()}
    best = min(means, key=means.get)
    scores = {}
    for name, size in sizes.items():
        excess = means[name] - means[best]
        # Beds of a group share a deviation: the standard error is that of a sum over groups.
        deviations = [
            float(weights[groups == label] @ (size - sizes[best] - excess)[groups == label]) for label in labels
        ]
        spread = np.sqrt(len(labels) / (len(labels) - 1) * np.sum(np.square(deviations)))
        scores[name] = Score(means[name], excess, float(spread))
    return scores


def choose(by_family, by_form, parameters, in_use=None):
    """Return the name of the chosen candidate.

    by_family, by_form: dicts of Score with families and with forms left out. parameters: number of fitted parameters,
    dict by name, in the order of preference among equally many. in_use: name of the candidate that was chosen before,
    None if there is none. It is kept if its excess is at most KEPT_WITHIN standard errors in both. Otherwise the
    candidate with the fewest parameters is chosen whose excess is at most one standard error in both; without one, the
    one with the least error over families.
    """

    def within(limit, name):
        return all(scores[name].excess <= limit * scores[name].excess_std_error for scores in (by_family, by_form))

    if in_use in parameters and within(KEPT_WITHIN, in_use):
        return in_use
    equal = [name for name in parameters if within(1.0, name)]
    if not equal:
        return min(parameters, key=lambda name: by_family[name].error)
    return min(equal, key=lambda name: parameters[name])

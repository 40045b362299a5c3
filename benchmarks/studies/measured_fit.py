"""How often the intervals of `fit` contain the truth, for measured beds made by a known model.

    python -m benchmarks.studies.measured_fit

Each of 200 draws makes beds of random form whose porosity follows a known model, plus normally distributed scatter: our
model plus an offset, our model rescaled, or a model of its own that is linear in 1/EQ and 1/EL. It prints one CSV row
per truth and number of beds: share of the 95 % confidence intervals that contain the true coefficients of the model of
this kind, and mean probability with which the 95 % prediction intervals of this model, and of the chosen model, contain
a new bed.
"""

import sys

import numpy as np
import pandas as pd
from scipy.stats import norm

from simcore.grains.measured_forms import Sample
from simcore.grains.statistics import equancy_statistics
from simcore.models.fitting import fit_reference_models
from simcore.models.measured_fit import choose, fit_candidates
from simcore.models.prediction import sample_features

DRAWS = 200
SCATTER = 0.006
OFFSET, RESCALING, OWN = 0.012, (-0.04, 1.2), (0.26, 0.03, 0.01)
CONFIGURATIONS = (
    ("offset", 3),
    ("offset", 6),
    ("offset", 12),
    ("rescaling", 6),
    ("rescaling", 12),
    ("features", 9),
    ("features", 18),
)


def random_beds(number, rng):
    """Return the features of `number` beds with random distributions of form."""
    mu_FL, mu_EL = rng.uniform(0.45, 0.8, number), rng.uniform(0.5, 0.8, number)
    sigma_FL, sigma_EL = rng.uniform(0.1, 0.18, (2, number))
    mu_EQ, sigma_EQ = equancy_statistics(mu_FL, sigma_FL, mu_EL, sigma_EL)
    rows = zip(mu_FL, sigma_FL, mu_EL, sigma_EL, mu_EQ, sigma_EQ, strict=True)
    return sample_features([Sample(f"bed {i}", 0, *map(float, row)) for i, row in enumerate(rows)])


def true_porosity(kind, beds, base):
    """Return the porosity of beds without scatter, (n,), and the true coefficients; base: our model."""
    ours = base.predict(beds)
    if kind == "offset":
        return ours + OFFSET, [OFFSET]
    if kind == "rescaling":
        return RESCALING[0] + RESCALING[1] * ours, RESCALING
    return OWN[0] + OWN[1] * beds.EQ_inv + OWN[2] * beds.EL_inv, OWN


def coverage(kind, number, base, draws=DRAWS, seed=0):
    """Return the coverage for one kind of truth and number of beds, a dict; base: PorosityModel that is corrected."""
    rng = np.random.default_rng([seed, number, len(kind)])
    hits, by_kind, by_chosen = [], [], []
    for _ in range(draws):
        beds, new = random_beds(number, rng), random_beds(1, rng)
        n, truth = true_porosity(kind, beds, base)
        beds = beds.assign(n=n + SCATTER * rng.normal(size=number), name=[f"bed {i}" for i in range(number)])
        expected = float(np.ravel(true_porosity(kind, new, base)[0])[0])
        candidates = fit_candidates(base, beds, "U1")
        of_kind = next(item for item in candidates if item.kind == kind)
        lower, upper = of_kind.coefficients[["lower", "upper"]].to_numpy().T
        hits.append((lower <= truth) & (truth <= upper))
        by_kind.append(probability(of_kind.model, new, expected))
        by_chosen.append(probability(choose(candidates).model, new, expected))
    row = {"truth": kind, "beds": number, "coefficients": np.mean(hits), "prediction": np.mean(by_kind)}
    return row | {"chosen": np.mean(by_chosen)}


def probability(model, new, expected):
    """Return the probability that the prediction interval of a PorosityModel contains a new bed with this porosity."""
    _, lower, upper = model.predict_interval(new)
    return float(norm.cdf((upper[0] - expected) / SCATTER) - norm.cdf((lower[0] - expected) / SCATTER))


def main():
    """Print the table as CSV."""
    base = fit_reference_models().models["unified", "U1"]
    rows = [coverage(kind, number, base) for kind, number in CONFIGURATIONS]
    pd.DataFrame(rows).to_csv(sys.stdout, index=False, float_format="%.3f")


if __name__ == "__main__":
    main()

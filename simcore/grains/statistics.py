# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Features of a packing whose grains differ in form: statistics of form over its grains."""

import numpy as np
import pandas as pd

from simcore.grains.form import features as form_features

# Statistics over the grains from which the features of the models follow.
STATISTICS = ("mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL")


def mixture_features(L, I, S):
    """Return the 104 features of one packing, Series; L >= I >= S: full axes of its grains (n,), in any one unit."""
    single = form_features(L, I, S)
    with np.errstate(invalid="ignore"):
        mean, std = single.mean(skipna=False), single.std(ddof=0, skipna=False)
        # Grains of one form differ only by rounding, whose inverse would be a feature of about 1e16.
        return combine_statistics(mean, std.mask(std <= 1e-12 * mean.abs(), 0.0))


def combine_statistics(mean, std):
    """Return the 104 features of one packing, Series: mean and standard deviation of the 26, and their inverses.

    mean, std: Series over the 26 features, number-based over the grains. The names are those in the tables of Rettinger
    et al. (2022), such as mu_EQ, sigma_EQ and mu_EQ_inv = 1/mu_EQ; for an inverse feature mu_1/EQ is the mean of 1/EQ,
    and mu_1/EQ_inv its inverse. A feature that is not finite for one grain has no finite statistics; usable_features
    leaves it out.
    """

    def rename(name):
        return f"1/{name.removesuffix('_inv')}" if name.endswith("_inv") else name

    statistics = pd.concat([mean.rename(rename).add_prefix("mu_"), std.rename(rename).add_prefix("sigma_")])
    with np.errstate(divide="ignore"):
        return pd.concat([statistics, (1.0 / statistics).add_suffix("_inv")])


def equancy_statistics(mu_FL, sigma_FL, mu_EL, sigma_EL):
    """Return mean and standard deviation of EQ = FL EL from those of FL and EL, which are assumed to be independent.

    Source: Rettinger et al. (2022).
    """
    mu_EQ = mu_EL * mu_FL
    variance = (mu_EL**2 + sigma_EL**2) * (mu_FL**2 + sigma_FL**2) - mu_EQ**2
    # If nothing varies, the difference is rounding and may be below 0.
    return mu_EQ, np.sqrt(np.maximum(variance, 0.0))


def few_grains_covariance(EQ, EL, counts=None):
    """Return the covariance (4, 4) of the errors of STATISTICS that follow from the limited number of grains.

    EQ, EL (n,): of the measured grains, which are taken as drawn independently from all grains. counts (n,): number of
    grains of each row; None: one. To first order in its deviation d from the mean, a grain changes mu of N grains by
    d/N and their sigma by (d² - sigma²)/(2 sigma N). The sum of the products of these changes is multiplied by
    N/(N - 1), because the deviations are from the mean of the same grains. The result is nan for one grain.
    """
    counts = np.ones(len(EQ)) if counts is None else np.asarray(counts, float)
    number = counts.sum()
    changes = []
    for values in (np.asarray(EQ, float), np.asarray(EL, float)):
        d = values - np.average(values, weights=counts)
        sigma = np.sqrt(np.average(d**2, weights=counts))
        changes += [d, (d**2 - sigma**2) / (2 * sigma) if sigma > 0 else np.zeros(len(d))]
    changes = np.array(changes)
    with np.errstate(invalid="ignore"):
        return (counts * changes) @ changes.T / np.float64(number * (number - 1.0))


def means_covariance(mu_FL, sigma_FL, mu_EL, sigma_EL, grains):
    """Return the covariance (4, 4) of few_grains_covariance of a number of grains of which only these are known.

    FL and EL are assumed to be independent and normally distributed, so that the variance of a mean is
    sigma²/(grains - 1), and that of a deviation half of it. equancy_statistics are linearised. grains: at least 2.
    """
    variances = np.array([sigma_FL**2, 0.5 * sigma_FL**2, sigma_EL**2, 0.5 * sigma_EL**2]) / (grains - 1.0)
    _, sigma_EQ = equancy_statistics(mu_FL, sigma_FL, mu_EL, sigma_EL)
    squares_FL, squares_EL = mu_FL**2 + sigma_FL**2, mu_EL**2 + sigma_EL**2
    of_deviation = [mu_FL * sigma_EL**2, sigma_FL * squares_EL, mu_EL * sigma_FL**2, sigma_EL * squares_FL]
    derivatives = np.array(
        [
            [mu_EL, 0.0, mu_FL, 0.0],
            np.array(of_deviation) / sigma_EQ if sigma_EQ > 0 else np.zeros(4),
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
    return (derivatives * variances) @ derivatives.T


def flatness_statistics(mu_EQ, sigma_EQ, mu_EL, sigma_EL):
    """Return mean and standard deviation of FL = EQ/EL from those of EQ and EL; the inverse of equancy_statistics.

    FL and EL are assumed to be independent, as they are in packings with a distribution of form.
    """
    mu_FL = mu_EQ / mu_EL
    square = (mu_EQ**2 + sigma_EQ**2) / (mu_EL**2 + sigma_EL**2)
    return mu_FL, np.sqrt(np.maximum(square - mu_FL**2, 0.0))

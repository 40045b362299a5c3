"""Reference tables made from a known porosity model, as a campaign commits them, and samples of one form."""

import numpy as np
import pandas as pd

from simcore.grains.measured_forms import Sample


def random_forms(number, seed=0):
    """Return random flatness and elongation, (2, number)."""
    return np.random.default_rng(seed).uniform(0.35, 0.95, (2, number))


def random_mixtures(number=16, seed=1):
    """Return a table of random means and standard deviations of form, one row per mixture."""
    rng = np.random.default_rng(seed)
    table = pd.DataFrame({"mu_EQ": rng.uniform(0.25, 0.55, number), "mu_EL": rng.uniform(0.5, 0.8, number)})
    return table.assign(sigma_EQ=rng.uniform(0.08, 0.16, number), sigma_EL=rng.uniform(0.1, 0.2, number), case="U1")


def porosity_of_form(flatness, elongation):
    """Return the porosity of grains of one form, by the model that the rows are made from."""
    return 0.30 + 0.02 / (flatness * elongation) + 0.01 / elongation


def write_reference(folder):
    """Write reference tables as a campaign does: two sources, two seeds, and ellipsoids, which must not count."""
    parts = []
    for source, seed in (("synthetic", 0), ("scans", 1)):
        flatness, elongation = random_forms(20, seed)
        table = pd.DataFrame({"grain": [f"G{i}" for i in range(20)], "L": 5 / elongation, "I": 5.0, "S": 5 * flatness})
        n = porosity_of_form(flatness, elongation) + (0.01 if source == "scans" else 0.0)
        for run, sign in ((1, 1), (2, -1)):
            mesh = table.assign(source=source, case="U1", representation="polyhedron", seed=run, n=n + sign * 1e-3)
            parts += [mesh, mesh.assign(representation="ellipsoid", n=0.2)]
    pd.concat(parts).to_csv(folder / "single_form.csv", index=False)
    table = random_mixtures()
    for name in ("mu_FL", "sigma_FL", "mu_EL", "sigma_EL"):
        table[f"{name}_nominal"] = np.arange(16) / 16
    table["n"] = 0.31 + 0.03 / table.mu_EQ - 0.003 / table.sigma_EQ + 0.02 / table.mu_EL - 0.002 / table.sigma_EL
    table.to_csv(folder / "form_mixture.csv", index=False)
    return folder


def sample_of_one_form(flatness, elongation):
    """Return a sample of one grain."""
    return Sample("one", 1, flatness, 0.0, elongation, 0.0, flatness * elongation, 0.0)

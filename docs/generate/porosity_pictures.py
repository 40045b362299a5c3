"""Pictures of the page "What porosity means here": a profile over height, and sampling errors against seeds."""

import functools

import numpy as np
import pandas as pd
import yaml
from matplotlib.figure import Figure

from simcore.paths import REFERENCE, ROOT

DARK, ORANGE, GRAIN = "#20313b", "#b3541e", "#e8dcc4"


@functools.cache
def bed():
    """Pack the bed of examples/polyhedra.yaml with three times as many grains, so that a part of it is evaluated."""
    from simcore.packing.single import pack

    specification = yaml.safe_load((ROOT / "examples" / "polyhedra.yaml").read_text(encoding="utf-8"))
    return pack(specification | {"amount": {"grains": 3 * specification["amount"]["grains"]}})


def profile():
    """Draw a cut through the bed, its porosity over height, and the evaluated part."""
    from simcore.evaluation.porosity import bulk_porosity, porosity_profile
    from simcore.report.figures.interval import interval_figure

    methods = {"slices of the grains": "exact", "slices of spheres of equal volume": "spheres"}
    profiles = {label: porosity_profile(bed(), 5e-4, method)["porosity"] for label, method in methods.items()}
    return interval_figure(bed(), profiles, bulk_porosity(bed()))


def seed_differences():
    """Return the differences of two seeds over their stated error, (n,), of the 63 synthetic single forms."""
    rows = pd.read_csv(REFERENCE / "single_form.csv")
    rows = rows.query("representation == 'polyhedron' and source == 'synthetic' and case == 'U1' and seed in (1, 2)")
    pairs = rows.pivot(index="grain", columns="seed", values=["n", "n_error"]).dropna()
    return ((pairs["n"][2] - pairs["n"][1]) / np.hypot(pairs["n_error"][1], pairs["n_error"][2])).to_numpy()


def sampling_error():
    """Draw how far two seeds of one form differ, in units of the sampling error that the packings state."""
    differences = seed_differences()
    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    axes = figure.subplots()
    edges = np.arange(-3.5, 3.51, 0.5)
    axes.hist(differences, edges, color=GRAIN, edgecolor=DARK, label=f"{len(differences)} pairs of packings")
    z = np.linspace(-3.5, 3.5, 200)
    expected = len(differences) * 0.5 * np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi)
    axes.plot(z, expected, color=ORANGE, lw=2.0, label="expected if the stated errors are right")
    axes.set(xlabel="difference of two seeds / its stated standard error [-]", ylabel="number of pairs [-]")
    axes.legend(fontsize="small", loc="upper left")
    axes.set_ylim(0.0, 1.45 * max(expected.max(), np.histogram(differences, edges)[0].max()))
    return figure


FIGURES = {"explanation/porosity_profile.png": profile, "explanation/sampling_error.png": sampling_error}

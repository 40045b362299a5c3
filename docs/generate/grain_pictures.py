"""Pictures of the page of the grains: their forms by size, a sheet of them, and one from its mesh to its ellipsoid."""

import functools

import pandas as pd

from simcore.paths import REFERENCE

WITH_FINE_MESH = "G35"  # 2146 triangles, and flatness and elongation near the mean


@functools.cache
def grains():
    """Make the 63 synthetic grains."""
    from simcore.grains.synthetic import synthetic_grains

    return synthetic_grains()


def forms():
    """Draw the synthetic grains in the Zingg diagram, coloured by sieve class, beside the Rhine's grains."""
    from simcore.reference.r22_tables import rhine_statistics
    from simcore.report.figures.grains import zingg_diagram

    table = pd.read_csv(REFERENCE / "grains" / "forms.csv")
    return zingg_diagram({"synthetic grains": table}, rhine_statistics())


def sheet():
    """Draw twelve of the synthetic grains from two sides."""
    from simcore.report.figures.single_grains import grain_sheet

    return grain_sheet(grains())


def steps():
    """Draw one grain as its mesh, its hulls, and its mass-equivalent ellipsoid."""
    from simcore.report.figures.single_grains import grain_steps

    return grain_steps(next(grain for grain in grains() if grain.name == WITH_FINE_MESH))


def mixtures():
    """Draw the 52 distributions of form in U1 in the Zingg diagram, with that of the Rhine's gravel."""
    from simcore.report.committed import findings

    return findings(REFERENCE)[1]["form_mixture_sets"]


FIGURES = {
    "appendices/grain_forms.png": forms,
    "appendices/grain_sheet.png": sheet,
    "appendices/grain_steps.png": steps,
    "appendices/form_mixtures.png": mixtures,
}

"""The picture of the page "Porosity from a sieve curve": how sizes lower the porosity, drawn and as a curve."""

import numpy as np
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from docs.generate.porosity_pictures import DARK, GRAIN, ORANGE
from simcore.grains.sieve import SieveCurve

FINE = "#c98f5a"
FINE_CLASS, COARSE_CLASS = (4e-3, 5.6e-3), (16e-3, 22.4e-3)  # [m], a ratio of 4
SHARES = np.linspace(0.0, 1.0, 81)  # of coarse grains by mass
SPACE = 0.94  # diameter of a drawn disc relative to the distance of the centres


def lattice(distance, size=1.0):
    """Return the points (n, 2) of a triangular lattice that cover a square of this size, centred on one point."""
    reach = int(np.ceil(size / distance)) + 1
    rows, columns = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    points = np.column_stack([(columns + 0.5 * (rows % 2)).ravel(), np.sqrt(0.75) * rows.ravel()]) * distance
    return points[np.abs(points).max(axis=1) < 0.5 * (size + distance)]


def sketches():
    """Return the three drawn beds: list of (title, discs), discs as (x, y, radius, colour)."""
    coarse, fine = lattice(0.4), lattice(0.1)
    large, small = 0.2 * SPACE, 0.05 * SPACE
    coarse_grains = [(x, y, large, GRAIN) for x, y in coarse]
    # The pores of the triangular lattice are the centres of its triangles; each takes a small disc.
    corners = coarse[:, None] + 0.4 * np.array([[0.5, 0.5 / np.sqrt(3)], [0.0, 1 / np.sqrt(3)]])
    pores = corners.reshape(-1, 2)
    touching = 0.4 / np.sqrt(3) - large  # radius of the disc that touches three coarse grains
    filling = [(x, y, SPACE * touching, FINE) for x, y in pores]
    around = fine[np.hypot(*fine.T) > large + small]
    return [
        ("coarse grains alone", coarse_grains),
        ("fine grains fill\nthe pores of coarse ones", coarse_grains + filling),
        ("a coarse grain replaces\nfine ones and their pores", [(0.0, 0.0, large, GRAIN)]
         + [(x, y, small, FINE) for x, y in around]),
    ]  # fmt: skip


def binary_porosities(model, one_class):
    """Return the porosity (n,) of mixtures of a fine and a coarse class with SHARES of coarse grains by mass."""
    bounds = [*FINE_CLASS, *COARSE_CLASS]
    return np.array([model.predict(SieveCurve(bounds, [1 - share, 0.0, share], ""), one_class) for share in SHARES])


def size_effects():
    """Draw three beds, and the porosity of mixtures of fine and coarse grains by the model that `predict` uses."""
    from simcore.models.size_and_form.sized_model import current_model
    from simcore.models.size_and_form.stretch import REFERENCE_POROSITY

    n = binary_porosities(current_model(), REFERENCE_POROSITY)
    figure = Figure(figsize=(9.0, 6.2), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(1.0, 1.1))
    for axes, (title, discs) in zip(top.subplots(1, 3), sketches(), strict=True):
        patches = [Circle((x, y), radius, facecolor=colour, edgecolor=DARK, lw=0.6) for x, y, radius, colour in discs]
        axes.add_collection(PatchCollection(patches, match_original=True))
        axes.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), aspect="equal", xticks=[], yticks=[])
        axes.set_title(title, fontsize=9.5)
    axes = bottom.subplots()
    axes.axhline(REFERENCE_POROSITY, color=DARK, ls="--", lw=1.0)
    axes.text(
        50.0, REFERENCE_POROSITY + 0.004, "one sieve class of the same grains", ha="center", fontsize=9, color=DARK
    )
    axes.plot(100 * SHARES, n, color=ORANGE, lw=2.2)
    least = int(np.argmin(n))
    for share, text, place in (
        (0.28, "coarse grains replace\nfine ones and their pores", (14.0, 0.26)),
        (0.9, "fine grains fill the\npores of coarse ones", (77.0, 0.305)),
    ):
        at = 100 * share, float(np.interp(share, SHARES, n))
        axes.annotate(text, at, place, fontsize=9, ha="center", arrowprops={"arrowstyle": "->", "color": DARK})
    axes.plot(100 * SHARES[least], n[least], "o", color=ORANGE)
    axes.set(xlabel="share of coarse grains in the mass of the bed [%]", ylabel="porosity [-]", xlim=(0, 100))
    axes.set_ylim(n.min() - 0.025, REFERENCE_POROSITY + 0.02)
    return figure


FIGURES = {"how_to/size_effects.png": size_effects}

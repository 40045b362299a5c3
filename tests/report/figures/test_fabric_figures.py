"""Figures of the fabric show the numbers of the datasets."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb

from simcore.evaluation.axis_statistics import equal_solid_angles
from simcore.report.figures.fabric import STYLES, contact_radius_figure, fabric_figure


def fabric(second, axes=True, n_bins=4):
    """Return a fabric with one P2 term, of axes too or of normals alone, and a made-up radial distribution."""
    edges = equal_solid_angles(n_bins)
    height = np.cos(edges)
    # The density is the mean over a bin of 1 + 5 a P2, whose integral is c + 5 a (c³ - c) / 2.
    density = np.diff(height + 2.5 * second * (height**3 - height)) / np.diff(height)
    present = np.array([1.0, 1.0 if axes else np.nan, 1.0 if axes else np.nan])[:, None]
    return xr.Dataset(
        {
            "density": (("direction", "angle"), present * density),
            "density_std_error": (("direction", "angle"), present * np.full(n_bins, 0.1)),
            "legendre": (("direction", "order"), present * [second, 0.0, 0.0]),
            "contact_radius_density": ("radius", [0.0, 0.0, 12.0, 8.0, 0.0]),
            "contact_radius_density_std_error": ("radius", np.full(5, 0.5)),
            "surface_radius_density": ("radius", [0.0, 0.0, 16.0, 4.0, 0.0]),
        },
        {
            "direction": ["contact_normal", "long_axis", "short_axis"],
            "order": [2, 4, 6],
            "angle_bounds": (("angle", "bound"), np.stack([edges[:-1], edges[1:]], axis=1)),
            "radius": 0.05 * np.arange(1, 6),
        },
    )


def test_steps_bands_and_curves_are_those_of_the_dataset(tmp_path):
    figure = fabric_figure({"round": fabric(0.0, axes=False), "flat": fabric(0.2)}, crossing={"contact_normal": 0.955})
    figure.savefig(tmp_path / "fabric.png", dpi=40)
    normals, long_axes, _ = figure.axes
    assert [axes.get_title() for axes in figure.axes] == ["normals of contacts", "long axes", "short axes"]
    assert "solid angle" in normals.get_ylabel() and "[-]" in normals.get_ylabel()
    assert all("[°]" in axes.get_xlabel() for axes in figure.axes)
    curves = {line.get_label(): line.get_xydata() for line in normals.get_lines()}
    np.testing.assert_allclose(curves["flat (± standard error)"][[0, -1]], [[0, 2.0], [90, 0.5]], atol=1e-12)
    np.testing.assert_allclose(curves["round (± standard error)"][:, 1], 1.0)
    np.testing.assert_allclose(curves["isotropic"][:, 1], 1.0)
    np.testing.assert_allclose(curves["crossing"][:, 0], np.degrees(0.955))
    assert "54.7°" in [text.get_text() for text in normals.texts]
    steps = normals.patches[1].get_data()
    np.testing.assert_allclose(steps.values, fabric(0.2)["density"].values[0])
    np.testing.assert_allclose(steps.edges, np.degrees(equal_solid_angles(4)))
    band = normals.collections[1].get_paths()[0].vertices
    assert band[:, 1].max() == pytest.approx(steps.values.max() + 0.1)
    # Spheres have no axes: nothing is drawn of them there, and the legend names each label once.
    assert len(long_axes.patches) == 1
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(labels) == len(set(labels)) == 4


def test_kinds_of_directions_that_nobody_has_get_no_panel():
    assert len(fabric_figure({"spheres": fabric(0.0, axes=False)}).axes) == 1
    assert [axes.get_title() for axes in fabric_figure({"a": fabric(0.1)}, ["long_axis"]).axes] == ["long axes"]


def test_contacts_are_drawn_in_front_of_the_surface(tmp_path):
    figure = contact_radius_figure({"flat": fabric(0.2), "round": fabric(0.0)})
    figure.savefig(tmp_path / "radius.png", dpi=40)
    assert len(figure.axes) == 2
    axes = figure.axes[0]
    surface, contacts = (patch.get_data() for patch in axes.patches)
    np.testing.assert_allclose(surface.values, [0, 0, 16, 4, 0])
    np.testing.assert_allclose(contacts.values, [0, 0, 12, 8, 0])
    np.testing.assert_allclose(surface.edges, 0.025 + 0.05 * np.arange(6))
    # The axis shows only the occupied range, from the edge at 0.125 to that at 0.225, with a margin.
    assert axes.get_xlim() == pytest.approx((0.025, 0.325))


def test_they_read_in_grey():
    """Each style has its own line, and the first two, mostly used, differ in lightness (luma) by a fifth."""
    assert len({str(line) for _, line in STYLES}) == len(STYLES)
    luma = [np.dot([0.299, 0.587, 0.114], to_rgb(color)) for color, _ in STYLES]
    assert luma[1] - luma[0] > 0.2 and (np.diff(luma) > -0.1).all()


def test_too_many_are_refused():
    many = {str(k): fabric(0.1) for k in range(6)}
    for draw in (fabric_figure, contact_radius_figure):
        with pytest.raises(ValueError, match="6 fabrics were given, but it can draw 1 to 5"):
            draw(many)

"""The rendered picture shows each grain at its place."""

import numpy as np
import pytest

from simcore.report.figures.rendering import camera_axes, project, render
from tests.helpers.packings import make_packing
from tests.helpers.polyhedra import CUBE

RED, BLUE = [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]


def shown_area(image, extent):
    """Return the area covered by grains [m²]."""
    rows, columns = image.shape[:2]
    return image[..., 3].sum() * (extent[1] - extent[0]) / columns * (extent[3] - extent[2]) / rows


def test_silhouettes_have_their_area():
    """The error of counting pixels, about the root of the outline's pixels over the area, is far below 1 %."""
    sphere = make_packing([[1.0, 2.0, 3.0]], 0.7)
    image, extent = render(sphere, [RED], pixels=400)
    assert shown_area(image, extent) == pytest.approx(np.pi * 0.49, rel=5e-3)
    cube = make_packing([[0.0, 0.0, 0.0]], 2.0, vertices=CUBE)
    image, extent = render(cube, [RED], azimuth=-90.0, elevation=90.0, pixels=400)
    assert shown_area(image, extent) == pytest.approx(4.0, rel=1e-2)
    # Along a diagonal of the horizontal a cube shows sqrt(2) times its face.
    image, extent = render(cube, [RED], azimuth=45.0, elevation=0.0, pixels=400)
    assert shown_area(image, extent) == pytest.approx(4.0 * np.sqrt(2), rel=1e-2)


def test_nearer_grains_hide_farther_ones():
    stack = make_packing([[0, 0, 0], [0, 0, 5]], [[1.0, 1.0, 1.0], [0.5, 0.5, 0.5]])
    image, _ = render(stack, [RED, BLUE], azimuth=-90.0, elevation=90.0, pixels=200)
    middle = np.array(image.shape[:2]) // 2
    assert image[middle[0], middle[1], 2] > 0 == image[middle[0], middle[1], 0]
    assert image[middle[0], 10, 0] > 0 == image[middle[0], 10, 2]


def test_picture_lies_at_the_projected_place():
    pair = make_packing([[0.0, 0.0, 0.0], [4.0, 1.0, 2.0]], 0.5)
    _, extent = render(pair, [RED, BLUE], azimuth=-60.0, elevation=20.0, pixels=600)
    centres = project(pair["position"].values, -60.0, 20.0)
    expected = [
        *(centres[:, 0].min() - 0.5, centres[:, 0].max() + 0.5),
        centres[:, 1].min() - 0.5,
        centres[:, 1].max() + 0.5,
    ]
    assert extent == pytest.approx(expected, abs=0.02)


def test_camera_from_above_has_x_to_the_right_and_y_up():
    np.testing.assert_allclose(camera_axes(-90.0, 90.0), np.eye(3), atol=1e-15)
    axes = camera_axes(33.0, 20.0)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)

"""Pictures of single grains show the grains that they name, with the proportions of their axes."""

import numpy as np
import pytest

from simcore.grains.synthetic import synthetic_grains
from simcore.report.figures import single_grains


@pytest.fixture(scope="module")
def grains():
    return synthetic_grains(n=21)


def test_the_sheet_orders_grains_by_elongation_and_flatness(grains, tmp_path):
    figure = single_grains.grain_sheet(grains)
    figure.savefig(tmp_path / "sheet.png", dpi=40)
    by_name = {grain.name: grain for grain in grains}
    texts = [text for text in figure.axes[0].texts if text.get_text()[0] == "G"]
    assert len(texts) == 12 == len({text.get_text() for text in texts})
    for text in texts:
        grain = by_name[text.get_text()[:3]]
        assert text.get_text().endswith(f"EL = {grain.elongation:.2f}, FL = {grain.flatness:.2f}")
    rows = np.array([by_name[text.get_text()[:3]].elongation for text in texts]).reshape(3, 4)
    columns = np.array([by_name[text.get_text()[:3]].flatness for text in texts]).reshape(3, 4)
    assert (np.diff(columns, axis=1) > 0).all() and (rows[:-1].min(axis=1) > rows[1:].max(axis=1)).all()
    assert np.allclose(np.ptp([text.get_position()[0] for text in texts[::4]]), 0.0)


@pytest.mark.parametrize(("given", "shown"), [(1, 1), (9, 8)])
def test_a_sheet_of_few_grains_has_fewer_classes(grains, given, shown):
    texts = single_grains.grain_sheet(grains[:given]).axes[0].texts
    assert sum(text.get_text()[0] == "G" for text in texts) == shown


def test_a_grain_is_turned_as_its_quaternion_says(grains):
    """Seen from above it is as wide as its mesh along L and as high as along I; seen along L as wide as along I."""
    grain = grains[0]
    sizes = np.ptp(grain.vertices, axis=0)  # along S, I, L
    for quaternion, expected in ((single_grains.FROM_ABOVE, sizes[[2, 1]]), (single_grains.ALONG_L, sizes[[1, 0]])):
        bed = single_grains.as_packing([(grain, quaternion, (0.0, 0.0))], single_grains.ABOVE)
        image, extent = single_grains.render(bed, [[1.0, 1.0, 1.0]], **single_grains.ABOVE, pixels=400)
        drawn = extent[1] - extent[0], extent[3] - extent[2]
        np.testing.assert_allclose(drawn, expected, atol=2.5 * grain.L / 400)  # pixels at both ends


def test_the_steps_are_mesh_hulls_and_ellipsoid(grains, tmp_path):
    grain = max(grains, key=lambda grain: len(grain.faces))
    figure = single_grains.grain_steps(grain, faces=(100, 60))
    figure.savefig(tmp_path / "steps.png", dpi=40)
    titles = [axes.get_title() for axes in figure.axes]
    assert titles[0].endswith(f"{len(grain.faces)} triangles") and "100" in titles[1] and "60" in titles[2]
    edges = [len(axes.collections[0].get_segments()) for axes in figure.axes[:3]]
    assert edges[0] > edges[1] > edges[2]  # only those that are turned to the camera
    ellipsoid = figure.axes[3].texts[-1].get_text()
    share = np.pi / 6 * grain.L * grain.I * grain.S / grain.volume
    assert f"volume {100 * share:.1f} %" in ellipsoid and f"FL {grain.flatness:.3f}" in ellipsoid
    assert {"S", "I", "L"} <= {text.get_text() for text in figure.axes[3].texts}

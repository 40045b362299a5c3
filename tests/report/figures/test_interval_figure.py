"""The figure of the evaluation interval: a cut through the grains, and the lengths that are left out."""

import numpy as np
import pytest

from simcore.evaluation.porosity import bulk_porosity, porosity_profile
from simcore.report.figures.interval import cut_outlines, interval_figure
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.polyhedra import CUBE


@pytest.fixture
def bed():
    centres, width = sphere_lattice("bcc", 3, 6)
    return make_packing(1e-2 * centres, 5e-3, width=1e-2 * width)


def test_the_figure_divides_the_bed_into_three(bed, tmp_path):
    profile, bulk = porosity_profile(bed)["porosity"], bulk_porosity(bed)
    figure = interval_figure(bed, {"grains": profile}, bulk)
    figure.savefig(tmp_path / "f.png", dpi=40)
    right = figure.axes[1]
    lengths = [float(text.get_text().split("\n")[1].split()[0]) for text in right.texts if "mm" in text.get_text()]
    floor, surface, top = (1e3 * float(bulk[name]) for name in ("z_lower", "z_upper", "bed_top"))
    np.testing.assert_allclose(lengths, [floor, surface - floor, top - surface], atol=0.5)
    assert [text.get_text() for text in right.get_legend().get_texts()] == ["grains"]
    assert all("[" in label for label in (right.get_xlabel(), *map(lambda a: a.get_xlabel(), figure.axes)))


def test_a_cylinder_leaves_nothing_out(bed):
    bed.attrs["domain_shape"] = "cylinder"
    texts = [t.get_text() for t in interval_figure(bed, {}, bulk_porosity(bed)).axes[1].texts]
    assert any(text.startswith("evaluated") for text in texts) and not any("left out" in text for text in texts)


def test_a_cut_has_the_size_of_the_grains():
    """A sphere 3 mm away from the plane shows a circle of 4 mm; the mesh of the sphere is 1 % inside it."""
    bed = make_packing([[0.02, 0.023, 0.03]], 5e-3, width=0.04)
    (outline,) = cut_outlines(bed, 0.02)
    radius = np.linalg.norm(outline - [0.02, 0.03], axis=1)
    np.testing.assert_allclose(radius, 4e-3, rtol=0.015)
    assert cut_outlines(bed, 0.03) == []


def test_a_grain_at_a_side_is_there_at_both():
    bed = make_packing([[0.0, 0.04, 0.01]], 4e-3, vertices=CUBE, width=0.04)
    places = sorted(outline[:, 0].mean() for outline in cut_outlines(bed, 0.0))
    np.testing.assert_allclose(places, [0.0, 0.04], atol=1e-9)
    bed.attrs["domain_shape"] = "cylinder"
    assert len(cut_outlines(bed, 0.04)) == 1 and cut_outlines(bed, 0.0) == []

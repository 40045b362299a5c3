"""A packing of polyhedra and ellipsoids in one bed: packed, saved, sliced, drawn."""

import numpy as np
import pytest

from simcore.evaluation.evaluate import evaluate
from simcore.evaluation.slicing import slab_volumes, vertical_extent
from simcore.grains.mesh import make_grain
from simcore.packing.file import packing_dataset, read_packing, write_packing
from simcore.packing.process import pack
from simcore.report.figures.rendering import render
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

SPECIFICATION = {
    "name": "both",
    "domain": {"width": "30 mm", "height": "0.25 m"},
    "shapes": {"kind": "mixed", "ellipsoid_share": 0.5},
    "faces": "original",
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
    "amount": {"grains": 70},
    "shaking": {"duration": "0.1 s"},
    "numerics": {"contact_time": "1 ms"},
}
SPHERE = 3  # index of the sphere's base shape, after three grains


def load_grains(group):
    rng = np.random.default_rng(11)
    directions = rng.normal(size=(3, 40, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    return [make_grain(f"g{k}", 1e-3 * points * [2.0, 3.0, 3.5 + k]) for k, points in enumerate(directions)]


@pytest.fixture(scope="module")
def made():
    specification = resolve(SPECIFICATION)
    setup = set_up(specification, load_grains)
    packed = pack(setup.scene, setup.bases, setup.draw)
    sample = setup.sample(np.arange(len(packed.bodies.mass)))
    attributes = {"largest_sieve_size": setup.curve.largest, "cpu_seconds": 1.0}
    return packed, packing_dataset(setup.scene, setup.bases, packed, sample, specification, **attributes)


def test_both_kinds_lie_in_one_bed_at_rest(made):
    packed, dataset = made
    smooth = dataset["shape"].values == SPHERE
    assert 20 < smooth.sum() < 50
    assert packed.observation.unbalanced_force < 0.02
    assert packed.observation.max_overlap < 2e-4
    a, b = packed.contacts.body_a, packed.contacts.body_b
    touching = packed.contacts.touching > 0
    for kinds in (0, 1, 2):
        assert (touching & (smooth[a].astype(int) + smooth[b] == kinds)).sum() > 10


def test_only_hulls_have_patches(made):
    """A contact of a smooth body is a point, so its torque is that of its force alone."""
    packed, dataset = made
    contacts, walls = packed.contacts, packed.walls
    smooth = dataset["shape"].values == SPHERE
    touching = contacts.touching > 0
    point = smooth[contacts.body_a] | smooth[contacts.body_b]
    assert (contacts.spread[point] == 0.0).all()
    assert (contacts.spread[touching & ~point, :3].sum(axis=1) > 0.0).all()
    lever = np.cross(contacts.point, contacts.force)
    off = np.abs(contacts.torque_a + lever).max(axis=1)
    scale = np.abs(contacts.force).max() * packed.bodies.radius.max()
    assert (off[touching & point] <= 1e-15 * scale).all()
    assert (walls.spread[smooth[walls.body]] == 0.0).all()


def test_it_is_filed_sliced_and_evaluated(made, tmp_path):
    _, dataset = made
    write_packing(tmp_path / "both.nc", dataset)
    read = read_packing(tmp_path / "both.nc")
    assert list(read["shape_kind"].values) == ["convex"] * 3 + ["sphere"]
    low, high = vertical_extent(read, "exact")
    assert (low > -1e-4).all()
    edges = np.array([-0.01, *np.linspace(0.0, 0.1, 50)])
    assert high.max() < edges[-1]
    each = slab_volumes(read, edges, "exact", per_grain=True)
    np.testing.assert_allclose(each.sum(axis=1), read["volume"].values, rtol=1e-12)
    found = evaluate(read, cut=8e-3)
    # Closest packings of equal ellipsoids have porosities of some 0.23, loose beds of rough angular grains up to 0.5.
    assert 0.25 < float(found.n_exact) < 0.5
    assert float(found.n) == pytest.approx(float(found.n_exact), abs=0.05)
    assert 3.0 < float(found.coordination_number) < 9.0


def test_the_picture_frames_the_bed(made):
    """The scale of a polyhedron is a factor and that of an ellipsoid a length; the frame must not confuse them."""
    _, dataset = made
    image, extent = render(dataset, np.tile([1.0, 0.0, 0.0], (70, 1)), azimuth=-90.0, elevation=90.0, pixels=200)
    assert extent[1] - extent[0] < 0.045 and extent[3] - extent[2] < 0.045
    assert min(image.shape[:2]) > 100

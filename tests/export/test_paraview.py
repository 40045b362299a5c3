"""Files for ParaView, read back with meshio and with VTK's own reader (pyvista)."""

import meshio
import numpy as np
import pytest
import pyvista
import trimesh

from simcore.evaluation.coordination import coordination_number
from simcore.export.export import export
from simcore.export.paraview import contact_lines
from tests.helpers.packings import make_packing, sphere_lattice, touching_pairs
from tests.helpers.random_beds import KINDS, WIDTH, strew


def lattice():
    """Return a body-centred cubic bed of 10 mm spheres on a floor, with all contacts through the sides of the box."""
    centres, width = sphere_lattice("bcc", 2, 3)
    pairs, images = touching_pairs(centres, width)
    floor = [(int(g), -1) for g in np.flatnonzero(centres[:, 2] == 0.5)]
    contacts = np.concatenate([pairs, floor])
    images = np.concatenate([images, np.zeros((len(floor), 2), int)])
    return make_packing(1e-2 * centres, 5e-3, width=1e-2 * width, contacts=contacts, images=images)


def columns(packing):
    """Return the columns of the grains in the files."""
    length, middle, short = (packing[name].values for name in "LIS")
    numbers = {name: packing[name].values for name in ("D", "L", "I", "S", "volume")}
    contacts = coordination_number(packing)["contacts"].values
    return numbers | {"FL": short / middle, "EL": middle / length, "coordination": contacts}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("periodic", ["leave", "cut"])
def test_solids_have_the_volume_and_the_numbers_of_their_grain(tmp_path, kind, periodic):
    packing = strew(kind, contacts=[(0, 1), (1, 2), (2, -1)])
    paths = export(packing, tmp_path / "bed.vtu", periodic)
    assert [path.name for path in paths] == ["bed.vtu", "bed_contacts.vtu"]
    mesh = meshio.read(tmp_path / "bed.vtu")
    volumes, data = np.zeros(packing.sizes["grain"]), {}
    for block, cells in enumerate(mesh.cells):
        grains = mesh.cell_data["grain"][block]
        for grain, faces in zip(grains, cells.data, strict=True):
            volumes[grain] += trimesh.Trimesh(mesh.points, np.array(faces), process=False).volume
        for name in mesh.cell_data:
            data.setdefault(name, np.full(len(volumes), np.nan))[grains] = mesh.cell_data[name][block]
    np.testing.assert_allclose(volumes, packing["volume"].values, rtol=1e-6)
    for name, values in columns(packing).items():
        np.testing.assert_allclose(data[name], values, rtol=1e-14, err_msg=name)
    # VTK reads the same solids: sections of a solid are filled, and its surface encloses the volume.
    grid = pyvista.read(tmp_path / "bed.vtu")
    surface = grid.extract_surface(algorithm=None).triangulate()
    assert surface.volume == pytest.approx(packing["volume"].values.sum(), rel=1e-6)
    assert grid.slice(normal="z", origin=(0, 0, 0.02)).area > 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_surfaces_have_the_numbers_of_their_grain(tmp_path, kind):
    packing = strew(kind, contacts=[(0, 1), (1, 2), (2, -1)])
    export(packing, tmp_path / "bed.vtp")
    mesh = pyvista.read(tmp_path / "bed.vtp")
    assert mesh.volume == pytest.approx(packing["volume"].values.sum(), rel=1e-6)
    grain = mesh["grain"]
    assert set(grain) == set(range(packing.sizes["grain"]))
    for name, values in columns(packing).items():
        np.testing.assert_allclose(mesh[name], values[grain], rtol=1e-14, err_msg=name)
    centres = np.array([mesh.extract_cells(grain == g).center for g in range(packing.sizes["grain"])])
    np.testing.assert_allclose(
        centres, packing["position"].values, atol=6e-4
    )  # centre of the bounding box, not of mass


@pytest.mark.parametrize("suffix", [".vtu", ".vtp"])
def test_contacts_have_their_force_and_overlap(tmp_path, suffix):
    packing = lattice()
    packing["contact_overlap"][:] = np.linspace(1e-7, 2e-7, packing.sizes["contact"])
    packing["contact_overlap"][3] = 0.0  # remembered, but apart
    packing["contact_force"] = 2.5 * packing["contact_normal"]
    _, path = export(packing, tmp_path / f"bed{suffix}")
    lines = pyvista.read(path)
    touching = packing["contact_overlap"].values > 0.0
    assert lines.n_cells == touching.sum() == packing.sizes["contact"] - 1
    np.testing.assert_array_equal(lines["overlap"], packing["contact_overlap"].values[touching])
    np.testing.assert_allclose(lines["force"], 2.5, rtol=1e-14)
    np.testing.assert_allclose(lines["normal_force"], 2.5, rtol=1e-14)
    np.testing.assert_array_equal(lines["force_vector"], packing["contact_force"].values[touching])
    np.testing.assert_array_equal(
        np.column_stack([lines["first"], lines["second"]]), packing["contact_body"].values[touching]
    )
    # Lines between touching spheres are one diameter long, lines to the floor one radius.
    lengths = np.linalg.norm(np.diff(lines.points.reshape(-1, 2, 3), axis=1)[:, 0], axis=1)
    np.testing.assert_allclose(lengths, np.where(lines["second"] >= 0, 1e-2, 5e-3), rtol=1e-5)


def test_contacts_through_a_side_are_left_copied_or_cut():
    packing = lattice()
    through = packing["contact_image"].values.any(axis=1)
    assert through.sum() > 10
    left, table, _ = contact_lines(packing, "leave")
    assert len(left) == len(table) == packing.sizes["contact"]
    copied, _, vectors = contact_lines(packing, "copy")
    assert len(copied) == packing.sizes["contact"] + through.sum()
    assert vectors["point"].shape == vectors["force_vector"].shape == (len(copied), 3)
    width = packing.attrs["domain_width"]
    pieces, table, _ = contact_lines(packing, "cut")
    assert pieces[..., :2].min() >= -1e-15 and pieces[..., :2].max() <= width + 1e-15
    # The pieces of a line sum to the line, also of one through an edge of the box.
    lengths = np.bincount(table.index, weights=np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1))
    total = np.zeros(packing.sizes["contact"])
    keys = {tuple(row): k for k, row in enumerate(contact_keys(packing))}
    rows = [keys[tuple(row)] for row in table[["first", "second", "image_x", "image_y"]].to_numpy()]
    np.add.at(total, rows, lengths)
    np.testing.assert_allclose(total, np.linalg.norm(left[:, 1] - left[:, 0], axis=1), rtol=1e-12)


def test_a_line_through_an_edge_of_the_box_has_three_pieces():
    radius = 0.5 * np.linalg.norm([1.1e-2, 1.5e-2])
    packing = make_packing(
        [[0.098, 0.09, 0.05], [0.009, 0.005, 0.05]], radius, width=0.1, contacts=[(0, 1)], images=[(1, 1)]
    )
    pieces, _, _ = contact_lines(packing, "cut")
    assert len(pieces) == 3
    assert np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1).sum() == pytest.approx(2.0 * radius)


def contact_keys(packing):
    return np.column_stack([packing["contact_body"].values, packing["contact_image"].values])


def test_a_bed_without_contacts_is_written_too(tmp_path):
    for suffix in (".vtu", ".vtp"):
        _, path = export(strew("sphere"), tmp_path / f"bed{suffix}")
        assert pyvista.read(path).n_cells == 0


def test_contact_lines_of_a_grain_wider_than_half_the_box_end_at_the_sides():
    packing = make_packing([[0.002, 0.01, 0.01]], 1e-2, width=WIDTH, contacts=[(0, -1)])
    lines, _, _ = contact_lines(packing, "cut")
    np.testing.assert_allclose(lines[0], [[0.002, 0.01, 0.01], [0.002, 0.01, 0.0]], atol=1e-15)


@pytest.mark.parametrize("place", [[0.0995, 0.05, 0.002], [0.0995, 0.0005, 0.002], [0.05, 0.0005, 0.002]])
def test_a_line_to_the_floor_through_a_side_keeps_its_length(place):
    """The grain touches the floor with a point beside its centre, beyond a side or an edge of the box."""
    packing = make_packing([place], 2e-3, width=0.1, contacts=[(0, -1)])
    aside = np.where(np.array(place[:2]) > 0.06, 1e-3, np.where(np.array(place[:2]) < 0.04, -1e-3, 0.0))
    packing["contact_point"][0] = [*(place[:2] + aside), 0.0]
    pieces, _, vectors = contact_lines(packing, "cut")
    assert len(pieces) == 2
    length = np.linalg.norm(np.r_[aside, place[2]])
    assert np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1).sum() == pytest.approx(length)
    assert (pieces[..., :2] >= -1e-15).all() and (pieces[..., :2] <= 0.1 + 1e-15).all()

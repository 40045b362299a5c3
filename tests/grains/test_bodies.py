"""Several bodies in one file: refused with their volumes, or split; cavities and touching parts stay one."""

import numpy as np
import pytest
import trimesh

from simcore.grains.bodies import mesh_bodies
from simcore.grains.readers import read_grain, read_grain_files, read_grains_of


def ball(radius=5.0, place=(0, 0, 0), level=2):
    return trimesh.creation.icosphere(level, radius).apply_translation(place)


def inward(mesh):
    mesh.invert()
    return mesh


def together(*meshes):
    return trimesh.util.concatenate(meshes)


def turntable():
    return trimesh.creation.box((40, 40, 2)).apply_translation([0, 0, -7])


SEVERAL = {
    "two stones": (lambda: together(ball(), ball(4, (30, 0, 0))), 2),
    "a stone on a turntable": (lambda: together(ball(), turntable()), 2),
    "a chip of noise": (lambda: together(ball(), ball(0.2, (6, 1, 0), 0)), 2),
    "stones that overlap": (lambda: together(ball(), ball(4, (6, 0, 0))), 2),
    "three": (lambda: together(ball(), ball(4, (30, 0, 0)), ball(3, (0, 30, 0))), 3),
}


def write(path, mesh):
    if path.name.endswith(".ascii.stl"):
        # Each body is a solid of its own, as several exporters write it.
        parts = mesh.split(only_watertight=False)
        path.write_text("\n".join(part.export(file_type="stl_ascii") for part in parts))
    else:
        mesh.export(path)
    return path


@pytest.mark.parametrize("kind", SEVERAL)
@pytest.mark.parametrize("name", ["a.stl", "a.ascii.stl", "a.obj", "a.ply", "a.off"])
def test_several_bodies_are_refused_with_their_number_and_volumes(tmp_path, kind, name):
    make, number = SEVERAL[kind]
    mesh = make()
    volumes = sorted((part.volume for part in mesh.split(only_watertight=False)), reverse=True)
    with pytest.raises(ValueError, match=rf"it has {number} separate bodies, of .* mm³.*grains\.bodies") as error:
        read_grain(write(tmp_path / name, mesh), "mm")
    said = str(error.value).split("bodies, of ")[1].split(" mm³")[0].split(", ")
    np.testing.assert_allclose([float(word) for word in said], volumes, rtol=5e-3)


def test_split_makes_a_grain_of_each_body(tmp_path):
    path = write(tmp_path / "a.stl", together(ball(4, (30, 0, 0)), ball(), ball(0.3, (9, 0, 0))))
    grains = read_grains_of(path, "mm", bodies="split")
    assert [grain.name for grain in grains] == ["a_1", "a_2", "a_3"]
    for grain, radius in zip(grains, (5, 4, 0.3), strict=True):
        assert grain.volume == pytest.approx(ball(radius).volume * 1e-9, rel=1e-5)
        assert grain.hull_ratio == pytest.approx(1, rel=1e-5)
    assert [len(grain.notes) for grain in grains] == [0, 0, 1] and "noise" in grains[2].notes[0]


def test_largest_leaves_the_others_out_with_a_note(tmp_path):
    path = write(tmp_path / "a.stl", together(ball(0.3, (9, 0, 0)), ball()))
    (grain,) = read_grains_of(path, "mm", bodies="largest")
    assert grain.name == "a" and grain.volume == pytest.approx(ball().volume * 1e-9, rel=1e-5)
    assert "largest of 2 bodies" in grain.notes[0]


def test_joined_takes_the_hull_of_all_with_a_note(tmp_path):
    mesh = together(ball(), ball(5, (10.2, 0, 0)))
    (grain,) = read_grains_of(write(tmp_path / "a.stl", mesh), "mm", bodies="joined")
    assert grain.volume == pytest.approx(mesh.convex_hull.volume * 1e-9, rel=1e-5)
    assert grain.hull_ratio == pytest.approx(mesh.convex_hull.volume / (2 * ball().volume), rel=1e-4)
    assert "hull of 2 bodies" in grain.notes[0]


def test_bodies_that_overlap_have_no_known_volume_together(tmp_path):
    mesh = together(ball(), ball(5, (4.3, 0.2, 0.1)))
    (grain,) = read_grains_of(write(tmp_path / "a.stl", mesh), "mm", bodies="joined")
    assert grain.volume == pytest.approx(mesh.convex_hull.volume * 1e-9, rel=1e-5) and np.isnan(grain.hull_ratio)


def test_an_unknown_choice_is_refused(tmp_path):
    with pytest.raises(ValueError, match="split"):
        read_grains_of(write(tmp_path / "a.stl", ball()), "mm", bodies="all")


ONE = {
    "a ball": (ball, 1.0),
    "a cavity": (lambda: together(ball(), inward(ball(2))), 1 - 0.4**3),
    "two cavities": (lambda: together(ball(), inward(ball(1, (2, 0, 0))), inward(ball(1, (-2, 0, 0)))), 1 - 2 * 0.2**3),
    "a shell within, wound outwards": (lambda: together(ball(), ball(2)), 1.0),
    "a stone in a cavity": (lambda: together(ball(), inward(ball(3)), ball(1)), 1 - 0.6**3),
}


@pytest.mark.parametrize("kind", ONE)
@pytest.mark.parametrize("name", ["a.stl", "a.ply"])
def test_what_lies_within_a_body_belongs_to_it(tmp_path, kind, name):
    make, solid = ONE[kind]
    (grain,) = read_grains_of(write(tmp_path / name, make()), "mm")
    assert grain.volume == pytest.approx(ball().volume * 1e-9, rel=1e-5)
    assert grain.hull_ratio == pytest.approx(1 / solid, rel=1e-4)


def test_bodies_that_touch_in_a_vertex_are_one():
    one = trimesh.creation.box((2, 2, 2))
    other = one.copy().apply_translation([2, 2, 2])
    both = together(one, other)
    (body,) = mesh_bodies(np.asarray(both.vertices), np.asarray(both.faces))
    assert body.volume == pytest.approx(16) and np.ptp(body.points, axis=0) == pytest.approx([4, 4, 4])


def test_an_inverted_body_beside_another_is_refused(tmp_path):
    path = write(tmp_path / "a.stl", together(ball(), inward(ball(2, (30, 0, 0)))))
    for choice in ("one", "split", "largest", "joined"):
        with pytest.raises(ValueError, match=r"inverted.*1 of its 2 bodies"):
            read_grains_of(path, "mm", bodies=choice)


def test_an_open_piece_beside_a_body_is_named(tmp_path):
    sheet = trimesh.Trimesh([[-9, -9, -7], [9, -9, -7], [0, 9, -7]], [[0, 1, 2]], process=False)
    with pytest.raises(ValueError, match=r"open.*2 separate pieces"):
        read_grain(write(tmp_path / "a.stl", together(ball(), sheet)), "mm")


# A box with a corner in the middle of an edge of one face, which a fan of triangles fills with a triangle of area 0.
BOX_WITH_A_CORNER_ON_AN_EDGE = """v 0 0 0\nv 0 0 4\nv 0 7 0\nv 0 7 4\nv 10 0 0\nv 10 0 4\nv 10 7 0\nv 10 7 4\nv 0 0 2
f 1 9 2 4 3\nf 5 7 8 6\nf 9 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4
"""


def test_a_triangle_of_area_0_may_close_a_mesh(tmp_path):
    (tmp_path / "a.obj").write_text(BOX_WITH_A_CORNER_ON_AN_EDGE)
    grain = read_grain(tmp_path / "a.obj", "mm")
    assert grain.hull_ratio == pytest.approx(1.0) and grain.volume == pytest.approx(280e-9)


@pytest.mark.parametrize(
    "fault, message",
    [
        ("hole", "the mesh is open: 3 edges have only one face; close its holes$"),
        ("double", "the mesh is not the surface of bodies: 3 edges have more than two faces; remove double"),
        ("apart", r"its \d+ faces are \d+ separate pieces, because corners at the same place have different"),
    ],
)
def test_the_fault_of_a_mesh_that_is_not_closed_is_named(tmp_path, fault, message):
    ball = trimesh.creation.icosphere(2, 5.0)
    corners = ball.triangles.copy()
    if fault == "hole":
        corners = corners[1:]
    elif fault == "double":
        corners = np.concatenate([corners, corners[:1]])
    else:
        corners += 1e-4 * np.random.default_rng(0).normal(size=corners.shape)
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3), process=False)
    mesh.export(tmp_path / "a.stl")
    with pytest.raises(ValueError, match=message):
        read_grain(tmp_path / "a.stl", "mm")


def test_all_faulty_files_are_named_at_once(tmp_path):
    for name in "abcdefg":
        (tmp_path / f"{name}.obj").write_text("v 0 0 0\nf 1 1 2\n")
    trimesh.creation.icosphere(1, 5.0).export(tmp_path / "good.stl")
    with pytest.raises(ValueError, match=r"a\.obj: .*; .*e\.obj: .*; 2 more files have errors"):
        read_grain_files(tmp_path, "mm")

"""Mesh files of all kinds (OBJ, PLY, STL, OFF) give the same body."""

import numpy as np
import pytest
import trimesh

from simcore.grains.bodies import mesh_bodies
from simcore.grains.mesh_files import read_mesh
from simcore.grains.readers import read_grain, read_grains_of

BOX = trimesh.creation.box((10, 7, 5))
CORNERS = np.array([[x, y, z] for x in (-5, 5) for y in (-3.5, 3.5) for z in (-2.5, 2.5)])
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
# The first side is two triangles; the others are quads.
MIXED = [QUADS[0][:3], (QUADS[0][0], *QUADS[0][2:]), *QUADS[1:]]
AXES = np.array([5, 3.5, 2.5]) * 2e-3 * np.sqrt(5 / 3)


def assert_is_box(path):
    grain = read_grain(path, "mm")
    assert (grain.L, grain.I, grain.S) == pytest.approx(AXES, rel=1e-6)
    assert grain.volume == pytest.approx(350e-9, rel=1e-6) and grain.hull_ratio == pytest.approx(1, rel=1e-6)


def obj_text(faces, negative=False, slash=""):
    """Return the text of an OBJ file with each face after its own vertices (negative), or all vertices first."""
    if not negative:
        rows = [f"v {x} {y} {z}" for x, y, z in CORNERS]
        return "\n".join([*rows, *("f " + " ".join(f"{i + 1}{slash}" for i in face) for face in faces)])
    rows = []
    for face in faces:
        rows += ["v {} {} {}".format(*CORNERS[i]) for i in face]
        rows.append("f " + " ".join(f"{i - len(face)}{slash}" for i in range(len(face))))
    return "\n".join(rows)


@pytest.mark.parametrize("faces", [QUADS, MIXED], ids=["quads", "mixed"])
@pytest.mark.parametrize("negative", [False, True])
@pytest.mark.parametrize("slash", ["", "/1", "//2", "/1/2"])
def test_obj(tmp_path, faces, negative, slash):
    text = "# scanned\nmtllib a.mtl\no box\nvt 0 0\nvn 0 0 1\nusemtl grey\n" + obj_text(faces, negative, slash)
    (tmp_path / "a.obj").write_bytes(text.replace("\n", "\r\n").encode("latin-1"))
    assert_is_box(tmp_path / "a.obj")


def test_obj_goes_on_over_lines_and_its_names_may_have_any_encoding(tmp_path):
    text = obj_text(QUADS).replace("f 1 2 ", "f 1 2 \\\n")
    (tmp_path / "a.obj").write_bytes("o Körper\n".encode("latin-1") + text.encode())
    assert_is_box(tmp_path / "a.obj")


@pytest.mark.parametrize(
    "text, reason",
    [
        ("v 1 2\n", "line 1: a vertex needs three numbers"),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: a face"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "does not exist; the mesh has 3 vertices"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n", "does not exist; the mesh has 3 vertices"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4: a face"),
    ],
)
def test_broken_obj(tmp_path, text, reason):
    (tmp_path / "a.obj").write_text(text)
    with pytest.raises(ValueError, match=rf"a\.obj: .*{reason}"):
        read_grain(tmp_path / "a.obj", "mm")


def ply_bytes(faces, form, extra="", corner_type="uchar"):
    """Return a PLY file; `extra` is the type of a property of the faces before their list."""
    order = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[form]
    header = [
        "ply", f"format {form} 1.0", "comment scanned", "element vertex 8", "property float x", "property float y",
        "property float z", "property uchar red", f"element face {len(faces)}",
        *([f"property {extra} quality"] if extra else []), f"property list {corner_type} int vertex_indices",
        "element edge 1", "property int vertex1", "property int vertex2", "end_header",
    ]  # fmt: skip
    data = ("\n".join(header) + "\n").encode()
    kind = {"uchar": "u1", "int": "i4"}[corner_type]
    if order is None:
        rows = [f"{x} {y} {z} 255" for x, y, z in CORNERS]
        rows += [" ".join(map(str, [*([0.5] if extra else []), len(face), *face])) for face in faces]
        return data + "\n".join([*rows, "0 1"]).encode()
    for point in CORNERS:
        data += point.astype(f"{order}f4").tobytes() + b"\xff"
    for face in faces:
        data += np.array(0.5, f"{order}f4").tobytes() if extra else b""
        data += np.array(len(face), order + kind).tobytes() + np.array(face, f"{order}i4").tobytes()
    return data + np.array([0, 1], f"{order}i4").tobytes()


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("faces", [QUADS, MIXED, MIXED[::-1]], ids=["quads", "mixed", "mixed, quads first"])
@pytest.mark.parametrize("extra", ["", "float"])
@pytest.mark.parametrize("corner_type", ["uchar", "int"])
def test_ply(tmp_path, form, faces, extra, corner_type):
    (tmp_path / "a.ply").write_bytes(ply_bytes(faces, form, extra, corner_type))
    assert_is_box(tmp_path / "a.ply")


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("faces", [QUADS, MIXED], ids=["quads", "mixed"])
def test_a_ply_that_is_cut_short_is_refused(tmp_path, form, faces):
    data = ply_bytes(faces, form)
    for length, reason in ((len(data) // 2, "does not begin with `ply` and a header"), (len(data) - 20, "cut short")):
        (tmp_path / "a.ply").write_bytes(data[:length])
        with pytest.raises(ValueError, match=rf"a\.ply: .*{reason}"):
            read_grain(tmp_path / "a.ply", "mm")


def test_strips_and_unknown_formats_of_ply_are_named(tmp_path):
    data = ply_bytes(QUADS, "ascii")
    for old, new, reason in (
        (b"element face", b"element tristrips", "triangle strips"),
        (b"format ascii", b"format zipped", "its format is zipped"),
        (b"property float z", b"property half z", "property half z"),
        (b"vertex_indices", b"corners", "no property vertex_indices"),
        (b"property float x", b"property float east", "no property x"),
    ):
        (tmp_path / "a.ply").write_bytes(data.replace(old, new))
        with pytest.raises(ValueError, match=rf"a\.ply: .*{reason}"):
            read_grain(tmp_path / "a.ply", "mm")


@pytest.mark.parametrize("name", ["a.ply", "b.ply", "a.obj", "a.off"])
def test_a_mesh_file_without_faces_is_a_point_cloud(tmp_path, name):
    path, points = tmp_path / name, trimesh.creation.icosphere(2).vertices * [5, 4, 3]
    if name == "a.obj":
        path.write_text("\n".join("v {} {} {}".format(*point) for point in points))
    elif name == "a.off":
        path.write_text(f"OFF\n{len(points)} 0 0\n" + "\n".join("{} {} {}".format(*point) for point in points))
    else:
        encoding = "ascii" if name == "b.ply" else "binary"
        path.write_bytes(trimesh.PointCloud(points).export(file_type="ply", encoding=encoding))
    grain = read_grain(path, "mm")
    assert grain.L == pytest.approx(0.01, rel=0.03) and np.isnan(grain.hull_ratio)
    assert grain.notes == ("has no faces; its vertices were read as points",)


def test_the_parsers_agree_with_trimesh(tmp_path):
    mesh = trimesh.creation.icosphere(3, 5.0)
    for name in ("a.obj", "a.ply"):
        mesh.export(tmp_path / name)
        vertices, faces = read_mesh(tmp_path / name)
        other = trimesh.load(tmp_path / name, process=False)
        np.testing.assert_array_equal(vertices, other.vertices)
        np.testing.assert_array_equal(faces, other.faces)


def test_files_that_macos_adds_are_named(tmp_path):
    (tmp_path / "._a.stl").write_bytes(b"\x00\x05\x16\x07\x00\x02\x00\x00Mac OS X")
    with pytest.raises(ValueError, match="macOS"):
        read_grain(tmp_path / "._a.stl", "mm")


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.obj", "a.off"])
def test_a_mesh_too_far_from_the_origin_for_its_precision_is_refused(tmp_path, name):
    far = trimesh.creation.icosphere(3, 5.0).apply_translation([512345.0, 5401234.0, 287.0])
    if name in ("a.stl", "a.ply"):
        far.export(tmp_path / name)  # single precision: 0.5 mm
    else:
        (tmp_path / name).write_text(far.export(file_type=name[2:], digits=0))
    with pytest.raises(ValueError, match=rf"{name}: .*too far from the origin.*shift them"):
        read_grain(tmp_path / name, "mm")
    near = far.copy().apply_translation([-512345.0, -5401234.0, -287.0])
    near.export(tmp_path / name)
    assert read_grain(tmp_path / name, "mm").L == pytest.approx(0.01, rel=0.02)


def surface_of(voxels):
    """Return the outward faces (m, 4, 3) between solid and empty voxels of edge 1."""
    quads = []
    for place in np.argwhere(voxels):
        for axis in range(3):
            for side in (0, 1):
                beyond = place.copy()
                beyond[axis] += 2 * side - 1
                if voxels[tuple(beyond)]:
                    continue
                one, two = [np.eye(3)[(axis + k) % 3] for k in (1, 2)]
                start = place + side * np.eye(3)[axis]
                quad = np.array([start, start + one, start + one + two, start + two])
                quads.append(quad if side else quad[::-1])
    return np.array(quads)


def test_the_ratio_of_a_concave_mesh_is_hull_over_mesh(tmp_path):
    voxels = np.zeros((5, 5, 5), bool)  # a cross of seven cubes
    voxels[1:4, 2, 2] = voxels[2, 1:4, 2] = voxels[2, 2, 1:4] = True
    corners = surface_of(voxels).reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 4)
    mesh = trimesh.Trimesh(corners, np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]]), process=False)
    mesh.export(tmp_path / "cross.stl")
    (grain,) = read_grains_of(tmp_path / "cross.stl", "mm")
    assert grain.hull_ratio == pytest.approx(mesh.convex_hull.volume / 7, rel=1e-6) and grain.hull_ratio > 1.7
    assert mesh_bodies(np.asarray(mesh.vertices), np.asarray(mesh.faces))[0].volume == pytest.approx(7, rel=1e-12)


def stl_text(count=12):
    lines = BOX.export(file_type="stl_ascii").splitlines()
    return "\n".join(lines[: 1 + 7 * count])


def off_text(faces=QUADS, head="OFF\n8 {} 0", tail=""):
    rows = [" ".join(map(str, point)) for point in CORNERS]
    rows += [" ".join(map(str, [len(face), *face])) + tail for face in faces]
    return "\n".join([head.format(len(faces)), *rows])


FORMS = {
    "binary": ("a.stl", BOX.export(file_type="stl")),
    "text that begins as binary": ("a.stl", b"solid" + BOX.export(file_type="stl")[5:]),
    "text": ("a.stl", stl_text().encode()),
    "CRLF": ("a.stl", stl_text().replace("\n", "\r\n").encode()),
    "several solids": (
        "a.stl",
        (stl_text(5) + "\nendsolid\nsolid b\n" + "\n".join(stl_text().split("\n")[36:])).encode(),
    ),
    "Latin-1": ("a.stl", ("solid Kö\n" + stl_text().split("\n", 1)[1]).encode("latin-1")),
    "quads": ("a.off", off_text().encode()),
    "mixed": ("a.off", off_text(MIXED).encode()),
    "counts beside": ("a.off", off_text(head="OFF 8 {} 0").encode()),
    "no keyword": ("a.off", off_text(head="8 {} 12").encode()),
    "colours and comments": ("a.off", off_text(head="COFF\n# a box\n\n8 {} 0", tail=" 255 0 0  # red").encode()),
}


@pytest.mark.parametrize("kind", FORMS)
def test_stl_and_off(tmp_path, kind):
    name, data = FORMS[kind]
    (tmp_path / name).write_bytes(data)
    assert_is_box(tmp_path / name)


UNREADABLE = "the file cannot be read as a mesh"


@pytest.mark.parametrize(
    "name, data, reason",
    [
        ("a.stl", BOX.export(file_type="stl")[:-30], UNREADABLE),
        ("a.stl", BOX.export(file_type="stl") + b"0", UNREADABLE),
        ("a.stl", stl_text()[:-40].encode(), UNREADABLE),
        ("a.stl", stl_text().replace("vertex 5", "vertex five", 1).encode(), UNREADABLE),
        ("a.stl", b"solid\nendsolid", UNREADABLE),
        ("a.stl", BOX.export(file_type="stl_ascii")[:-40].encode(), f"{UNREADABLE}: the STL text has 12 facets and 11"),
        ("a.off", off_text()[:-14].encode(), UNREADABLE),
        ("a.off", off_text()[:-1].encode(), UNREADABLE),
        ("a.off", off_text(head="8").encode(), UNREADABLE),
        ("a.off", off_text().replace("3.5", "3;5").encode(), UNREADABLE),
        ("a.off", b"OFF BINARY\n\x00", "it is a file of the kind"),
        ("a.off", off_text(head="4OFF\n8 {} 0").encode(), "it is a file of the kind"),
    ],
)
def test_stl_and_off_that_cannot_be_read_are_errors(tmp_path, name, data, reason):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ValueError, match=f"{name}: {reason}") as error:
        read_grain(tmp_path / name, "mm")
    assert "\n" not in str(error.value)


def test_a_coordinate_that_is_no_length_is_refused(tmp_path):
    (tmp_path / "a.obj").write_text(obj_text(QUADS).replace("v 5.0", "v 1e300", 1).replace("v 5 ", "v 1e300 ", 1))
    with pytest.raises(ValueError, match="1e\\+300 mm are too large for lengths"):
        read_grain(tmp_path / "a.obj", "mm")


@pytest.mark.parametrize("suffix", ["obj", "off", "stl", "ply"])
def test_a_byte_order_mark_is_no_part_of_a_mesh(tmp_path, suffix):
    path = tmp_path / f"box.{suffix}"
    text = obj_text(QUADS) if suffix == "obj" else BOX.export(file_type="stl_ascii" if suffix == "stl" else suffix)
    path.write_bytes(b"\xef\xbb\xbf" + (text.encode() if isinstance(text, str) else text))
    assert_is_box(path)


def test_stl_in_capitals_is_read(tmp_path):
    (tmp_path / "capitals.stl").write_text(BOX.export(file_type="stl_ascii").upper())
    assert_is_box(tmp_path / "capitals.stl")


@pytest.mark.parametrize("far", [1e3, 1e9, 1e15])
def test_a_vertex_without_a_face_has_no_effect(tmp_path, far):
    text = obj_text(QUADS).split("\n")
    (tmp_path / "box.obj").write_text("\n".join([*text[:8], f"v {far} 0 0", *text[8:]]))
    assert_is_box(tmp_path / "box.obj")

"""Frames of a running packing: ParaView reads the series, and the result does not depend on it."""

import numpy as np
import pytest
import pyvista

from simcore.__main__ import main
from simcore.dem.ranks.one_rank import OneRank
from simcore.dem.state.parts import assemble
from simcore.export import frames
from simcore.export.frames import FramesKeeper
from simcore.export.paraview import contacts_path
from simcore.packing.keeping import Keeper
from simcore.packing.process import pack
from simcore.scene.specification import resolve
from tests.helpers.few_spheres import pack_few_spheres, set_up_few_spheres, specify_few_spheres
from tests.helpers.same_bits import arrays_of, assert_same_bits


class Notes(Keeper):
    """A keeper that requests a checkpoint at every opportunity, resumes from `header` and records what it receives."""

    def __init__(self, header=None):
        self.header, self.states, self.grains = header, [], []

    def wish(self, step):
        return 1

    def latest(self):
        return self.header and (self.header, None)

    def keep(self, state, parts):
        self.states.append(state)
        self.grains.append(sum(len(part["body.id"]) for part in parts))


def keep_frames(folder, keeper, interval=0.05, report=print, key="few"):
    setup, specification = set_up_few_spheres(), resolve(specify_few_spheres())
    ranks = OneRank()
    return setup, FramesKeeper(keeper, folder / "few.nc", interval, setup, specification, report, ranks, key), ranks


@pytest.fixture(scope="module")
def series(tmp_path_factory):
    """Return the folder with the series of a packing, the packing, and the keeper of its checkpoints."""
    folder, notes = tmp_path_factory.mktemp("frames"), Notes()
    setup, keeper, ranks = keep_frames(folder, notes)
    return folder, pack(setup.scene, setup.bases, setup.draw, ranks=ranks, keeper=keeper), notes


def test_the_result_has_the_bits_of_a_packing_without_frames(series):
    _, packed, _ = series
    plain = pack_few_spheres()
    assert_same_bits(arrays_of(packed.bodies, packed.candidates), arrays_of(plain.bodies, plain.candidates))
    assert packed.steps == plain.steps


def test_the_series_has_a_frame_for_every_interval(series):
    folder, packed, _ = series
    reader = pyvista.get_reader(folder / "few.pvd")
    times = np.array(reader.time_values)
    # A frame is taken at the first pause after its time; a packing pauses at least every 0.01 s.
    due = 0.05 * np.arange(len(times))
    assert len(times) == int(packed.time / 0.05) + 1
    assert (times >= due - 1e-9).all() and (times < due + 0.011).all()
    heights = []
    for time in times:
        reader.set_active_time_value(time)
        (mesh,) = reader.read()
        assert set(mesh["grain"]) == set(range(40))
        heights.append(mesh.center_of_mass()[2])
    assert (np.diff(heights) < 1e-4).all() and heights[-1] < 0.5 * heights[0]  # the grains fall
    contacts = pyvista.get_reader(folder / "few_contacts.pvd")
    contacts.set_active_time_value(times[-1])
    (lines,) = contacts.read()
    assert lines.n_cells > 40 and lines["force"].max() > 0.0
    assert len(list((folder / "few_frames").iterdir())) == 2 * len(times)


def test_checkpoints_are_kept_as_well_and_complete(series):
    _, packed, notes = series
    assert len(notes.states) > 10 and set(notes.grains) == {40}


class Often(Keeper):
    """A keeper that requests a frame every 3.7 ms, between the checks, and records the forces that it receives."""

    def __init__(self, dt):
        self.dt, self.due, self.normals, self.forces, self.times = dt, 0.0, [], [], []

    def wish(self, step):
        return int(step * self.dt >= self.due)

    def keep(self, state, parts):
        _, (contacts, _) = assemble(list(parts), np.arange(state["inserted"]))
        touching = contacts.touching != 0
        self.due += 3.7e-3
        self.times.append(state["step"] * self.dt)
        self.normals.append(np.linalg.norm(contacts.direction[touching], axis=1))
        self.forces.append(np.linalg.norm(contacts.force[touching], axis=1))


def test_frames_between_checks_show_the_forces_of_their_step():
    """A call that ends at a stale list has stored no forces; half of these frames follow such a call."""
    setup = set_up_few_spheres()
    often = Often(setup.scene.numerics.time_step)
    packed = pack(setup.scene, setup.bases, setup.draw, keeper=often)
    normals, forces = np.concatenate(often.normals), np.concatenate(often.forces)
    assert len(often.times) > 50 and len(forces) > 1000
    np.testing.assert_allclose(normals, 1.0, rtol=1e-12)
    # A contact that has just been lost in a rebound may have no force; without attraction its force is zero.
    assert (forces == 0.0).mean() < 0.01
    plain = pack_few_spheres()
    assert_same_bits(arrays_of(packed.bodies, packed.candidates), arrays_of(plain.bodies, plain.candidates))


def test_frames_before_a_checkpoint_remain_after_it_is_resumed(series, tmp_path):
    folder, _, _ = series
    times = pyvista.get_reader(folder / "few.pvd").time_values
    setup = set_up_few_spheres()
    step = round((times[2] + 1e-3) / setup.scene.numerics.time_step)
    _, keeper, _ = keep_frames(folder, Notes({"step": step}))
    assert keeper.latest() is not None
    assert [time for time, _ in keeper.frames] == pytest.approx(times[:3])
    assert all(path.exists() for _, path in keeper.frames)
    assert keeper.next == pytest.approx(0.15)
    _, keeper, _ = keep_frames(tmp_path, Notes({"step": step}))
    keeper.latest()
    assert keeper.frames == [] and keeper.next == 0.0


@pytest.mark.parametrize("left", ["of another packing", "cut off", "without times", "no text"])
def test_a_series_that_is_not_of_this_packing_is_not_continued(series, tmp_path, left):
    folder, _, _ = series
    text = (folder / "few.pvd").read_text()
    _, keeper, _ = keep_frames(tmp_path, Notes({"step": 10**6}))
    (tmp_path / "few.pvd").write_text(text)
    keeper.latest()
    assert len(keeper.frames) > 4
    changed = {
        "of another packing": text.replace("few-->", "many-->").encode(),
        "cut off": text[:-30].encode(),
        "without times": text.replace("timestep", "time").encode(),
        "no text": b"\xff\xfe\xff",
    }
    assert changed[left] != text.encode()
    (tmp_path / "few.pvd").write_bytes(changed[left])
    keeper.latest()
    assert keeper.frames == []


def test_frames_of_a_former_run_do_not_remain_in_the_series(tmp_path):
    (tmp_path / "few_frames").mkdir()
    (tmp_path / "few_frames" / "00999.vtp").touch()
    (tmp_path / "few_frames" / "00999_contacts.vtp").touch()
    (tmp_path / "few_frames" / "slice.vtp").touch()
    setup, keeper, ranks = keep_frames(tmp_path, Keeper())
    pack(setup.scene, setup.bases, setup.draw, ranks=ranks, keeper=keeper)
    listed = {file for _, path in keeper.frames for file in (path, contacts_path(path))}
    assert len(listed) > 4
    assert {*(tmp_path / "few_frames").glob("*.vtp")} == listed | {tmp_path / "few_frames" / "slice.vtp"}


def test_a_full_disk_ends_the_frames_and_not_the_packing(tmp_path, monkeypatch):
    def fail(*arguments):
        raise OSError("no space left")

    monkeypatch.setattr(frames, "write_surfaces", fail)
    lines = []
    setup, keeper, ranks = keep_frames(tmp_path, Keeper(), report=lines.append)
    packed = pack(setup.scene, setup.bases, setup.draw, ranks=ranks, keeper=keeper)
    assert packed is not None
    assert lines == ["few: a frame cannot be written (no space left); there will be no more"]


def test_the_command_writes_frames_or_refuses_their_time(tmp_path, capsys):
    text = "name: tiny\ndomain: {width: 25 mm, height: 0.2 m}\nshapes: {kind: sphere}\namount: {grains: 40}\n"
    text += "sizes: {bounds: [5.6 mm, 8 mm], mass_fractions: [1]}\nshaking: {duration: 0.05 s}\n"
    (tmp_path / "tiny.yaml").write_text(text + "numerics: {contact_time: 1 ms}\n")
    arguments = ["pack", str(tmp_path / "tiny.yaml"), str(tmp_path / "tiny.nc"), "--frames"]
    for wrong, message in (("0 s", "'0 s' is not a time above 0"), ("1 mm", "'1 mm' is a length; a time is needed")):
        assert main([*arguments, wrong]) == 2
        *warnings, error = capsys.readouterr().err.splitlines()
        assert error.startswith("scree pack: --frames: ") and message in error
        assert all("warning: " in line for line in warnings)
    assert main([*arguments, "0.1 s"]) == 0
    assert (tmp_path / "tiny.pvd").exists() and (tmp_path / "tiny.nc").exists()

"""A packing while it runs, as a series for ParaView: a .vtp file for each frame, and a .pvd file that lists them.

Frames use the interface of checkpoints (simcore.packing.keeping): the packing pauses between two steps, and its bodies
are read. No step and no bit of the result depends on it.
"""

import math
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from simcore.dem.state.parts import assemble
from simcore.export.libraries import library
from simcore.export.paraview import contacts_path, write_surfaces
from simcore.packing.file import packing_dataset
from simcore.packing.heartbeat import beat
from simcore.packing.keeping import KEEP, Keeper
from simcore.packing.observation import observe
from simcore.packing.packed import Packed
from simcore.writing import whole_file

_OF_PACKING = "of packing "
_FRAME = re.compile(r"\d{5,}(?:_contacts)?\.vtp")


class FramesKeeper(Keeper):
    """Writes a frame every `interval` of simulated time, and leaves checkpoints to another keeper.

    The packing pauses at the latest at each of its checks (convergence.interval), so that a frame is at the first pause
    after its time is due; the .pvd file has the time of its state.
    """

    def __init__(self, keeper: Keeper, output: Path, interval: float, setup, specification, report, ranks, key=""):
        """output: file of the packing, bed.nc; the frames are bed_frames/00000.vtp, ... and bed.pvd, bed_contacts.pvd.

        interval [s]: of simulated time. setup, specification: of the packing. report(line): called if a frame cannot be
        written, after which the packing goes on without frames. key: of the packing, so that a resumed one continues
        only its own series. ValueError without pyvista.
        """
        library("pyvista", "--frames")
        self.keeper, self.interval, self.setup, self.specification = keeper, interval, setup, specification
        self.ranks, self.dt = ranks, setup.scene.numerics.time_step
        self.folder, self.series = output.with_name(f"{output.stem}_frames"), output.with_suffix(".pvd")
        self.next, self.frames, self.wished = 0.0, [], 0  # frames: (time [s], path)
        self.report, self.failed, self.begun, self.key = report, False, False, key

    def __getattr__(self, name):
        return getattr(self.keeper, name)  # what a keeper of checkpoints has besides the interface

    def wish(self, step):
        """Return what the inner keeper wants, or KEEP if a frame is due."""
        self.wished = self.keeper.wish(step) if self.keeper.wish else 0
        return max(self.wished, KEEP if self._is_due(step) else 0)

    def latest(self):
        """Return the latest checkpoint of the inner keeper, and drop the frames after it."""
        latest = self.keeper.latest()
        if latest is not None:  # the frames before the checkpoint remain
            time = latest[0]["step"] * self.dt
            self.frames = [frame for frame in _read_series(self.series, self.key) if frame[0] <= time]
            self.next = self._after(self.frames[-1][0]) if self.frames else 0.0
        return latest

    def keep(self, state, parts):
        """Write a frame if one is due, and return whether the inner keeper, if it wants to, has stored the state."""
        # Only the keeper of one rank may want a checkpoint, but all ranks must agree on it.
        checkpoint = max(self.ranks.all([self.wished])) > 0
        parts = list(parts)
        if self._is_due(state["step"]):
            time = state["step"] * self.dt
            self.next = self._after(time)
            if self.ranks.rank == 0 and not self.failed:
                try:
                    self._write(state, parts, time)
                except OSError as error:  # a packing is worth more than its frames
                    self.failed = True
                    self.report(f"{self.setup.scene.name}: a frame cannot be written ({error}); there will be no more")
        return self.keeper.keep(state, iter(parts)) if checkpoint else False

    def _after(self, time):
        """Return the next multiple of the interval [s]."""
        return (math.floor(time / self.interval + 1e-9) + 1) * self.interval

    def _is_due(self, step):
        # Half a step is allowed for, since neither time is exact.
        return (step + 0.5) * self.dt >= self.next

    def _write(self, state, parts, time):
        beat()
        bodies, candidates = assemble(parts, range(state["inserted"]))
        observed = observe(bodies, candidates)
        packed = Packed(bodies, candidates, observed, state["step"], time, 0.0, [(time, state["phase"], observed)])
        sample = self.setup.sample(range(len(bodies.mass)))
        packing = packing_dataset(self.setup.scene, self.setup.bases, packed, sample, self.specification)
        self.folder.mkdir(parents=True, exist_ok=True)
        if not self.begun:
            self._remove_others()
        self.begun = True
        path = self.folder / f"{len(self.frames):05d}.vtp"
        write_surfaces(path, packing)
        self.frames.append((time, path))
        _write_series(self.series, self.frames, self.key)
        contacts = [(time, contacts_path(path)) for time, path in self.frames]
        _write_series(contacts_path(self.series), contacts, self.key)
        beat()

    def _remove_others(self):
        """Remove the frames of a former run, which programs would show as a part of this series."""
        kept = {file for _, path in self.frames for file in (path, contacts_path(path))}
        for path in set(self.folder.glob("*.vtp")) - kept:
            if _FRAME.fullmatch(path.name):
                path.unlink()


def _write_series(path, frames, key):
    """Write a .pvd file; frames: (time [s], path) of each; key: of the packing, which is written in a comment."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    root.append(ElementTree.Comment(_OF_PACKING + key))
    collection = ElementTree.SubElement(root, "Collection")
    for time, file in frames:
        name = file.relative_to(path.parent).as_posix()
        ElementTree.SubElement(collection, "DataSet", timestep=repr(float(time)), part="0", file=name)
    ElementTree.indent(root)
    with whole_file(path) as part:
        ElementTree.ElementTree(root).write(part, encoding="utf-8", xml_declaration=True)


def _read_series(path, key):
    """Return the frames of a .pvd file, list of (time [s], path); empty if none has been written for this packing."""
    try:
        text = path.read_text(encoding="utf-8")
        if f"<!--{_OF_PACKING}{key}-->" not in text:
            return []
        sets = ElementTree.fromstring(text).iter("DataSet")
        return [(float(item.get("timestep")), path.parent / item.get("file")) for item in sets]
    except (OSError, ElementTree.ParseError, ValueError, TypeError):  # a damaged file, or one of another program
        return []

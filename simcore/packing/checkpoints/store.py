"""A folder with the two newest checkpoints of each scene."""

import operator
import os
import re
import socket
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from simcore.packing.checkpoints.file import PART, CheckpointError, Sections, read_checkpoint, reason, write_checkpoint
from simcore.packing.checkpoints.lock import take_lock

KEPT = 2
SUFFIX, LOCK = ".checkpoint", ".lock"


class Store:
    """The checkpoints of one scene in a folder, which other scenes may share.

    key: of the scene (`scene_key`), letters and digits. code: version of the code. report(line): called for each
    checkpoint that is rejected, and for files that cannot be locked or removed. lock: True for the one process that
    writes: the store then makes the folder, locks the key until it is closed or its process ends, and removes
    incomplete files of a killed run. Without the lock the store changes nothing until it saves. CheckpointError if
    another process has locked the key, or if the folder cannot be made or written; ValueError if the key has other
    characters.
    """

    def __init__(self, folder, key: str, code: str, report: Callable[[str], None], lock: bool = True):
        if not re.fullmatch("[0-9A-Za-z]+", key):
            raise ValueError(f"key of the checkpoints: {key!r} must consist of letters and digits, as from scene_key")
        self.folder, self.key, self.code, self.report = Path(folder), key, code, report
        self._good = []  # paths, oldest first: valid checkpoints that this store wrote or read
        self._lock = None
        if lock:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                self._lock = self._take_lock()
                if self._locked:
                    self._remove(self._files(SUFFIX + PART))
            except OSError as error:
                self.close()
                raise CheckpointError(
                    f"{self.folder}: no checkpoint can be written there ({reason(error)}). Give a writable folder"
                ) from error

    def save(self, header: dict, sections: Iterable[dict[str, np.ndarray]]) -> None:
        """Write the checkpoint of header["step"], and remove all of this scene except the two newest valid ones.

        "Newest" refers to the order in which they were written. Rejected checkpoints do not count, whatever their step;
        they are only removed when there are two valid ones. CheckpointError as in `write_checkpoint`.
        """
        path = self.folder / f"{self.key}-{operator.index(header['step'])}{SUFFIX}"
        try:
            write_checkpoint(path, {**header, "key": self.key, "code": self.code}, sections)
        except CheckpointError as error:
            raise CheckpointError(f"{error}; there is none of this step") from error
        self._good = [good for good in self._good if good != path][1 - KEPT :] + [path]
        if len(self._good) == KEPT:
            self._remove(other for other in self._files(SUFFIX) if other not in self._good)

    def latest(self) -> tuple[dict, Sections] | None:
        """Return header and sections of the newest valid checkpoint, or None; each rejected one is reported."""
        try:
            paths = self._files(SUFFIX)
        except OSError as error:
            raise CheckpointError(
                f"{self.folder}: the checkpoints cannot be listed ({reason(error)}). Check its permissions, or give "
                f"another folder"
            ) from error
        for path in paths:
            try:
                header, sections = read_checkpoint(path, self.key, self.code)
            except CheckpointError as error:
                self.report(str(error))
                continue
            self._good = [path]
            return header, sections
        return None

    def clear(self) -> None:
        """Remove all checkpoints of this scene, and the lock, after its final file is written."""
        try:
            self._remove([*self._files(SUFFIX), *self._files(SUFFIX + PART)])
        except OSError as error:
            self.report(f"{self.folder}: checkpoints of {self.key} remain ({reason(error)}); remove them by hand")
        self._good = []
        self.close()

    def close(self) -> None:
        """Release the key; the checkpoints remain."""
        if self._lock is not None:
            if self._locked:  # before the lock is released, so that no process locks a file without a name
                self._remove([self._lock_path])
            self._lock.close()
            self._lock = None

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    @property
    def _lock_path(self):
        return self.folder / f"{self.key}{LOCK}"

    def _take_lock(self):
        """Return the lock file. `_locked` is True if the file system supports locks and the file is locked."""

        def busy(holder):
            raise CheckpointError(
                f"{self.folder}: {holder or 'another process'} runs this scene ({self.key}) with its checkpoints here. "
                f"Wait until it ends, end it, or give another folder"
            )

        def no_locks(error):
            self.report(
                f"{self._lock_path} cannot be locked ({reason(error)}); make sure that no other process runs this "
                f"scene with its checkpoints there"
            )

        file, self._locked = take_lock(
            self._lock_path, f"process {os.getpid()} on {socket.gethostname()}", busy, no_locks
        )
        return file

    def _files(self, ending):
        """Return the paths of this scene's files with this ending, latest step first. OSError if this fails."""
        name = re.compile(re.escape(self.key) + r"-(\d+)" + re.escape(ending))
        try:
            names = os.listdir(self.folder)
        except FileNotFoundError:
            return []
        steps = [(int(match[1]), match[0]) for match in map(name.fullmatch, names) if match]
        return [self.folder / name for _, name in sorted(steps, reverse=True)]

    def _remove(self, paths):
        for path in paths:
            try:
                path.unlink(missing_ok=True)
            except OSError as error:
                self.report(f"{path} cannot be removed ({reason(error)}); remove it by hand")

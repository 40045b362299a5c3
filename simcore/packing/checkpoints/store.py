"""A folder that keeps the two newest checkpoints of each scene."""

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

    key: of the scene (`scene_key`), letters and digits. code: version of the code. report(line): is told of each
    checkpoint that is refused. lock: for the one process that writes; it makes the folder, keeps any second process
    from the key until this store is closed or its process dead, and removes what a killed run left half written.
    Without it the store touches nothing until it saves. CheckpointError where the key is taken, or the folder cannot
    be made or written.
    """

    def __init__(self, folder, key: str, code: str, report: Callable[[str], None], lock: bool = True):
        if not re.fullmatch("[0-9A-Za-z]+", key):
            raise ValueError(f"key of the checkpoints: {key!r} must be letters and digits, as of scene_key")
        self.folder, self.key, self.code, self.report = Path(folder), key, code, report
        self._good = []  # paths, oldest first: written or read here, and neither replaced nor removed since
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
                    f"{self.folder}: no checkpoint can be written there ({reason(error)}); give a folder that can be "
                    f"written"
                ) from error

    def save(self, header: dict, sections: Iterable[dict[str, np.ndarray]]) -> None:
        """Write the checkpoint of header["step"], and remove all of this scene but the two newest that are good.

        Newest in the order in which they were made: those that were refused count for nothing, whatever their step,
        but stay until two good ones stand. CheckpointError as of `write_checkpoint`.
        """
        path = self.folder / f"{self.key}-{operator.index(header['step'])}{SUFFIX}"
        try:
            write_checkpoint(path, {**header, "key": self.key, "code": self.code}, sections)
        except CheckpointError as error:
            raise CheckpointError(f"{error}; the run goes on without it") from error
        self._good = [good for good in self._good if good != path][1 - KEPT :] + [path]
        if len(self._good) == KEPT:
            self._remove(other for other in self._files(SUFFIX) if other not in self._good)

    def latest(self) -> tuple[dict, Sections] | None:
        """Header and sections of the newest checkpoint that reads right, None without any; each refused is reported."""
        try:
            paths = self._files(SUFFIX)
        except OSError as error:
            raise CheckpointError(
                f"{self.folder}: the checkpoints cannot be listed ({reason(error)}); see to its rights, or give "
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
        """Remove all checkpoints of this scene, and the lock: its final file is written."""
        try:
            self._remove([*self._files(SUFFIX), *self._files(SUFFIX + PART)])
        except OSError as error:
            self.report(f"{self.folder}: checkpoints of {self.key} remain ({reason(error)}); remove them by hand")
        self._good = []
        self.close()

    def close(self) -> None:
        """Give the key free; the checkpoints stay."""
        if self._lock is not None:
            if self._locked:  # before it is let go of, so that nobody can hold a lock that has lost its name
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
        """The lock file, locked where the file system has locks (`_locked` says so)."""

        def busy(holder):
            raise CheckpointError(
                f"{self.folder}: {holder or 'another process'} runs this scene ({self.key}) with its checkpoints here; "
                f"wait for it or end it, or give another folder"
            )

        def no_locks(error):
            self.report(
                f"{self._lock_path} cannot be locked ({reason(error)}); see that no other process runs this scene with "
                f"its checkpoints there"
            )

        file, self._locked = take_lock(
            self._lock_path, f"process {os.getpid()} on {socket.gethostname()}", busy, no_locks
        )
        return file

    def _files(self, ending):
        """Paths of this scene's files with this ending, the latest step first; OSError."""
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

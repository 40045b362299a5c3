"""Checkpoints: a run's state in a file that is right or refused, and a folder that keeps the two newest of a scene.

What a section holds is the caller's: a dict of named arrays, one section per rank or per part of the state.

The file, little-endian throughout:

    magic (8 bytes), schema (uint32), length of the header (uint64), header (JSON)
    for each section: length of its table (uint64), table (JSON list of [name, dtype, shape]), its arrays one after
        another, C order
    end mark (8 bytes), number of bytes before it (uint64), SHA-256 of everything before the digest (32 bytes)

Magic, schema, end mark and digest stay where they are in every schema: so a file of another schema is told from a
damaged one. Nothing between them is looked at before the digest holds.
"""

import errno
import fcntl
import hashlib
import json
import math
import operator
import os
import re
import socket
import struct
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

SCHEMA = 1  # of the file format above
MAGIC, END = b"SCREE-CP", b"CP-SCREE"
DTYPES = {"float64": "<f8", "int64": "<i8", "int32": "<i4", "uint8": "|u1", "bool": "|b1"}
# Keys of a specification that change no bit of a run: what it is called, how often it reports, a choice whose settings
# stand in the other keys once it is resolved, and what only refuses to start. Any other key counts.
WITHOUT_EFFECT = (("name",), ("accuracy",), ("numerics", "progress_interval"), ("sizes", "allow_few_top_grains"))
KEPT = 2
HOLDER_LENGTH = 200  # bytes in a lock file
SUFFIX, PART, LOCK = ".checkpoint", ".part", ".lock"
BLOCK = 1 << 20  # bytes read at a time for the digest
READABLE = "see that it is there, may be read, and is written by nothing else"
MOST_DIMENSIONS = 32  # of an array, within what every numpy can make

_FRONT = struct.Struct("<8sIQ")
_LENGTH = struct.Struct("<Q")
_BACK = struct.Struct("<8sQ")
_DIGEST_SIZE = hashlib.sha256().digest_size


class CheckpointError(ValueError):
    """A checkpoint that cannot be used or written; one line: which file, what is wrong, how to mend it."""


def scene_key(specification: dict, bases: Iterable, drawn: Iterable = ()) -> str:
    """Digest (16 hex digits) of what decides the bits of a packing, but for the code.

    specification: resolved; the order of its keys does not count, nor do the keys WITHOUT_EFFECT. bases: the base
    shapes (simcore.dem.shapes.hulls.Base), in their order. drawn: arrays that tell what neither shows, such as the Draw
    of the first grains: the forms of ellipsoids come from files of which the specification has the path alone, and the
    sieve curve of a case from a table.
    """
    bases = list(bases)
    told = [_deciding(specification), [base.name for base in bases]]
    total = hashlib.sha256(json.dumps(told, sort_keys=True).encode())
    arrays = []
    for base in bases:
        arrays += [np.asarray(part, np.float64) for part in (base.vertices, base.volume, base.second_moments)]
        arrays.append(np.asarray(base.faces, np.int64))
    for array in [*arrays, *map(np.asarray, drawn)]:
        # Type and shape first: they say where the array ends
        total.update(f"\n{array.dtype} {array.shape} ".encode() + array.tobytes())
    return total.hexdigest()[:16]


def _deciding(group, path=()):
    """The nested dict but for the keys WITHOUT_EFFECT."""
    return {
        key: _deciding(value, (*path, key)) if isinstance(value, dict) else value
        for key, value in group.items()
        if (*path, key) not in WITHOUT_EFFECT
    }


# -- one file -----------------------------------------------------------------------------------------------


def write_checkpoint(path, header: dict, sections: Iterable[dict[str, np.ndarray]]) -> None:
    """Write a checkpoint under a temporary name beside `path`, then rename: `path` is whole or as it was.

    header: what JSON holds, numpy scalars too. sections: taken one at a time; arrays of DTYPES, TypeError otherwise.
    CheckpointError where the disk is full or the file cannot be written: the temporary file is then removed, and the
    rest of the sections still taken and dropped, so that no rank waits for its own to be received.
    """
    path = Path(path)
    part = path.with_name(path.name + PART)
    sections = iter(sections)
    try:
        try:
            with open(part, "wb") as file:
                _write(file, header, sections)
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, path)
        except BaseException:
            with suppress(OSError):
                part.unlink(missing_ok=True)
            raise
        _sync_folder(path.parent)
    except OSError as error:
        for _ in sections:
            pass
        raise CheckpointError(
            f"{path}: the checkpoint could not be written ({_reason(error)}), earlier ones stay as they are; make room "
            f"in {path.parent} and see that it can be written, or give another folder"
        ) from error


def _write(file, header, sections):
    digest = hashlib.sha256()
    size = 0

    def put(data):
        nonlocal size
        file.write(data)
        digest.update(data)
        size += len(data)

    text = json.dumps(header, default=_plain).encode()
    put(_FRONT.pack(MAGIC, SCHEMA, len(text)))
    put(text)
    for section in sections:
        _put_section(put, section)
        del section  # before the next one comes: never two in memory
    put(_BACK.pack(END, size))
    file.write(digest.digest())


def _put_section(put, section):
    arrays = {name: np.asarray(array) for name, array in section.items()}
    for name, array in arrays.items():
        if array.dtype.name not in DTYPES:
            raise TypeError(f"checkpoint: array {name} is of {array.dtype}; it must be one of {', '.join(DTYPES)}")
    table = [[name, array.dtype.name, list(array.shape)] for name, array in arrays.items()]
    text = json.dumps(table).encode()
    put(_LENGTH.pack(len(text)))
    put(text)
    for array in arrays.values():
        put(np.asarray(array, DTYPES[array.dtype.name], order="C").reshape(-1).view(np.uint8))


def _plain(value):
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"checkpoint: the header cannot hold {value!r}; give numbers, text, lists and dicts")


def _sync_folder(folder):
    """Make a rename in `folder` outlast a loss of power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        # Some network file systems sync no folders
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(handle)


def read_checkpoint(path, key: str, code: str, schema: int = SCHEMA) -> tuple[dict, "Sections"]:
    """Header and sections of the checkpoint at `path`; the arrays are read when a section is taken.

    key, code: of the run that wants to go on from it. CheckpointError, with its reason, unless the file is whole and
    of that scene, code and schema.
    """
    path = Path(path)
    try:
        return _read(path, key, code, schema)
    except OSError as error:
        raise CheckpointError(f"{path}: the checkpoint cannot be read ({_reason(error)}); {READABLE}") from error


def _read(path, key, code, schema):
    if path.is_dir():
        raise CheckpointError(f"{path} is a folder, not a checkpoint; move it elsewhere")
    if path.exists() and not path.is_file():
        raise CheckpointError(f"{path} is no ordinary file, so no checkpoint; move it elsewhere")
    file = open(path, "rb")
    try:
        end = _check_whole(path, file)
        _, found, length = _FRONT.unpack(_bytes(file, 0, _FRONT.size))
        if found != schema:
            raise CheckpointError(
                f"{path} is a checkpoint of schema {found}, this code reads schema {schema}; it is not used: go on "
                f"with the code that wrote it, or start anew"
            )
        try:
            header, start = _header(file, length, end)
            for name, wanted, what in (("key", key, "scene"), ("code", code, "version of the code")):
                if header.get(name) != wanted:
                    raise CheckpointError(
                        f"{path} is a checkpoint of another {what} ({header.get(name)}, this run's is {wanted}); it is "
                        f"not used, as the result would be neither's: go on with that {what}, or start anew"
                    )
            return header, Sections(path, file, _tables(file, start, end))
        except _Malformed as error:
            raise CheckpointError(
                f"{path} is whole, but not laid out as a checkpoint ({error}); it is not used, remove it"
            ) from None
    except BaseException:
        file.close()
        raise


def _check_whole(path, file):
    """Place where the sections end, of a file whose digest holds. Reads in blocks, and believes nothing before."""
    size = os.fstat(file.fileno()).st_size
    if size == 0:
        raise CheckpointError(f"{path} is empty, not a checkpoint; it is not used, remove it")
    start = _bytes(file, 0, min(size, len(MAGIC)))
    if not MAGIC.startswith(start):
        raise CheckpointError(f"{path} does not start as a checkpoint does; it is not used, remove it")
    end = size - _BACK.size - _DIGEST_SIZE
    if end < _FRONT.size:
        raise CheckpointError(f"{path} is truncated, {size} bytes are no checkpoint; it is not used, remove it")
    mark, told = _BACK.unpack(_bytes(file, end, _BACK.size))
    if mark != END or told != end:
        raise CheckpointError(
            f"{path} is truncated or damaged, its end is not that of a checkpoint; it is not used, remove it"
        )
    digest = hashlib.sha256()
    place, stop = 0, size - _DIGEST_SIZE
    while place < stop:
        block = _bytes(file, place, min(stop - place, BLOCK))
        digest.update(block)
        place += len(block)
    if digest.digest() != _bytes(file, stop, _DIGEST_SIZE):
        raise CheckpointError(f"{path} is damaged, its checksum does not hold; it is not used, remove it")
    return end


def _bytes(file, place, count):
    """`count` bytes from `place` on; OSError where there are fewer."""
    file.seek(place)
    data = file.read(count)
    if len(data) < count:
        raise OSError("it became shorter while it was read")
    return data


class _Malformed(Exception):
    """The checksum holds, but what was written is no checkpoint."""


def _header(file, length, end):
    """Header, and the place where it ends."""
    header = _json(file, _FRONT.size, length, end)
    if not isinstance(header, dict):
        raise _Malformed("the header is no group of keys")
    return header, _FRONT.size + length


def _tables(file, place, end):
    """Of every section, {name: (dtype, shape, place)}; each array lies before `end`."""
    tables = []
    while place < end:
        if end - place < _LENGTH.size:
            raise _Malformed("it ends within a table")
        (length,) = _LENGTH.unpack(_bytes(file, place, _LENGTH.size))
        rows = _json(file, place + _LENGTH.size, length, end)
        place += _LENGTH.size + length
        table = {}
        for row in rows if isinstance(rows, list) else [rows]:
            name, dtype, shape = _row(row)
            table[name] = (dtype, shape, place)
            place += math.prod(shape) * np.dtype(dtype).itemsize
            if place > end:
                raise _Malformed(f"array {name} is longer than the file")
        tables.append(table)
    return tables


def _json(file, place, length, end):
    if length > end - place:
        raise _Malformed("a text is longer than the file")
    try:
        return json.loads(_bytes(file, place, length))
    except (ValueError, RecursionError):
        raise _Malformed("a text is no JSON") from None


def _row(row):
    """Name, dtype and shape of an array, from a row of a table."""
    try:
        name, dtype, shape = row
        known = isinstance(name, str) and dtype in DTYPES and isinstance(shape, list) and len(shape) <= MOST_DIMENSIONS
        # Lengths beside a zero are not bounded by the file, but numpy must be able to count them
        if known and all(type(n) is int and n >= 0 for n in shape) and math.prod(n or 1 for n in shape) < 1 << 59:
            return name, DTYPES[dtype], tuple(shape)
    except (TypeError, ValueError):
        pass
    raise _Malformed("a table does not describe arrays")


class Sections(Sequence):
    """Sections of a checkpoint that was found whole; each is read from the file when it is taken, and not kept.

    Holds the file open until it is closed or dropped, so it stays readable when a newer checkpoint takes its place.
    """

    def __init__(self, path, file, tables):
        self.path = path  # for the other ranks, to read the same one
        self._file, self._tables = file, tables

    def __len__(self) -> int:
        return len(self._tables)

    def __getitem__(self, number: int) -> dict[str, np.ndarray]:
        """Arrays of a section by name, owned and writable. CheckpointError where the file can no longer be read."""
        return {name: self._array(*place) for name, place in self._tables[number].items()}

    def _array(self, dtype, shape, place):
        array = np.empty(shape, dtype)
        data = array.reshape(-1).view(np.uint8)
        try:
            self._file.seek(place)
            if self._file.readinto(data) < data.size:
                raise OSError("it became shorter while it was read")
        except OSError as error:
            raise CheckpointError(f"{self.path} can no longer be read ({_reason(error)}); {READABLE}") from error
        return array.astype(array.dtype.newbyteorder("="), copy=False)

    def close(self) -> None:
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()


# -- a folder -----------------------------------------------------------------------------------------------


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
                    f"{self.folder}: no checkpoint can be written there ({_reason(error)}); give a folder that can be "
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
                f"{self.folder}: the checkpoints cannot be listed ({_reason(error)}); see to its rights, or give "
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
            self.report(f"{self.folder}: checkpoints of {self.key} remain ({_reason(error)}); remove them by hand")
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
        """Open lock file with the lock on it, or without where the file system has no locks (`_locked` says so)."""
        while True:
            self._locked = False
            file = open(self._lock_path, "a+b", buffering=0)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                self._locked = True
            except BlockingIOError:
                file.seek(0)
                holder = file.read(HOLDER_LENGTH).decode(errors="replace") or "another process"
                file.close()
                raise CheckpointError(
                    f"{self.folder}: {holder} runs this scene ({self.key}) with its checkpoints here; wait for it or "
                    f"end it, or give another folder"
                ) from None
            except OSError as error:
                self.report(
                    f"{self._lock_path} cannot be locked ({_reason(error)}); see that no other process runs this scene "
                    f"with its checkpoints there"
                )
                return file
            # Its holder may have removed it, and another made it anew, between our opening and locking
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(file.fileno()), os.stat(self._lock_path)):
                    with suppress(OSError):  # who holds it is told as a courtesy, a full disk does not matter here
                        file.truncate(0)
                        file.write(f"process {os.getpid()} on {socket.gethostname()}".encode()[:HOLDER_LENGTH])
                    return file
            file.close()

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
                self.report(f"{path} cannot be removed ({_reason(error)}); remove it by hand")


def _reason(error):
    return error.strerror or str(error)

"""A checkpoint: the state of a run in one file that is right or refused.

What a section stores is the caller's: a dict of named arrays, one section per rank or per part of the state.

The file, little-endian throughout:

    magic (8 bytes), schema (uint32), length of the header (uint64), header (JSON)
    for each section: length of its table (uint64), table (JSON list of [name, dtype, shape]), its arrays one after
        another, C order
    end mark (8 bytes), number of bytes before it (uint64), SHA-256 of everything before the digest (32 bytes)

Magic, schema, end mark and digest stay where they are in every schema, so that a file of another schema is not taken
for a damaged one. Nothing between them is read before the digest is verified.
"""

import errno
import hashlib
import json
import math
import os
import struct
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

SCHEMA = 1  # of the file format above
MAGIC, END = b"SCREE-CP", b"CP-SCREE"
DTYPES = {"float64": "<f8", "int64": "<i8", "int32": "<i4", "uint8": "|u1", "bool": "|b1"}
PART = ".part"
BLOCK = 1 << 20  # bytes read at a time for the digest
READABLE = "see that it is there, may be read, and is written by nothing else"
MAX_DIMENSIONS = 32  # of an array, within what every numpy can make

_FRONT = struct.Struct("<8sIQ")
_LENGTH = struct.Struct("<Q")
_BACK = struct.Struct("<8sQ")
_DIGEST_SIZE = hashlib.sha256().digest_size


class CheckpointError(ValueError):
    """A checkpoint that cannot be used or written; one line: which file, what is wrong, how to mend it."""


def reason(error: OSError) -> str:
    """What the operating system says of an error."""
    return error.strerror or str(error)


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
            f"{path}: the checkpoint could not be written ({reason(error)}), earlier ones stay as they are; make room "
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
        raise CheckpointError(f"{path}: the checkpoint cannot be read ({reason(error)}); {READABLE}") from error


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
        known = isinstance(name, str) and dtype in DTYPES and isinstance(shape, list) and len(shape) <= MAX_DIMENSIONS
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
            raise CheckpointError(f"{self.path} can no longer be read ({reason(error)}); {READABLE}") from error
        return array.astype(array.dtype.newbyteorder("="), copy=False)

    def close(self) -> None:
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

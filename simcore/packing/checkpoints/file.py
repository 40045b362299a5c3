"""A checkpoint: the state of a run in one file, which is verified when it is read.

A section is a dict of named arrays, one section per rank or per part of the state; the caller decides its contents.

The file, little-endian throughout:

    magic (8 bytes), schema (uint32), length of the header (uint64), header (JSON)
    for each section: length of its table (uint64), table (JSON list of [name, dtype, shape]), its arrays one after
        another, C order
    end mark (8 bytes), number of bytes before it (uint64), SHA-256 of everything before the digest (32 bytes)

Magic, schema, end mark and digest have the same positions in every schema, so that a file of another schema is not
reported as damaged. Nothing between them is read before the digest is verified.
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
READABLE = "check that the file exists, that it may be read, and that no other process writes it"
MAX_DIMENSIONS = 32  # of an array; every numpy version supports as many

_FRONT = struct.Struct("<8sIQ")
_LENGTH = struct.Struct("<Q")
_BACK = struct.Struct("<8sQ")
_DIGEST_SIZE = hashlib.sha256().digest_size


class CheckpointError(ValueError):
    """A checkpoint cannot be used or written; the message, one line, names the file, the fault and the remedy."""


def reason(error: OSError) -> str:
    """Return the operating system's text for an error."""
    return error.strerror or str(error)


def write_checkpoint(path, header: dict, sections: Iterable[dict[str, np.ndarray]]) -> None:
    """Write a checkpoint under a temporary name beside `path`, then rename it, so that `path` is never incomplete.

    header: values that JSON can store, and numpy scalars. sections: consumed one at a time; TypeError for an array
    whose type is not in DTYPES. CheckpointError if the disk is full or the file cannot be written. The temporary file
    is then removed, and the remaining sections are consumed and dropped, so that no rank waits to send its section.
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
            f"{path}: the checkpoint could not be written ({reason(error)}); earlier ones are unchanged. Free space "
            f"in {path.parent} and check that it is writable, or give another folder"
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
        del section  # so that memory never contains two sections
    put(_BACK.pack(END, size))
    file.write(digest.digest())


def _put_section(put, section):
    arrays = {name: np.asarray(array) for name, array in section.items()}
    for name, array in arrays.items():
        if array.dtype.name not in DTYPES:
            raise TypeError(
                f"checkpoint: array {name} is of {array.dtype}, but its type must be one of {', '.join(DTYPES)}"
            )
    table = [[name, array.dtype.name, list(array.shape)] for name, array in arrays.items()]
    text = json.dumps(table).encode()
    put(_LENGTH.pack(len(text)))
    put(text)
    for array in arrays.values():
        put(np.asarray(array, DTYPES[array.dtype.name], order="C").reshape(-1).view(np.uint8))


def _plain(value):
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"checkpoint: the header cannot store {value!r}; use numbers, text, lists and dicts")


def _sync_folder(folder):
    """Make a rename in `folder` permanent even if power fails, on systems where a folder can be opened."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as error:
        # Some network file systems cannot sync folders.
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(handle)


def read_checkpoint(path, key: str, code: str, schema: int = SCHEMA) -> tuple[dict, "Sections"]:
    """Return header and sections of the checkpoint at `path`; the arrays of a section are read when it is accessed.

    key, code: of the run that resumes from it. CheckpointError, with the reason, unless the file is complete and has
    the same scene, code and schema.
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
        raise CheckpointError(f"{path} is not a regular file and therefore not a checkpoint; move it elsewhere")
    file = open(path, "rb")
    try:
        end = _check_whole(path, file)
        _, file_schema, length = _FRONT.unpack(_bytes(file, 0, _FRONT.size))
        if file_schema != schema:
            raise CheckpointError(
                f"{path} is a checkpoint of schema {file_schema}, but this code reads schema {schema}. It is not used: "
                f"resume with the code that wrote it, or start again"
            )
        try:
            header, start = _header(file, length, end)
            for name, wanted, label in (("key", key, "scene"), ("code", code, "version of the code")):
                if header.get(name) != wanted:
                    raise CheckpointError(
                        f"{path} is a checkpoint of another {label} ({header.get(name)}; this run has {wanted}). It is "
                        f"not used, as the result would mix both: resume with that {label}, or start again"
                    )
            return header, Sections(path, file, _tables(file, start, end))
        except _Malformed as error:
            raise CheckpointError(
                f"{path} is complete, but its layout is not that of a checkpoint ({error}). It is not used; remove it"
            ) from None
    except BaseException:
        file.close()
        raise


def _check_whole(path, file):
    """Verify the digest of a file and return the position where its sections end. The file is read in blocks."""
    size = os.fstat(file.fileno()).st_size
    if size == 0:
        raise CheckpointError(f"{path} is empty and not a checkpoint. It is not used; remove it")
    start = _bytes(file, 0, min(size, len(MAGIC)))
    if not MAGIC.startswith(start):
        raise CheckpointError(f"{path} does not start like a checkpoint. It is not used; remove it")
    end = size - _BACK.size - _DIGEST_SIZE
    if end < _FRONT.size:
        raise CheckpointError(f"{path} is truncated: it has only {size} bytes. It is not used; remove it")
    mark, stored_end = _BACK.unpack(_bytes(file, end, _BACK.size))
    if mark != END or stored_end != end:
        raise CheckpointError(
            f"{path} is truncated or damaged: its end is not that of a checkpoint. It is not used; remove it"
        )
    digest = hashlib.sha256()
    place, stop = 0, size - _DIGEST_SIZE
    while place < stop:
        block = _bytes(file, place, min(stop - place, BLOCK))
        digest.update(block)
        place += len(block)
    if digest.digest() != _bytes(file, stop, _DIGEST_SIZE):
        raise CheckpointError(f"{path} is damaged: its checksum is wrong. It is not used; remove it")
    return end


def _bytes(file, place, count):
    """Return `count` bytes from position `place`; OSError if there are fewer."""
    file.seek(place)
    data = file.read(count)
    if len(data) < count:
        raise OSError("it became shorter while it was read")
    return data


class _Malformed(Exception):
    """The checksum is right, but the contents are not a checkpoint."""


def _header(file, length, end):
    """Return the header and the position where it ends."""
    header = _json(file, _FRONT.size, length, end)
    if not isinstance(header, dict):
        raise _Malformed("the header is not a dict")
    return header, _FRONT.size + length


def _tables(file, place, end):
    """Return {name: (dtype, shape, position)} of every section; every array ends before position `end`."""
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
        raise _Malformed("a text is not JSON") from None


def _row(row):
    """Return name, dtype and shape of an array from a row of a table."""
    try:
        name, dtype, shape = row
        valid = isinstance(name, str) and dtype in DTYPES and isinstance(shape, list) and len(shape) <= MAX_DIMENSIONS
        # If one length is zero, the size of the file does not bound the others; numpy must be able to store them.
        if valid and all(type(n) is int and n >= 0 for n in shape) and math.prod(n or 1 for n in shape) < 1 << 59:
            return name, DTYPES[dtype], tuple(shape)
    except (TypeError, ValueError):
        pass
    raise _Malformed("a table does not describe arrays")


class Sections(Sequence):
    """Sections of a verified checkpoint; a section is read from the file at each access and not cached.

    The file stays open until this object is closed or deleted, so it stays readable after a newer one replaces it.
    """

    def __init__(self, path, file, tables):
        self.path = path  # the other ranks read the same file
        self._file, self._tables = file, tables

    def __len__(self) -> int:
        return len(self._tables)

    def __getitem__(self, number: int) -> dict[str, np.ndarray]:
        """Return the writable arrays of a section by name. CheckpointError if the file can no longer be read."""
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
        """Close the file."""
        self._file.close()

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

"""Reads vertices and triangles from mesh files: STL, PLY, OBJ and OFF."""

import codecs
import re

import numpy as np

_PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_STL_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_STL_VERTEX = re.compile(rb"^\s*vertex\s+([^\r\n]*)", re.IGNORECASE | re.MULTILINE)
_STL_FACET = rb"facet\b", rb"endfacet\b"
_PLY_ORDER = {"binary_little_endian": "<", "binary_big_endian": ">"}


def read_mesh(path):
    """Read the vertices (n, 3) and triangles (m, 3) of a mesh file; m = 0 if the file has only points.

    Faces with more than three corners become fans of triangles. ValueError describes the fault in the file, without its
    path.
    """
    data, suffix = path.read_bytes().removeprefix(codecs.BOM_UTF8), path.suffix.lower()
    vertices, faces = {".obj": _read_obj, ".ply": _read_ply, ".stl": _read_stl, ".off": _read_off}[suffix](data)
    if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
        raise ValueError(
            f"a face refers to a vertex that does not exist; the mesh has {len(vertices)} vertices; export it again"
        )
    return vertices, faces


def _fans(polygons):
    """Return the triangles (m, 3) of polygons, each a sequence of at least three vertex indices."""
    fans = [(corners[0], corners[i], corners[i + 1]) for corners in polygons for i in range(1, len(corners) - 1)]
    try:
        return np.array(fans, int).reshape(-1, 3)
    except OverflowError:
        raise ValueError("a face refers to a vertex by a number that is too large; export the mesh again") from None


def _read_stl(data):
    is_text = data.lstrip()[:5].lower() == b"solid"
    if len(data) >= 84:
        count = int(np.frombuffer(data, "<u4", 1, 80)[0])
        if len(data) == 84 + 50 * count:  # also if its header begins as text does
            corners = np.frombuffer(data, _STL_ROW, count, 84)["corners"].reshape(-1, 3).astype(float)
            return corners, np.arange(len(corners)).reshape(-1, 3)
    words = _STL_VERTEX.findall(data)
    if not is_text or not words:
        raise ValueError(
            "the file cannot be read as a mesh: it is neither STL text nor binary STL of the length in its header"
            f"{'' if is_text else _describe_length(data)}; export or copy it again"
        )
    ends = [len(re.findall(rb"^\s*" + word, data, re.IGNORECASE | re.MULTILINE)) for word in _STL_FACET]
    if 0 < ends[1] < ends[0]:
        raise ValueError(
            f"the file cannot be read as a mesh: the STL text has {ends[0]} facets and {ends[1]} lines `endfacet`, so "
            "that it may be cut short; export or copy it again"
        )
    try:
        corners = np.array([line.split() for line in words], float)
        return corners, np.arange(len(corners)).reshape(-1, 3)
    except ValueError:
        raise ValueError(
            "the file cannot be read as a mesh: a vertex is not three numbers, or a triangle not three vertices; it "
            "may be cut short; export or copy it again"
        ) from None


def _describe_length(data):
    """Return a clause on how far the length of a binary STL is from that in its header, or ""."""
    if len(data) < 84:
        return "; it may be cut short"
    count = int(np.frombuffer(data, "<u4", 1, 80)[0])
    surplus = len(data) - 84 - 50 * count
    what = f"{surplus} bytes longer" if surplus > 0 else f"{-surplus} bytes shorter, so it may be cut short"
    return f", which has {count} triangles; the file is {what}"


def _read_off(data):
    text = data.decode("utf-8", errors="replace")
    lines = [words for line in text.splitlines() if (words := line.split("#", 1)[0].split())]
    keyword = lines[0].pop(0) if lines and lines[0][0].endswith("OFF") else ""
    if keyword not in ("", "OFF", "COFF", "NOFF", "CNOFF", "STOFF") or lines[:1] == [["BINARY"]]:
        raise ValueError(
            f"it is a file of the kind {keyword} {' '.join(lines[0])}, but only OFF text in three dimensions is read; "
            "export the mesh again"
        )
    lines = [words for words in lines if words]
    try:
        vertex_count, face_count = int(lines[0][0]), int(lines[0][1])
        rows, faces = lines[1 : 1 + vertex_count], lines[1 + vertex_count : 1 + vertex_count + face_count]
        if len(rows) < vertex_count or len(faces) < face_count or min(vertex_count, face_count) < 0:
            raise IndexError
        vertices = np.array([words[:3] for words in rows], float).reshape(-1, 3)
        corners = [[int(word) for word in words[1 : 1 + int(words[0])]] for words in faces]
        if any(len(own) < max(int(words[0]), 3) for own, words in zip(corners, faces, strict=True)):
            raise IndexError
    except (IndexError, ValueError):
        raise ValueError(
            "the file cannot be read as a mesh: OFF text has the numbers of vertices and faces and then a line of "
            "numbers for each; it may be cut short; export or copy it again"
        ) from None
    return vertices, _fans(corners)


def _read_obj(data):
    text = data.decode("utf-8", errors="replace")
    vertices, polygons = [], []
    for number, line in enumerate(text.replace("\\\r\n", " ").replace("\\\n", " ").splitlines(), start=1):
        words = line.split("#", 1)[0].split()
        if not words or words[0] not in ("v", "f"):
            continue
        try:
            if words[0] == "v":
                x, y, z = map(float, words[1:4])
                vertices.append((x, y, z))
            else:
                polygons.append(_obj_corners(words[1:], len(vertices)))
        except ValueError as error:
            reason = "a vertex needs three numbers" if words[0] == "v" else f"a face cannot be read ({error})"
            raise ValueError(f"line {number}: {reason}: '{line.strip()[:60]}'; export the mesh again") from None
    return np.array(vertices, float).reshape(-1, 3), _fans(polygons)


def _obj_corners(words, count):
    """Return the vertex indices, from 0, of one face; negative ones count back from the last vertex before the face."""
    indices = [int(word.split("/", 1)[0]) for word in words]
    if len(indices) < 3 or 0 in indices:
        raise ValueError("at least three corners are needed, counted from 1")
    return [index - 1 if index > 0 else count + index for index in indices]


def _read_ply(data):
    format_name, elements, start = _ply_header(data)
    read = _ascii_reader(data[start:]) if format_name == "ascii" else _binary_reader(data, start, format_name)
    vertices, faces = np.empty((0, 3)), np.empty((0, 3), int)
    for name, count, properties in elements:
        columns = read(name, count, properties)
        if name == "vertex":
            missing = [axis for axis in "xyz" if axis not in columns]
            if missing:
                raise ValueError(f"its vertices have no property {', '.join(missing)}; export the mesh again")
            vertices = np.column_stack([np.asarray(columns[axis], float) for axis in "xyz"])
        elif name == "face":
            lists = [columns[key] for key in ("vertex_indices", "vertex_index") if key in columns]
            if not lists and count:
                raise ValueError("its faces have no property vertex_indices; export the mesh again")
            faces = _triangles(lists[0]) if lists else faces
        elif name == "tristrips" and count:
            raise ValueError("it stores triangle strips, which cannot be read; export it with separate triangles")
    return vertices, faces


def _triangles(polygons):
    """Return the triangles (m, 3) of polygons: an array (m, k) if all have k corners, otherwise a list of sequences."""
    if isinstance(polygons, np.ndarray) and polygons.ndim == 2:
        if polygons.shape[1] < 3:
            raise ValueError(f"its faces have {polygons.shape[1]} corners, but at least 3 are needed; export it again")
        corners = polygons.astype(int)
        fans = [corners[:, [0, i, i + 1]] for i in range(1, corners.shape[1] - 1)]
        return np.stack(fans, axis=1).reshape(-1, 3)
    if any(len(corners) < 3 for corners in polygons):
        raise ValueError("one of its faces has fewer than three corners; export the mesh again")
    return _fans(polygons)


def _ply_header(data):
    """Return the format, the elements as (name, count, properties), and the position where the data begin.

    properties: list of (name, type, type of the length of a list or None).
    """
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        raise ValueError("the file is not a PLY file: it does not begin with `ply` and a header; export it again")
    start = end + len(b"end_header")
    start += 2 if data[start : start + 2] == b"\r\n" else 1
    format_name, elements = None, []
    try:
        for line in data[:end].decode("latin-1").splitlines():
            words = line.split()
            if words[:1] == ["format"]:
                format_name = words[1]
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                elements[-1][2].append((words[4], _PLY_TYPES[words[3]], _PLY_TYPES[words[2]]))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[2], _PLY_TYPES[words[1]], None))
    except (IndexError, KeyError, ValueError):
        raise ValueError(
            f"the line '{line.strip()[:60]}' of its header cannot be read; export the mesh again"
        ) from None
    if format_name != "ascii" and format_name not in _PLY_ORDER:
        raise ValueError(f"its format is {format_name}; export it as one of ascii, {', '.join(_PLY_ORDER)}")
    return format_name, elements, start


def _cut_short(name, count):
    return ValueError(f"the file ends before its {count} elements `{name}`; it is cut short, export or copy it again")


def _ascii_reader(body):
    """Return read(name, count, properties) -> columns, whose calls proceed through the words of the file."""
    words = body.split()
    position = 0

    def read(name, count, properties):
        nonlocal position
        try:
            if all(of_list is None for _, _, of_list in properties):
                numbers = words[position : position + count * len(properties)]
                position += count * len(properties)
                table = np.array(numbers, float).reshape(count, len(properties))
                return {key: table[:, i] for i, (key, _, _) in enumerate(properties)}
            columns = {key: [] for key, _, _ in properties}
            for _ in range(count):
                for key, _, of_list in properties:
                    length = 1 if of_list is None else int(words[position])
                    position += of_list is not None
                    values = words[position : position + length]
                    position += length
                    if len(values) < length:
                        raise IndexError
                    columns[key].append([int(value) for value in values] if of_list else values[0])
            return columns
        except (IndexError, ValueError) as error:
            if position >= len(words) or isinstance(error, IndexError):
                raise _cut_short(name, count) from None
            raise ValueError(f"an element `{name}` is not a number ({error}); export the mesh again") from None

    return read


def _binary_reader(data, start, format_name):
    """Return read(name, count, properties) -> columns, whose calls proceed through the bytes of the file."""
    order, position = _PLY_ORDER[format_name], start

    def read(name, count, properties):
        nonlocal position
        try:
            lengths = _list_lengths(data, position, order, properties) if count else {}
            row = _row_type(order, properties, lengths)
            table = np.frombuffer(data, row, count, position) if row.itemsize else np.empty(count, row)
            if all((table[f"{key} length"] == length).all() for key, length in lengths.items()):
                position += count * row.itemsize
                return {key: table[key] for key, _, _ in properties}
        except ValueError:
            if all(of_list is None for _, _, of_list in properties):
                raise _cut_short(name, count) from None
        try:
            columns, position = _mixed_rows(data, position, order, count, properties)
        except (IndexError, ValueError):
            raise _cut_short(name, count) from None
        return columns

    return read


def _row_type(order, properties, lengths):
    """Return the NumPy type of one row whose lists have these lengths."""
    fields = []
    for key, kind, of_list in properties:
        if of_list is None:
            fields.append((key, order + kind))
        else:
            fields += [(f"{key} length", order + of_list), (key, order + kind, (lengths.get(key, 0),))]
    return np.dtype(fields)


def _list_lengths(data, position, order, properties):
    """Return the length of each list in the row at `position`, dict from name to length."""
    lengths = {}
    for key, kind, of_list in properties:
        if of_list is not None:
            lengths[key] = int(np.frombuffer(data, order + of_list, 1, position)[0])
            position += np.dtype(of_list).itemsize
        position += lengths.get(key, 1) * np.dtype(kind).itemsize
    return lengths


def _mixed_rows(data, position, order, count, properties):
    """Read rows whose lists differ in length, one after the other; return their columns and the end position."""
    columns = {key: [] for key, _, _ in properties}
    types = [(key, np.dtype(order + kind), of_list and np.dtype(order + of_list)) for key, kind, of_list in properties]
    for _ in range(count):
        for key, kind, of_list in types:
            length = 1
            if of_list is not None:
                length = int(np.frombuffer(data, of_list, 1, position)[0])
                position += of_list.itemsize
                if length < 0:
                    raise ValueError
            values = np.frombuffer(data, kind, length, position)
            position += length * kind.itemsize
            columns[key].append(values.tolist() if of_list is not None else values[0])
    return columns, position

"""Files for ParaView: grains as solids (.vtu, by meshio) or surfaces (.vtp, by pyvista), and contacts as lines."""

import numpy as np

from simcore.export.libraries import library
from simcore.export.placement import places
from simcore.export.surfaces import DIVISIONS, surfaces
from simcore.export.table import contact_table, grain_table
from simcore.writing import whole_file

OF_GRAINS = ("grain", "D", "L", "I", "S", "FL", "EL", "volume", "coordination")
OF_CONTACTS = ("first", "second", "image_x", "image_y", "overlap", "force", "normal_force")


def contacts_path(path):
    """Return the path of the contacts that belong to a file of grains: bed_contacts.vtu beside bed.vtu."""
    return path.with_name(f"{path.stem}_contacts{path.suffix}")


def write_solids(path, packing, periodic="leave", divisions=None):
    """Write each grain as one solid cell (.vtu), so that ParaView's slices of it are filled; and its contacts.

    The cell data are those of simcore.export.table.grain_table, in SI units. Cells are sorted by their number of
    vertices; `grain` has their number in the file of the packing. Returns the paths of both files.
    """
    meshio = library("meshio", f"{path.suffix} for ParaView")
    by_count, points, n = {}, [], 0
    for grain, vertices, faces in surfaces(packing, periodic, DIVISIONS if divisions is None else divisions):
        cells, grains = by_count.setdefault(len(vertices), ([], []))
        cells.append(list(faces + n))
        grains.append(grain)
        points.append(vertices)
        n += len(vertices)
    table = grain_table(packing)
    by_count = dict(sorted(by_count.items()))  # meshio's reader assigns the data of the cells in this order
    blocks = [(f"polyhedron{count}", cells) for count, (cells, _) in by_count.items()]
    data = {name: [table[name].to_numpy()[grains] for _, grains in by_count.values()] for name in OF_GRAINS}
    with whole_file(path) as part:
        meshio.Mesh(np.concatenate(points), blocks, cell_data=data).write(part, "vtu")

    ends, table, vectors = contact_lines(packing, periodic)
    lines = np.arange(2 * len(ends)).reshape(-1, 2)
    data = {name: [table[name].to_numpy()] for name in OF_CONTACTS} | {name: [v] for name, v in vectors.items()}
    contacts = contacts_path(path)
    with whole_file(contacts) as part:
        meshio.Mesh(ends.reshape(-1, 3), [("line", lines)], cell_data=data).write(part, "vtu")
    return [path, contacts]


def write_surfaces(path, packing, periodic="leave", divisions=None):
    """Write the surfaces of the grains as triangles (.vtp), with the numbers of their grain; and their contacts.

    The cell data are those of `write_solids`. Returns the paths of both files.
    """
    pyvista = library("pyvista", f"{path.suffix} for ParaView")
    points, faces, of_grain, n = [], [], [], 0
    for grain, vertices, triangles in surfaces(packing, periodic, DIVISIONS if divisions is None else divisions):
        points.append(vertices)
        faces.append(triangles + n)
        of_grain.append(np.full(len(triangles), grain))
        n += len(vertices)
    table, of_grain = grain_table(packing), np.concatenate(of_grain)
    mesh = pyvista.PolyData.from_regular_faces(np.concatenate(points), np.concatenate(faces))
    for name in OF_GRAINS:
        mesh.cell_data[name] = table[name].to_numpy()[of_grain]
    save_vtk(mesh, path)

    ends, table, vectors = contact_lines(packing, periodic)
    lines = np.column_stack([np.full(len(ends), 2), np.arange(2 * len(ends)).reshape(-1, 2)])
    mesh = pyvista.PolyData(ends.reshape(-1, 3), lines=lines.ravel()) if len(ends) else pyvista.PolyData()
    # pyvista takes no empty arrays.
    for name, values in ({name: table[name].to_numpy() for name in OF_CONTACTS} | vectors).items() if len(ends) else ():
        mesh.cell_data[name] = values
    contacts = contacts_path(path)
    save_vtk(mesh, contacts)
    return [path, contacts]


def save_vtk(mesh, path):
    """Write a pyvista.PolyData or ImageData to an XML file of VTK. OSError, which names the file, if this fails."""
    vtk = library("vtkmodules.vtkIOXML", f"{path.suffix} for ParaView")
    writer = {".vtp": vtk.vtkXMLPolyDataWriter, ".vti": vtk.vtkXMLImageDataWriter}[path.suffix.lower()]()
    with whole_file(path) as part:
        writer.SetFileName(str(part))
        writer.SetInputData(mesh)
        # VTK reports a failure neither by an exception nor always by its result.
        if not writer.Write() or writer.GetErrorCode():
            raise OSError(f"VTK error {writer.GetErrorCode()}")


def contact_lines(packing, periodic="leave"):
    """Return the contacts as lines: ends (k, 2, 3) [m], rows of contact_table (k), vectors (dict of (k, 3) arrays).

    A line runs from the centre of the first grain to that of the second, or to the point of contact at a wall. With
    `copy`, a contact through a side of the box has a second line, from the other side; with `cut`, its lines end at the
    sides. The vectors are the force on the second body [N], the normal, and the point of contact [m].
    """
    table = contact_table(packing)
    where = places(packing, periodic)
    position = packing["position"].values
    first, second = table["first"].to_numpy(), table["second"].to_numpy()
    point = table[list("xyz")].to_numpy()
    width = packing.attrs["domain_width"]
    image = np.column_stack([table["image_x"], table["image_y"], np.zeros(len(table))]) * width
    starts = position[first]
    ends = np.where((second >= 0)[:, None], position[np.maximum(second, 0)] + image, point)
    rows, shift = np.arange(len(table)), np.zeros((len(table), 3))
    if periodic != "leave" and packing.attrs["domain_shape"] == "periodic":
        # The same contact, seen from the place of the second grain in the box.
        through = np.flatnonzero(image.any(axis=1))
        rows, shift = np.append(rows, through), np.concatenate([shift, -image[through]])
    if where.sides is not None:
        # A line through an edge of the box may also have a piece that enters by one side and leaves by the other.
        at_edge = np.flatnonzero(image[:, :2].all(axis=1))
        rows = np.concatenate([rows, at_edge, at_edge])
        shift = np.concatenate([shift, *(-image[at_edge] * axis for axis in np.eye(3)[:2])])
        # A line to the floor that leaves the box has a piece that enters by the other side.
        beyond = np.where(second < 0, np.floor(point[:, :2].T / where.sides), 0.0).T
        for side in ([1.0, 0.0], [0.0, 1.0], [1.0, 1.0]):
            through = np.flatnonzero((beyond * side != 0.0).sum(axis=1) == sum(side))
            rows = np.append(rows, through)
            shift = np.concatenate([shift, np.c_[-where.sides * beyond[through] * side, np.zeros(len(through))]])
    lines = np.stack([starts[rows] + shift, ends[rows] + shift], axis=1).reshape(-1, 2, 3)
    if where.sides is not None:
        lines, kept = _cut_lines(lines, where.sides)
        rows, shift = rows[kept], shift[kept]
    table = table.iloc[rows].reset_index(drop=True)
    vectors = {
        "force_vector": table[[f"force_{axis}" for axis in "xyz"]].to_numpy(),
        "normal": table[[f"normal_{axis}" for axis in "xyz"]].to_numpy(),
        "point": table[list("xyz")].to_numpy() + shift,
    }
    return lines, table, vectors


def _cut_lines(lines, width):
    """Return the parts of lines (k, 2, 3) with 0 <= x, y <= width, and whether each line has one, (k,) bool."""
    start, way = lines[:, 0], lines[:, 1] - lines[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        at = (np.stack([np.zeros(2), np.full(2, width)])[:, None] - start[:, :2]) / way[:, :2]  # (side, k, axis)
    parallel = way[:, :2] == 0.0
    low = np.where(parallel, 0.0, at.min(axis=0)).max(axis=1, initial=0.0)
    high = np.where(parallel, 1.0, at.max(axis=0)).min(axis=1, initial=1.0)
    beside = (parallel & ((start[:, :2] < 0.0) | (start[:, :2] > width))).any(axis=1)
    kept = (low < high) & ~beside
    ends = np.stack([start + low[:, None] * way, start + high[:, None] * way], axis=1)
    return ends[kept], kept

"""Checks that a file of a packing has all that its evaluation needs, with values that a packing can have."""

import json
from numbers import Real

import numpy as np

from simcore.grains.polyhedron import volume_moments

VARIABLES = (
    "position", "orientation", "scale", "shape", "L", "I", "S", "D", "volume",
    "shape_kind", "shape_vertices", "shape_vertex_start", "shape_vertex_count",
    "shape_faces", "shape_face_start", "shape_face_count",
    "contact_body", "contact_image", "contact_normal", "contact_point", "contact_overlap", "contact_force",
)  # fmt: skip
ATTRIBUTES = ("domain_shape", "domain_width")
POSITIVE = ("L", "I", "S", "D", "volume")
OF_CONTACTS = ("contact_normal", "contact_point", "contact_overlap", "contact_force")
DOMAINS = ("periodic", "cylinder")
SPHERE = 4.0 / 3.0 * np.pi  # volume of the unit sphere
ALIKE = 1e-3  # largest relative difference of a grain's volume and that of its shape and scale
CENTRED = 1e-3  # largest distance of a base shape's centre of mass from the origin, in its largest coordinate
UNIT = 1e-6  # largest deviation of the norm of an orientation from 1
FARTHEST = 1e4  # maximum distance of a grain from the origin, in widths of the domain


FILE = "so that the file is damaged. Make it again with `scree pack`."
DATASET = "which no packing has. Correct the Dataset, or evaluate the packing as it was read."


def check_content(path, packing, remedy: str = FILE) -> None:
    """Raise ValueError, which names the file and the grain, unless a Dataset is a whole packing.

    path: of its file, or words for a Dataset that has none; remedy: FILE or DATASET, the end of the message.
    """

    def damaged(what):
        return ValueError(f"{path}: {what}, {remedy}")

    missing = [*(name for name in VARIABLES if name not in packing.variables),
               *(name for name in ATTRIBUTES if name not in packing.attrs)]  # fmt: skip
    if missing:
        raise ValueError(f"{path} is not a packing: {', '.join(missing)} missing. Give a file that `scree pack` wrote.")
    try:
        scene = json.loads(packing.attrs.get("scene", "{}"))  # a file made by hand may have none
    except ValueError:
        raise damaged("the attribute scene is not JSON") from None
    if not isinstance(scene, dict):
        raise damaged("the attribute scene is not a specification")
    shape, width = packing.attrs["domain_shape"], packing.attrs["domain_width"]
    if shape not in DOMAINS:
        raise damaged(f"the attribute domain_shape is {shape!r} and not one of {', '.join(DOMAINS)}")
    if not (isinstance(width, Real) and 0.0 < width < np.inf):
        raise damaged(f"the attribute domain_width is {width!r}, but must be a positive number [m]")
    farthest = FARTHEST * float(width)
    wrong = {name: ~(packing[name].values > 0.0) | np.isinf(packing[name].values) for name in POSITIVE}
    wrong["position"] = ~(np.abs(packing["position"].values) <= farthest).all(axis=1)
    wrong["scale"] = ~np.isfinite(packing["scale"].values).all(axis=1)
    wrong["orientation"] = ~(np.abs(np.linalg.norm(packing["orientation"].values, axis=1) - 1.0) <= UNIT)
    shapes = packing["shape"].values
    wrong["shape"] = (shapes < 0) | (shapes >= packing.sizes["shape"])
    for name, grains in wrong.items():
        if grains.any():
            grain = int(np.argmax(grains))
            raise damaged(f"{name} of grain {grain} is {packing[name].values[grain]}")
    _check_shapes(path, packing, damaged)
    if (packing["contact_body"].values >= packing.sizes["grain"]).any():
        raise damaged("a contact is of a grain that does not exist")
    for name in OF_CONTACTS:
        contacts = ~np.isfinite(packing[name].values)
        contacts = contacts.any(axis=tuple(range(1, contacts.ndim)))
        if contacts.any():
            contact = int(np.argmax(contacts))
            raise damaged(f"{name} of contact {contact} is {packing[name].values[contact]}")


def _check_shapes(path, packing, damaged):
    """Raise ValueError unless base shapes are closed about their centre of mass, and volumes are those of the shapes.

    The volume of a grain is that of its base shape times the product of its scale.
    """
    values = {name: packing[f"shape_{name}"].values for name in ("vertices", "faces")}
    ranges = {
        name: packing[f"shape_{name}_start"].values[:, None] + np.stack([0 * n, n], axis=1)
        for name, n in (("vertex", packing["shape_vertex_count"].values), ("face", packing["shape_face_count"].values))
    }
    base = np.full(packing.sizes["shape"], SPHERE)
    for i in np.flatnonzero(np.diff(ranges["face"], axis=1)):
        (first, end), (first_face, end_face) = ranges["vertex"][i], ranges["face"][i]
        vertices, faces = values["vertices"][first:end], values["faces"][first_face:end_face]
        whole = len(vertices) == end - first and len(faces) == end_face - first_face and end > first
        if not whole or faces.min() < 0 or faces.max() >= len(vertices):
            raise damaged(f"base shape {i} has faces or vertices that do not exist")
        base[i], centre, _ = volume_moments(vertices, faces)
        if not np.abs(centre).max() <= CENTRED * np.abs(vertices).max():
            raise damaged(f"the vertices of base shape {i} are not relative to its centre of mass")
    expected = base[packing["shape"].values] * packing["scale"].values.prod(axis=1)
    volume = packing["volume"].values
    wrong = np.flatnonzero(~(np.abs(volume - expected) <= ALIKE * np.abs(expected)))
    if len(wrong):
        grain = wrong[0]
        raise ValueError(
            f"{path}: volume of grain {grain} is {volume[grain]:.6g} m³, but its shape and scale give "
            f"{expected[grain]:.6g} m³. scale contains semi-axes [m], not diameters, and volume is in m³."
        )

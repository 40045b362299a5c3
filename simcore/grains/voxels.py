"""Bodies in voxel images, and points on their surface without the first-order bias of voxel centres."""

import numpy as np
from scipy.ndimage import find_objects, gaussian_filter, label

from simcore.grains.bodies import Body, with_share

# The width of the smoothing in voxels is this times the square root of the grain's radius in voxels, because the
# terraces of the mask are about sqrt(radius) wide where the surface is tangent to a lattice plane.
_SMOOTHING = 0.25
# Minimum share of the solid voxels of a label image that are in the largest part of their label, and minimum share of
# pairs of neighbouring solid voxels with one label. Images of grey values have far smaller shares.
_LEAST_IN_PARTS, _LEAST_ALIKE = 0.5, 0.5
_HOW_TO_MASK = "make a mask of 0 outside and 1 inside, for example `mask = image > threshold`"


def mask_surface(mask, spacing):
    """Return points (n, 3) on the surface of the solid in a voxel mask, in the unit of spacing.

    mask: (nx, ny, nz), non-zero inside; spacing: edge of a voxel, a number or (3,). ValueError if the mask is empty or
    the spacing is not positive.

    Bias: the hull of the centres of solid voxels is inside the solid, by 0.5 voxel at a face along the lattice and by
    0.3 to 0.15 voxel on average on spheres of 5 to 40 voxels radius. This is 7 % and 1 % of the volume at radii of 10
    and 40. The hull of the corners is outside the solid by at least as much. Therefore the mask is smoothed, and the
    points are where it crosses 1/2 between neighbouring centres. A Gaussian would shift curved surfaces inwards by
    width² x curvature; the difference 2 G(w) - G(sqrt(2) w) of two Gaussians has no second moment and does not shift
    them. The remaining error of the semi-axes is below 0.1 voxel, of either sign (tests/grains/test_voxels.py). It is
    larger if the grain is flat or long and S is below about 12 voxels: S is then too large by up to 0.3 voxel, L too
    small by up to 0.6, and S/I or I/L wrong by up to 0.02.
    """
    mask = np.asarray(mask) != 0
    spacing = np.broadcast_to(np.asarray(spacing, float), 3)
    if mask.ndim != 3 or not mask.any():
        raise ValueError(f"a voxel mask needs three dimensions and at least one solid voxel; its shape is {mask.shape}")
    if not (np.isfinite(spacing).all() and np.all(spacing > 0)):
        raise ValueError(f"the voxel spacing {spacing} must be positive; correct it")
    inside = [np.flatnonzero(mask.any(axis=axes)) for axes in ((1, 2), (0, 2), (0, 1))]
    start = np.array([i[0] for i in inside])
    mask = mask[tuple(slice(i[0], i[-1] + 1) for i in inside)]
    width = _SMOOTHING * np.sqrt(np.cbrt(3 * mask.sum() / (4 * np.pi)))
    margin = int(np.ceil(4 * np.sqrt(2) * width)) + 1
    solid = np.pad(mask, margin).astype(float)
    points = np.empty((0, 3))
    while not len(points):
        level = 2 * gaussian_filter(solid, width) - gaussian_filter(solid, np.sqrt(2) * width) - 0.5
        points = np.concatenate([_crossings(level, axis) for axis in range(3)])
        width /= 2.0  # a sheet that is thinner than the smoothing is nowhere solid
    return (points + start - margin) * spacing


def _crossings(level, axis):
    """Return the points (n, 3) [index] where a lattice field (nx, ny, nz) crosses zero between neighbours along axis.

    The field is interpolated linearly between neighbours.
    """
    along = np.moveaxis(level, axis, 0)
    index = np.argwhere((along[:-1] > 0) != (along[1:] > 0))
    here, there = along[:-1][tuple(index.T)], along[1:][tuple(index.T)]
    points = index.astype(float)
    points[:, 0] += here / (here - there)
    return np.insert(points[:, 1:], axis, points[:, 0], axis=1)


def image_bodies(image, spacing):
    """Return [(name, bodies)] of a voxel image: one pair with the name "" for a mask, one pair per label otherwise.

    image: (nx, ny, nz), a mask of 0 and one other value, or whole numbers with 0 outside and one label per grain.
    spacing: as in mask_surface. bodies: list of Body, the parts of the mask or label that do not touch each other, not
    even at corners. ValueError if the image is neither mask nor labels: grey values, NaN, or solid at its borders.
    """
    image = np.asarray(image)
    if image.ndim != 3 or not image.any():
        raise ValueError(
            f"a voxel image needs three dimensions and at least one solid voxel; its shape is {image.shape}"
        )
    if image.dtype.kind not in "buif":
        raise ValueError(f"its values are of type {image.dtype}, not numbers; {_HOW_TO_MASK}")
    if image.dtype.kind == "f" and not np.isfinite(image).all():
        raise ValueError(
            "it has voxels with NaN or infinite values; if they are outside the grain, set them to 0, for example with "
            "`mask = np.isfinite(image)`"
        )
    values = [True] if image.dtype.kind == "b" else np.unique(image[image != 0])
    if image.all():
        raise ValueError(f"its {len(values)} values have no 0 among them, so all voxels are solid; {_HOW_TO_MASK}")
    _check_borders(image)
    if len(values) == 1:
        return [("", _parts(image != 0, spacing, image.shape, (0, 0, 0)))]
    return _labelled(image, values, spacing)


def _check_borders(image):
    """Raise ValueError if most of the image's border is solid."""
    faces = [np.take(image, end, axis) != 0 for axis in range(3) for end in (0, -1)]
    share = sum(np.count_nonzero(face) for face in faces) / sum(face.size for face in faces)
    if share > 0.5:
        raise ValueError(
            f"{100 * share:.0f} % of the voxels at its borders are solid; the mask seems inverted (`mask = image == 0` "
            "corrects it), or cropped too tightly (`np.pad(mask, 2)` adds voxels of 0 around it)"
        )


def _labelled(image, values, spacing):
    if np.any(values != np.round(values)) or values[0] < 0 or not _could_be_labels(image):
        raise ValueError(
            f"its {len(values)} values besides 0 are grey values, neither a mask nor labels of grains; {_HOW_TO_MASK}"
        )
    numbers = np.searchsorted(values, image) + 1  # from 1 without gaps, whatever the labels are
    numbers[image == 0] = 0
    groups = []
    for number, box in enumerate(find_objects(numbers), start=1):
        start = [part.start for part in box]
        groups.append((f"{values[number - 1]:.0f}", _parts(numbers[box] == number, spacing, image.shape, start)))
    voxel = float(np.prod(np.broadcast_to(spacing, 3)))
    volumes = [sum(body.volume for body in bodies) for _, bodies in groups]
    groups = [
        (name, [with_share(body, volume / max(volumes), "label of its image") for body in bodies])
        for (name, bodies), volume in zip(groups, volumes, strict=True)
    ]
    in_parts = sum(max(body.volume for body in bodies) for _, bodies in groups) / (voxel * np.count_nonzero(image))
    if in_parts < _LEAST_IN_PARTS:
        raise ValueError(
            f"the voxels of each of its {len(values)} values are scattered like grey values; {_HOW_TO_MASK}"
        )
    return groups


def _could_be_labels(image):
    """Return whether most neighbours that are both solid have the same value."""
    pairs = alike = 0
    for axis in range(3):
        along = np.moveaxis(image, axis, 0)
        solid = (along[:-1] != 0) & (along[1:] != 0)
        pairs += np.count_nonzero(solid)
        alike += np.count_nonzero(solid & (along[:-1] == along[1:]))
    return alike >= _LEAST_ALIKE * pairs


def _parts(mask, spacing, shape, start):
    """Return the bodies of the parts of a mask that do not touch; it begins at `start` of an image of this shape."""
    numbers, count = label(mask, np.ones((3, 3, 3)))
    voxel = float(np.prod(np.broadcast_to(spacing, 3)))
    bodies = []
    for number, box in enumerate(find_objects(numbers), start=1):
        part = numbers == number if count > 1 else mask
        notes = _cut_note(box, start, shape)
        bodies.append(Body(mask_surface(part, spacing), voxel * np.count_nonzero(part), notes))
    return bodies


def _cut_note(box, start, shape):
    """Return a note (in a tuple) if a part touches the image's border, otherwise an empty tuple."""
    sides = []
    for axis, part, offset, size in zip("xyz", box, start, shape, strict=True):
        sides += [f"{axis} = 0"] if offset + part.start == 0 else []
        sides += [f"{axis} = {size - 1}"] if offset + part.stop == size else []
    if not sides:
        return ()
    return (f"touches the border of its voxel image ({', '.join(sides)}); unless it is cropped tightly, it is cut off",)

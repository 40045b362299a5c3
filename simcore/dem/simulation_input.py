"""Checks of what a Simulation is given; the errors name the argument, the body and the remedy."""

import numpy as np
from scipy.spatial.transform import Rotation

from simcore.dem.shapes.polyhedra import Shape

UPRIGHT = (1.0, 0.0, 0.0, 0.0)  # the quaternion of no rotation
# Limits of numbers, and whether they are part of the interval.
LIMITS = {
    "density": (0.0, np.inf, "()"),
    "restitution": (0.0, 1.0, "(]"),
    "friction": (0.0, np.inf, "[)"),
    "poisson_ratio": (-1.0, 0.5, "(]"),
    "contact_time": (1e-12, 1e9, "[]"),
    "steps_per_contact_time": (0.0, 1e9, "(]"),
    "gravity": (-np.inf, np.inf, "()"),
    "width": (0.0, np.inf, "()"),
    "cylinder_radius": (0.0, np.inf, "()"),
    "duration": (0.0, np.inf, "[)"),
}


def check_shapes(shapes):
    """Return the shapes as a list; ValueError if it is empty or if one of them is not a Shape."""
    try:
        shapes = [shapes] if isinstance(shapes, Shape) else list(shapes)
    except TypeError:
        raise ValueError(f"Simulation: shapes is {shapes!r}; give a list of shapes.") from None
    for i, shape in enumerate(shapes):
        if not isinstance(shape, Shape):
            raise ValueError(
                f"Simulation: shapes[{i}] is a {type(shape).__name__}; make shapes with simcore.sphere, "
                "simcore.ellipsoid or simcore.convex."
            )
    if not shapes:
        raise ValueError("Simulation: shapes is empty; give at least one.")
    return shapes


def check_index(shape, n_shapes):
    """Return the indices (n,) of the shapes of bodies; ValueError unless they are whole numbers below n_shapes."""
    try:
        index = np.asarray(shape)
    except ValueError:
        raise ValueError("Simulation: shape has rows of different length; give one index for each body.") from None
    if index.ndim != 1 or len(index) == 0 or not np.issubdtype(index.dtype, np.integer):
        raise ValueError(
            f"Simulation: shape has the form {index.shape} and the type {index.dtype}; give the index of the shape of "
            "each body, (n,) whole numbers."
        )
    wrong = np.flatnonzero((index < 0) | (index >= n_shapes))
    if len(wrong):
        raise ValueError(
            f"Simulation: shape of body {wrong[0]} is {index[wrong[0]]}; give an index from 0 to {n_shapes - 1}."
        )
    return index.astype(np.int64)


def rows_of(name, value, n, width, per_body=False):
    """Return an array (n, width) of finite numbers from one row for each body, or from one for all.

    per_body: one row for all is an error. ValueError names the argument and the first wrong body.
    """
    try:
        rows = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"Simulation: {name} is {value!r}; give numbers, (n, {width}).") from None
    shared = rows.shape == (width,) and not per_body
    if not shared and rows.shape != (n, width):
        also = "" if per_body else f", or ({width},) for all bodies"
        raise ValueError(f"Simulation: {name} has the form {rows.shape}; give ({n}, {width}){also}.")
    rows = np.broadcast_to(rows, (n, width))
    wrong = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(wrong):
        raise ValueError(f"Simulation: {name} of body {wrong[0]} is {rows[wrong[0]]}; give finite numbers.")
    return rows


def rotations_of(quaternions):
    """Return the Rotation of quaternions (n, 4), (w, x, y, z); ValueError if one is zero."""
    largest = np.abs(quaternions).max(axis=1)
    zero = np.flatnonzero(~(largest > 0.0))
    if len(zero):
        raise ValueError(
            f"Simulation: orientation of body {zero[0]} is zero; give a quaternion (w, x, y, z). {UPRIGHT} is no "
            "rotation."
        )
    return Rotation.from_quat(quaternions / largest[:, None], scalar_first=True)


def check_number(name, value):
    """Raise ValueError unless a number is within its LIMITS."""
    least, largest, ends = LIMITS[name]
    numeric = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    inside = numeric and (
        least < value < largest or (ends[0] == "[" and value == least) or (ends[1] == "]" and value == largest)
    )
    if not inside:
        raise ValueError(
            f"Simulation: {name} is {value!r}; give a number in {ends[0]}{least:g}, {largest:g}{ends[1]}, in SI units."
        )

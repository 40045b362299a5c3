"""What a scene has: the constants from which its step is composed, its arrays laid out and its explanation written.

A new force law adds a field to Features, a sentence to PARTS and, where it remembers something, a column to COLUMNS.
"""

from typing import NamedTuple

import numpy as np


class Features(NamedTuple):
    """Every combination is compiled by itself, and carries no array that it does not need."""

    kind: int  # of simcore.dem.shapes.hulls: SPHERE, ELLIPSOID, POLYHEDRON or MIXED
    friction: bool
    attractive: bool = True  # normal force may pull at the end of a contact
    floor: bool = True
    cylinder: bool = False
    periodic: bool = True  # horizontally: pairs may meet through images
    shaken: bool = True
    patch: bool = False  # two polyhedra, or one and a wall, press at the centroid of their overlap
    implicit: bool = False  # the dashpot of a contact sees what the contact does to the velocity within the step
    timed: bool = False  # count the processor's cycles of each part of the step
    potential: bool = False  # ellipsoids meet where the potential of each is least on the other, not by a common normal
    hertz: bool = False  # the contact law's coefficients follow from the overlap (simcore.dem.forces.hertz)
    sliding: int = 0  # friction without springs, not `friction`: NONE, CAPPED or VISCOUS (sliding_friction.py)
    preloaded: bool = False  # with friction: what begins to be held has its tangential spring loaded to the limit
    inflated: bool = False  # polyhedra meet as in Rettinger et al. (2022), simcore.dem.contact.pairs.inflated


class Part(NamedTuple):
    """A part that steps have or leave out, in words."""

    is_there: object  # function of Features
    text: str
    lack: str  # what a step without it leaves out


PARTS = (
    Part(lambda f: f.kind != 0, "orientations and their rotation", "orientations: spheres look alike from all sides"),
    Part(
        lambda f: f.friction, "friction, with the history of each contact's tangential spring", "friction and history"
    ),
    Part(
        lambda f: f.attractive,
        "contacts that may pull as they end, by their dashpot",
        "contacts that pull: forces are clamped at zero",
    ),
    Part(lambda f: f.hertz, "Hertzian contacts with a viscous term", "Hertzian contacts: they are linear"),
    Part(
        lambda f: f.preloaded,
        "tangential springs that start at the limit of friction, as in Rettinger et al. (2022)",
        "springs that start at the limit of friction",
    ),
    Part(lambda f: f.sliding, "friction against the sliding velocity, without history", "sliding friction"),
    Part(lambda f: f.implicit, "implicit dashpots, by how firmly a grain is held", "implicit dashpots"),
    Part(lambda f: f.patch, "patches: polyhedra press at the centroid of their overlap", "patches"),
    Part(
        lambda f: f.inflated,
        "contacts of polyhedra as the program of Rettinger et al. (2022) finds them",
        "the contact search of Rettinger et al. (2022)",
    ),
    Part(
        lambda f: f.potential,
        "potentials: ellipsoids press where each is deepest in the other",
        "potentials of ellipsoids: their contacts have a common normal",
    ),
    Part(lambda f: f.floor, "a floor", "a floor"),
    Part(lambda f: f.cylinder, "a cylinder's wall", "a cylinder's wall"),
    Part(lambda f: f.periodic, "periodic images", "periodic images"),
    Part(lambda f: f.shaken, "shaking", "shaking"),
)


class Column(NamedTuple):
    """A column that contacts and walls have only where a feature needs it, zero at first."""

    is_there: object  # function of Features
    width: tuple  # shape of a row
    dtype: type


# By the names of the fields of Contacts and Walls, which say what they mean.
COLUMNS = {
    "spring": Column(lambda f: f.friction, (3,), np.float64),
    "twist": Column(lambda f: f.friction and f.patch, (), np.float64),
    "stuck": Column(lambda f: f.friction and f.preloaded, (), np.uint8),
    "spread": Column(lambda f: f.patch, (6,), np.float64),
}


def columns(features: Features, n_rows: int) -> dict:
    """The columns of COLUMNS with so many rows, without rows where the features need none."""
    return {
        name: np.zeros((n_rows if column.is_there(features) else 0, *column.width), column.dtype)
        for name, column in COLUMNS.items()
    }

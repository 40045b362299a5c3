"""The features of a scene: constants that select the parts of its step, its arrays and the texts that describe it.

A new force law adds a field to Features, a text to PARTS and, if it has state of its own, a column to COLUMNS.
"""

from typing import NamedTuple

import numpy as np


class Features(NamedTuple):
    """The features of a scene. Each combination is compiled separately and has only the arrays that it needs."""

    kind: int  # of simcore.dem.shapes.polyhedra: SPHERE, ELLIPSOID, POLYHEDRON or MIXED
    friction: bool
    attractive: bool = True  # the normal force may pull at the end of a contact
    floor: bool = True
    cylinder: bool = False
    periodic: bool = True  # horizontally: pairs may meet through images
    shaken: bool = True
    patch: bool = False  # polyhedra press at the centroid of their overlap, on a wall at that of the part behind it
    implicit: bool = False  # implicit dashpots: they include the change of velocity within the step
    timed: bool = False  # count the processor cycles of each stage of the step
    potential: bool = False  # contacts of ellipsoids by their potentials instead of a common normal
    hertz: bool = False  # the contact law's coefficients follow from the overlap (simcore.dem.forces.hertz)
    sliding: int = 0  # friction without springs, instead of `friction`: NONE, CAPPED or VISCOUS (viscous_friction.py)
    preloaded: bool = False  # with friction: a contact that begins to stick has its spring loaded to the limit
    inflated: bool = False  # contacts of polyhedra as in Rettinger et al. (2022), simcore.dem.contact.pairs.inflated


class Part(NamedTuple):
    """A part of the step that depends on the features, described in words."""

    is_there: object  # function of Features
    text: str  # description of the part
    lack: str  # description of what a step without the part leaves out


PARTS = (
    Part(lambda f: f.kind != 0, "orientations and their rotation", "orientations: they have no effect on spheres"),
    Part(
        lambda f: f.friction, "friction, with the history of each contact's tangential spring", "friction and history"
    ),
    Part(
        lambda f: f.attractive,
        "contacts that may pull as they end, by their dashpot",
        "contacts that pull: normal forces are not negative",
    ),
    Part(lambda f: f.hertz, "Hertzian contacts with a viscous term", "Hertzian contacts: the contact law is linear"),
    Part(
        lambda f: f.preloaded,
        "tangential springs that start at the limit of friction, as in Rettinger et al. (2022)",
        "springs that start at the limit of friction",
    ),
    Part(lambda f: f.sliding, "friction against the sliding velocity, without history", "viscous friction"),
    Part(lambda f: f.implicit, "implicit dashpots, weighted by the effective contacts of a grain", "implicit dashpots"),
    Part(lambda f: f.patch, "patch contacts: polyhedra press at the centroid of their overlap", "patch contacts"),
    Part(
        lambda f: f.inflated,
        "contacts of polyhedra as the program of Rettinger et al. (2022) finds them",
        "the contact search of Rettinger et al. (2022)",
    ),
    Part(
        lambda f: f.potential,
        "potentials: ellipsoids press where each reaches deepest into the other",
        "potentials of ellipsoids: their contacts have a common normal",
    ),
    Part(lambda f: f.floor, "a floor", "a floor"),
    Part(lambda f: f.cylinder, "a cylinder's wall", "a cylinder's wall"),
    Part(lambda f: f.periodic, "periodic images", "periodic images"),
    Part(lambda f: f.shaken, "shaking", "shaking"),
)


class Column(NamedTuple):
    """A column of contacts and walls that only some features require; its initial value is zero."""

    is_there: object  # function of Features
    width: tuple  # shape of a row
    dtype: type


# The keys are fields of Contacts and Walls, where they are described.
COLUMNS = {
    "spring": Column(lambda f: f.friction, (3,), np.float64),
    "twist": Column(lambda f: f.friction and f.patch, (), np.float64),
    "stuck": Column(lambda f: f.friction and f.preloaded, (), np.uint8),
    "spread": Column(lambda f: f.patch, (6,), np.float64),
}


def columns(features: Features, n_rows: int) -> dict:
    """Return the columns of COLUMNS with n_rows rows, or with none if the features do not require the column."""
    return {
        name: np.zeros((n_rows if column.is_there(features) else 0, *column.width), column.dtype)
        for name, column in COLUMNS.items()
    }

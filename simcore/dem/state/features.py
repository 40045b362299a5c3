"""What a scene has: the constants from which its step is composed and its arrays are laid out."""

from typing import NamedTuple


class Features(NamedTuple):
    """Every combination is compiled by itself, and carries no array that it does not need."""

    kind: int  # of simcore.dem.shapes.hulls: SPHERE, ELLIPSOID, CONVEX or MIXED
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
    sliding: int = 0  # of simcore.dem.forces.sliding: NONE, CAPPED or VISCOUS: friction without springs, not `friction`
    preloaded: bool = False  # with friction: what begins to be held has its tangential spring loaded to the limit
    inflated: bool = False  # polyhedra meet as the source study's program finds it (simcore.dem.contact.pairs.inflated)

"""A pair of bodies, the argument of all searches: rows, offset between the centres, and size."""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.vectors import Vec, negative


class Pair(NamedTuple):
    """Bodies a and b. All results follow from the offset and therefore do not depend on the position of the pair."""

    a: int  # row of the first body
    b: int  # row of the second body
    offset: Vec  # [m], from the centre of a to that of b, or of an image of b; world axes
    size: float  # [m], sum of the radii of the bounding spheres; the unit of all tolerances


class Closest(NamedTuple):
    """Closest points of a pair, or deepest points if the bodies overlap; point_b + r − point_a = distance n."""

    distance: float  # [m], signed: positive: the gap, negative: minus the overlap
    normal: Vec  # from a to b
    point_a: Vec  # [m], from the centre of a
    point_b: Vec  # [m], from the centre of b


@leaf
def pair_of(bodies, i, j, offset):
    """Return the pair of bodies i and j."""
    return Pair(i, j, offset, bodies.radius[i] + bodies.radius[j])


@leaf
def exchanged(pair):
    """Return the pair with the bodies exchanged; offset and normals change their sign."""
    return Pair(pair.b, pair.a, negative(pair.offset), pair.size)

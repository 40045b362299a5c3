"""Two bodies as the searches take them: their rows, the offset between their centres and their size."""

from typing import NamedTuple

from simcore.compilation import leaf
from simcore.dem.vectors import Vec, negative


class Pair(NamedTuple):
    """Bodies a and b. The offset is formed first, so that no result depends on where in the world the pair is."""

    a: int  # row of the one body
    b: int  # row of the other
    offset: Vec  # [m], from the centre of a to that of b, or of an image of b; world axes
    size: float  # [m], sum of the radii of the bounding spheres, to which all tolerances refer


class Closest(NamedTuple):
    """Closest points of a pair, or its deepest points where the bodies overlap; point_b + r − point_a = distance n."""

    distance: float  # [m], signed: positive a gap, negative an overlap
    normal: Vec  # from a to b
    point_a: Vec  # [m], from the centre of a
    point_b: Vec  # [m], from the centre of b


@leaf
def pair_of(bodies, i, j, offset):
    """The pair of bodies i and j."""
    return Pair(i, j, offset, bodies.radius[i] + bodies.radius[j])


@leaf
def exchanged(pair):
    """The same pair with b as the one body: offset and normals change their sign."""
    return Pair(pair.b, pair.a, negative(pair.offset), pair.size)

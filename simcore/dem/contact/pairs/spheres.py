"""Sphere against sphere, in closed form."""

from simcore.compilation import leaf
from simcore.dem.vectors import Contact, Vec, length, over, scaled


@leaf
def touch(bodies, pair):
    """Return the contact of two spheres; they are apart if its overlap is not positive.

    The normal of concentric spheres is not unique; x is returned.
    """
    radius_a, radius_b = bodies.radius[pair.a], bodies.radius[pair.b]
    distance = length(pair.offset)
    overlap = radius_a + radius_b - distance
    normal = Vec(1.0, 0.0, 0.0)
    if distance > 0.0:
        normal = over(pair.offset, distance)
    return Contact(overlap, normal, scaled(radius_a - 0.5 * overlap, normal))

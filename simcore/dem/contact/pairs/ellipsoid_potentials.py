"""Contacts of two ellipsoids by the least potential of each on the surface of the other.

This is the construction of Baram and Lind (arXiv:1110.2792), after Perram et al. (1996). The potential of an ellipsoid
is its quadratic form, 0 at its centre and 1 on its surface. The point of the other surface where the potential is least
is the deepest one. Two such points, one on each surface, span the contact vector: its length is the overlap and its
middle the contact point. With M = R diag(s²) Rᵀ and r from a to b, the point of b is r − M_b g and that of a is M_a g,
where for each

    (M_near + λ M_far) g = r,   φ(λ) = gᵀ M_near g = 1.

Here g is half the gradient of the potential of the surface's own ellipsoid at that point (reversed for b), and λ >= 0
as long as neither centre is inside the other body. φ decreases and 1/√φ is concave in λ (as in trust regions, Moré and
Sorensen 1983). Newton's iteration therefore climbs to the only root from any start below it, and a start above it goes
below in one step. λ follows from the normal as h_near (n·r − h_near) / h_far²; the remembered normal gives it to second
order, and nothing else is remembered.

Direction. The contact vector is not a normal. As the depth δ goes to zero it tends to δ (n + t), n the common normal
and t a tangential vector of the order of the tangents of the angles between n and the lines to the centres; t is zero
for spheres. A force along the contact vector would add or remove energy in every oblique impact. The gradients at both
points tend to ±n.
# ASSUME: the paper replaces the direction by the averaged gradients if it deviates from them by more than an angle that
# is missing from its text. Here it is always replaced, because the deviation does not vanish with the depth: it is 20
# degrees on average in pairs of 1.6 : 1 : 0.6.
The length is not changed: it is |n + t| times the depth along the normal, which makes the spring stiffer by this
factor. Since the factor changes as the contact slides, elastic impacts lose some energy, in proportion to their depth.
benchmarks/studies/ellipsoid_contact.py measures these effects.

Separation. For λ > 0, det(λA + B) of the 4 × 4 forms has the sign of λ rᵀ (M_a + λ M_b)⁻¹ r − 1 − λ. If that is
positive for some λ, it has two distinct positive roots, and the pair is apart (Wang et al. 2001). Divided by 1 + λ it
is the function of Perram and Wertheim of λ / (1 + λ) minus one, which is concave, so that its maximum decides. If the
maximum is positive, q = (M_a + λ M_b)⁻¹ r is normal to a separating plane, and the gap along q is certain. That plane
is remembered and tried first, and the pair is not checked until the bodies can have closed the gap (`remembered_gaps`).

The walls press at the deepest point of a body with either construction, because a plane has no centre.
"""

from typing import NamedTuple

import numpy as np

from simcore.compilation import leaf, routine
from simcore.dem.contact.pair import exchanged
from simcore.dem.contact.pairs.ellipsoids import search_contact as search_common_normal
from simcore.dem.contact.pairs.remembered_gaps import STILL_GAP, remember_apart
from simcore.dem.contact.search.deep_overlap import start_normal
from simcore.dem.contact.search.ellipsoid_climb import gap_along, image, support_height
from simcore.dem.vectors import (
    ZERO,
    Contact,
    Vec,
    direction_of,
    dot,
    length,
    minus,
    minus_scaled,
    over,
    plus,
    read,
)

CLOSE = 1e-8  # |√φ − 1| below which one more step, with g linear in λ, is accurate to rounding
FEW, MANY = 8, 60  # maximum number of iterations from the last normal, which needs one to three, and in a search
FLAT = 1e-8  # |Δ log λ| at the maximum that decides on separation; its value is accurate to the square of this
ENOUGH = 0.1  # |Δ log λ| that is sufficient where the value is positive, that is where it shows a gap


class Factors(NamedTuple):
    """Factors L D Lᵀ of a symmetric matrix."""

    d: Vec
    lyx: float
    lzx: float
    lzy: float


class Deepest(NamedTuple):
    """The point of the surface of one ellipsoid that is deepest in the other."""

    reached: bool  # False: the iteration did not converge, for example because a centre is inside the other body
    factor: float  # λ
    gradient: Vec  # g, with gᵀ M g = 1 but for rounding


class Meeting(NamedTuple):
    """The points at which two ellipsoids are deepest in each other."""

    reached: bool
    overlapping: bool
    vector: Vec  # [m], of contact; for a pair apart it points from b to a, and its length is no bound of the gap
    normal: Vec
    middle: Vec  # [m], from the centre of a


class Characteristic(NamedTuple):
    """det(λA + B) divided by a positive number, at one λ."""

    value: float
    q: Vec  # (M_a + λ M_b)⁻¹ r
    step: float  # Newton step of log λ towards the maximum of value / (1 + λ)


@leaf
def _factorise(m, i, j, factor):
    """Return the factors of M_i + factor M_j."""
    xx, yy, zz = m[i, 0] + factor * m[j, 0], m[i, 1] + factor * m[j, 1], m[i, 2] + factor * m[j, 2]
    xy, xz, yz = m[i, 3] + factor * m[j, 3], m[i, 4] + factor * m[j, 4], m[i, 5] + factor * m[j, 5]
    lyx, lzx = xy / xx, xz / xx
    dy = yy - lyx * xy
    lzy = (yz - lyx * xz) / dy
    return Factors(Vec(xx, dy, zz - lzx * xz - lzy * lzy * dy), lyx, lzx, lzy)


@leaf
def _solve(factors, v):
    """Return the inverse of the matrix times v."""
    y = v.y - factors.lyx * v.x
    z = v.z - factors.lzx * v.x - factors.lzy * y
    z = z / factors.d.z
    y = y / factors.d.y - factors.lzy * z
    return Vec(v.x / factors.d.x - factors.lyx * y - factors.lzx * z, y, z)


@leaf
def deepest_gradient(m, pair, offset, start, iterations):
    """Find the point of the surface of pair.a that is deepest in pair.b: Deepest. start: initial λ.

    offset: r of the original pair, also if the bodies of `pair` are exchanged; both points follow from the same r.
    """
    factor, gradient = max(start, 0.0), ZERO
    for _ in range(iterations):
        factors = _factorise(m, pair.a, pair.b, factor)
        gradient = _solve(factors, offset)
        here = image(m, pair.a, gradient)
        change = _solve(factors, image(m, pair.b, gradient))  # −dg/dλ
        square = dot(gradient, here)
        root = np.sqrt(square)
        step = square * (root - 1.0) / dot(here, change)
        if abs(root - 1.0) <= CLOSE:
            return Deepest(factor + step >= 0.0, factor + step, minus_scaled(gradient, step, change))
        if not (step > 0.0 or factor > 0.0):
            break
        factor = max(factor + step, 0.0)
    return Deepest(False, factor, gradient)


@routine
def meeting_of(m, pair, normal, iterations):
    """Find the points at which two ellipsoids are deepest in each other, from a normal close to theirs: Meeting."""
    across, other = dot(normal, pair.offset), exchanged(pair)
    height_a, height_b = support_height(m, pair.a, normal), support_height(m, pair.b, normal)
    start_a = height_a * (across - height_a) / (height_b * height_b)
    start_b = height_b * (across - height_b) / (height_a * height_a)
    a = deepest_gradient(m, pair, pair.offset, start_a, iterations)
    b = deepest_gradient(m, other, pair.offset, start_b, iterations)
    point_a, point_b = image(m, pair.a, a.gradient), image(m, pair.b, b.gradient)
    point_a = over(point_a, np.sqrt(dot(a.gradient, point_a)))
    point_b = over(point_b, np.sqrt(dot(b.gradient, point_b)))
    # The potential of each ellipsoid at the point of the other, 1 where they only touch
    of_b = a.factor * support_height(m, pair.b, a.gradient)
    of_a = b.factor * support_height(m, pair.a, b.gradient)
    # These sums are symmetric: they are the same to the bit if the bodies are exchanged.
    vector = minus(plus(point_a, point_b), pair.offset)
    normal = direction_of(plus(over(a.gradient, length(a.gradient)), over(b.gradient, length(b.gradient))))
    return Meeting(a.reached and b.reached, of_a + of_b < 2.0, vector, normal, minus_scaled(point_a, 0.5, vector))


@leaf
def characteristic(m, pair, factor):
    """Return det(λA + B) at λ = factor > 0, divided by a positive number: Characteristic.

    value / (1 + λ) is largest where √(qᵀ M_a q) = λ √(qᵀ M_b q).
    """
    factors = _factorise(m, pair.a, pair.b, factor)
    q = _solve(factors, pair.offset)
    image_b = image(m, pair.b, q)
    a, b = dot(q, image(m, pair.a, q)), dot(q, image_b)
    c = dot(image_b, _solve(factors, image_b))
    left = 0.5 * np.log(a / b) - np.log(factor)
    slope = 1.0 + factor * (b / a - factor * c / a - c / b)
    if not slope > 0.1:
        slope = 1.0
    return Characteristic(factor * dot(q, pair.offset) - 1.0 - factor, q, left / slope)


@leaf
def separation(m, pair, normal):
    """Decide by the roots of det(λA + B) whether the pair is apart: (apart, normal of a separating plane)."""
    guess = np.log(support_height(m, pair.a, normal) / support_height(m, pair.b, normal))
    low, high = -np.inf, np.inf
    apart, q = False, normal
    for _ in range(MANY):
        at = characteristic(m, pair, np.exp(guess))
        apart, q = at.value > 0.0, at.q
        if abs(at.step) <= (ENOUGH if apart else FLAT):
            break
        if at.step > 0.0:
            low = guess
        else:
            high = guess
        trial = guess + min(max(at.step, -2.0), 2.0)
        if not (trial > low and trial < high):
            trial = 0.5 * (low + high)
        if trial == guess:
            break
        guess = trial
    return apart, direction_of(q)


@leaf
def recheck(shapes, bodies, contacts, p, pair):
    """Check candidate pair p from its remembered normal: (whether the result is certain, Contact).

    The pair is apart if the overlap is not positive. The result is not certain if there is no remembered normal, the
    remembered plane no longer separates, the iteration did not converge, or a centre is inside the other body.
    """
    normal, m = read(contacts.direction, p), bodies.form_matrix
    if normal.x == 0.0 and normal.y == 0.0 and normal.z == 0.0:
        return False, Contact(0.0, ZERO, ZERO)
    if contacts.touching[p] == 0:
        gap = gap_along(m, pair, normal)
        if not gap > -STILL_GAP * contacts.overlap[p]:
            return False, Contact(0.0, ZERO, ZERO)
        remember_apart(bodies, contacts, p, pair, gap)
        return True, Contact(min(-gap, contacts.overlap[p]), normal, ZERO)
    meeting = meeting_of(m, pair, normal, FEW)
    if not meeting.reached:
        return False, Contact(0.0, ZERO, ZERO)
    return True, _conclude(bodies, contacts, p, pair, meeting)


@routine
def search_contact(shapes, bodies, contacts, p, pair):
    """Search the contact of candidate pair p, without a remembered contact.

    If a centre is inside the other body, the point of least potential on the surface is on the far side. Such a pair is
    thousands of times deeper than any in a packing, and its contact is that of the common normal.
    """
    m = bodies.form_matrix
    normal = start_normal(m, pair)
    apart, plane = separation(m, pair, normal)
    if apart:
        gap = max(gap_along(m, pair, plane), 0.0)
        remember_apart(bodies, contacts, p, pair, gap)
        return Contact(-gap, plane, ZERO)
    meeting = meeting_of(m, pair, normal, MANY)
    if not meeting.reached:
        return search_common_normal(shapes, bodies, contacts, p, pair)
    return _conclude(bodies, contacts, p, pair, meeting)


@leaf
def _conclude(bodies, contacts, p, pair, meeting):
    """Return the contact whose overlap is the length of the contact vector; a gap is negative and remembered."""
    if meeting.overlapping:
        return Contact(length(meeting.vector), meeting.normal, meeting.middle)
    gap = max(gap_along(bodies.form_matrix, pair, meeting.normal), 0.0)
    remember_apart(bodies, contacts, p, pair, gap)
    return Contact(-gap, meeting.normal, meeting.middle)

"""Torque of a patch contact about its centroid, which resists rocking and twisting."""

import numpy as np

from simcore.compilation import leaf
from simcore.dem.vectors import Vec, cross, dot, plus, scaled


@leaf
def moments_times(spread, k, v):
    """Return the product of the matrix of second moments in row k, xx yy zz xy xz yz, with a vector."""
    xx, yy, zz = spread[k, 0], spread[k, 1], spread[k, 2]
    xy, xz, yz = spread[k, 3], spread[k, 4], spread[k, 5]
    return Vec(
        xx * v.x + xy * v.y + xz * v.z,
        xy * v.x + yy * v.y + yz * v.z,
        xz * v.x + yz * v.y + zz * v.z,
    )


@leaf
def patch_torque(damping, tangent, dt, normal, spin, touches, k, friction):
    """Return the torque on b [N m] of patch k about its centroid, zero for a point contact; update its twist.

    The springs and dashpots of the contact law are distributed over the patch in proportion to depth, so that they also
    resist rotation about the centroid. With the second moments C of the patch, rocking at g = n × ω causes the torque
    −d_n (C g) × n. Twisting causes the torque of a torsional spring k_t tr C with its dashpot, up to the limit of
    friction µ |F_n| √(tr C).
    # ASSUME: slip and twist do not weaken each other, and the gyration radius is used as the mean lever arm: for a
    # disc 0.707 R instead of 0.667 R, for a square 7 % and for a line 16 % too much. On a cylinder the corners bear, so
    # that it is up to twice too much.
    damping [N s/m]: d_n. spin [1/s]: angular velocity of b relative to a. touches: contacts or walls.
    """
    rocking = moments_times(touches.spread, k, cross(normal, spin))
    torque = scaled(-damping, cross(rocking, normal))
    if friction:
        return plus(torque, scaled(twisting_torque(tangent, dt, dot(normal, spin), touches, k), normal))
    return torque


@leaf
def twisting_torque(tangent, dt, rate, touches, k):
    """Return the torque [N m] about the normal on a patch that twists at `rate` [1/s]; update the twist of row k."""
    spread = touches.spread
    # For a single vertex behind a wall the trace is zero except for rounding of either sign.
    moment = max(spread[k, 0] + spread[k, 1] + spread[k, 2], 0.0)
    stiffness, damping = tangent.stiffness * moment, tangent.damping * moment
    twist = touches.twist[k] + rate * dt
    torque = -stiffness * twist - damping * rate
    limit = tangent.limit * np.sqrt(moment)
    if not abs(torque) < limit:  # also for a point contact, whose limit is zero
        torque = limit if torque > 0.0 else -limit
        twist = -(torque + damping * rate) / stiffness if stiffness > 0.0 else 0.0
    touches.twist[k] = twist
    return torque

"""Pairs apart: a gap once seen is certain until the bodies can have closed it."""

from simcore.compilation import leaf

STILL_GAP = 0.5  # of the gap searched last: a direction that still shows this share spares the search for the best


@leaf
def remember_apart(bodies, contacts, p, i, j, rx, ry, rz, gap):
    """Note that near pair p, with relative position r, is apart by at least `gap` [m]."""
    contacts.apart_at[p, 0], contacts.apart_at[p, 1], contacts.apart_at[p, 2] = rx, ry, rz
    contacts.safe_until[p] = bodies.turned[i] + bodies.turned[j] + 0.999 * gap


@leaf
def still_apart(bodies, contacts, p, i, j, rx, ry, rz):
    """Whether neither turning nor moving relative to each other can have closed the gap seen last."""
    dx, dy, dz = rx - contacts.apart_at[p, 0], ry - contacts.apart_at[p, 1], rz - contacts.apart_at[p, 2]
    left = contacts.safe_until[p] - bodies.turned[i] - bodies.turned[j]
    return left > 0.0 and dx * dx + dy * dy + dz * dz < left * left

"""Pairs apart: a gap is certain until the bodies can have closed it."""

from simcore.compilation import leaf
from simcore.dem.vectors import minus, read, squared, write

STILL_GAP = 0.5  # of the gap searched last: a direction that still shows this share spares the search for the best


@leaf
def remember_apart(bodies, contacts, p, pair, gap):
    """Store that candidate pair p is apart by at least `gap` [m]."""
    write(contacts.apart_at, p, pair.offset)
    contacts.safe_until[p] = bodies.turned[pair.a] + bodies.turned[pair.b] + 0.999 * gap


@leaf
def still_apart(bodies, contacts, p, pair):
    """Whether neither turning nor moving relative to each other can have closed the gap that was stored last."""
    left = contacts.safe_until[p] - bodies.turned[pair.a] - bodies.turned[pair.b]
    return left > 0.0 and squared(minus(pair.offset, read(contacts.apart_at, p))) < left * left

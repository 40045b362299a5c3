"""Remembered gaps of pairs that are apart: a gap is certain until the bodies can have closed it."""

from simcore.compilation import leaf
from simcore.dem.vectors import minus, read, squared, write

# Share of the gap of the last search: no new search is needed while a direction shows at least this share.
STILL_GAP = 0.5


@leaf
def remember_apart(bodies, contacts, p, pair, gap):
    """Store that candidate pair p is apart by at least `gap` [m]."""
    write(contacts.apart_at, p, pair.offset)
    contacts.safe_until[p] = bodies.turned[pair.a] + bodies.turned[pair.b] + 0.999 * gap


@leaf
def still_apart(bodies, contacts, p, pair):
    """Return whether rotation and relative motion cannot yet have closed the gap that was stored last."""
    left = contacts.safe_until[p] - bodies.turned[pair.a] - bodies.turned[pair.b]
    return left > 0.0 and squared(minus(pair.offset, read(contacts.apart_at, p))) < left * left

"""Interface through which a packing stores its checkpoints; checkpoints/keeper.py writes them to a folder."""

KEEP, KEEP_AND_STOP = 1, 2


class Keeper:
    """A keeper that stores nothing and never interrupts the packing."""

    # wish(step) -> 0 (go on), KEEP or KEEP_AND_STOP; called between steps. The largest value of all ranks counts.
    wish = None

    def latest(self):
        """Return (state, sections) to resume from, or None. sections(): iterates over the parts of all bodies."""
        return None

    def keep(self, state: dict, parts) -> bool:
        """Store the state, a dict that JSON can store, and the parts, which arrive one after the other on rank 0.

        Return whether the packing can be resumed from this state; only the value on rank 0 counts.
        """
        return False

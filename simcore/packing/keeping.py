"""What a packing asks of the one that keeps its checkpoints; checkpoints/keeper.py writes them to a folder."""

KEEP, KEEP_AND_STOP = 1, 2


class Keeper:
    """Keeps nothing and never interrupts."""

    # wish(step) -> 0 to go on, KEEP, or KEEP_AND_STOP; called between steps. The largest of all ranks counts.
    wish = None

    def latest(self):
        """(state, sections) to go on from, or None. sections(): iterates over the parts of all bodies."""
        return None

    def keep(self, state: dict, parts) -> None:
        """Keep the state, a dict that JSON can store, and the parts, which come one after the other on rank 0."""

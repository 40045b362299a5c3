"""That results are right: the same bits on any ranks, exact contacts, faults that are met."""

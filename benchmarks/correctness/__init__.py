"""Checks of results: the same bits on any ranks, exact contacts, behaviour after faults."""

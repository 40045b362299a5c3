"""Provenance of a result: its code, its machine and its CPU time."""

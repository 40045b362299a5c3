"""Packings whose outcome is published, or follows from a closed form: cases with bands, runs, measures, table."""

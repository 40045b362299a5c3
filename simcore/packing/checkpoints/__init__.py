"""Checkpoint files, from which an interrupted packing resumes."""

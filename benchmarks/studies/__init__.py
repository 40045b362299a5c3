"""Measurements behind constants and statements of the documentation."""

"""Shapes as the kernels have them: tables of hulls, their support points and their moments."""

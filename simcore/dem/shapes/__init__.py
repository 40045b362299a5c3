"""Shapes for the kernels: tables of polyhedra, their support points and their moments."""

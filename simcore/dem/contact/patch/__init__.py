"""Patch contacts: the region in which two polyhedra overlap.

patch finds it: by corner where a corner meets a face, by crossing where two edges meet, by clipping otherwise. moments
has the integrals that they share, axes the directions in which they measure, workspace the arrays they work in.
"""

"""Patch contacts: centroid and second moments of the region in which two polyhedra overlap.

`patch` selects the method: `corner` if a corner meets a face, `crossing` if two edges meet, `clipping` otherwise.
`moments` contains the integrals that they share, `axes` the directions of the coordinates, and `workspace` the arrays.
"""

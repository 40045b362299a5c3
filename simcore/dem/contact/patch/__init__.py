"""The region in which two polyhedra overlap."""

"""Packings on one or several MPI ranks: which rank moves which bodies, and what the ranks exchange."""

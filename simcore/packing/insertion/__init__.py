"""Insertion of grains into the domain, in batches on a lattice or at random places."""

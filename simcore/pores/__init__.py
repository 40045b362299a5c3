"""Pore space of a packing: specific surface, tortuosity, permeability, and the distribution of pore sizes."""

"""Searches for the contact of two grains from nothing: distance and overlap of convex shapes."""

"""Contacts of two grains from the remembered contact of the previous step, one module for each pair of shapes."""

"""Evaluation of a finished packing: porosity, trends over height, contacts and directions."""

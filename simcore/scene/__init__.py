"""Specification of a packing in SI units, its sizes, its domain, and the scene made from them."""

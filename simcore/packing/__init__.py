"""One packing, from its specification to its netCDF file."""

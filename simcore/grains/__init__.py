"""What a grain is, before anything moves.

form                 mass-equivalent ellipsoid, sieve size, 13 form factors, 26 features
polyhedron           hull, exact moments and flat facets of closed triangle meshes
mesh                 Grain: hull in its principal frame; decimation
readers              grains from meshes, point clouds, voxel masks, spherical-harmonic coefficients
voxels, spherical_harmonics, directions   what the readers rest on
scan_shapes          how round and flat-sided grains are; what was measured on scans
synthetic            Rhine-like pebbles from a seed
grain_set            many grains in one netCDF file
sieve                sieve curves and the table of cases
sampling             size, form and shape of every grain of a packing
report               tables about a set of grains
"""

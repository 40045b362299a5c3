"""Grains before they are packed: form, shape, size, and the files they are read from.

form                   mass-equivalent ellipsoid, sieve size, 13 form factors, 26 features
statistics             104 features of a packing: statistics of the 26 over its grains
polyhedron             convex hull, exact moments and flat facets of closed triangle meshes
mesh                   Grain: convex polyhedron in its principal frame; decimation
readers                grains from meshes, point clouds, voxel images, spherical-harmonic coefficients
mesh_files, point_tables, voxels, spherical_harmonics   one kind of file each, used by the readers
bodies                 separate bodies in one file, and which of them become grains
sources                the grains that a specification asks for, with notes for the user
grain_set              many grains in one netCDF file
synthetic              Rhine-like pebbles from a seed
scan_shapes            sphericity and flat facets of grains, and their ranges over scanned gravel
spiral, spread         evenly spread directions; order that spreads grains over the Zingg diagram
sieve, beta_sizes, own_sizes   size distributions: sieve curve, beta distribution, the grains' own sizes
sampling               size, form and shape of every grain of a packing
measured_forms, table_file, form_columns, row_errors, summary_rows   samples from tables of measured axes or forms
tables                 tables about a set of grains
"""

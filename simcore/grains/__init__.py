"""Grains before they are packed: form, shape, size, and the files they are read from.

form                   mass-equivalent ellipsoid, sieve size, 13 form factors, 26 features
statistics             104 features of a packing: statistics of the 26 over its grains
polyhedron             convex hull, exact moments and flat facets of closed triangle meshes
mesh                   Grain: convex polyhedron in its principal frame; decimation
readers                grains from meshes, point clouds, voxel images, spherical-harmonic coefficients
mesh_files, point_tables, voxels, spherical_harmonics   one kind of file each, used by the readers
bodies                 separate bodies in one file, and which of them become grains
sources                the grains of a specification, with notes for the user
grain_set              many grains in one netCDF file
synthetic              Rhine-like pebbles from a seed
scan_shapes            sphericity and flat facets of grains, and their ranges over scanned gravel
spiral, spread         evenly spread directions; order that spreads grains over the Zingg diagram
sieve, beta_sizes, own_sizes   size distributions: sieve curve, beta distribution, the grains' own sizes
sampling, quota        size, form and shape of every grain of a packing, at random or by quota
measured_forms, measured_beds, forms_by_class   samples, beds and forms by sieve class from measured tables
table_file, table_head, text_columns, text_lists, cell_numbers   tables and lists as text, and numbers in their cells
form_columns, grain_counts, form_notices, class_labels, row_errors, summary_rows   parts of the reading of these tables
sieve_table, sieve_columns, sieve_classes, sieve_openings, sieve_sums   sieve curves from tables
sieve_statistics, sieve_text   statistics of a sieve curve, and their text
tables                 tables about a set of grains
"""

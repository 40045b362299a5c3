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

from .form import FORM_FACTORS, features, form_factors
from .grain_set import read_grains, write_grains
from .mesh import Grain, decimate, make_grain
from .readers import read_grain, read_grain_files
from .sampling import GrainSample, ShapeChoice, grain_uniforms, sample_grains, sample_sizes
from .sieve import Case, SieveCurve, read_cases
from .synthetic import synthetic_grains

__all__ = [
    "FORM_FACTORS",
    "Case",
    "Grain",
    "GrainSample",
    "ShapeChoice",
    "SieveCurve",
    "decimate",
    "features",
    "form_factors",
    "grain_uniforms",
    "make_grain",
    "read_cases",
    "read_grain",
    "read_grain_files",
    "read_grains",
    "sample_grains",
    "sample_sizes",
    "synthetic_grains",
    "write_grains",
]

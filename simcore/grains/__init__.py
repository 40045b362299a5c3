"""What a grain is, before anything moves: reading, form, synthetic grains, sieve curves, sampling.

form        mass-equivalent ellipsoid, sieve size, 13 form factors, 26 features
polyhedron  hull, exact moments and flat facets of closed triangle meshes
mesh        Grain: hull in its principal frame; decimation
grain_set   many grains in one netCDF file
sieve       sieve curves and the table of cases
sampling    size, form and shape of every grain of a packing
"""

from .form import FORM_FACTORS, features, form_factors
from .grain_set import read_grains, write_grains
from .mesh import Grain, decimate, make_grain
from .sampling import GrainSample, ShapeChoice, grain_uniforms, sample_grains, sample_sizes
from .sieve import Case, SieveCurve, read_cases

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
    "read_grains",
    "sample_grains",
    "sample_sizes",
    "write_grains",
]

"""A packing as it lies, and its porosity over height."""

import xarray as xr

from simcore.figures.packings import packing_figure, profile_figure
from simcore.figures.saving import save_figure
from simcore.packing_io import read_packing

(packing,), (evaluation,) = snakemake.input.packing, snakemake.input.evaluation
bulk = xr.load_dataset(evaluation)
profiles = {"volume-equivalent spheres": bulk.profile, "the grains themselves": bulk.profile_exact}
save_figure(packing_figure(read_packing(packing)), snakemake.output.picture, snakemake.params.test_only)
save_figure(profile_figure(profiles, bulk), snakemake.output.profile, snakemake.params.test_only)

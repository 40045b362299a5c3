"""Write the evaluation of one packing: porosity and its error, coordination, trends over height, form."""

from simcore.evaluation.evaluate import evaluate
from simcore.packing.file import read_packing

evaluation = evaluate(read_packing(snakemake.input.packing), **snakemake.params.settings)
evaluation.to_netcdf(snakemake.output.evaluation)

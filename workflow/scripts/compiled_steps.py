"""Compile the steps of all packings of a campaign and store them in the cache on disk."""

import os

# Numba reads its number of threads when it is imported.
os.environ["NUMBA_NUM_THREADS"] = str(snakemake.params.threads)

from simcore.campaign.job_log import log_to
from simcore.compilation import set_threads
from simcore.packing.compiling import compile_steps

log = log_to(snakemake.log[0])
set_threads(snakemake.params.threads)
count = compile_steps(snakemake.params.specifications, log.info)
with open(snakemake.output.steps, "w", encoding="utf-8") as file:
    print(f"Compiled steps: {count}", file=file)

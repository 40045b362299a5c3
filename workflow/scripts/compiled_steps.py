"""Compile the steps of all packings of a campaign and store them in the cache on disk."""

import os

# Numba reads its number of threads when it is imported.
os.environ["NUMBA_NUM_THREADS"] = str(snakemake.params.threads)

from simcore.compilation import set_threads  # noqa: E402
from simcore.packing.compiling import compile_steps  # noqa: E402

set_threads(snakemake.params.threads)
with open(snakemake.log[0], "w", encoding="utf-8") as log:
    count = compile_steps(snakemake.params.specifications, lambda text: print(text, file=log, flush=True))
with open(snakemake.output.steps, "w", encoding="utf-8") as file:
    print(f"Compiled steps: {count}", file=file)

"""The grains in the order that spreads their forms over the Zingg diagram."""

import pandas as pd

from simcore.grains.grain_set import read_grains
from simcore.grains.spread import spread_order

grains = read_grains(snakemake.input.grains)
table = pd.DataFrame(
    [(grain.name, grain.flatness, grain.elongation) for grain in grains], columns=["grain", "FL", "EL"]
)
order = spread_order(table.FL, table.EL)
table.iloc[order].to_csv(snakemake.output.forms, index=False)

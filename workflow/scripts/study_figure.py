"""The porosities of a study beside those of the source study."""

import pandas as pd

from simcore.figures.models import study_figure
from simcore.figures.saving import save_figure

table = pd.read_csv(snakemake.input.table)
settings = dict.fromkeys(["case", *snakemake.params.rows[0]["varied"], "grain"])
label = [name for name in settings if name in table and name != "seed"]
save_figure(study_figure(table, label), snakemake.output.figure, snakemake.params.test_only)

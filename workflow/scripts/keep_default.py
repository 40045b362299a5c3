"""Copy the tables of a finished default campaign to the committed ones; those of models to a folder of their own."""

import shutil
from pathlib import Path

from simcore.campaign.gathering import check_gathered
from simcore.campaign.job_log import log_to
from simcore.paths import REFERENCE

DEFAULT = "snakemake"  # the command of the campaign without an overlay

log = log_to(snakemake.log[0])
folder = Path(snakemake.params.folder)
check_gathered(str(folder), snakemake.params.test_only)
if folder.resolve() == REFERENCE / "default" and snakemake.params.command != DEFAULT:
    raise ValueError(
        f"{folder} has the tables of `{DEFAULT}`, and this campaign is `{snakemake.params.command}`; leave out its "
        "overlays, or set `reference` to another folder"
    )
for paths, place in (
    ([*snakemake.input.tables, snakemake.input.cost], folder),
    (snakemake.input.models, folder / "models"),
):
    place.mkdir(parents=True, exist_ok=True)
    for path in paths:
        shutil.copy(path, place)
        log.info("%s", place / Path(path).name)

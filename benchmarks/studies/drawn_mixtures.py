"""The 104 statistics of form of the packings in form_mixture.csv, from their grains, which are drawn again.

    python -m benchmarks.studies.drawn_mixtures

Rettinger et al. (2022) correlate the porosity of mixtures with 104 statistics: mean and standard deviation of 26 form
factors over the grains, and their inverses. The rows of form_mixture.csv have four of them. The grains of a packing
follow from its settings and its seed, so that all 104 can be computed without packing. The command prints how far the
statistics of the drawn grains are from those of the rows, and the ten statistics with the highest correlations. It
takes about ten seconds.
"""

import numpy as np
import pandas as pd
import yaml

from simcore.campaign.studies import expand, merge
from simcore.grains.sources import load_grains
from simcore.grains.statistics import STATISTICS, mixture_features
from simcore.models.mixtures import mixture_models
from simcore.packing.forecast import draw_packing
from simcore.paths import CONFIG, REFERENCE
from simcore.reference.columns import SPECIFIED_FORM, study_names
from simcore.reference.committed_rows import fitted_mixtures
from simcore.reference.r22_tables import read_r22_table
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

STUDY, TABLE = "form_mixtures", "form_mixture.csv"  # the table has all studies whose names begin so
CONFIGURATION = ("config.yaml", "workstation.yaml")
KEYS = ["case", *SPECIFIED_FORM, "seed"]


def drawn_mixtures(rows=None):
    """Return the 104 statistics of the grains of the packings of a table, DataFrame (n, 104) with its index.

    rows: columns KEYS, as in the table of a study; None: of form_mixture.csv. ValueError if the configuration does not
    list a packing.
    """
    rows = read_rows() if rows is None else rows
    configuration = [yaml.safe_load((CONFIG / name).read_text(encoding="utf-8")) for name in CONFIGURATION]
    config = resolve(merge(*configuration), "config")
    config["studies"] = {name: study for name, study in config["studies"].items() if name.startswith(STUDY)}
    plan = expand(config)
    listed = {tuple(row["varied"][key] for key in KEYS): index for index, row in plan["row"].items()}
    wanted = [tuple(values) for values in rows[KEYS].itertuples(index=False)]
    absent = [values for values in wanted if values not in listed]
    if absent:
        raise ValueError(
            f"{' and '.join(CONFIGURATION)} do not list the packing {dict(zip(KEYS, absent[0], strict=True))}"
        )
    grains = load_grains(plan["grains"].iloc[0])
    samples = (draw_packing(set_up(plan.at[listed[values], "specification"], lambda _: grains)) for values in wanted)
    return pd.DataFrame([mixture_features(sample.L, sample.I, sample.S) for sample in samples], index=rows.index)


def read_rows():
    """Return the rows of form_mixture.csv with the columns of a study."""
    return pd.read_csv(REFERENCE / TABLE).rename(columns=study_names(*SPECIFIED_FORM))


def correlations():
    """Return the correlations of the 104 statistics with porosity, the highest first, with their rank in each case."""
    rows = read_rows()
    beds = fitted_mixtures(rows)[["case", "sample", "n"]]
    tables, _ = mixture_models(pd.concat([beds, drawn_mixtures(rows)], axis=1), read_r22_table("correlations"))
    table = tables["correlations"]
    table.insert(1, "rank", table.groupby("case").cumcount() + 1)
    return table


def main() -> None:
    """Print the difference between drawn and committed statistics, and the highest correlations."""
    rows = read_rows()
    difference = np.abs(drawn_mixtures(rows)[list(STATISTICS)] - rows[list(STATISTICS)])
    print(f"largest difference of {len(rows)} rows to the statistics of the drawn grains:")
    print(difference.max().to_string(float_format="%.1e"))
    print(correlations().groupby("case").head(10).to_string(index=False, float_format="%.3f"))


if __name__ == "__main__":
    main()

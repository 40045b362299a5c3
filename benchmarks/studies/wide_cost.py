"""Cost of the settings for wide sieve curves, and how the porosity differs from that of the study `wide_quota`.

    python -m benchmarks.studies.wide_cost

It reads the tables results/reference/wide_*.csv of pebbles and writes results/reference/wide_cost.csv with one row per
packing. It prints one line for each sieve curve and each study that packs beds of `wide_quota` again: the number of
pairs (same curve, same seed), the mean difference of the porosity with its standard error, whether the rule of
config/wide.yaml accepts the setting, and the ratio of the CPU times. A second table compares the means over all seeds
of beds with sizes drawn at random with those by quota, which have other grains. A third one compares with the settings
of Rettinger et al. The rule requires a mean difference of at most 0.003 in size with a standard error of at most
0.0015, over three seeds, or over the number in SEEDS.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from simcore.paths import REFERENCE

BASE = "wide_quota"
# Beds with sizes drawn at random: the beds by quota with the same settings, whose grains are others.
UNPAIRED = {"wide_random": BASE, "wide_both_random": "wide_both"}
NO_COST = {"wide_cost", "wide_spheres"}  # the table itself, and the check of the sampling error on spheres
LARGEST_DIFFERENCE, LARGEST_ERROR = 0.003, 0.0015
# Seeds over which the rule judges a study of a sieve curve; three if it is not listed.
SEEDS = {("wide_soft", "U5"): 8, ("wide_both", "B50"): 6}
COLUMNS = ["settings", "case", "seed", "shapes", "mass_kg", "n", "n_error", "grains", "grain_steps", "cpu_s"]


def cost_table(tables: dict[str, pd.DataFrame], gathered: pd.DataFrame) -> pd.DataFrame:
    """Return one row per packing, with COLUMNS.

    tables: rows of each study. gathered: rows of gathered.csv, which give the grain-steps; a row belongs to the packing
    of the same study with the same CPU time. ValueError if there is not exactly one.
    """
    rows = []
    for study, table in tables.items():
        entries = gathered[gathered["study"] == study]
        for row in table.to_dict("records"):
            entry = entries[entries["cpu_s"] == row["cpu_s"]]
            if len(entry) != 1:
                raise ValueError(
                    f"gathered.csv has {len(entry)} packings of {study} that took {row['cpu_s']} s of CPU time; one is "
                    f"needed for the row of seed {row['seed']}. To collect the study again, run: snakemake --cores 1 "
                    "--configfile config/wide.yaml -- collect"
                )
            one = entry.iloc[0]
            rows.append({**row, "settings": study, "shapes": one["source"], "grain_steps": one["grain_steps"]})
    return pd.DataFrame(rows, columns=COLUMNS)


def paired(table: pd.DataFrame, base: str = BASE) -> pd.DataFrame:
    """Return the differences from the packings of `base`, paired by case and seed: one row for each settings and case.

    Columns: settings, case, pairs, difference and error (mean and standard error; NaN if there is one pair), cost
    (ratio of the CPU times of all pairs) and verdict.
    """
    reference = table[table["settings"] == base].set_index(["case", "seed"])
    rows = []
    for (settings, case), group in table.groupby(["settings", "case"], sort=False):
        group = group.set_index(["case", "seed"])
        group = group[group.index.isin(reference.index)]
        if settings == base or settings in UNPAIRED or group.empty:
            continue
        of_base = reference.loc[group.index]
        difference = (group["n"] - of_base["n"]).to_numpy()
        count, mean = len(difference), float(difference.mean())
        error = float(difference.std(ddof=1) / np.sqrt(count)) if count > 1 else np.nan
        cost = float(group["cpu_s"].sum() / of_base["cpu_s"].sum())
        judged = verdict(mean, error, count, SEEDS.get((settings, case), 3))
        rows.append((settings, case, count, mean, error, cost, judged))
    return pd.DataFrame(rows, columns=["settings", "case", "pairs", "difference", "error", "cost", "verdict"])


def compare_means(table: pd.DataFrame) -> pd.DataFrame:
    """Return the differences of means of the settings in UNPAIRED: one row for each settings and case.

    Columns: settings, case, beds, difference and error (of the means over the seeds of both), and cost (ratio of the
    mean CPU times of a packing).
    """
    rows = []
    for (settings, case), group in table[table["settings"].isin(UNPAIRED)].groupby(["settings", "case"], sort=False):
        of_base = table[(table["settings"] == UNPAIRED[settings]) & (table["case"] == case)]
        if of_base.empty:
            continue
        difference = group["n"].mean() - of_base["n"].mean()
        error = np.hypot(group["n"].sem(), of_base["n"].sem())
        rows.append((settings, case, len(group), difference, error, group["cpu_s"].mean() / of_base["cpu_s"].mean()))
    return pd.DataFrame(rows, columns=["settings", "case", "beds", "difference", "error", "cost"])


def compare_r22(table: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Return `wide_random` minus the settings of Rettinger et al., paired by seed: columns seed, difference and cost.

    rows: of difference_wide.csv, of the same grains, shaken for 1 s instead of 2 s. Settings of Rettinger et al. are
    contacts at the deepest point and 40 explicit steps in each.
    """
    r22 = rows.query("polyhedron_contact == 'point' and dashpot == 'explicit' and steps_per_contact_time == 40")
    ours = table.query("settings == 'wide_random'")
    pairs = r22.merge(ours, on=["case", "seed", "grains"], suffixes=("_r22", ""))
    columns = {"seed": pairs["seed"], "difference": pairs["n"] - pairs["n_r22"]}
    return pd.DataFrame(columns | {"cost": pairs["cpu_s"] / pairs["cpu_s_r22"]})


def verdict(difference: float, error: float, pairs: int, required: int) -> str:
    """Return the verdict of the rule on a mean difference with its standard error, over this number of pairs."""
    if pairs < required:
        return f"open: {pairs} of {required} pairs"
    return "accepted" if abs(difference) <= LARGEST_DIFFERENCE and error <= LARGEST_ERROR else "not accepted"


def read_tables(folder: Path = REFERENCE) -> dict[str, pd.DataFrame]:
    """Return the committed rows of each study of wide sieve curves, the base first."""
    names = sorted(path.stem for path in folder.glob("wide_*.csv") if path.stem not in NO_COST)
    names.sort(key=lambda name: name != BASE)
    return {name: pd.read_csv(folder / f"{name}.csv") for name in names}


def main() -> None:
    """Write the table of packings and print the pairs."""
    table = cost_table(read_tables(), pd.read_csv(REFERENCE / "gathered.csv"))
    table.to_csv(REFERENCE / "wide_cost.csv", index=False)
    r22 = compare_r22(table, pd.read_csv(REFERENCE / "difference_wide.csv"))
    for rows in (paired(table), compare_means(table), r22):
        print(rows.to_string(index=False, float_format="%.4f", na_rep=""))


if __name__ == "__main__":
    main()

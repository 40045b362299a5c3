"""CPU time of the studies of a campaign, compared with that of the program of Rettinger et al. (2022)."""

import pandas as pd

from simcore.reference.named_tables import read_named_table

# A packing of Rettinger et al., 20 000 grains and 1.5 million steps, takes their program 230 to 250 core-hours.
R22_HOURS, R22_GRAINS, R22_STEPS = 230.0, 20_000, 1.5e6


def cost_table(packings):
    """Return the CPU time of the studies as a DataFrame with one row per study and a last row `all`.

    packings: one row per packing of all studies, as from study_tables.tabulate. Columns: study, packings, grains (of
    all packings), cpu_h, cpu_h_per_packing, grain_steps (sum of grains times steps), cpu_us_per_grain_step [µs], and
    r22_cpu_h: the core-hours of the program of Rettinger et al. for the same number of grain-steps. Both count all
    grains of a packing in all its steps.
    """
    of_packing = packings[["study", "grains"]].assign(
        packings=1,
        cpu_h=packings["cpu_s"] / 3600.0,
        grain_steps=packings["grains"].astype(float) * packings["steps"],
    )
    by_study = of_packing.groupby("study", sort=False).sum()
    by_study.loc["all"] = by_study.sum()
    table = by_study.astype({"grains": int, "packings": int}).rename_axis("study").reset_index()
    return table[["study", "packings", "grains", "cpu_h"]].assign(
        cpu_h_per_packing=table["cpu_h"] / table["packings"],
        grain_steps=table["grain_steps"],
        cpu_us_per_grain_step=3600.0e6 * table["cpu_h"] / table["grain_steps"],
        r22_cpu_h=r22_hours(table["grain_steps"]),
    )


def r22_hours(grain_steps):
    """Return the core-hours of the program of Rettinger et al. for this number of grains times steps."""
    return R22_HOURS * grain_steps / (R22_GRAINS * R22_STEPS)


def read_packings(paths):
    """Return the tables of packings of several studies as one DataFrame, in the order of the paths."""
    return pd.concat([read_named_table(path) for path in paths], ignore_index=True)

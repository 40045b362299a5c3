"""The estimated cost of a campaign's packings, study by study, and their division into pieces of some hours."""

import numpy as np
import pandas as pd

from simcore.grains.sources import source_name
from simcore.packing.cost import estimate


def number_pieces(cpu_hours, seeds, max_hours):
    """Return the number of the piece, from 1, of each packing of a study, (n,) int.

    cpu_hours (n,): estimate for each packing. seeds (n,): packings are ordered by seed, so that an interrupted study
    has every setting once before it has any setting twice. max_hours: largest number of CPU hours of a piece; a
    packing that takes longer is a piece by itself.
    """
    pieces, piece, filled = np.empty(len(cpu_hours), int), 0, np.inf
    for k in np.argsort(seeds, kind="stable"):
        if filled + cpu_hours[k] > max_hours:
            piece, filled = piece + 1, 0.0
        pieces[k] = piece
        filled += cpu_hours[k]
    return pieces


def estimate_studies(packings, in_all):
    """Return a DataFrame with one row per study and a row `all`: study, packings, grains, cpu_h, longest_h, pieces.

    packings: one row per packing, columns study, cost (a PackingCost) and piece. in_all: names of the studies of the
    target `all`; they come first, then the row "all" with their sums, then the other studies. longest_h: CPU hours of
    the longest packing.
    """
    costs = pd.DataFrame(
        {
            "study": packings["study"],
            "packings": 1,
            "grains": [cost.grains for cost in packings["cost"]],
            "cpu_h": [cost.cpu_seconds / 3600.0 for cost in packings["cost"]],
            "piece": packings["piece"],
        }
    )
    groups = costs.groupby("study", sort=False)
    table = groups[["packings", "grains", "cpu_h"]].sum()
    table = table.assign(longest_h=groups["cpu_h"].max(), pieces=groups["piece"].max())
    listed = table[table.index.isin(in_all)]
    everything = (
        listed[["packings", "grains", "cpu_h", "pieces"]].sum().to_frame().T.assign(longest_h=listed.longest_h.max())
    )
    everything.index = ["all"]
    table = pd.concat([listed, everything, table.drop(listed.index)]).rename_axis("study").reset_index()
    return table.astype({"packings": int, "grains": int, "pieces": int})


def describe_studies(table, piece_hours):
    """Return the table of estimate_studies as lines of text."""
    lines = [f"{'study':<24}{'packings':>9}{'grains':>10}{'CPU hours':>11}{'longest':>9}{'pieces':>8}"]
    for row in table.itertuples():
        lines.append(
            f"{row.study:<24}{row.packings:>9}{row.grains:>10}{row.cpu_h:>11.2f}{row.longest_h:>9.2f}{row.pieces:>8}"
        )
    lines.append(
        f"Estimates are for one thread without compiling. A piece takes at most {piece_hours:g} CPU hours, or is one "
        f"packing that takes longer; it is a target, such as {table.study.iloc[0]}_piece_1. The studies below `all` "
        "are made only if they are requested."
    )
    return "\n".join(lines)


def with_cost(packings, campaign):
    """Return the packings of simcore.campaign.studies.expand with the columns that Plan adds.

    ValueError names the packing whose cost cannot be estimated.
    """
    # Results do not depend on cores and memory of a packing, so these must not be in the `params` of a rule.
    costs = pd.Series([_cost(row) for row in packings.itertuples()], index=packings.index)
    hours = np.array([cost.cpu_seconds / 3600.0 for cost in costs])
    seeds = np.array([specification["seed"] for specification in packings.specification])
    pieces = np.zeros(len(packings), int)
    for rows in packings.groupby("study").indices.values():
        pieces[rows] = number_pieces(hours[rows], seeds[rows], campaign["piece_hours"])
    return packings.assign(
        cost=costs,
        is_first=~packings.study.duplicated(),
        grain_folder=packings.grain_set.str.partition("/")[0],
        source=[source_name((group or campaign["grains"])["source"]) for group in packings.grains],
        piece=pieces,
        ranks=[cost.ranks(campaign["ranks"], campaign["grains_per_rank"]) for cost in costs],
    )


def _cost(row):
    try:
        return estimate(row.specification)
    except ValueError as error:
        raise ValueError(f"studies.{row.study}, packing {row.packing}: {error}") from None

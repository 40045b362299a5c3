"""What a campaign will cost, study by study, and how it is cut into pieces that end within some hours."""

import numpy as np
import pandas as pd

from simcore.packing.forecast import check_bed, typical_grains
from simcore.scene.domain import Domain


def number_pieces(cpu_hours, seeds, most):
    """The piece, from 1, that each packing of a study belongs to, (n,) int.

    cpu_hours: estimate of each packing (n,); seeds (n,): all packings of the least seed come first, so that a study
    that is broken off has every setting before it has any twice. A piece ends before its packings take more than
    `most` hours; a packing that takes longer is a piece by itself.
    """
    pieces, piece, filled = np.empty(len(cpu_hours), int), 0, np.inf
    for k in np.argsort(seeds, kind="stable"):
        if filled + cpu_hours[k] > most:
            piece, filled = piece + 1, 0.0
        pieces[k] = piece
        filled += cpu_hours[k]
    return pieces


def estimate_studies(packings, in_all):
    """DataFrame with one row a study and one of all: study, packings, grains, cpu_h, longest_h, pieces.

    packings: one row a packing, columns study, cost (a PackingCost) and piece. in_all: names of the studies that `all`
    holds; they come first, the row "all" is theirs, and the others follow it. longest_h: of a single packing.
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
    inside = table[table.index.isin(in_all)]
    everything = (
        inside[["packings", "grains", "cpu_h", "pieces"]].sum().to_frame().T.assign(longest_h=inside.longest_h.max())
    )
    everything.index = ["all"]
    table = pd.concat([inside, everything, table.drop(inside.index)]).rename_axis("study").reset_index()
    return table.astype({"packings": int, "grains": int, "pieces": int})


def describe_studies(table, piece_hours):
    """The table of estimate_studies as lines of text."""
    lines = [f"{'study':<24}{'packings':>9}{'grains':>10}{'CPU hours':>11}{'longest':>9}{'pieces':>8}"]
    for row in table.itertuples():
        lines.append(
            f"{row.study:<24}{row.packings:>9}{row.grains:>10}{row.cpu_h:>11.2f}{row.longest_h:>9.2f}{row.pieces:>8}"
        )
    lines.append(
        f"Estimated for one thread, compiling apart; a piece takes at most {piece_hours:g} CPU hours and is a target, "
        f"such as {table.study.iloc[0]}_piece_1. Below `all`: studies that are made only when they are asked for."
    )
    return "\n".join(lines)


def check_beds(packings, cut=None):
    """ValueError where the bed of a packing will be too low for its porosity to be evaluated with that cut.

    packings: one row a packing, columns study, packing and specification. cut: of the campaign's group `porosity`.
    """
    for row in packings.itertuples():
        specification = row.specification
        try:
            density = specification["material"]["density"]
            check_bed(Domain(**specification["domain"]), typical_grains(specification), density, cut)
        except ValueError as error:
            raise ValueError(
                f"studies.{row.study}, packing {row.packing}: {error} To evaluate a lower bed, set porosity.cut."
            ) from None

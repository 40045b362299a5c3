"""Model of the run time on many ranks, from measurements on two, for packings of Rettinger et al. (2022).

    python -m benchmarks.speed.ranks_model [--measured results/reference/ranks.csv]

The wall time of a step is that of the slowest rank: cost × (own grains + grains whose cost is that of the pairs across
borders, which both sides compute) + time of the exchange. The block of a rank is a rectangle of the bed's footprint,
and its ghosts form a layer around it, whose width is measured. A rank exchanges the bytes of the ghosts, at least two
messages with each neighbour, and one reduction over all ranks, at the stated speed and latency of a network (ASSUME:
those of an ordinary cluster, 10 GB/s and 2 µs; within one machine both are better).

The model leaves out: waiting for the slower rank (two ranks on one machine lost 6 to 11 % to waiting and exchange);
uneven blocks (up to simcore.dem.ranks.many_ranks.UNEVEN); neighbour lists, 2 % of a step; and the competition of the
ranks of one machine for its memory.
"""

import argparse
import csv
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

MEASURED = Path(__file__).parents[2] / "results" / "reference" / "ranks.csv"
BANDWIDTH, LATENCY = 10e9, 2e-6  # [byte/s], [s]
STEPS = 8.0 / 5e-6  # of a packing of Rettinger et al.: 6 s of shaking, 2 s before and after
# Grains in the packings of 16 kg of Rettinger et al. (Table 7: U7 and B50 in a box 0.2 m wide), and in larger beds.
BEDS = {"16 kg, 20 000 grains": 20_000, "16 kg, 100 000 grains": 100_000, "10^6 grains": 10**6, "10^7 grains": 10**7}
RANKS = (1, 2, 4, 16, 64, 100, 400)


class Measured(NamedTuple):
    """Measurements of a bed of `grains` on two ranks side by side, in a periodic box."""

    grains: int
    cost: float  # [s] per grain and step on one rank
    ghosts_per_own: float
    twice: float  # share of pairs computed twice
    bytes_per_ghost: float


def read_measured(path) -> Measured:
    """Return the measurements of the largest bed in a table of benchmarks.speed.ranks."""
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    grains = max(int(row["grains"]) for row in rows)
    one, two = (next(r for r in rows if int(r["grains"]) == grains and int(r["ranks"]) == ranks) for ranks in (1, 2))
    ghosts = float(two["ghosts_per_own"])
    bytes_per_ghost = float(two["bytes_per_step_and_rank"]) / (ghosts * grains / 2)
    cost = 1e-6 * float(one["wall_us_per_grain_step"])
    return Measured(grains, cost, ghosts, float(two["pairs_twice_share"]), bytes_per_ghost)


def step_time(measured: Measured, grains: float, ranks: int) -> float:
    """Return the wall time [s] of a step of a bed as deep as it is wide."""
    columns, rows = _layout(ranks)
    # The measured bed has two blocks of half its width, with ghosts on two sides. Widths are in grains.
    width = measured.grains ** (1 / 3)
    layer = 0.25 * measured.ghosts_per_own * width
    pairs = 0.25 * measured.twice * width  # layer on each side of a border whose pairs both sides compute
    side = grains ** (1 / 3)
    a, b = side / columns, side / rows
    own = a * b * side

    def about(thickness):
        """Return the number of grains in a layer around a block, on the sides where it has neighbours."""
        wider, deeper = (2 * thickness if n > 1 else 0.0 for n in (columns, rows))
        return min(((a + wider) * (b + deeper) - a * b) * side, grains)

    ghosts, twice = about(layer), about(pairs)
    neighbours = min(ranks - 1, 8)
    exchanged = ghosts * measured.bytes_per_ghost / BANDWIDTH + 2 * neighbours * LATENCY
    reduced = 2 * np.ceil(np.log2(ranks)) * LATENCY if ranks > 1 else 0.0
    return measured.cost * (own + twice) + (exchanged + reduced if ranks > 1 else 0.0)


def _layout(ranks):
    rows = max(k for k in range(1, int(np.sqrt(ranks)) + 1) if ranks % k == 0)
    return ranks // rows, rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measured", default=MEASURED)
    measured = read_measured(parser.parse_args().measured)
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["bed", "ranks", "step_ms", "efficiency", "hours_of_a_packing", "core_hours"])
    for name, grains in BEDS.items():
        alone = step_time(measured, grains, 1)
        for ranks in RANKS:
            step = step_time(measured, grains, ranks)
            hours = step * STEPS / 3600
            writer.writerow(
                [
                    name,
                    ranks,
                    f"{1e3 * step:.3g}",
                    f"{alone / step / ranks:.2f}",
                    f"{hours:.3g}",
                    f"{hours * ranks:.3g}",
                ]
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())

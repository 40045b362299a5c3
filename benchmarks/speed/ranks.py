"""MPI ranks compared with one rank: wall time, bytes sent, pairs computed twice; and a large bed stored and resumed.

    python -m benchmarks.speed.ranks [--shape polyhedron] [--faces 300] [--ranks 1 2] [--runs 5] [--csv FILE]
    python -m benchmarks.speed.ranks --large

A settled periodic bed of 1250 grains is repeated 2 x 2 and 4 x 4 times. Runs of different numbers of ranks take turns,
each in processes of its own, and medians of the wall time are compared (strong scaling). With --weak the bed is
repeated so often that a rank has about 5000 grains (2 x 2 times on one rank, 3 x 3 on two). A rank has one thread. With
--large a bed of 1000 polyhedra is repeated 10 x 10 times on two ranks, shaken, stored as a checkpoint, and resumed.
"""

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.speed.throughput import default_beds, face_count

GRAINS = 1250
TIMES = (2, 4)
LEAST_GRAIN_STEPS = 1.5e6
LEAST_STEPS = 200
COLUMNS = (
    "shape", "faces", "grains", "ranks", "wall_us_per_grain_step", "speedup", "exchange_share",
    "bytes_per_step_and_rank", "ghosts_per_own", "pairs_twice_share", "steps", "runs", "load_average", "digest",
)  # fmt: skip


def main():
    options = parse()
    if options.work:
        return work(options, *options.work)
    if options.large:
        return large(options)
    rows = []
    pour(options, GRAINS)
    for times in TIMES[:1] if options.weak else TIMES:
        figures = {ranks: [] for ranks in options.ranks}
        for _ in range(options.runs):
            for ranks in options.ranks:
                copies = round(times * np.sqrt(ranks)) if options.weak else times
                figures[ranks].append(call(options, ranks, copies))
        for runs in figures.values():
            wall = float(np.median([row["wall_us_per_grain_step"] for row in runs]))
            base = float(np.median([row["wall_us_per_grain_step"] for row in figures[options.ranks[0]]]))
            rows.append(runs[-1] | {"wall_us_per_grain_step": wall, "speedup": base / wall, "runs": len(runs)})
            print(json.dumps(rows[-1]), file=sys.stderr, flush=True)
    with open(options.csv, "w", newline="", encoding="utf-8") if options.csv else sys.stdout as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator=os.linesep)
        writer.writeheader()
        writer.writerows(rows)
    return 0


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shape", choices=["sphere", "ellipsoid", "polyhedron"], default="polyhedron")
    parser.add_argument("--faces", type=face_count, default=300)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--csv", metavar="FILE", help="otherwise printed")
    parser.add_argument("--beds", metavar="FOLDER", default=default_beds(), help="where beds are kept")
    parser.add_argument("--weak", action="store_true", help="the same number of grains for each rank")
    parser.add_argument("--large", action="store_true", help="run the large bed")
    parser.add_argument("--work", nargs=3, metavar=("GRAINS", "TIMES", "KEPT"), help=argparse.SUPPRESS)
    return parser.parse_args()


def pour(options, grains):
    """Return settings and bed; it is poured here once, so that the ranks only read it."""
    from benchmarks.beds import bed_settings, settled_bed

    settings = bed_settings(options.shape, grains, options.faces)
    return settings, settled_bed(settings, options.beds, lambda text: print(text, file=sys.stderr, flush=True))


def call(options, ranks, times, grains=GRAINS, kept="-"):
    """Return the figures of one run, which has processes of its own."""
    command = [sys.executable, "-m", "benchmarks.speed.ranks", "--shape", options.shape, "--faces", str(options.faces)]
    command += ["--beds", options.beds, "--work", str(grains), str(times), kept]
    if ranks > 1:
        command = [str(Path(sys.executable).with_name("mpiexec")), "-n", str(ranks), *command]
    environment = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads([line for line in done.stdout.splitlines() if line.startswith("{")][-1])


def work(options, grains, times, kept):
    """Make a run; every rank calls this, and rank 0 prints the figures."""
    from simcore.dem.ranks.one_rank import ONE_RANK, started_by_mpi

    ranks = ONE_RANK
    if started_by_mpi(os.environ):
        from simcore.dem.ranks.many_ranks import ManyRanks

        ranks = ManyRanks()
    with ranks.together():
        figures = run(options, ranks, int(grains), int(times), None if kept == "-" else Path(kept))
    if ranks.rank == 0:
        print(json.dumps(figures))
    return 0


def run(options, ranks, grains, times, kept):
    from benchmarks.beds import prepare, start, tile
    from benchmarks.measurement import machine
    from simcore.packing.packed import SHAKING

    settings, bed = pour(options, grains)
    setup, bed = tile(prepare(settings), bed, times)
    keeper = _keeper(kept, ranks, settings) if kept else None
    began = time.perf_counter()
    process = start(setup, bed, ranks=ranks, keeper=keeper)
    n = process.state.inserted
    steps = max(round(LEAST_GRAIN_STEPS / n), LEAST_STEPS) if not kept else LEAST_STEPS
    resumed = 0
    if kept and keeper.latest() is not None:
        process.resume()
        resumed = process.step
    process.advance(steps // 4, SHAKING)  # compiles the step, and contacts become remembered ones
    before = ranks.exchanging, ranks.bytes_sent, ranks.steps
    started = time.perf_counter()
    process.advance(steps, SHAKING)
    wall = time.perf_counter() - started
    contacts = process.contacts
    own = len(process.bodies.own)
    shared, pairs = ranks.add([ranks.shared, len(contacts.body_a)])
    figures = {
        "shape": options.shape,
        "faces": len(setup.bases[0].faces) or None,
        "grains": n,
        "ranks": ranks.size,
        "wall_us_per_grain_step": wall / steps / n * 1e6,
        "exchange_share": (ranks.exchanging - before[0]) / wall,
        "bytes_per_step_and_rank": (ranks.bytes_sent - before[1]) / max(ranks.steps - before[2], 1),
        "ghosts_per_own": (len(process.bodies.mass) - own) / own,
        "pairs_twice_share": float(0.5 * shared / (pairs - 0.5 * shared)),
        "steps": steps,
        "resumed_at": resumed,
        "seconds_in_all": time.perf_counter() - began,
    }
    if kept:
        figures |= _kept(process, keeper)
    return figures | {name: machine()[name] for name in ("load_average", "digest")}


def _keeper(folder, ranks, settings):
    from simcore.packing.checkpoints.keeper import CheckpointKeeper
    from simcore.packing.checkpoints.key import checkpoint_code, scene_key

    return CheckpointKeeper(folder, scene_key(settings, []), checkpoint_code(), np.inf, print, ranks)


def _kept(process, keeper):
    """Store a checkpoint; return its time [s], peak memory of rank 0 [MiB], and a digest of all bodies and contacts."""
    import hashlib
    import resource

    from simcore.dem.state.parts import assemble, take_part

    began = time.perf_counter()
    process.keep()
    seconds = time.perf_counter() - began
    keeper.close()
    digest = hashlib.sha256()
    parts = list(process.ranks.parts(process.bodies, process.candidates))
    if process.ranks.rank == 0:
        bodies, near = assemble(parts, np.arange(process.state.inserted))
        for array in take_part(bodies, near, bodies.own).values():
            digest.update(array.tobytes())
    return {
        "keeping_s": seconds,
        "megabytes_of_rank_0": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "state": digest.hexdigest()[:16],
    }


def large(options):
    """Run the large bed on two ranks and store it; resume it on two ranks and on one. Return 1 if the bits differ."""
    with tempfile.TemporaryDirectory() as scratch:
        first, other = Path(scratch) / "first", Path(scratch) / "other"
        print("two ranks", json.dumps(call(options, 2, 10, 1000, str(first))), flush=True)
        shutil.copytree(first, other)
        states = []
        for ranks, folder in ((2, first), (1, other)):
            figures = call(options, ranks, 10, 1000, str(folder))
            print(f"resumed on {ranks}", json.dumps(figures), flush=True)
            states.append(figures["state"])
    return int(states[0] != states[1])


if __name__ == "__main__":
    sys.exit(main())

"""Cost per grain and step against the number of grains, and two threads against one.

    python -m benchmarks.speed.scaling [--shape sphere ...] [--faces 300] [--csv FILE]

A settled periodic bed is repeated side by side in a wider box. The number of grains is varied by repeating 1000 grains
1 x 1, 3 x 3 and 10 x 10 times: these beds differ only in the size of their memory. For threads, 1250 grains are
repeated 2 x 2 and 4 x 4 times. Each row is measured in a process of its own. `speedup` is the wall time with one thread
over that with the given number of threads.
"""

import argparse
import csv
import json
import os
import subprocess
import sys

from benchmarks.speed.throughput import default_beds, face_count

SHAPES = ("sphere", "ellipsoid", "polyhedron")
SIZES = ((1000, 1), (1000, 3), (1000, 10))  # grains of the bed, times repeated along x and along y
THREADED = ((1250, 2), (1250, 4))
LEAST_GRAIN_STEPS = 20e6  # minimum of grains times steps in a row
LEAST_STEPS = 400
COLUMNS = (
    "shape", "faces", "grains", "threads", "cpu_us_per_grain_step", "wall_us_per_grain_step", "speedup",
    "contacts_per_grain", "near_pairs_per_grain", "steps", "load_average", "digest",
)  # fmt: skip


def main(arguments=None):
    options = parse(arguments)
    if options.one:
        print(json.dumps(measure_one(options, options.shape[0], *options.one)))
        return
    rows = []
    for shape in options.shape:
        rows += [call(options, shape, grains, times, 1) for grains, times in SIZES]
        for grains, times in THREADED:
            threaded = [call(options, shape, grains, times, threads) for threads in (1, 2)]
            alone = threaded[0]["wall_us_per_grain_step"]
            rows += [row | {"speedup": alone / row["wall_us_per_grain_step"]} for row in threaded]
    with open(options.csv, "w", newline="", encoding="utf-8") if options.csv else sys.stdout as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator=os.linesep)
        writer.writeheader()
        writer.writerows(rows)


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shape", choices=SHAPES, nargs="+", default=["sphere", "polyhedron"])
    parser.add_argument("--faces", type=face_count, default=300)
    parser.add_argument("--csv", metavar="FILE", help="otherwise printed")
    parser.add_argument("--beds", metavar="FOLDER", default=default_beds(), help="where beds are kept")
    parser.add_argument(
        "--one", type=int, nargs=2, metavar=("GRAINS", "TIMES"), help="measure only this bed and print JSON"
    )
    return parser.parse_args(arguments)


def call(options, shape, grains, times, threads):
    """Return the row of one size and number of threads, from a process of its own."""
    command = [
        sys.executable,
        "-m",
        "benchmarks.speed.scaling",
        "--shape",
        shape,
        "--faces",
        str(options.faces),
    ]
    command += ["--beds", options.beds, "--one", str(grains), str(times)]
    environment = {**os.environ, "NUMBA_NUM_THREADS": str(threads)}
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def measure_one(options, shape, grains, times):
    import numba

    from benchmarks.beds import bed_settings, prepare, settled_bed, tile
    from benchmarks.measurement import machine, measure

    settings = bed_settings(shape, grains, options.faces)
    bed = settled_bed(settings, options.beds, lambda text: print(text, file=sys.stderr, flush=True))
    setup, bed = tile(prepare(settings), bed, times)
    n = len(bed.shape)
    steps = max(LEAST_GRAIN_STEPS / n, LEAST_STEPS)
    figures, _ = measure(setup, bed, steps * setup.scene.numerics.time_step)
    where = machine()
    return figures | {
        "shape": shape,
        "faces": len(setup.bases[0].faces) or None,
        "grains": n,
        "threads": numba.get_num_threads(),
        "load_average": where["load_average"],
        "digest": where["digest"],
    }


if __name__ == "__main__":
    main()

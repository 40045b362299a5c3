"""CPU time of a time step for each kind of grain, and of the same beds and pairs in LAMMPS and coal, in turns.

    python -m benchmarks.speed.step_cost [--python OTHERS/bin/python] [--runs 3] [--csv FILE]

The dense shaken beds are those of benchmarks.speed.throughput: 2000 grains, one thread. Everything is measured once,
then a second time and so on, so that a slow minute of the machine does not meet one kind of grain only. The median of
the runs is given with the lowest and the highest one. OTHERS is the environment of benchmarks.speed.compare; without
it, only our code is measured.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

GRAINS = 2000
WIDE = ["numerics.contact_time=0.5 ms", "numerics.steps_per_contact_time=14", "numerics.dashpot=implicit"]
# Shape and settings of each row; the others are those of Rettinger et al. (2022).
BEDS = {
    "spheres": ("sphere", []),
    "ellipsoids": ("ellipsoid", []),
    "polyhedra, point contact": ("polyhedron", ["numerics.polyhedron_contact=point"]),
    "polyhedra, patch contact": ("polyhedron", ["numerics.polyhedron_contact=patch"]),
    "polyhedra, accuracy: wide": ("polyhedron", ["numerics.polyhedron_contact=patch", *WIDE]),
}
COLUMNS = (
    "what",
    "code",
    "median_us",
    "lowest_us",
    "highest_us",
    "contacts_per_grain",
    "runs",
    "load_average",
    "digest",
)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", help="interpreter of the environment of the other codes")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--duration", type=float, default=0.02, help="simulated time of each run [s]")
    parser.add_argument("--csv", metavar="FILE", help="otherwise printed")
    options = parser.parse_args(arguments)
    measured = []
    with tempfile.TemporaryDirectory() as folder:
        for run in range(options.runs):
            print(f"run {run + 1} of {options.runs}", file=sys.stderr, flush=True)
            for what in BEDS:
                measured.append(measure_bed(what, options.duration, Path(folder) / "bed.json"))
            if options.python:
                measured += compare(options.python, options.duration, Path(folder) / "others.csv")
            if options.csv:  # after each run, so that a stopped measurement leaves the runs before
                with open(options.csv, "w", newline="", encoding="utf-8") as file:
                    write(file, measured)
    if not options.csv:
        write(sys.stdout, measured)


def write(file, measured):
    """Write the summary of the runs as CSV."""
    writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(summary(measured, load_average=os.getloadavg()[0]))


def measure_bed(what, duration, path):
    """Return the cost of the bed `what` of BEDS as a dict of what, code, cost_us, contacts_per_grain and digest."""
    shape, assignments = BEDS[what]
    command = [sys.executable, "-m", "benchmarks.speed.throughput", "--shape", shape, "--grains", str(GRAINS)]
    command += ["--duration", str(duration), "--json", str(path)]
    for assignment in assignments:
        command += ["--set", assignment]
    run(command)
    result = json.loads(path.read_text(encoding="utf-8"))
    return {
        "what": what,
        "code": "Scree",
        "cost_us": result["cpu_us_per_grain_step"],
        "contacts_per_grain": result["contacts_per_grain"],
        "digest": result["machine"]["digest"],
    }


def compare(python, duration, path):
    """Return the costs of the bed of spheres in both codes, and those of queries of touching pairs; see measure_bed."""
    command = [sys.executable, "-m", "benchmarks.speed.compare", "--python", python, "--codes", "lammps", "coal"]
    run([*command, "--spheres", str(GRAINS), "--duration", str(duration), "--csv", str(path)])
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [
        {
            "what": f"beside another code: {row['what']}",
            "code": f"{row['code']} {row['version']}",
            "cost_us": float(row["cpu_us"]),
            "contacts_per_grain": row["contacts_per_grain"],
            "digest": row["digest"],
        }
        for row in rows
    ]


def run(command):
    """Run a command with one thread; RuntimeError with its output if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "NUMBA_NUM_THREADS": "1"})
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")


def summary(measured, load_average):
    """Return one row per bed or pair and code: the median of its runs, the lowest and the highest one, as dicts."""
    groups = {}
    for row in measured:
        groups.setdefault((row["what"], row["code"]), []).append(row)
    return [
        {
            "what": what,
            "code": code,
            "median_us": np.median([row["cost_us"] for row in rows]),
            "lowest_us": min(row["cost_us"] for row in rows),
            "highest_us": max(row["cost_us"] for row in rows),
            "contacts_per_grain": rows[0]["contacts_per_grain"],
            "runs": len(rows),
            "load_average": load_average,
            "digest": rows[0]["digest"],
        }
        for (what, code), rows in groups.items()
    ]


if __name__ == "__main__":
    main()

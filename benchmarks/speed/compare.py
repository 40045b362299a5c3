"""CPU time of the same beds in other programs.

    python -m benchmarks.speed.compare --python OTHERS/bin/python [--csv FILE]

Our code and the others run one after the other, each on one thread; `ratio` is the CPU time of a program over ours.
LAMMPS and LIGGGHTS get spheres, MuJoCo polyhedra (also YADE, but only if it is named), and coal touching pairs of
hulls. OTHERS is an environment with the packages of benchmarks/speed/others/environment.txt; a program that is not
installed is reported and left out. The column not_comparable lists what differs although the bed is the same.
"""

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ["NUMBA_NUM_THREADS"] = "1"

from benchmarks.speed.throughput import default_beds, face_count  # noqa: E402  before numba

OTHERS = Path(__file__).parent / "others"
SPHERES = {"lammps": "lammps_spheres.py", "liggghts": "liggghts_spheres.py"}
POLYHEDRA = {"mujoco": "mujoco_polyhedra.py", "yade": "yade_polyhedra.py"}
PAIRS = {"coal": "coal_pairs.py"}
# YADE crashes at 300 faces (2023.02a of Debian 12); it runs if it is named, with --faces 20.
NOT_BY_DEFAULT = {"yade"}
PROGRAMS = {"liggghts", "yade"}  # a program on the PATH; the others are modules of OTHERS
COLUMNS = (
    "what", "code", "version", "grains", "cpu_us", "ratio", "cpu_us_per_contact", "ratio_per_contact",
    "contacts_per_grain", "kinetic_energy_per_grain", "steps", "settings", "not_comparable", "digest",
)  # fmt: skip


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", required=True, help="interpreter of the environment of the other codes")
    parser.add_argument("--codes", nargs="+", choices=[*SPHERES, *POLYHEDRA, *PAIRS], help="default: all but YADE")
    parser.add_argument("--spheres", type=int, default=2000)
    parser.add_argument("--polyhedra", type=int, default=500)
    parser.add_argument("--faces", type=face_count, default=300)
    parser.add_argument("--duration", type=float, default=0.05, help="simulated time measured [s]; less for slow codes")
    parser.add_argument("--csv", metavar="FILE", help="otherwise printed")
    parser.add_argument("--beds", metavar="FOLDER", default=default_beds(), help="where beds are kept")
    options = parser.parse_args(arguments)
    by_default = [code for code in (*SPHERES, *POLYHEDRA, *PAIRS) if code not in NOT_BY_DEFAULT]
    codes = [code for code in options.codes or by_default if is_there(code, options.python)]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for shape, grains, scripts in (
            ("sphere", options.spheres, SPHERES),
            ("polyhedron", options.polyhedra, POLYHEDRA),
        ):
            chosen = [code for code in codes if code in scripts]
            if chosen:
                rows += compare_beds(shape, grains, [(code, scripts[code]) for code in chosen], options, folder)
        if "coal" in codes:
            rows += compare_pairs(options, folder)
    with open(options.csv, "w", newline="", encoding="utf-8") if options.csv else sys.stdout as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator=os.linesep)
        writer.writeheader()
        writer.writerows(rows)


def is_there(code, python):
    if code in PROGRAMS:
        there = shutil.which(code) is not None
    else:
        there = subprocess.run([python, "-c", f"import importlib.util as u; assert u.find_spec({code!r})"],
                               capture_output=True).returncode == 0  # fmt: skip
    if not there:
        print(f"{code}: not installed, left out", file=sys.stderr)
    return there


def compare_beds(shape, grains, scripts, options, folder):
    """Return the rows of one bed, ours first; a program that fails is reported and left out."""
    from benchmarks.beds import bed_settings, export_bed, prepare, settled_bed
    from benchmarks.measurement import measure
    from simcore import __version__
    from simcore.compilation import source_digest

    settings = bed_settings(shape, grains, options.faces)
    bed = settled_bed(settings, options.beds, lambda text: print(text, file=sys.stderr, flush=True))
    setup = prepare(settings)
    path = Path(folder) / f"{shape}.npz"
    export_bed(path, setup, bed, steps=round(options.duration / setup.scene.numerics.time_step))
    figures, _ = measure(setup, bed, options.duration)
    ours = figures | {"code": "Scree", "version": __version__, "digest": source_digest()}
    theirs = [answer for code, script in scripts if (answer := call(options.python, script, path, code))]
    rows = []
    for result in (ours, *theirs):
        cpu, contacts = result["cpu_us_per_grain_step"], result["contacts_per_grain"]
        per_contact = cpu / contacts if contacts else None
        rows.append(
            result
            | {
                "what": f"{shape}, per grain and step",
                "grains": grains,
                "cpu_us": cpu,
                "ratio": cpu / ours["cpu_us_per_grain_step"],
                "cpu_us_per_contact": per_contact,
                "ratio_per_contact": per_contact and per_contact / ours["cpu_us_per_contact_step"],
                "not_comparable": "; ".join(result.get("not_comparable", ())),
            }
        )
    return rows


def compare_pairs(options, folder):
    """Return the rows of cold and warm queries of touching pairs, ours first."""
    from benchmarks.speed.pairs import run
    from simcore import __version__

    path = Path(folder) / "pairs.npz"
    ours = run(export_to=path)
    ours |= {"version": __version__, "digest": ours["machine"]["digest"]}
    theirs = call(options.python, PAIRS["coal"], path, "coal")
    return [
        result
        | {
            "what": f"touching pair of 152-vertex hulls, {query} query",
            "cpu_us": result[f"{query}_us"],
            "ratio": result[f"{query}_us"] / ours[f"{query}_us"],
            "not_comparable": "; ".join(result.get("not_comparable", ())),
        }
        for query in ("cold", "warm")
        for result in filter(None, (ours, theirs))
    ]


def call(python, script, path, code):
    """Return the JSON that a script of benchmarks/speed/others prints; if it fails, print why and return None."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    environment.pop("PYTHONPATH", None)
    program = ["yade", "-n", "-x", "-j1", "-f1"] if code == "yade" else [python]
    done = subprocess.run([*program, OTHERS / script, path], capture_output=True, text=True, env=environment)
    if done.returncode:
        print(f"{code} failed:\n{done.stdout[-1000:]}{done.stderr[-2000:]}", file=sys.stderr)
        return None
    return json.loads(done.stdout.splitlines()[-1])


if __name__ == "__main__":
    main()

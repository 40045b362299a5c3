"""CPU time per grain and step in a dense shaken bed.

    python -m benchmarks.speed.throughput [--shape polyhedron] [--faces 300] [--grains 2000] [--threads 1] [--json FILE]

The contact time is 0.2 ms with 40 steps, restitution 0.1, friction 0.5 with tangential springs; the box is periodic,
and the bed is shaken as by default. The bed is poured once and stored (benchmarks/beds.py). The CPU time of all threads
counts, including new neighbour lists but not compilation. `--set group.key=value` overrides a setting; settings under
`numerics` do not change the bed.
"""

import argparse
import json
import os
import sys
from pathlib import Path

from simcore.paths import cache_folder


def parse(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shape", choices=["sphere", "ellipsoid", "polyhedron"], default="polyhedron")
    parser.add_argument("--faces", type=face_count, default=300, help='faces of polyhedra: a number, or "original"')
    parser.add_argument("--grains", type=int, default=2000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--duration", type=float, default=0.1, help="simulated time measured [s]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--set", action="append", default=[], metavar="GROUP.KEY=VALUE", dest="assignments")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--beds", metavar="FOLDER", default=default_beds(), help="where beds are kept")
    return parser.parse_args(arguments)


def face_count(text):
    return text if text == "original" else int(text)


def default_beds():
    return str(cache_folder() / "beds")


def use_threads(threads):
    """Set the number of threads, by the environment if numba is not imported yet."""
    if "numba" in sys.modules:
        from simcore.compilation import set_threads

        set_threads(threads)
    else:
        os.environ["NUMBA_NUM_THREADS"] = str(threads)


def main(arguments=None):
    options = parse(arguments)
    use_threads(options.threads)
    result = run(options)
    print(line(result))
    if options.json:
        Path(options.json).write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


def run(options, least_solid_fraction=None):
    """Return the result (dict) that is written as JSON; `measurement` describes the figures."""
    from benchmarks.beds import bed_settings, prepare, read_overrides, settled_bed
    from benchmarks.measurement import (
        LEAST_SOLID_FRACTION,
        check_solid_fraction,
        compile_steps,
        machine,
        measure,
        measure_shares,
        solid_fraction,
    )
    from simcore.scene.specification import resolve

    overrides = read_overrides(options.assignments)
    settings = bed_settings(options.shape, options.grains, options.faces, options.seed, overrides)
    specification = resolve(settings)
    setup = prepare(settings)
    compiled = compile_steps(setup)
    bed = settled_bed(settings, options.beds, lambda text: print(text, file=sys.stderr, flush=True))
    figures, process = measure(setup, bed, options.duration)
    fraction = solid_fraction(setup, process, specification)
    least = LEAST_SOLID_FRACTION if least_solid_fraction is None else least_solid_fraction
    check_solid_fraction(settings["name"], fraction, least)
    shares = measure_shares(setup, bed, min(options.duration, 0.02))
    faces = [len(base.faces) for base in setup.bases]
    return {
        **figures,
        **compiled,
        "solid_fraction": fraction,
        "shares": shares,
        "shape": options.shape,
        "faces": max(faces) if max(faces) else None,
        "grains": options.grains,
        "threads": options.threads,
        "duration": options.duration,
        "time_step": setup.scene.numerics.time_step,
        "overrides": overrides,
        "specification": specification,
        "machine": machine(),
    }


def line(result):
    """Return the result as one line of text."""
    shares = result["shares"]
    parts = ", ".join(f"{name} {share:.0%}" for name, share in shares.items())
    faces = f" of {result['faces']} faces" if result["faces"] else ""
    return (
        f"{result['grains']} {result['shape']} grains{faces}, {result['threads']} threads: "
        f"{result['cpu_us_per_grain_step']:.3f} µs CPU per grain and step "
        f"({result['cpu_us_least']:.3f} to {result['cpu_us_most']:.3f}), "
        f"{result['cpu_us_per_contact_step'] or 0:.3f} per contact; {result['contacts_per_grain']:.2f} contacts per "
        f"grain, {result['solid_fraction']:.3f} solid; "
        f"{'compiled' if result['compiled_anew'] else 'loaded'} in {result['compile_s']:.1f} s; shares: {parts}"
    )


if __name__ == "__main__":
    main()

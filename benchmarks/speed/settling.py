"""CPU time until a packing is finished, beside MuJoCo, with the porosity and the overlap of both.

    python -m benchmarks.speed.settling --python OTHERS/bin/python [--seeds 3] [--accuracies draft standard]
        [--csv FILE]

600 pebbles (U1) are packed in a cylinder, because MuJoCo has no periodic box. MuJoCo drops all of them from one lattice
and lets them come to rest; they have the 300 faces of the preset `r22`. Our code packs them with each preset of
--accuracies and its number of faces, and once more without shaking. Porosity and overlap of both are evaluated by our
code, with MuJoCo's grains in their final poses. OTHERS is that of benchmarks.speed.compare.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.progress import print_progress

os.environ["NUMBA_NUM_THREADS"] = "1"

SCRIPT = Path(__file__).parent / "others" / "mujoco_settling.py"
COLUMNS = (
    "code", "version", "settings", "seed", "grains", "faces", "cpu_s", "simulated_s", "n", "n_std_error",
    "coordination", "mean_overlap_m", "max_overlap_m", "max_speed_m_s", "digest",
)  # fmt: skip


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", help="interpreter of an environment with mujoco; without it, only our code runs")
    parser.add_argument("--grains", type=int, default=600)
    parser.add_argument("--width", default="60 mm", help="diameter of the cylinder")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--accuracies", nargs="*", default=["draft", "standard"])
    parser.add_argument("--csv", metavar="FILE", help="otherwise printed")
    options = parser.parse_args(arguments)
    with open(options.csv, "w", newline="", encoding="utf-8") if options.csv else sys.stdout as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator=os.linesep)
        writer.writeheader()
        for row in rows(options):
            writer.writerow(row)
            file.flush()


def rows(options):
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        for accuracy in options.accuracies:
            for change in ({}, {"shaking": {"amplitude": "0 m", "duration": "0 s"}}):
                yield ours(options, seed, accuracy, change)
        if options.python:
            yield theirs(options, seed)


def prepared(options, seed, accuracy, change):
    """Return the setup and the specification of the bed with this preset and these changes."""
    from simcore.campaign.studies import merge
    from simcore.grains.sources import load_grains
    from simcore.scene.setup import set_up
    from simcore.scene.specification import resolve

    settings = {
        "name": f"{accuracy}-{seed}",
        "seed": seed,
        "accuracy": accuracy,
        "domain": {"type": "cylinder", "width": options.width, "height": "0.6 m"},
        "shapes": {"kind": "polyhedron", "choice": "random"},
        "sizes": {"case": "U1"},
        "amount": {"grains": options.grains},
        "numerics": {"progress_interval": "30 s"},
    }
    specification = resolve(merge(settings, change))
    return set_up(specification, load_grains), specification


def ours(options, seed, accuracy, change):
    from benchmarks.measurement import compile_steps
    from simcore import __version__
    from simcore.packing.process import pack

    setup, specification = prepared(options, seed, accuracy, change)
    compile_steps(setup)
    began = time.process_time()
    packed = pack(setup.scene, setup.bases, setup.draw, print_progress)
    cpu = time.process_time() - began
    return figures(setup, specification, packed, options, seed) | {
        "code": "Scree",
        "version": __version__,
        "settings": accuracy + (", not shaken" if change else ""),
        "cpu_s": cpu,
        "simulated_s": packed.time,
    }


def theirs(options, seed):
    """Return the row of MuJoCo's bed of the grains of the preset `r22`, evaluated by our code."""
    import numpy as np

    from benchmarks.beds import Bed, export_bed, start
    from simcore.packing.packed import Packed
    from simcore.scene.domain import lattice_sites

    setup, specification = prepared(options, seed, "r22", {})
    drawn = setup.draw(np.arange(options.grains))
    spacing = setup.scene.generation.spacing
    sites = lattice_sites(setup.scene.domain, spacing, spacing, 100.0 * setup.scene.domain.height)[: options.grains]
    upright, still = np.tile([1.0, 0.0, 0.0, 0.0], (options.grains, 1)), np.zeros((options.grains, 3))
    falling = still + [0.0, 0.0, setup.scene.generation.velocity_z]
    bed = Bed(drawn.shape, drawn.scale, drawn.sieve_size, sites, upright, falling, still)
    with tempfile.TemporaryDirectory() as folder:
        grains, poses = Path(folder) / "grains.npz", Path(folder) / "poses.npz"
        export_bed(grains, setup, bed, steps=0)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        environment.pop("PYTHONPATH", None)
        done = subprocess.run(
            [options.python, SCRIPT, grains, poses], stdout=subprocess.PIPE, text=True, env=environment, check=True
        )
        result = json.loads(done.stdout.splitlines()[-1])
        with np.load(poses) as file:
            bed = bed._replace(position=file["position"], orientation=file["orientation"], velocity=still)
    process = start(setup, bed)
    process.evaluate()
    from simcore.packing.observation import observe

    observed = observe(process.bodies, process.candidates)
    packed = Packed(process.bodies, process.candidates, observed, result["steps"], result["simulated_s"], 0.0, [])
    return figures(setup, specification, packed, options, seed) | result | {"max_speed_m_s": result["max_speed"]}


def figures(setup, specification, packed, options, seed):
    """Return the figures by which both programs are compared."""
    from simcore.evaluation.coordination import coordination_number
    from simcore.evaluation.porosity import bulk_porosity
    from simcore.packing.file import code_version, packing_dataset
    from simcore.packing.observation import observe

    sample = setup.sample(range(options.grains))
    packing = packing_dataset(
        setup.scene, setup.bases, packed, sample, specification, largest_sieve_size=setup.curve.largest
    )
    bulk = bulk_porosity(packing, method="exact")
    observed = observe(packed.bodies, packed.candidates)
    return {
        "seed": seed,
        "grains": options.grains,
        "faces": specification["faces"],
        "n": float(bulk.n),
        "n_std_error": float(bulk.n_std_error),
        "coordination": float(coordination_number(packing).coordination_number),
        "mean_overlap_m": observed.mean_overlap,
        "max_overlap_m": observed.max_overlap,
        "max_speed_m_s": observed.max_speed,
        "digest": code_version(),
    }


if __name__ == "__main__":
    main()

"""Beds of campaigns that stopped with ten steps per contact time, packed with other numbers of steps.

    python -m benchmarks.studies.thrown_beds U5 --seed 2 3 --steps 10 11 > results/reference/thrown_beds.csv

SCENES has the five specifications: U7 of the form G26, 4 kg in a box of 0.1 m with patch contacts; a mixture of 1200
flat grains with point contacts; U5, 1.4 kg in a box of 70 mm, with point contacts; U7, 1.5 kg of grains of 50 faces in
a cylinder of 104 mm, with patch contacts; and B30, 3 kg of grains of 300 faces in the same cylinder (seed 2). It prints
one CSV row per packing: scene, seed, steps per contact time, number of expected steps, outcome (rest, or stopped with
the message), simulated time and CPU time. A packing takes from minutes (mixture, U5) to an hour (U7 in a box) of CPU
time.
"""

import argparse
import os
import sys
import time

os.environ.setdefault("NUMBA_NUM_THREADS", "1")

CAMPAIGN = {"accuracy": "standard", "generation": {"fill": "r22"}}
SCENES = {
    "U7": {
        **CAMPAIGN,
        "name": "U7",
        "faces": 300,
        "domain": {"width": "0.1 m", "height": "1 m"},
        "amount": {"mass": "4 kg"},
        "sizes": {"case": "U7"},
        "shapes": {"choice": "one", "grain": "G26"},
        "shaking": {"duration": "2 s"},
        "numerics": {"contact_time": "0.2 ms", "polyhedron_contact": "patch"},
    },
    "flat": {
        **CAMPAIGN,
        "name": "flat",
        "faces": 100,
        "domain": {"width": "63 mm", "height": "0.8 m"},
        "amount": {"grains": 1200},
        "sizes": {"case": "U1"},
        "shapes": {
            "choice": "form_distribution",
            "flatness": {"mean": 0.4, "std": 0.1},
            "elongation": {"mean": 0.8, "std": 0.1},
        },
        "convergence": {"max_unbalanced_force": 0.5},
        "numerics": {"contact_time": "0.5 ms", "polyhedron_contact": "point"},
    },
    "U5": {
        **CAMPAIGN,
        "name": "U5",
        "faces": 300,
        "domain": {"width": "70 mm", "height": "1 m"},
        "amount": {"mass": "1.4 kg"},
        "sizes": {"case": "U5"},
        "shaking": {"duration": "1 s"},
        "convergence": {"max_unbalanced_force": 0.5},
        "numerics": {"contact_time": "0.2 ms", "polyhedron_contact": "point"},
    },
    "cylinder": {
        **CAMPAIGN,
        "name": "cylinder",
        "faces": 50,
        "domain": {"type": "cylinder", "width": "0.104 m", "height": "1 m"},
        "amount": {"mass": "1.5 kg"},
        "sizes": {"case": "U7", "allow_few_top_grains": True},
        "shaking": {"duration": "2 s"},
        "numerics": {"contact_time": "0.2 ms", "polyhedron_contact": "patch"},
    },
    "B30": {
        **CAMPAIGN,
        "name": "B30",
        "faces": 300,
        "domain": {"type": "cylinder", "width": "0.104 m", "height": "1 m"},
        "amount": {"mass": "3 kg"},
        "sizes": {"case": "B30", "allow_few_top_grains": True},
        "shaking": {"duration": "1 s"},
        "numerics": {"contact_time": "0.2 ms", "polyhedron_contact": "patch"},
    },
}


def thrown_bed(scene, steps=10, seed=1, **changes):
    """Return the resolved specification of a scene of SCENES with these steps per contact time and other changes."""
    from simcore.campaign.studies import merge
    from simcore.scene.specification import resolve

    own = {"seed": seed, "numerics": {"steps_per_contact_time": steps, "progress_interval": "1000 s"}}
    return resolve(merge(SCENES[scene], own, changes))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("--seed", nargs="+", type=int, default=[1])
    parser.add_argument("--steps", nargs="+", type=int, default=[10])
    options = parser.parse_args()
    print("scene,seed,steps,expected,outcome,simulated_s,cpu_s,message", flush=True)
    for seed in options.seed:
        for steps in options.steps:
            print(",".join(_packed(options.scene, seed, steps)), flush=True)


def _packed(scene, seed, steps):
    """Return the row of a packing, as texts."""
    from simcore.grains.sources import load_grains
    from simcore.packing.packed import PackingError
    from simcore.packing.process import Process
    from simcore.scene.setup import set_up

    setup = set_up(thrown_bed(scene, steps, seed), load_grains)
    process, started = Process(setup.scene, setup.bases, setup.draw, lambda line: None), time.process_time()
    expected = process.expect().stability.expected
    outcome, message = "rest", ""
    try:
        process.run()
    except PackingError as error:
        outcome, message = "stopped", " ".join(str(error).replace('"', "'").split())
    cpu = time.process_time() - started
    simulated = f"{process.step * process.dt:.3f}"
    return scene, str(seed), str(steps), f"{expected:.1f}", outcome, simulated, f"{cpu:.0f}", f'"{message}"'


if __name__ == "__main__":
    sys.exit(main())

"""What each choice that departs from the study, or costs accuracy, does to porosity.

    python benchmarks/choices.py [--seeds 6] > results/reference/choices.csv

Packs 300 random pebbles of U1 in a periodic box with the settings of config/config.yaml, and again with one setting
changed at a time, over several seeds. One CSV row a packing; `summary` (python benchmarks/choices.py --summary FILE)
prints the mean difference of each choice to the reference with its standard error, seed by seed.
"""

import argparse
import os
import sys
import time

os.environ.setdefault("NUMBA_NUM_THREADS", "1")

REFERENCE = {
    "domain": {"width": "45 mm", "height": "0.4 m"},
    "shapes": {"kind": "mesh", "choice": "random"},
    "sizes": {"case": "U1"},
    "amount": {"grains": 300},
    "faces": 100,
    "shaking": {"duration": "1 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "1000 s"},
}
CHOICES = {
    "reference": {},
    "clamped end of contact": {"material": {"end_of_contact": "clamped"}},
    "born with random orientation": {"generation": {"orientation": "random"}},
    "born as in the study": {"generation": {"fill": "study"}},
    "ellipsoids": {"shapes": {"kind": "ellipsoid"}},
    "300 faces": {"faces": 300},
    "contact time 0.5 ms": {"numerics": {"contact_time": "0.5 ms"}},
    "80 steps a contact time": {"numerics": {"steps_per_contact_time": 80}},
    "shaking 3 s": {"shaking": {"duration": "3 s"}},
    # The point hops between facets, so that the gate of the patch is never reached.
    "deepest point alone": {
        "numerics": {"contact_region": "point"},
        "convergence": {"max_unbalanced_force": 0.2},
    },
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--only", nargs="+", choices=CHOICES, default=list(CHOICES), metavar="CHOICE")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--summary", metavar="FILE")
    options = parser.parse_args()
    if options.summary:
        summarise(options.summary)
        return
    from simcore.packing_io import code_version

    code_version()  # what is loaded now is what runs
    print("choice,seed,n,n_std_error,n_exact,coordination,cpu_s,code_version")
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        for choice in options.only:
            print(measure(choice, CHOICES[choice], seed), flush=True)


def measure(choice, settings, seed):
    from simcore.coordination import coordination_number
    from simcore.dem.packing import pack
    from simcore.packing_io import code_version, packing_dataset
    from simcore.porosity import bulk_porosity
    from simcore.scenes import set_up
    from simcore.sources import load_grains
    from simcore.specification import resolve
    from simcore.studies import merge

    specification = resolve(merge(REFERENCE, settings, {"name": "choice", "seed": seed}))
    setup = set_up(specification, load_grains)
    started = time.process_time()
    packed = pack(setup.scene, setup.bases, setup.draw, lambda line: print(choice, line, file=sys.stderr))
    cpu = time.process_time() - started
    sample = setup.sample(range(len(packed.bodies.mass)))
    packing = packing_dataset(
        setup.scene, setup.bases, packed, sample, specification, largest_sieve_size=setup.curve.largest
    )
    bulk, exact = bulk_porosity(packing), bulk_porosity(packing, method="exact")
    coordination = float(coordination_number(packing).coordination_number)
    return (
        f"{choice},{seed},{float(bulk.n):.5f},{float(bulk.n_std_error):.5f},{float(exact.n):.5f},{coordination:.3f},"
        f"{cpu:.1f},{code_version()}"
    )


def summarise(path):
    import pandas as pd

    runs = pd.read_csv(path).set_index(["choice", "seed"])
    reference = runs.loc["reference"]
    print(f"reference: n = {reference.n.mean():.4f}, scatter over {len(reference)} seeds {reference.n.std():.4f}")
    for choice in runs.index.unique("choice"):
        change = runs.loc[choice].n - reference.n
        error = change.std() / len(change) ** 0.5
        print(f"{choice:32s} {change.mean():+.4f} ± {error:.4f}   {runs.loc[choice].cpu_s.mean():6.0f} s")


if __name__ == "__main__":
    main()

"""Compare the bits of packings on any threads and ranks, and after any stop: a matrix of scenes and ways to run them.

    python -m benchmarks.correctness.equality [--large] [--scenes NAME ...] [--runs NAME ...] [--folder FOLDER]

Each run packs all scenes, either without a stop or stopped and resumed. Its files are compared with those of one rank
and one thread. The exit status is 1 if a bit differs. With --large, 700 to 4000 grains are packed until they rest; a
scene of polyhedra then takes a minute per run.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from simcore.dem.ranks.one_rank import ONE_RANK
from simcore.packing.file import differences, packing_dataset, read_packing, write_packing
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

# These beds need not come to rest: the comparison requires contacts of all ages, and grains that cross borders.
SMALL = {
    "domain": {"width": "26 mm", "height": "0.12 m"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0]},
    "amount": {"grains": 40},
    "generation": {"fill": "bed"},
    "shaking": {"duration": "50 ms"},
    "convergence": {"max_speed": "1 m/s", "max_unbalanced_force": 10, "height_change": "1 cm"},
    "numerics": {"contact_time": "4 ms"},
}
LARGE = {
    "domain": {"width": "70 mm", "height": "0.3 m"},
    "sizes": {"case": "U3"},
    "amount": {"grains": 1000},
    "generation": {"fill": "bed"},
    "shaking": {"duration": "0.3 s"},
    "accuracy": "draft",
}
CYLINDER = {"domain": {"type": "cylinder", "width": "32 mm", "height": "0.15 m"}}
MANY = {
    "sizes": {
        "bounds": ["4 mm", "5.6 mm", "8 mm", "11.2 mm"],
        "mass_fractions": [0.3, 0.3, 0.4],
        "allow_few_top_grains": True,
    }
}
SCENES = {
    "spheres": {"shapes": {"kind": "sphere"}, **MANY, "numerics": {"dashpot": "implicit"}},
    "ellipsoids_cylinder": {"shapes": {"kind": "ellipsoid"}, **CYLINDER, "numerics": {"dashpot": "implicit"}},
    "ellipsoids_potential": {
        "shapes": {"kind": "ellipsoid"},
        "numerics": {"ellipsoid_contact": "potential"},
        "material": {"friction_law": "preloaded"},
    },
    "polyhedra": {"shapes": {"kind": "polyhedron"}},
    "mixed": {"shapes": {"kind": "mixed", "ellipsoid_share": 0.5}},
    "filled": {
        "shapes": {"kind": "sphere"},
        "generation": {"placement": "filled", "orientation": "random"},
        **MANY,
        "sizes": {**MANY["sizes"], "draw": "quota"},
        "domain": {"height": "60 mm"},
    },
    "deposit": {
        "shapes": {"kind": "sphere"},
        "sizes": {"case": None, "bounds": None, "mass_fractions": None, "beta": {"radius": "3.4 mm", "spread": 0.4}},
        "numerics": {"dashpot": "explicit", "steps_per_contact_time": 40},
        "material": {"law": "hertz", "youngs_modulus": "0.5 MPa", "friction_law": "dynamic"},
        "generation": {"placement": "random", "batch_grains": 12, "drop_height": "4 mm"},
        "convergence": {"rule": "settled", "kinetic_energy": 1.0e-2, "compaction": 1.0e-2},
    },
}
LARGE_SCENES = {
    **SCENES,
    "spheres": {"shapes": {"kind": "sphere"}, "amount": {"grains": 4000}},
    "ellipsoids_cylinder": {"shapes": {"kind": "ellipsoid"}, "domain": {"type": "cylinder"}, "amount": {"grains": 700}},
    "polyhedra_cylinder": {"shapes": {"kind": "polyhedron"}, "domain": {"type": "cylinder"}, "amount": {"grains": 700}},
}


class Run(NamedTuple):
    """How a packing is run. layout: (columns, rows) of the blocks of the ranks.

    If `stop` is not 0, the packing is stopped after about this share of its steps and resumed as RUNS[then].
    """

    ranks: int = 1
    threads: int = 1
    layout: tuple | None = None
    stop: float = 0.0
    then: str = ""
    disturbed: bool = False


RUNS = {
    "one": Run(),
    "threads_2": Run(threads=2),
    "ranks_1": Run(layout=(1, 1)),
    "ranks_2": Run(2),
    "ranks_2_rows": Run(2, layout=(1, 2)),
    "ranks_3": Run(3),
    "ranks_4": Run(4),
    "ranks_4_columns": Run(4, layout=(4, 1)),
    "stopped_1_then_2": Run(stop=0.5, then="ranks_2"),
    "stopped_2_then_1": Run(2, stop=0.7, then="one"),
    "stopped_3_then_2_rows": Run(3, stop=0.3, then="ranks_2_rows"),
}
RESUMED = "resumes from step"
DISTURBED = Run(2, disturbed=True)  # the control, which must not give the same bits


def specification(name, large):
    from simcore.campaign.studies import merge

    return resolve(
        merge(LARGE if large else SMALL, (LARGE_SCENES if large else SCENES)[name], {"name": name, "seed": 5})
    )


def load_grains(group):
    """Return six hulls of random points on ellipsoids as grains, without a file; `group` has no effect."""
    from simcore.grains.mesh import make_grain

    rng = np.random.default_rng(11)
    directions = rng.normal(size=(6, 60, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    return [make_grain(f"g{k}", 1e-3 * points * [2.0, 2.4 + 0.3 * k, 4.0]) for k, points in enumerate(directions)]


def make(name: str, folder: Path, scenes, large=False, timeout=None) -> None:
    """Make RUNS[name] and write folder / scene.nc.

    RuntimeError if the command fails, or if a scene is not stopped and resumed as the run says.
    """
    run = RUNS[name]
    launch(run, folder, scenes, large, timeout)
    if run.stop:
        if written := sorted(path.name for path in folder.glob("*.nc")):
            raise RuntimeError(f"{name}: {', '.join(written)} are written, although the run should have been stopped")
        said = launch(RUNS[run.then], folder, scenes, large, timeout)
        if said.count(RESUMED) != len(scenes):
            raise RuntimeError(f"{name}: {said.count(RESUMED)} of {len(scenes)} scenes were resumed from a checkpoint")


def launch(run: Run, folder: Path, scenes, large=False, timeout=None) -> str:
    """Run all scenes in one command and return what it prints; RuntimeError if the command fails."""
    folder.mkdir(parents=True, exist_ok=True)
    command = [
        sys.executable,
        "-m",
        "benchmarks.correctness.equality",
        "--work",
        repr(run._asdict()),
        "--folder",
        str(folder),
    ]
    command += ["--scenes", *scenes] + (["--large"] if large else [])
    if run.ranks > 1 or run.layout is not None:
        command = [str(Path(sys.executable).with_name("mpiexec")), "-n", str(run.ranks), *command]
    environment = {**os.environ, "NUMBA_NUM_THREADS": str(run.threads)}
    done = subprocess.run(
        command,
        cwd=Path(__file__).parents[2],
        env=environment,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
    if done.returncode != 0:
        raise RuntimeError(f"{run}: status {done.returncode}\n{done.stderr[-2000:]}")
    return done.stdout


def work(run: Run, ranks, folder: Path, scenes, large) -> None:
    """Pack all scenes; every rank calls this, and rank 0 writes the files."""
    from simcore.compilation import set_threads
    from simcore.packing.checkpoints.keeper import CheckpointKeeper
    from simcore.packing.checkpoints.key import checkpoint_code, packing_key
    from simcore.packing.packed import Interrupted
    from simcore.packing.process import pack

    set_threads(run.threads)
    report = print if ranks.rank == 0 else lambda line: None
    if run.disturbed:
        disturb(ranks.rank)
    for name in scenes:
        spec = specification(name, large)
        setup = set_up(spec, load_grains)
        keeper = CheckpointKeeper(
            folder.parent / "checkpoints", packing_key(spec, setup), checkpoint_code(), np.inf, print, ranks
        )
        if run.stop:
            keeper.wish = stop_at(folder.parent / "one" / f"{name}.nc", run.stop)
        try:
            packed = pack(setup.scene, setup.bases, setup.draw, report, ranks, keeper)
        except Interrupted:
            keeper.close()
            continue
        if ranks.rank == 0:
            sample = setup.sample(np.arange(len(packed.bodies.mass)))
            packing = packing_dataset(setup.scene, setup.bases, packed, sample, spec)
            write_packing(folder / f"{name}.nc", packing)
        keeper.done()


def stop_at(path, share):
    """Return a function of the step that requests a stop after this share of the steps of the packing at `path`."""
    from simcore.packing.keeping import KEEP_AND_STOP

    last = share * read_packing(path).attrs["steps"]
    return lambda step: KEEP_AND_STOP if step >= last else 0


def disturb(rank):
    """Make all ranks except rank 0 add contacts in the opposite order, which changes the bits of the sums."""
    from simcore.dem.state import contacts as neighbors

    straight = neighbors.list_incident

    def reversed_(*keys):
        start, incident = straight(*keys)
        for low, high in zip(start[:-1], start[1:], strict=True):
            incident[low:high] = incident[low:high][::-1].copy()
        return start, incident

    if rank > 0:
        neighbors.list_incident = reversed_


def compare(folder: Path, runs: list, scenes, large=False, say=print) -> dict:
    """Make the runs of these names; return {(run, scene): list of differences from the first one}.

    say: a function that prints.
    """
    results = {}
    for number, name in enumerate(runs):
        make(name, folder / name, scenes, large)
        if number == 0:
            reference = {scene: read_packing(folder / name / f"{scene}.nc") for scene in scenes}
            continue
        for scene in scenes:
            results[name, scene] = differences(reference[scene], read_packing(folder / name / f"{scene}.nc"))
            say(f"{name:24s} {scene:20s} {'; '.join(results[name, scene]) or 'the same bits'}")
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--scenes", nargs="+", choices=LARGE_SCENES, metavar="SCENE")
    parser.add_argument("--runs", nargs="+", choices=RUNS, metavar="RUN")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--work", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.runs == ["one"]:
        parser.error("argument --runs: `one` is what others are compared with; name another run")
    scenes = options.scenes or list(LARGE_SCENES if options.large else SCENES)
    if options.work:
        import ast

        run = Run(**ast.literal_eval(options.work))
        ranks = ONE_RANK
        if run.ranks > 1 or run.layout is not None:
            from simcore.dem.ranks.many_ranks import ManyRanks

            ranks = ManyRanks(layout=run.layout)
        with ranks.together():
            work(run, ranks, options.folder, scenes, options.large)
        return 0
    runs = list(dict.fromkeys(["one", *(options.runs or RUNS)]))
    with tempfile.TemporaryDirectory() as scratch:
        results = compare(options.folder or Path(scratch), runs, scenes, options.large)
    return int(any(results.values()))


if __name__ == "__main__":
    sys.exit(main())

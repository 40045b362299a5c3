"""Kill a small packing at random moments, and compare the result after a restart with an undisturbed run.

    python -m benchmarks.correctness.faults --runs 50 --seed 1

Each run starts `python -m simcore launch` on two ranks, with checkpoints. One of FAULTS then disturbs it, at a moment
that is drawn over the time of the undisturbed run. The requirements are: the run ends within --patience; it has
finished, or it reports the reason in one line and leaves no incomplete file under the final name; none of its processes
stays alive; and, started again, it ends with the bits of the undisturbed run, in all variables and attributes except
NOT_COMPARED. A table with one line per run is printed, and the exit status is 1 if any run failed. --program runs
another program with the same command line instead of simcore, and --specification another packing; both with absolute
paths (tests/packing/stand_in.py).
"""

import argparse
import collections
import os
import random
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import netCDF4
import numpy as np
import psutil
import yaml

from simcore.packing.launch import INTERRUPTED, MARK

ROOT = Path(__file__).resolve().parents[2]
PACKING = {
    "name": "faults",
    "domain": {"width": "42 mm", "height": "0.3 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["7 mm", "7.001 mm"], "mass_fractions": [1]},
    "amount": {"grains": 60},
    "shaking": {"duration": "0.4 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "0.5 s"},
}
LINE = "{:>3}  {:16}  {:>6}  {:>5} {:>5}  {:>4}  {:>5} {:>5}  {}  | {:.100}"
# Maximum time until the first step [s], with and without compilation.
COMPILING, STARTING = 600.0, 30.0
# Attributes of the run, which do not describe the packing.
NOT_COMPARED = {"cpu_seconds", "wall_seconds", "threads", "ranks"}


class Ended(NamedTuple):
    """How a run ended."""

    status: int | None  # None: it did not end in time and was killed
    seconds: float
    line: str  # last message of simcore
    traceback: bool


class Bench:
    """A folder for one run, with methods that start it there."""

    def __init__(self, folder, options):
        self.folder, self.options = folder, options
        self.output = folder / "bed.nc"
        self.checkpoints = folder / "checkpoints"
        self.starts = 0
        folder.mkdir()

    def launch(self, output=None, startup=STARTING):
        options = self.options
        command = [*options.program, "launch", options.specification, output or self.output, "--force"]
        command += ["--ranks", options.ranks]
        command += ["--silence", f"{options.silence:g} s", "--startup", f"{startup:g} s", "--grace", "2 s"]
        command += ["--checkpoints", self.checkpoints, "--checkpoint-interval", "0.5 s"]
        return self._start(command, self.folder)

    def snakemake(self):
        """Start a campaign of this one packing and return its process; the messages of simcore are in its log."""
        for name in ("Snakefile", "workflow", "config", "profiles"):
            if not (self.folder / name).exists():
                (self.folder / name).symlink_to(ROOT / name)
        shipped = yaml.safe_load((ROOT / "config" / "config.yaml").read_text())["studies"]
        shipped |= yaml.safe_load((ROOT / "config" / "work_precision.yaml").read_text()).get("studies", {})
        settings = {key: value for key, value in PACKING.items() if key != "name"}
        studies = {**dict.fromkeys(shipped), "faults": {"fixes": settings}}
        # With the preset of the shipped campaign it would be another packing.
        campaign = {"packing": {"accuracy": None}, "studies": studies}
        campaign |= {"ranks": self.options.ranks, "grains_per_rank": 10}
        (self.folder / "campaign.yaml").write_text(yaml.safe_dump(campaign))
        target = "results/packings/faults/faults.nc"
        self.output = self.folder / target
        self.checkpoints = self.folder / "results" / "checkpoints"
        command = [sys.executable, "-m", "snakemake", "--cores", "2", "--nolock", "--nocolor", target]
        return self._start([*command, "--configfile", "campaign.yaml"], self.folder)

    def _start(self, command, folder):
        environment = {
            **os.environ,
            "PYTHONPATH": str(ROOT),
            "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        }
        self.starts += 1
        with self.log_path().open("w") as output:
            return subprocess.Popen(
                [str(word) for word in command], cwd=folder, env=environment, stdout=output, stderr=subprocess.STDOUT
            )

    def finish(self, process, started):
        """Wait for a started process, which is killed after --patience, and return how it Ended."""
        try:
            status = process.wait(max(started + self.options.patience - time.monotonic(), 1.0))
        except subprocess.TimeoutExpired:
            status = None
            for member in [psutil.Process(process.pid), *family(process)]:
                try:
                    member.kill()
                except psutil.Error:
                    pass
            process.wait()
        text = self.log_path().read_text()
        lines = [line for line in text.splitlines() if line.startswith(("scree", "simcore")) or "interrupted" in line]
        return Ended(status, time.monotonic() - started, lines[-1] if lines else "", "Traceback" in text)

    def log_path(self):
        """Return the path of the output of the run that was started last."""
        return self.folder / f"log_{self.starts}.txt"

    def kept(self):
        """Return the number of checkpoint files."""
        return sum(path.is_file() for path in self.checkpoints.rglob("*")) if self.checkpoints.exists() else 0


def family(process):
    """Return all living processes of a run: descendants of the started one, and all others with their marks."""
    try:
        below = psutil.Process(process.pid).children(recursive=True)
    except psutil.Error:
        return []
    marks = {mark_of(member) for member in below} - {None}
    return below + [member for member in psutil.process_iter() if member not in below and mark_of(member) in marks]


def mark_of(process):
    """Return the mark of a living process of a run, None if it has none or cannot be read."""
    try:
        return process.environ().get(MARK)
    except (psutil.Error, OSError):
        return None


def ranks_of(process):
    """Return the ranks of a started run by process id: marked processes that run Python."""
    ranks = []
    for member in family(process):
        try:
            if mark_of(member) and Path(member.exe()).name.startswith("python"):
                ranks.append(member)
        except (psutil.Error, OSError):
            pass
    return sorted(ranks, key=lambda member: member.pid)


def wait_for_ranks(process, number):
    """Wait until the run has this number of ranks and return them; an empty list if the run ends before."""
    while process.poll() is None:
        if len(ranks := ranks_of(process)) >= number:
            return ranks
        time.sleep(0.02)
    return []


def one_rank(process, rng, options):
    ranks = wait_for_ranks(process, options.ranks)
    return [rng.choice(ranks)] if ranks else []


def kill_one(process, rng, options):
    for member in one_rank(process, rng, options):
        member.kill()


def kill_all(process, rng, options):
    for member in wait_for_ranks(process, options.ranks):
        member.kill()


def kill_started(process, rng, options):
    process.kill()


def interrupt(process, rng, options):
    if wait_for_ranks(process, options.ranks):
        process.send_signal(rng.choice([signal.SIGTERM, signal.SIGINT]))


def stop_one(process, rng, options):
    for member in one_rank(process, rng, options):
        member.suspend()


def fill_disk(process, rng, options):
    """Limit the size of the files of each rank from now on, to fewer bytes than a packing has."""
    limit = rng.randrange(1, 4000)
    for member in wait_for_ranks(process, options.ranks):
        resource.prlimit(member.pid, resource.RLIMIT_FSIZE, (limit, limit))


def nothing(process, rng, options):
    pass


# The function, and whether the run may end without a message: a process prints nothing after its own SIGKILL.
FAULTS = {
    "one rank killed": (kill_one, False),
    "all ranks killed": (kill_all, False),
    "one rank stopped": (stop_one, False),
    "launcher killed": (kill_started, True),
    "interrupted": (interrupt, False),
    "disk full": (fill_disk, False),
    "output path bad": (nothing, False),
    "snakemake killed": (kill_started, True),
}


def run(fault, moment, rng, bench, reference):
    """Make one run with one fault; return a dict of observations, in which "wrong" lists the violated requirements."""
    act, silent = FAULTS[fault]
    start = bench.snakemake if fault == "snakemake killed" else bench.launch
    wrong = []
    started = time.monotonic()
    if fault == "output path bad":
        (bench.folder / "file").touch()
        process = bench.launch(bench.folder / "file" / "bed.nc")
    else:
        process = start()
    relatives = []
    while time.monotonic() < started + moment and process.poll() is None:
        time.sleep(0.01)
    try:
        if process.poll() is None:
            relatives = family(process)
            act(process, rng, bench.options)
            relatives = list({*relatives, *family(process)})
    except psutil.NoSuchProcess:
        pass  # the run ended at this very moment
    first = bench.finish(process, started)
    finished = first.status == 0
    if first.status is None:
        wrong.append("hang")
    # A rank may be killed after it wrote the file, which is then complete.
    if bench.output.exists() and differing(contents(bench.output), reference, fault == "snakemake killed"):
        wrong.append("half a file")
    if not finished and not silent and not first.line:
        wrong.append("no line that says why")
    if first.traceback:
        wrong.append("traceback")
    if fault == "interrupted" and first.status not in (0, INTERRUPTED):
        wrong.append(f"status {first.status} instead of {INTERRUPTED}")
    # A packing whose Snakemake was killed may write a last checkpoint.
    _, alive = psutil.wait_procs(relatives, timeout=30.0)
    alive = [member for member in alive if member.is_running() and member.status() != psutil.STATUS_ZOMBIE]
    if alive:
        wrong.append(f"{len(alive)} processes live on")
        for member in alive:
            member.kill()
    kept, again = bench.kept(), None
    if not finished:
        began = time.monotonic()
        again = bench.finish(start(), began)
        if again.status != 0:
            wrong.append(f"run again: status {again.status}: {again.line}")
    if not bench.output.exists():
        wrong.append("no file")
    elif differences := differing(contents(bench.output), reference, fault == "snakemake killed"):
        wrong.append(f"differs in {', '.join(differences)}")
    return {"first": first, "kept": kept, "again": again, "wrong": wrong}


def contents(path):
    """Return variables as (dimensions, shape, type, bytes), and attributes, of a netCDF file; empty if it is none."""
    try:
        opened = netCDF4.Dataset(path)
    except OSError:
        return {}
    with opened as file:
        file.set_auto_maskandscale(False)
        entries = {}
        for name, variable in file.variables.items():
            values = np.asarray(variable[:])
            content = repr(values.tolist()) if values.dtype == object else values.tobytes()
            entries[name] = (variable.dimensions, values.shape, str(values.dtype), content)
        return entries | {f":{name}": repr(file.getncattr(name)) for name in file.ncattrs() if name not in NOT_COMPARED}


def differing(actual, expected, by_campaign=False):
    """Return the names that differ. by_campaign: the text of the specification may differ; a campaign rewrites it."""
    names = {*actual, *expected} - ({":scene"} if by_campaign else set())
    return sorted(name for name in names if actual.get(name) != expected.get(name))


def parse(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--faults", nargs="+", choices=FAULTS, default=list(FAULTS), metavar="FAULT")
    parser.add_argument("--silence", type=float, default=5.0, help="of the watchdog [s]")
    parser.add_argument("--patience", type=float, default=300.0, help="a run that takes longer hangs [s]")
    parser.add_argument("--program", type=shlex.split, default=[sys.executable, "-m", "simcore"])
    parser.add_argument("--specification", type=Path, help="of the packing; Snakemake packs another one")
    parser.add_argument("--folder", type=Path, help="folder that keeps the runs; by default they are deleted")
    return parser.parse_args(arguments)


def main(arguments=None):
    options = parse(arguments)
    with tempfile.TemporaryDirectory(prefix="scree-faults-") as temporary:
        folder = options.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        if options.specification is None:
            options.specification = folder / "packing.yaml"
            options.specification.write_text(yaml.safe_dump(PACKING))
        options.specification = options.specification.resolve()
        return survive(options, folder.resolve())


def survive(options, folder):
    rng = random.Random(options.seed)
    lasted = []
    for name in ("compiling", "undisturbed", "once_more"):  # the last two give the time of a run
        bench = Bench(folder / name, options)
        started = time.monotonic()
        undisturbed = bench.finish(bench.launch(startup=COMPILING if name == "compiling" else STARTING), started)
        if undisturbed.status != 0:
            print(bench.log_path().read_text(), file=sys.stderr)
            print(f"the undisturbed run ended with status {undisturbed.status}", file=sys.stderr)
            return 1
        lasted.append(undisturbed.seconds)
    reference = contents(bench.output)
    seconds = min(lasted)
    print(f"undisturbed: {seconds:.1f} s on {options.ranks} ranks, {len(reference)} variables, attributes")
    print(LINE.format("run", "fault", "at [s]", "ended", "[s]", "kept", "again", "[s]", "outcome", "last message"))
    faults = (options.faults * (options.runs // len(options.faults) + 1))[: options.runs]
    rng.shuffle(faults)
    survived = collections.Counter()
    for number, fault in enumerate(faults):
        # Snakemake takes a while before it starts anything.
        moment = rng.uniform(0.0, seconds * (2.0 if fault == "snakemake killed" else 1.0))
        observed = run(fault, moment, rng, Bench(folder / f"{number:03d}", options), reference)
        first, again = observed["first"], observed["again"]
        outcome = "; ".join(observed["wrong"]) or "same bits"
        rerun = (again.status, f"{again.seconds:.1f}") if again else ("", "")
        shown = (f"{moment:.2f}", str(first.status), f"{first.seconds:.1f}", observed["kept"], *rerun)
        print(LINE.format(number, fault, *shown, outcome, first.line), flush=True)
        survived[fault] += not observed["wrong"]
    for fault, total in collections.Counter(faults).items():
        print(f"{fault:17} {survived[fault]} of {total}")
    print(f"{survived.total()} of {options.runs} survived")
    return 0 if survived.total() == options.runs else 1


if __name__ == "__main__":
    sys.exit(main())

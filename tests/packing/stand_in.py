"""A stand-in for `python -m simcore` that packs on ranks: the same interface, no physics and nothing to compile.

    python stand_in.py launch SPEC OUT --ranks N ...   as `python -m simcore launch`, with this file as the packing
    mpiexec -n N python stand_in.py pack SPEC OUT ...  the ranks

Each rank has its share of numbers that change from step to step. The ranks exchange values at each step and write
checkpoints. The result, a netCDF file, has the same bits on any number of ranks. SPEC is YAML:
{numbers: 64, steps: 300, step: 10 ms}. Rank i writes its process id into OUT.pid.i.
"""

import argparse
import io
import os
import signal
import sys
import time
from pathlib import Path

import netCDF4
import numpy as np
import yaml

from simcore.commands.launch import add_launch_options
from simcore.packing.heartbeat import beat
from simcore.packing.launch import launch_packing
from simcore.scene.quantity import parse_quantity


def main():
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers(dest="command", required=True)
    add_launch_options(commands.add_parser("launch"))
    packing = commands.add_parser("pack")
    packing.add_argument("specification", type=Path)
    packing.add_argument("output", type=Path)
    packing.add_argument("--threads")
    packing.add_argument("--checkpoints", type=Path)
    packing.add_argument("--checkpoint-interval", default="600 s")
    packing.add_argument("--force", action="store_true")
    packing.add_argument("--cut")
    options = parser.parse_args()
    try:
        if options.command == "launch":
            return launch_packing(options, [sys.executable, __file__])
        return pack(options)
    except (ValueError, OSError) as error:
        print(f"simcore stand-in: {error}", file=sys.stderr, flush=True)
        if "PMI_RANK" in os.environ:
            # The other ranks wait for this one, and a normal exit would wait for them in MPI_Finalize.
            os._exit(2)
        return 2


class Alone:
    """The methods of an MPI communicator that are used here, for one rank."""

    rank, size = 0, 1

    def allreduce(self, value, op=None):
        return value

    def allgather(self, value):
        return [value]


def communicator():
    if "PMI_RANK" not in os.environ:
        return Alone(), None
    from mpi4py import MPI

    return MPI.COMM_WORLD, MPI.MAX


def pack(options):
    comm, largest = communicator()
    asked = []
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda number, frame: asked.append(number))
    spec = yaml.safe_load(options.specification.read_text())
    pause, interval = parse_quantity(spec["step"], "s"), parse_quantity(options.checkpoint_interval, "s")
    options.output.with_name(f"{options.output.name}.pid.{comm.rank}").write_text(str(os.getpid()))
    checkpoint = options.checkpoints / "stand_in.npz" if options.checkpoints else None
    step, numbers = 0, np.random.default_rng(1).random(spec["numbers"])
    if checkpoint and checkpoint.exists():
        with np.load(checkpoint) as kept:
            step, numbers = int(kept["step"]), kept["numbers"]
        say(comm, f"going on from the checkpoint of step {step}")
    # All ranks have read before one writes.
    comm.allreduce(0, op=largest)
    written = time.monotonic()
    mine = numbers[comm.rank :: comm.size].copy()
    while step < spec["steps"]:
        time.sleep(pause)
        mine = 3.9 * mine * (1.0 - mine)
        step += 1
        stop = comm.allreduce(len(asked), op=largest)
        due = comm.allreduce(int(time.monotonic() - written > interval), op=largest)
        if comm.rank == 0:
            beat()
        if checkpoint and (stop or due):
            numbers = together(comm, mine, spec["numbers"])
            if comm.rank == 0:
                write_checkpoint(checkpoint, step, numbers)
            written = time.monotonic()
        if stop:
            say(comm, f"interrupted at step {step}, go on by running it again")
            return 75
    numbers = together(comm, mine, spec["numbers"])
    if comm.rank == 0:
        write_result(options.output, numbers)
        say(comm, f"wrote {options.output}")
    return 0


def together(comm, mine, n):
    numbers = np.empty(n)
    for rank, part in enumerate(comm.allgather(mine)):
        numbers[rank :: comm.size] = part
    return numbers


def write_checkpoint(path, step, numbers):
    content = io.BytesIO()
    np.savez(content, step=step, numbers=numbers)
    write(path, content.getvalue())


def write_result(path, numbers):
    # The file is made in memory first, because HDF5 has errors of its own on a full disk.
    file = netCDF4.Dataset("result", "w", memory=1)
    file.createDimension("number", len(numbers))
    file.createVariable("numbers", float, ("number",))[:] = numbers
    file.cpu_seconds = time.process_time()
    write(path, file.close())


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    try:
        part.write_bytes(content)
        os.replace(part, path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise OSError(f"{path} cannot be written ({error.strerror})") from None


def say(comm, line):
    if comm.rank == 0:
        print(f"simcore stand-in: {line}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())

"""`scree pack SPEC.yaml OUT.nc`: one packing."""

import contextlib
import os
import time
from pathlib import Path

from simcore.commands.options import check_writable, cut_length, duration, reporter

INTERRUPTED = 75  # EX_TEMPFAIL: the same command resumes the packing
INTERVAL = "10 min"  # wall-clock time between checkpoints


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "pack",
        help="run one packing",
        description="Pack the grains of a specification and write the packing as a netCDF file. If the packing fails, "
        "no file is written, and the message names the grain, the step and the setting to change.",
    )
    parser.add_argument("specification", type=Path, help="YAML file, see config/packing.schema.yaml")
    parser.add_argument("output", type=Path, help="netCDF file to write")
    parser.add_argument("--threads", type=int, default=1, help="number of threads; it does not change the result")
    parser.add_argument("--log", type=Path, help="file to which progress lines are also written")
    parser.add_argument("--checkpoints", type=Path, metavar="FOLDER", help="where to write checkpoints to resume from")
    parser.add_argument(
        "--checkpoint-interval", metavar="TIME", help=f"wall-clock time between checkpoints; default: {INTERVAL}"
    )
    parser.add_argument(
        "--frames", metavar="TIME", help='write a series for ParaView, a frame every TIME of simulated time: "0.1 s"'
    )
    parser.add_argument("--force", action="store_true", help="also pack a bed that is too low to evaluate its porosity")
    parser.add_argument("--cut", metavar="LENGTH", help='cut with which the height is checked: "8 mm"')
    parser.set_defaults(run=run)


def run(options) -> int:
    """Run one packing and return the exit status; under mpiexec or srun, as one of its ranks."""
    from simcore.dem.ranks.one_rank import ONE_RANK, started_by_mpi

    if not started_by_mpi(os.environ):
        return _pack_on(ONE_RANK, options)
    from simcore.dem.ranks.many_ranks import ManyRanks

    ranks = ManyRanks()
    with ranks.together():
        return _pack_on(ranks, options)


def _pack_on(ranks, options):
    """Run `pack` and return the exit status, equal on all ranks, since all ranks raise the errors caught here."""
    from simcore.packing.checkpoints.file import CheckpointError
    from simcore.packing.packed import Interrupted, PackingError
    from simcore.packing.process import pack

    started = time.monotonic()
    report = reporter(None) if ranks.rank == 0 else _ignore_line
    try:
        if options.log is not None:
            ranks.on_first(lambda: _check_log(options))
            report = ranks.on_first(lambda: reporter(options.log)) or report
        specification, setup, keeper, warned = _prepare(ranks, options, report)
    except (ValueError, OSError) as error:
        report(f"scree pack: {error}")
        return 2
    try:
        packed = pack(setup.scene, setup.bases, setup.draw, report, ranks, keeper)
        keeper.stepped()
        cpu_seconds = keeper.cpu_seconds()
        run = {
            "threads": options.threads,
            "ranks": ranks.size,
            "cpu_seconds": cpu_seconds,
            "wall_seconds": time.monotonic() - started,
        }
        ranks.on_first(lambda: _write(options.output, packed, specification, setup, warned, run))
        ranks.on_first(keeper.done)
    except PackingError as error:
        report(f"failed: {error}")
        return 1
    except Interrupted as error:
        report(str(error))
        return INTERRUPTED
    except (CheckpointError, OSError) as error:
        report(f"scree pack: {error}")
        return 2
    report(f"{setup.scene.name}: wrote {options.output} after {time.monotonic() - started:.0f} s")
    return 0


def _check_log(options):
    """Raise ValueError or OSError unless the log can be written; it is none of the other files of the packing."""
    from simcore.grains.sources import source_files
    from simcore.scene.specification import read_specification

    read = [options.specification]
    with contextlib.suppress(ValueError, OSError):  # a faulty specification has its message later
        read += source_files(read_specification(options.specification)["grains"])
    check_writable(options.log, *read, is_replaced=False)
    if options.log.resolve() == options.output.resolve():
        raise ValueError(f"--log: {options.log} is the file of the packing; give another path")


def _prepare(ranks, options, report):
    """Return specification, Setup, keeper and warnings; ValueError or OSError on all ranks if it cannot run."""
    from simcore.grains.sources import source_files
    from simcore.packing.checkpoints.keeper import CheckpointKeeper
    from simcore.packing.checkpoints.key import checkpoint_code, packing_key
    from simcore.packing.file import code_version
    from simcore.packing.single import prepare
    from simcore.packing.terminal import expect
    from simcore.scene.specification import read_specification

    code_version()
    code = checkpoint_code() if options.checkpoints else ""
    specification = read_specification(options.specification)
    expect(report, specification)
    if options.checkpoint_interval is not None and options.checkpoints is None:
        raise ValueError("--checkpoint-interval: it has no effect without --checkpoints; give both")
    interval = duration("--checkpoint-interval", options.checkpoint_interval or INTERVAL)
    read = (options.specification, *source_files(specification["grains"]))
    ranks.on_first(lambda: check_writable(options.output, *read))
    setup, warned = prepare(specification, options.threads, options.force, cut_length(options.cut))
    for text in warned:
        report(f"{setup.scene.name}: warning: {text}")
    key = packing_key(specification, setup) if options.checkpoints else ""
    keeper = CheckpointKeeper(options.checkpoints, key, code, interval, report, ranks)
    if options.frames is not None:
        from simcore.export.frames import FramesKeeper

        frames = duration("--frames", options.frames)
        keeper = FramesKeeper(keeper, options.output, frames, setup, specification, report, ranks, key)
    return specification, setup, keeper, warned


def _write(output, packed, specification, setup, warned, run):
    """Write the file of a packing. warned: warnings before it ran. run: attributes that describe how it was run."""
    from simcore.packing.file import write_dataset
    from simcore.packing.heartbeat import beat
    from simcore.packing.single import dataset_of

    beat()
    packing = dataset_of(packed, specification, setup, warned, **run)
    beat()
    write_dataset(output, packing)


def _ignore_line(line):
    """Ignore the line: the report function of all ranks but the first."""

"""Command line: `python -m simcore explain SPEC.yaml`, `compile`, `pack SPEC.yaml OUT.nc`, `launch ...`,
`porosity OUT.nc`, `fabric OUT.nc ...` and `predict FORMS.csv`."""

import argparse
import math
import os
import signal
import sys
import time
from pathlib import Path

from simcore.commands import compare, export, plot, porosity, watch
from simcore.packing.launch import add_launch_options, launch_packing


def main(arguments=None) -> int:
    """Run a command and return its exit status: 0 success; 1 the packing failed; 2 wrong input, with one line on it.

    The status is 141, as in a shell, if the reader of the output closes it early, such as `| head`.
    """
    options = _parser().parse_args(arguments)
    # Numba reads its number of threads when it is imported, and the variable must not change afterwards.
    if getattr(options, "threads", None) and "numba" not in sys.modules:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(max(options.threads, 1)))
    try:
        status = options.run(options)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        # Otherwise Python reports an error at exit for the text that is still in the buffer.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except (ValueError, OSError) as error:
        print(f"simcore {options.command}: {error}", file=sys.stderr)
        return 2


def _parser():
    parser = argparse.ArgumentParser(prog="python -m simcore", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    explain = commands.add_parser("explain", help="print what a packing computes and costs, without running it")
    explain.add_argument("specification", type=Path, help="YAML file, see config/packing.schema.yaml")
    explain.set_defaults(run=_explain)
    pack = commands.add_parser("pack", help="run one packing")
    pack.add_argument("specification", type=Path, help="YAML file, see config/packing.schema.yaml")
    pack.add_argument("output", type=Path, help="netCDF file to write")
    pack.add_argument("--threads", type=int, default=1, help="number of threads; it does not change the result")
    pack.add_argument("--log", type=Path, help="file to which progress lines are also written")
    pack.add_argument("--checkpoints", type=Path, metavar="FOLDER", help="where to write checkpoints to resume from")
    pack.add_argument(
        "--checkpoint-interval", default="10 min", metavar="TIME", help="wall-clock time between checkpoints"
    )
    pack.add_argument(
        "--frames", metavar="TIME", help='write a series for ParaView, a frame every TIME of simulated time: "0.1 s"'
    )
    pack.add_argument("--force", action="store_true", help="also pack a bed that is too low to evaluate its porosity")
    pack.set_defaults(run=_pack)
    compile_ = commands.add_parser("compile", help="compile the steps of packings ahead of time")
    compile_.add_argument(
        "specifications",
        type=Path,
        nargs="*",
        metavar="SPEC.yaml",
        help="specifications of packings; default: all packings of the campaign in config/config.yaml",
    )
    compile_.add_argument("--threads", type=int, default=1, help="threads of the packings: 1, or any larger number")
    compile_.set_defaults(run=_compile)
    launch = commands.add_parser("launch", help="run one packing on several ranks under a watchdog")
    add_launch_options(launch)
    launch.set_defaults(run=_launch)
    fabric = commands.add_parser(
        "fabric",
        help="density, contacts and directions in the bulk of a packing, or of several seeds with errors",
        description="Solid fraction, coordination, contact normals and axes of the bulk. For several packings of one "
        "scene: the mean over seeds with its standard error.",
    )
    fabric.add_argument("packings", type=Path, nargs="+", metavar="BED.nc", help="netCDF files of `pack`")
    fabric.add_argument("--cut", metavar="LENGTH", help='length left out at floor, surface and wall: "8 mm"')
    fabric.add_argument("--bearing-contacts", type=int, metavar="N", help="grains with fewer contacts are rattlers (2)")
    fabric.add_argument("--out", type=Path, metavar="FABRIC.nc", help="netCDF file for all results")
    fabric.set_defaults(run=_fabric)
    predict = commands.add_parser(
        "predict",
        help="porosity of a bed of measured grains, from our models and those of Rettinger et al. (2022)",
        description="Porosity of a bed of measured grains with its prediction interval, without packing them. The exit "
        "status is 2 if a sample is too far outside the range that the models were fitted to.",
    )
    predict.add_argument(
        "forms",
        type=Path,
        metavar="FORMS.csv",
        help="table as text or .xlsx. One row per grain: columns L, I, S or FL, EL, and optionally count, the number "
        "of such grains; or one row per sample: columns mean_FL, std_FL, mean_EL, std_EL",
    )
    predict.add_argument(
        "--case",
        required=True,
        help="sieve curve U1, U7, ..., or one-class: any single sieve class, with the model of U1",
    )
    predict.add_argument(
        "--sample", metavar="COLUMN", help='column with the name of the sample; default: "sample", if it exists'
    )
    predict.add_argument("--models", type=Path, metavar="FOLDER", help="folder results/models of your own campaign")
    predict.add_argument("--source", help="use only the committed packings of one form with grains of this source")
    predict.add_argument("--level", type=float, default=0.95, help="level of the prediction interval (0.95)")
    form = predict.add_mutually_exclusive_group()
    form.add_argument("--csv", action="store_const", dest="form", const="csv", help="one row per sample and model")
    form.add_argument("--json", action="store_const", dest="form", const="json")
    predict.set_defaults(run=_predict, form="text")
    for module in (porosity, export, plot, compare, watch):
        module.add(commands)
    return parser


def _explain(options):
    from simcore.grains.sources import load_grains
    from simcore.packing.explanation import explain
    from simcore.scene.setup import set_up
    from simcore.scene.specification import read_specification

    print(explain(set_up(read_specification(options.specification), load_grains)))
    return 0


def _pack(options):
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
    report = _reporter(options.log) if ranks.rank == 0 else _say_nothing
    try:
        specification, setup, keeper, warned = _prepare(ranks, options, report)
    except (ValueError, OSError) as error:
        report(f"simcore pack: {error}")
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
        return os.EX_TEMPFAIL
    except (CheckpointError, OSError) as error:
        report(f"simcore pack: {error}")
        return 2
    report(f"{setup.scene.name}: wrote {options.output} after {time.monotonic() - started:.0f} s")
    return 0


def _prepare(ranks, options, report):
    """Return specification, Setup, keeper and warnings; ValueError or OSError on all ranks if it cannot run."""
    from simcore.compilation import set_threads
    from simcore.dem.from_scene import compose
    from simcore.grains.sources import load_grains
    from simcore.packing.checkpoints.keeper import CheckpointKeeper
    from simcore.packing.checkpoints.key import checkpoint_code, packing_key
    from simcore.packing.file import code_version
    from simcore.packing.forecast_text import check_setup, setup_warnings
    from simcore.packing.terminal import expect
    from simcore.scene.quantity import parse_quantity
    from simcore.scene.setup import set_up
    from simcore.scene.specification import read_specification

    code_version()
    code = checkpoint_code() if options.checkpoints else ""
    specification = read_specification(options.specification)
    expect(report, specification)
    interval = parse_quantity(options.checkpoint_interval, "s")
    set_threads(options.threads)
    setup = set_up(specification, load_grains)
    compose(setup.scene)  # ValueError if its time step is too long for any bed
    if not options.force:
        check_setup(setup)
    ranks.on_first(lambda: _check_writable(options.output))
    warned = setup_warnings(setup, low_bed=not options.force)
    for text in warned:
        report(f"{setup.scene.name}: warning: {text}")
    key = packing_key(specification, setup) if options.checkpoints else ""
    keeper = CheckpointKeeper(options.checkpoints, key, code, interval, report, ranks)
    if options.frames is not None:
        from simcore.export.frames import FramesKeeper, read_interval

        keeper = FramesKeeper(
            keeper, options.output, read_interval(options.frames), setup, specification, report, ranks
        )
    return specification, setup, keeper, warned


def _write(output, packed, specification, setup, warned, run):
    """Write the file of a packing. warned: warnings before it ran. run: attributes that describe how it was run."""
    from simcore.packing.file import packing_dataset, write_packing
    from simcore.packing.heartbeat import beat

    beat()
    packing = packing_dataset(
        setup.scene,
        setup.bases,
        packed,
        setup.sample(range(len(packed.bodies.mass))),
        specification,
        setup.curve,
        largest_sieve_size=setup.curve.largest,
        warnings="\n".join([*warned, *packed.warnings]),
        **run,
    )
    beat()
    write_packing(output, packing)


def _say_nothing(line):
    """Ignore the line: the report function of all ranks but the first."""


def _compile(options):
    from simcore.compilation import set_threads
    from simcore.packing.compiling import compile_steps
    from simcore.provenance.cpu_time import compile_time
    from simcore.scene.specification import read_specification

    set_threads(options.threads)
    specifications = [read_specification(path) for path in options.specifications] or _campaign_specifications()
    count = compile_steps(specifications, _reporter(None))
    steps = "The step is" if count == 1 else f"The {count} steps are"
    print(f"{steps} compiled and stored on disk; compiling took {compile_time():.0f} s of CPU time.")
    return 0


def _campaign_specifications():
    from simcore.campaign.studies import expand
    from simcore.paths import CONFIG
    from simcore.scene.specification import read_specification

    return list(expand(read_specification(CONFIG / "config.yaml", "config")).specification)


def _launch(options):
    _check_writable(options.output)
    return launch_packing(options, [sys.executable, "-m", "simcore"])


def _fabric(options):
    from simcore.evaluation.coordination import BEARING_CONTACTS
    from simcore.evaluation.fabric import fabric, fabric_over_seeds
    from simcore.evaluation.fabric_text import fabric_text
    from simcore.packing.file import read_packing, write_packing

    cut = _length("--cut", options.cut)
    if options.out is not None:
        _check_writable(options.out)
    bearing = BEARING_CONTACTS if options.bearing_contacts is None else options.bearing_contacts
    fabrics = []
    for path in options.packings:
        packing = read_packing(path)
        try:
            fabrics.append(fabric(packing, cut, bearing))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    result = fabrics[0] if len(fabrics) == 1 else fabric_over_seeds(fabrics)
    if options.out is not None:
        write_packing(options.out, result)
    print(fabric_text(result))
    return 0


def _predict(options):
    from simcore.models.prediction_text import predict_file

    text = predict_file(
        options.forms,
        options.case,
        models=options.models,
        source=options.source,
        column=options.sample,
        level=options.level,
        form=options.form,
        notify=lambda notice: print(f"simcore predict: {notice}", file=sys.stderr),
    )
    print(text)
    return 0


def _length(option, text):
    """Return the length [m] of an option, given as a number of metres or as a quantity such as "8 mm"; None if absent.

    ValueError unless it is more than 0.
    """
    from simcore.scene.quantity import parse_quantity

    if text is None:
        return None
    try:
        metres = float(text)
    except ValueError:
        try:
            metres = parse_quantity(text, "m")
        except ValueError as error:
            raise ValueError(f"{option}: {error}") from None
    if not 0.0 < metres < math.inf:
        raise ValueError(f"{option}: {text!r} is not a length above 0; give one such as '8 mm'")
    return metres


def _check_writable(output):
    """Raise OSError if the output cannot be written, before any work is done."""
    probe = output.with_name(output.name + ".part")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise OSError(f"{output} cannot be written ({error.strerror}): {error.filename}; give another path") from None


def _reporter(log):
    """Return a function that shows a line, see simcore.packing.terminal."""
    from simcore.packing.terminal import reporter

    return reporter(log)


if __name__ == "__main__":
    sys.exit(main())

"""`scree compile [SPEC.yaml ...]`: the steps of packings, compiled ahead of time."""

from pathlib import Path

from simcore.commands.options import reporter


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "compile",
        help="compile the steps of packings ahead of time",
        description="Compile the time steps of packings, so that packings which start together do not compile the same "
        "step. Compiled code is stored in the folder that the variable SCREE_CACHE names, or in ~/.cache/scree.",
    )
    parser.add_argument(
        "specifications",
        type=Path,
        nargs="*",
        metavar="SPEC.yaml",
        help="specifications of packings; default: all packings of the campaign in config/config.yaml",
    )
    parser.add_argument("--threads", type=int, default=1, help="threads of the packings: 1, or any larger number")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Compile the steps, print how long it took, and return 0."""
    from simcore.compilation import set_threads
    from simcore.packing.compiling import compile_steps
    from simcore.provenance.cpu_time import compile_time
    from simcore.scene.specification import read_specification

    set_threads(options.threads)
    specifications = [read_specification(path) for path in options.specifications] or _campaign_specifications()
    count = compile_steps(specifications, reporter(None))
    steps = "The step is" if count == 1 else f"The {count} steps are"
    print(f"{steps} compiled and stored on disk; compiling took {compile_time():.0f} s of CPU time.")
    return 0


def _campaign_specifications():
    from simcore.campaign.studies import expand
    from simcore.paths import CONFIG
    from simcore.scene.specification import read_specification

    return list(expand(read_specification(CONFIG / "config.yaml", "config")).specification)

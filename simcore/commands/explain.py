"""`scree explain SPEC.yaml`: what a packing computes and costs, without running it."""

from pathlib import Path


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "explain",
        help="print what a packing computes and costs, without running it",
        description="Print the grains of a packing, the bed that it will have, the sampling error of its porosity, "
        "what its step computes and leaves out, its time and memory, and the margin of its time step. Nothing is "
        "packed.",
    )
    parser.add_argument("specification", type=Path, help="YAML file, see config/packing.schema.yaml")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the explanation and return 0."""
    from simcore.grains.sources import load_grains
    from simcore.packing.explanation import explain
    from simcore.scene.setup import set_up
    from simcore.scene.specification import read_specification

    print(explain(set_up(read_specification(options.specification), load_grains)))
    return 0

"""`scree compare A.nc B.nc ...`: packings side by side."""

from pathlib import Path

from simcore.commands.options import cut_length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "compare",
        help="porosity, contacts and sizes of packings side by side, and the settings in which they differ",
        description="Packings whose settings differ only in the seed form a group. Groups are compared with the first "
        "one, by pairs of equal seed where there are such pairs.",
    )
    parser.add_argument("packings", type=Path, nargs="+", metavar="BED.nc", help="two or more netCDF files of `pack`")
    parser.add_argument("--cut", metavar="LENGTH", help='length left out at both ends of each bed: "8 mm", or metres')
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the tables and return 0."""
    from simcore.evaluation.comparison import compare
    from simcore.evaluation.comparison_text import comparison_text
    from simcore.evaluation.porosity import warnings_of
    from simcore.packing.file import read_packing

    cut = cut_length(options.cut)
    paths = options.packings
    if len({path.resolve() for path in paths}) < len(paths):
        raise ValueError("the same file is given twice; give each file once")
    packings = {str(path): read_packing(path) for path in paths}
    warned = [f"{path}: warning: {line}" for path, packing in packings.items() for line in warnings_of(packing)]
    print("\n".join([comparison_text(compare(packings, cut)), *warned]))
    return 0

"""`scree plot BED.nc`: a figure of one packing."""

import sys
from pathlib import Path

from simcore.commands.options import check_figure, cut_length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "plot",
        help="draw a packing, its porosity over height, the sizes and the axes of its grains in one figure",
        description="Draw one figure of a packing: its grains, the porosity over height, the sieve sizes, and roses of "
        "the directions of the long axes.",
    )
    parser.add_argument("packing", type=Path, metavar="BED.nc", help="netCDF file of `pack`")
    parser.add_argument(
        "output", type=Path, nargs="?", metavar="OUT", help="figure to write, .png, .pdf or .svg; default: BED.png"
    )
    parser.add_argument("--cut", metavar="LENGTH", help='length left out at both ends of the bed: "8 mm", or metres')
    parser.set_defaults(run=run)


def run(options) -> int:
    """Write the figure, print its name and return 0."""
    from simcore.evaluation.porosity import bulk_porosity
    from simcore.packing.file import read_packing
    from simcore.report.figures.bed import bed_figure
    from simcore.report.figures.saving import save_figure

    output = options.packing.with_suffix(".png") if options.output is None else options.output
    cut = cut_length(options.cut)
    check_figure("the figure", output)
    packing = read_packing(options.packing)
    if not packing.sizes["grain"]:
        raise ValueError(f"{options.packing}: the packing contains no grain; check its amount and its log")
    try:
        bulk = bulk_porosity(packing, "exact", cut)
    except ValueError as error:
        # A bed that is too low to be evaluated can be seen all the same.
        print(f"scree plot: {options.packing}: without bulk porosity: {error}", file=sys.stderr)
        bulk = None
    save_figure(bed_figure(packing, bulk, packing.attrs.get("title", "")), output)
    print(f"wrote {output}")
    return 0

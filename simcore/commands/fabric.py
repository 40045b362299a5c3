"""`scree fabric BED.nc ...`: density, contacts and directions in the bulk of packings."""

from pathlib import Path

from simcore.commands.options import check_writable, cut_length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "fabric",
        help="density, contacts and directions in the bulk of a packing, or of several seeds with errors",
        description="Solid fraction, coordination, contact normals and axes of the bulk. For several packings of one "
        "scene: the mean over seeds with its standard error.",
    )
    parser.add_argument("packings", type=Path, nargs="+", metavar="BED.nc", help="netCDF files of `pack`")
    parser.add_argument("--cut", metavar="LENGTH", help='length left out at floor, surface and wall: "8 mm"')
    parser.add_argument("--bearing-contacts", type=int, metavar="N", help="grains with fewer contacts are rattlers (2)")
    parser.add_argument("--out", type=Path, metavar="FABRIC.nc", help="netCDF file for all results")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the fabric of one packing, or the mean of several, and return 0."""
    from simcore.evaluation.coordination import BEARING_CONTACTS
    from simcore.evaluation.fabric import fabric, fabric_over_seeds
    from simcore.evaluation.fabric_text import fabric_text
    from simcore.evaluation.porosity import check_physical, warnings_of
    from simcore.packing.file import read_packing, write_dataset

    cut = cut_length(options.cut)
    if options.out is not None:
        check_writable(options.out, *options.packings, endings=(".nc",))
    if options.bearing_contacts is not None and options.bearing_contacts < 1:
        raise ValueError(f"--bearing-contacts {options.bearing_contacts}: give a number of contacts from 1 upwards")
    bearing = BEARING_CONTACTS if options.bearing_contacts is None else options.bearing_contacts
    fabrics, warned = [], []
    for path in options.packings:
        packing = read_packing(path)
        warned += [f"{path}: warning: {line}" for line in warnings_of(packing)]
        try:
            fabrics.append(fabric(packing, cut, bearing))
            check_physical(1.0 - fabrics[-1]["solid_fraction"])
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    result = fabrics[0] if len(fabrics) == 1 else fabric_over_seeds(fabrics, options.packings)
    if options.out is not None:
        write_dataset(options.out, result)
    print("\n".join([fabric_text(result), *warned]))
    return 0

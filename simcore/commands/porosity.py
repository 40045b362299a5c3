"""`scree porosity BED.nc`: bulk porosity of a packing with its sampling error."""

from pathlib import Path

from simcore.commands.options import check_writable, cut_length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "porosity",
        help="bulk porosity of a packing with its sampling error",
        description="Print the porosity of a packing between its floor and its surface, with its sampling error and "
        "the part of the bed that is evaluated.",
    )
    parser.add_argument("packing", type=Path, metavar="BED.nc", help="netCDF file of `pack`")
    parser.add_argument(
        "--exact", action="store_true", help="slice the grains themselves instead of spheres of equal volume"
    )
    parser.add_argument("--cut", metavar="LENGTH", help='length left out at both ends of the bed: "8 mm", or metres')
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table; lengths are in metres")
    parser.add_argument("--profile", type=Path, metavar="OUT.csv", help="file for n(z), by both methods of slicing")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the porosity as a table or as JSON, write its profile if asked for, and return 0."""
    from simcore.evaluation.porosity import bulk_porosity, check_physical
    from simcore.evaluation.porosity_text import porosity_json, porosity_text, profile_table
    from simcore.packing.file import read_packing
    from simcore.writing import whole_file

    method, cut = "exact" if options.exact else "spheres", cut_length(options.cut)
    if options.profile is not None:
        check_writable(options.profile, options.packing, endings=(".csv",))
    packing = read_packing(options.packing)
    try:
        bulk = bulk_porosity(packing, method=method, cut=cut)
        check_physical(bulk["n"])
    except ValueError as error:
        raise ValueError(f"{options.packing}: {error}") from None
    if options.profile is not None:
        with whole_file(options.profile) as part:
            profile_table(packing, bulk).to_csv(part, index=False)
    print(porosity_json(bulk, packing) if options.json else porosity_text(bulk, packing))
    return 0

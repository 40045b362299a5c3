"""`scree export BED.nc OUT`: a packing as a file for another program."""

from pathlib import Path

from simcore.commands.options import check_writable, length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "export",
        help="write a packing for ParaView, Blender, 3D printers, image analysis or network analysis",
        description="Write a packing to a file for another program. The suffix selects the format: .glb, .stl, .ply "
        "(surfaces), .vtu, .vtp (ParaView, with a second file of contacts), .npz, .tif, .vti (voxels), .graphml, .csv "
        "(network of contacts). All numbers are in SI units, but the spacing in a .tif is in millimetres.",
    )
    parser.add_argument("packing", type=Path, metavar="BED.nc", help="netCDF file of `pack`")
    parser.add_argument("output", type=Path, metavar="OUT", help="file to write, such as bed.glb")
    parser.add_argument(
        "--periodic",
        choices=("cut", "copy", "leave"),
        help="what becomes of grains at the sides of a periodic box: they are cut there, copied whole to the other "
        "side, or left whole at one side; default: cut for voxels, leave otherwise",
    )
    parser.add_argument(
        "--voxel",
        metavar="LENGTH",
        help='edge of a voxel: "0.5 mm"; default: a twentieth of the median sieve size by number, or a quarter of the '
        "smallest axis of a grain",
    )
    parser.add_argument(
        "--divisions",
        type=int,
        metavar="N",
        help="spheres and ellipsoids have 20 · 4^N faces, with the exact volume; default: 2 (320 faces), and 3 in .glb "
        "unless grains are cut",
    )
    parser.set_defaults(run=run)


def run(options) -> int:
    """Write the files, print their names and return 0."""
    from simcore.export.export import export, known_suffix
    from simcore.export.paraview import contacts_path
    from simcore.packing.file import read_packing

    voxel = length("--voxel", options.voxel)
    known_suffix(options.output)
    check_writable(options.output, options.packing)
    if options.output.suffix.lower() in (".vtu", ".vtp"):
        check_writable(contacts_path(options.output), options.packing)
    packing = read_packing(options.packing)
    for path in export(packing, options.output, options.periodic, voxel, options.divisions):
        print(f"wrote {path}")
    return 0

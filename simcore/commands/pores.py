"""`scree pores BED.nc`: surface, tortuosity, permeability and pore sizes of a packing."""

from pathlib import Path

from simcore.commands.options import check_figure, cut_length, length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "pores",
        help="surface, tortuosity, permeability, hydraulic conductivity and pore sizes of a packing",
        description="Surface of the grains, permeability and hydraulic conductivity by Kozeny and Carman, tortuosity "
        "by diffusion on voxels. With the extra `pores` also the distribution of pore sizes and the permeability of a "
        "pore network. Voxels of two sizes give the error of resolution.",
    )
    parser.add_argument("packing", type=Path, metavar="BED.nc", help="netCDF file of `pack`")
    parser.add_argument("--cut", metavar="LENGTH", help='length left out at both ends of the bed: "8 mm", or metres')
    parser.add_argument(
        "--voxel",
        metavar="LENGTH",
        help='edge of the fine voxels: "0.2 mm"; default: a fortieth of the median sieve size by number, or an '
        "eighth of the smallest axis of a grain; larger for large beds",
    )
    parser.add_argument(
        "--no-voxels", action="store_true", help="print only what follows from porosity and surface, in seconds"
    )
    parser.add_argument("--json", action="store_true", help="print JSON in SI units instead of text")
    parser.add_argument(
        "--plot", type=Path, metavar="OUT.png", help="figure of the pore sizes; also .pdf or .svg; needs `pores`"
    )
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the properties of the pore space, draw the pore sizes if asked for, and return 0."""
    from simcore.evaluation.porosity import warnings_of
    from simcore.packing.file import read_packing
    from simcore.pores.image import TooManyVoxels
    from simcore.pores.pores import bulk_pores, missing_libraries, voxel_pores
    from simcore.pores.pores_text import INSTALL, pores_json, pores_text

    cut, voxel, missing = cut_length(options.cut), length("--voxel", options.voxel), missing_libraries()
    if options.no_voxels and (voxel is not None or options.plot is not None):
        raise ValueError("--no-voxels: --voxel and --plot have no effect with it; leave it out, or them")
    if options.plot is not None:
        if missing:
            raise ValueError(f"--plot: pore sizes need {' and '.join(missing)}; install the extra: {INSTALL}")
        check_figure("--plot", options.plot)
    packing = read_packing(options.packing)
    try:
        results, sizes, reason = bulk_pores(packing, cut), None, ""
    except ValueError as error:
        raise ValueError(f"{options.packing}: {error}") from None
    if not options.no_voxels:
        low, high = results["z_lower"], results["z_upper"]
        try:
            on_voxels, sizes = voxel_pores(packing, low, high, voxel, network=not missing)
            results |= on_voxels
        except TooManyVoxels as error:
            reason = str(error)
        except ValueError as error:
            raise ValueError(f"{options.packing}: {error}") from None
    if options.json:
        print(pores_json(results, warnings_of(packing)))
    else:
        warned = [f"warning: {line}" for line in warnings_of(packing)]
        print("\n".join([pores_text(results, () if options.no_voxels else missing, reason), *warned]))
    if reason and (options.json or options.plot is not None):
        raise ValueError(f"{options.packing}: {reason}")
    if options.plot is not None:
        from simcore.report.figures.pores import pore_size_figure
        from simcore.report.figures.saving import save_figure

        save_figure(pore_size_figure(*sizes, results["voxel_fine"], options.packing.stem), options.plot)
    return 0

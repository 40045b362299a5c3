"""`scree porosity BED.nc`: bulk porosity of a packing with its sampling error."""

import json
from pathlib import Path

from simcore.commands.options import length


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser("porosity", help="bulk porosity of a packing with its sampling error, as JSON")
    parser.add_argument("packing", type=Path, help="netCDF file of `pack`")
    parser.add_argument(
        "--exact", action="store_true", help="slice the grains themselves instead of spheres of equal volume"
    )
    parser.add_argument("--cut", metavar="LENGTH", help='length left out at both ends of the bed: "8 mm", or metres')
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the porosity as JSON and return 0."""
    from simcore.evaluation.porosity import bulk_porosity
    from simcore.packing.file import read_packing

    method, cut = "exact" if options.exact else "spheres", length("--cut", options.cut)
    bulk = bulk_porosity(read_packing(options.packing), method=method, cut=cut)
    scalars = {name: float(value) for name, value in bulk.data_vars.items() if value.ndim == 0}
    print(json.dumps({"method": method, **scalars}, indent=1))
    return 0

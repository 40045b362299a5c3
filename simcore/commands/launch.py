"""`scree launch SPEC.yaml OUT.nc`: one packing on several ranks under a watchdog."""

import os
import sys
from pathlib import Path

from simcore.commands.options import check_writable


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "launch",
        help="run one packing on several ranks under a watchdog",
        description="Run one packing on several MPI ranks. If a rank ends or becomes silent, all ranks are ended with "
        "one line. With a folder of checkpoints the same command continues the packing from its last checkpoint.",
    )
    add_launch_options(parser)
    parser.set_defaults(run=run)


def add_launch_options(parser) -> None:
    """Add the options of this command, for `launch_packing`, to an argparse parser."""
    parser.add_argument("specification", type=Path, help="YAML file, see config/packing.schema.yaml")
    parser.add_argument("output", type=Path, help="netCDF file to write")
    parser.add_argument("--ranks", type=int, default=1, help="number of MPI processes; it does not change the result")
    parser.add_argument("--threads", type=int, default=1, help="threads per rank; the result does not depend on them")
    parser.add_argument("--checkpoints", type=Path, metavar="FOLDER", help="as for pack")
    parser.add_argument("--checkpoint-interval", metavar="TIME", help="as for pack")
    parser.add_argument("--log", type=Path, help="as for pack")
    parser.add_argument("--frames", metavar="TIME", help="as for pack")
    parser.add_argument("--force", action="store_true", help="as for pack")
    parser.add_argument("--cut", metavar="LENGTH", help="as for pack")
    parser.add_argument("--silence", default="10 min", help="longest time between heartbeats, else all is ended")
    parser.add_argument("--startup", default="30 min", help="longest time to the first heartbeat, after compiling")
    parser.add_argument("--grace", default="10 s", help="time between SIGTERM and SIGKILL when ending")
    parser.add_argument("--mpiexec", default="", help='program that starts ranks, such as "srun"; "-n RANKS" is added')
    parser.add_argument("--with-parent", action="store_true", help="end when the parent process has ended")


def run(options) -> int:
    """Run the packing and return its exit status."""
    if os.name != "posix":
        raise ValueError("launch needs the signals of Linux, macOS or WSL; use `pack`, which runs on one rank")
    from simcore.packing.launch import launch_packing

    check_writable(options.output, options.specification)
    return launch_packing(options, [sys.executable, "-m", "simcore"])

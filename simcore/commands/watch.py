"""`scree watch FOLDER`: the packings of a running campaign."""

import sys
import time
from pathlib import Path


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "watch",
        help="show the packings of a running campaign: phase, share done, rate, time left",
        description="Show every packing whose specification the campaign has written, until Ctrl-C. If the output is "
        "not a terminal, the table is printed once.",
    )
    parser.add_argument(
        "folder", type=Path, metavar="FOLDER", help="results of the campaign, or a folder with logs of `pack --log`"
    )
    parser.add_argument("--once", action="store_true", help="print the table once, as text")
    parser.add_argument("--interval", type=float, default=2.0, metavar="SECONDS", help="time between two looks (2)")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Show the table and return 0."""
    from simcore.campaign.watching import Watcher
    from simcore.campaign.watching_text import watched_table, watched_text

    if not options.interval > 0.0:
        raise ValueError(f"--interval: {options.interval:g} s is not possible; give more than 0")
    watcher = Watcher(options.folder)
    if options.once or not sys.stdout.isatty():
        print(watched_text(watcher.look()))
        return 0
    from simcore.export.libraries import library

    live, table = library("rich.live", "a table that refreshes"), library("rich.table", "a table that refreshes")
    with live.Live(auto_refresh=False, screen=True) as screen:
        try:
            while True:
                rows = max(screen.console.height - 7, 1)
                screen.update(watched_table(watcher.look(), rows, table), refresh=True)
                time.sleep(options.interval)
        except KeyboardInterrupt:
            return 0

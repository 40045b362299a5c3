"""`scree sieve CURVE.csv`: percentiles and statistics of a measured sieve curve, its plot, and a packing of it."""

import sys
from pathlib import Path

from simcore.commands.options import YAML, check_figure, check_writable, grain_size
from simcore.writing import whole_file


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "sieve",
        help="statistics of a sieve curve, its plot, and the specification that packs it",
        description="Percentiles, mean, sorting, skewness, kurtosis, Cu and Cc of a sieve curve, with the words of "
        "Blott and Pye (2001).",
    )
    parser.add_argument(
        "curve",
        type=Path,
        metavar="CURVE.csv",
        help="table as text, .xlsx or .ods: a row per sieve and `pan`; openings [mm], [µm] or phi, or classes such as "
        "8-11.2 mm; mass [g], retained [%%], passing [%%] or cumulative retained [%%]",
    )
    parser.add_argument("--finest", metavar="SIZE", help='size of the finest grains in the pan, such as "0.02 mm"')
    parser.add_argument(
        "--coarsest", metavar="SIZE", help='size of the coarsest grains on the coarsest sieve, such as "90 mm"'
    )
    parser.add_argument("--plot", type=Path, metavar="OUT.png", help="figure to write; also .pdf or .svg")
    parser.add_argument(
        "--specification", type=Path, metavar="OUT.yaml", help="specification to write, for `explain` and `pack`"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the statistics, write what is asked for, and return 0."""
    from simcore.grains.sieve_statistics import sieve_statistics
    from simcore.grains.sieve_table import read_sieve_table
    from simcore.grains.sieve_text import describe_sieve, sieve_json

    if options.plot is not None:
        check_figure("--plot", options.plot)
    if options.specification is not None:
        check_writable(options.specification, options.curve, endings=YAML)
    finest, coarsest = grain_size("--finest", options.finest), grain_size("--coarsest", options.coarsest)
    table, notices = read_sieve_table(options.curve, coarsest)
    notices += [f"{options.curve}: {notice}" for notice in table.ends_without_effect(finest, coarsest)]
    try:
        table = table.closed(finest, coarsest)
        specification = _specification(options, table, notices) if options.specification else None
    except ValueError as error:
        raise ValueError(f"{options.curve}: {error}") from None
    statistics = sieve_statistics(table)
    if options.plot is not None:
        _plot(options, table)
    if specification is not None:
        with whole_file(options.specification) as part:
            part.write_text(specification, encoding="utf-8")
        notices.append(
            f"{options.specification} is written; `scree pack {options.specification} bed.nc` packs this curve"
        )
    for notice in [] if options.json else notices:
        print(f"scree sieve: {notice}", file=sys.stderr)
    if options.json:
        print(sieve_json(options.curve, table, statistics, notices))
    else:
        print(describe_sieve(options.curve, table, statistics))
    return 0


def _specification(options, table, notices):
    """Return the text of the specification; its notices are added to the list."""
    from simcore.packing.sieve_specification import sieve_specification

    closed, assumed = table.with_small_ends_closed()
    notices += [f"{options.curve}: the specification assumes that {what}" for what in assumed]
    text, further = sieve_specification(closed.curve(), options.curve)
    notices += further
    return text


def _plot(options, table):
    from simcore.report.figures.saving import save_figure
    from simcore.report.figures.sieve import sieve_figure

    save_figure(sieve_figure(table, options.curve.stem), options.plot)

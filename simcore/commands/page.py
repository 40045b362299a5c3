"""`scree page OUT.html`: a page that predicts the porosity of measured grains in a browser, without a server."""

from pathlib import Path

from simcore.commands.options import check_writable


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "page",
        help="a page that predicts porosity in a browser, also offline and on a phone",
        description="One HTML file with the models of `predict`: paste a table of grains or a sieve curve, "
        "and see the porosity.",
    )
    parser.add_argument("output", type=Path, metavar="OUT.html", help="page to write")
    parser.add_argument("--models", type=Path, metavar="FOLDER", help="folder results/models of your own campaign")
    parser.add_argument("--source", help="use only the committed packings of one form with grains of this source")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Write the page and return 0."""
    from simcore.models.measured_prediction import models_for
    from simcore.page.writing import write_page

    check_writable(options.output, options.models, endings=(".html", ".htm"))

    write_page(options.output, models_for(options.models, options.source))
    return 0

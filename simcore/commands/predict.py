"""`scree predict FORMS.csv`: porosity of a bed of measured grains, without packing them."""

import sys
from pathlib import Path


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "predict",
        help="porosity of a bed of measured grains, from our models and those of Rettinger et al. (2022)",
        description="Porosity of a bed of measured grains with its prediction interval, without packing them. The exit "
        "status is 2 if a sample is too far outside the range that the models were fitted to.",
    )
    parser.add_argument(
        "forms",
        type=Path,
        metavar="FORMS.csv",
        help="table as text or .xlsx. One row per grain: columns L, I, S or FL, EL, and optionally count, the number "
        "of such grains; or one row per sample: columns mean_FL, std_FL, mean_EL, std_EL",
    )
    parser.add_argument(
        "--case",
        required=True,
        help="sieve curve U1, U7, ..., or one-class: any single sieve class, with the model of U1",
    )
    parser.add_argument(
        "--sample", metavar="COLUMN", help='column with the name of the sample; default: "sample", if it exists'
    )
    parser.add_argument("--models", type=Path, metavar="FOLDER", help="folder results/models of your own campaign")
    parser.add_argument("--source", help="use only the committed packings of one form with grains of this source")
    parser.add_argument("--level", type=float, default=0.95, help="level of the prediction interval (0.95)")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--csv", action="store_const", dest="form", const="csv", help="one row per sample and model")
    form.add_argument("--json", action="store_const", dest="form", const="json")
    parser.set_defaults(run=run, form="text")


def run(options) -> int:
    """Print the predictions and return 0."""
    from simcore.models.prediction_text import predict_file

    text = predict_file(
        options.forms,
        options.case,
        models=options.models,
        source=options.source,
        column=options.sample,
        level=options.level,
        form=options.form,
        notify=lambda notice: print(f"simcore predict: {notice}", file=sys.stderr),
    )
    print(text)
    return 0

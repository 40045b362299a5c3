"""`scree fit MEASURED.csv`: measured porosities compared with our models, and a model corrected or fitted to them."""

import sys
from pathlib import Path

from simcore.commands.options import check_writable, grain_size


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "fit",
        help="compare measured porosities with our models, and correct or fit a model to them",
        description="Bias and scatter of our models on beds whose porosity you measured, and the simplest model that "
        "predicts them: an offset or a rescaling of ours, or a model of your own. An offset needs 3 beds of different "
        "form, a rescaling 6, and features 3 per coefficient; fewer beds are only compared. With --models MODEL.json, "
        "the file of an earlier fit, its models are tested on these beds, and nothing is fitted.",
    )
    parser.add_argument(
        "measured",
        type=Path,
        metavar="MEASURED.csv",
        help="table as text, .xlsx or .ods, one row per bed: columns n (porosity, or n [%%]), optionally n_error, "
        "case or sieve (file of its sieve curve), and mean_FL, std_FL, mean_EL, std_EL, or FL, EL or L, I, S of one "
        "form",
    )
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument(
        "--sieve", type=Path, metavar="CURVE.csv", help="sieve curve of all beds, without a column sieve or case"
    )
    parser.add_argument("--finest", metavar="SIZE", help='with sieve curves: size of the finest grains, "0.02 mm"')
    parser.add_argument("--coarsest", metavar="SIZE", help='with sieve curves: size of the coarsest grains, "90 mm"')
    sizes.add_argument(
        "--case",
        help="sieve curve of all beds, without a column case: U1, ..., or one-class: any single sieve class; it is "
        "that of the models if --models is a file of an earlier fit",
    )
    parser.add_argument(
        "--features",
        metavar="SET",
        help="features of a model of your own: single_form (1/EQ and 1/EL, the default), single_form_EQ, form_mixture "
        "or unified",
    )
    parser.add_argument(
        "--sample", metavar="COLUMN", help="column with the names of the beds; default: sample, Probe, bed or Bett"
    )
    parser.add_argument(
        "--out", type=Path, metavar="MODEL.json", help="file to write, for `predict --models MODEL.json`"
    )
    parser.add_argument(
        "--models",
        type=Path,
        metavar="PATH",
        help="file of an earlier fit, to test its models on these beds, with --out to correct them; or folder "
        "results/models of a campaign, to compare and correct its models",
    )
    parser.add_argument("--source", help="use only the committed packings of one form with grains of this source")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Print the test of models, or the comparison and the fitted models, write their file, and return 0."""
    from simcore.models.measured_file import is_file_of_fit

    if options.out is not None:
        check_writable(options.out, options.measured, options.sieve, options.models, endings=(".json",))
    given = {
        "case": options.case,
        "sieve": options.sieve,
        **{name: grain_size(f"--{name}", getattr(options, name)) for name in ("finest", "coarsest")},
        "source": options.source,
        "column": options.sample,
    }
    tested = options.out is None and options.models is not None and is_file_of_fit(options.models)
    if tested and options.features is not None:
        raise ValueError("--features: the models of --models are only tested; leave it out, or give --out")
    result, text = (_test if tested else _fit)(options, given)
    if not options.json:
        for notice in result.notices:
            print(f"scree fit: {notice}", file=sys.stderr)
    print(text)
    return 0


def _test(options, given, reason=""):
    """Return the MeasuredCheck of the models, and its text; reason: why none is fitted, if they are ours."""
    from simcore.models.measured_check import check_models
    from simcore.models.measured_check_text import check_as_json, describe_check

    result = check_models(options.measured, options.models, **given)
    write = check_as_json if options.json else describe_check
    return result, write(result, options.measured, options.models, reason)


def _fit(options, given):
    """Return the MeasuredFit, and its text; with too few beds and without --out, those of `_test`."""
    from simcore.models.measured_candidates import TooFewBeds
    from simcore.models.measured_fit import fit
    from simcore.models.measured_fit_text import describe_fit, fit_as_json

    try:
        features = options.features or "single_form"
        result = fit(options.measured, **given, features=features, models=options.models, out=options.out)
    except TooFewBeds as error:
        if options.out is None:
            return _test(options, given, str(error).removeprefix(f"{options.measured}: "))
        raise ValueError(f"{error}; without --out, `scree fit` compares the beds with our models") from error
    if options.json:
        return result, fit_as_json(result, options.measured)
    return result, describe_fit(result, options.measured, options.out)

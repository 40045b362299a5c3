"""`scree predict FORMS.csv`: porosity of a bed of measured grains, without packing them."""

import sys
from pathlib import Path

from simcore.commands.options import YAML, check_writable, grain_size


def add(commands) -> None:
    """Add the parser of this command."""
    parser = commands.add_parser(
        "predict",
        help="porosity of a bed of measured grains, from our models and those of Rettinger et al. (2022)",
        description="Porosity of a bed of measured grains with its prediction interval, without packing them. Samples "
        "that are too far outside the range that the models were fitted to are listed below the others with the "
        "reason. The exit status is 2 if no sample is predicted.",
    )
    parser.add_argument(
        "forms",
        type=Path,
        nargs="?",
        metavar="FORMS.csv",
        help="table as text, .xlsx or .ods. One row per grain: columns L, I, S (or a, b, c) or FL, EL, and optionally "
        "count, the number of such grains; or one row per sample: columns mean_FL, std_FL, mean_EL, std_EL, and "
        "optionally grains, the number of measured grains. With --sieve it may be left out: the form is then that of "
        "the Rhine's gravel. Further columns: sample, the name of the sample; sieve, the file of its sieve curve, "
        "instead of --sieve; class, the sieve class of the grains, if their form depends on size",
    )
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--case", help="sieve curve U1, U7, ..., or one-class: any single sieve class, by that of U1")
    sizes.add_argument(
        "--sieve",
        type=Path,
        metavar="CURVE.csv",
        help="a sieve curve of your own, a table as for `sieve`; or the name of a listed one, U1, U7, ...",
    )
    parser.add_argument("--finest", metavar="SIZE", help='with --sieve: size of the finest grains, such as "0.02 mm"')
    parser.add_argument("--coarsest", metavar="SIZE", help='with --sieve: size of the coarsest grains, such as "90 mm"')
    parser.add_argument(
        "--pack", type=Path, metavar="OUT.yaml", help="with --sieve: specification to write of a bed that checks it"
    )
    parser.add_argument(
        "--sample", metavar="COLUMN", help="column with the name of the sample; default: sample, Probe, bed or Bett"
    )
    parser.add_argument(
        "--models",
        type=Path,
        metavar="PATH",
        help="folder results/models of your own campaign, or the file of a model that `fit` wrote",
    )
    parser.add_argument("--source", help="use only the committed packings of one form with grains of this source")
    parser.add_argument("--level", type=float, default=0.95, help="level of the prediction interval (0.95)")
    output = parser.add_mutually_exclusive_group()
    output.add_argument(
        "--csv",
        action="store_const",
        dest="output",
        const="csv",
        help="one row per sample; with --case, one per sample and model",
    )
    output.add_argument(
        "--json",
        action="store_const",
        dest="output",
        const="json",
        help="JSON, with the models, their data and all notices",
    )
    parser.set_defaults(run=run, output="text")


def run(options) -> int:
    """Print the predictions and return 0."""
    from simcore.models.size_and_form.bed_forms import has_curves, refuse_curves

    common = {
        "models": options.models,
        "source": options.source,
        "column": options.sample,
        "level": options.level,
        "output": options.output,
        "notify": lambda notice: print(f"scree predict: {notice}", file=sys.stderr),
    }
    if options.sieve is not None or (options.case is None and has_curves(options.forms)):
        _print_of_curve(options, common)
        return 0
    if options.case is None:
        raise ValueError(
            "the sizes of the grains are not given; add --case one-class for grains of a single sieve class, or "
            "--sieve CURVE.csv for a sieve curve of your own, or a column sieve with the curve of each sample"
        )
    from simcore.models.prediction_text import predict_file

    for option in ("finest", "coarsest", "pack"):
        if getattr(options, option) is not None:
            raise ValueError(f"--{option} needs a sieve curve; give --sieve CURVE.csv instead of --case")
    if options.forms is None:
        raise ValueError("give the table of measured grains, FORMS.csv, or a sieve curve with --sieve CURVE.csv")
    refuse_curves(options.forms)
    print(predict_file(options.forms, options.case, **common))
    return 0


def _print_of_curve(options, common):
    from simcore.models.size_and_form.bed_prediction_text import predict_curve_file
    from simcore.models.size_and_form.predicted_specification import read_one_sample, write_specification

    ends = {name: grain_size(f"--{name}", getattr(options, name)) for name in ("finest", "coarsest")}
    if options.pack is not None:
        check_writable(options.pack, options.sieve, options.forms, endings=YAML)
        read_one_sample(options.forms, options.sieve, options.sample, **ends)
    print(predict_curve_file(options.sieve, options.forms, **ends, **common), flush=True)
    if options.pack is not None:
        for notice in write_specification(options.pack, options.sieve, options.forms, options.sample, **ends):
            common["notify"](notice)
        common["notify"](f"{options.pack} is written; `scree pack {options.pack} bed.nc` packs this bed")

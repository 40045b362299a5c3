"""Write the test of models on measured beds as text for people or as JSON."""

import json

from simcore.grains.text_columns import text_columns
from simcore.models.measured_plausibility import name_bed
from simcore.models.measured_text_parts import number, plain, records, wrap


def describe_check(result, path, models, reason=""):
    """Return a MeasuredCheck as text.

    path: the table; models: the file of the models, or None; reason: why no model is fitted, if there is one.
    """
    lines = []
    for check in result.checks:
        lines += [*_describe_model(check, path), ""]
    for sentence in result.left_out:
        lines += [*wrap(f"Left out: {sentence}."), ""]
    how = (
        f"Nothing is fitted. With --out NEW_MODEL.json a correction is fitted to these beds only: of the models of "
        f"{models} for a case, and of our model, in place of the former correction, for sieve curves. To use all beds, "
        "put them into one table."
    )
    lines += wrap(f"Nothing is fitted. {reason[0].upper()}{reason[1:]}." if reason else how)
    return "\n".join(lines)


def _describe_model(check, path):
    beds, count = check.beds, len(check.beds)
    what = f"case {check.given}" if check.case else "with sieve curves"
    joint = ", " if check.case else " "
    lines = [f"Test on {path}: {count} {'bed' if count == 1 else 'beds'}{joint}{what}", ""]
    lines += [*wrap(f"Model: {check.behind}"), ""]
    cells = [["bed", "measured", "predicted", "95 % interval", "difference", "in interval"]]
    for bed in beds.itertuples():
        if bed.refused:
            cells.append([bed.name, f"{bed.n:.4f}", "-", "-", "-", "-"])
            continue
        interval, answer = f"{bed.lower:.4f} to {bed.upper:.4f}", "yes" if bed.inside else "no"
        cells.append(
            [bed.name, f"{bed.n:.4f}", f"{bed.predicted:.4f}", interval, _signed(bed.predicted - bed.n), answer]
        )
    lines += [*text_columns(cells), ""]
    if not check.evaluated.empty:
        lines += [*text_columns(_summary(check)), ""]
        lines += wrap(
            "The bias is the mean of predicted minus measured porosity, and the scatter is the standard deviation of "
            "single beds about it. The last column is the share of the beds inside their 95 % prediction interval."
        )
    remarks = [line for sentence in sentences(check) for line in wrap(sentence, "- ")]
    return [*lines, "", *remarks] if remarks else lines


def _signed(value):
    """Return a difference with its sign; one that is rounded to 0 is positive."""
    return f"{round(value, 4) + 0.0:+.4f}"


def _summary(check):
    """Return the header and the row with the numbers of a ModelCheck over its beds."""
    beds = check.evaluated
    share = f"{int(beds.inside.sum())} of {len(beds)} ({100 * check.inside:.0f} %)"
    return [
        ["beds", "bias", "scatter", "in interval"],
        [str(len(beds)), _signed(check.bias), number(check.scatter), share],
    ]


def sentences(check):
    """Return sentences on beds outside the range of the model, and on those for which it is not evaluated."""
    texts = []
    for bed in check.beds.itertuples():
        name = name_bed(bed.name)
        name = name[0].upper() + name[1:]
        if bed.refused:
            texts.append(f"{name} is not predicted: {bed.refused}.")
        elif bed.outside:
            texts.append(f"{name} differs from the beds behind the model: {bed.outside}.")
    return texts


def check_as_json(result, path, models, reason=""):
    """Return a MeasuredCheck as JSON text; a number that is not finite is null. Arguments: as in describe_check."""
    checks = [
        {
            "case": check.case or None,
            "model": check.behind,
            "beds": records(check.beds),
            "evaluated": len(check.evaluated),
            "bias": plain(check.bias),
            "scatter": plain(check.scatter),
            "inside": plain(check.inside),
            "sentences": sentences(check),
        }
        for check in result.checks
    ]
    content = {
        "table": str(path),
        "models": None if models is None else str(models),
        "not_fitted": reason or None,
        "notices": list(result.notices),
        "left_out": list(result.left_out),
        "tests": checks,
    }
    return json.dumps(content, indent=1, allow_nan=False)

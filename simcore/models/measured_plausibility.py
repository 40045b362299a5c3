"""Notices on measured porosities that are probably something else, such as a solid fraction in the column n."""

import numpy as np

# Above the differences between loose and dense beds of the same grains, and between our models and measured gravels.
DIFFERENT = 0.15


def question_beds(measured, predicted):
    """Return sentences on beds whose porosity differs from the predicted one by more than DIFFERENT.

    measured: MeasuredBeds. predicted: porosity of each of them by a model that was not fitted to them; nan if there is
    none, and then nothing is reported.
    """
    return [_question(bed, n) for bed, n in zip(measured, predicted, strict=True) if abs(bed.n - n) > DIFFERENT]


def question_repeats(groups, predicted):
    """Return the sentences of question_beds on all repeats; groups: lists of MeasuredBed; predicted: one per group."""
    beds = [bed for group in groups for bed in group]
    return question_beds(beds, np.repeat(np.asarray(predicted, float), [len(group) for group in groups]))


def _question(bed, predicted):
    """Return the sentences on a MeasuredBed, with porosities in the unit of its table."""
    scale, unit = (100.0, " %") if bed.in_percent else (1.0, "")
    digits = 0 if bed.in_percent else 2
    far = (
        f"{bed.where or name_bed(bed.sample.name)}: n = {scale * bed.n:.4g}{unit} is far from the predicted "
        f"{scale * predicted:.{digits}f}{unit}."
    )
    readings = {"the solid fraction": 1.0 - bed.n, "the void ratio e": bed.n / (1.0 + bed.n)}
    likely = [
        f"if it is {name}, write {scale * n:.4g}" for name, n in readings.items() if abs(n - predicted) <= DIFFERENT
    ]
    if likely:
        return f"{far} I{'; '.join(likely)[1:]}."
    return f"{far} Check that it is the volume of the pores over the volume of the bed."


def name_bed(name):
    """Return the name of a bed in a sentence; "row 2" is a name that the program gave."""
    return name if name.lower().startswith(("row ", "bed ")) else f"bed {name}"

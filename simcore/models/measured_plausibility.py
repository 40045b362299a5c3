"""Notices on measured porosities that are probably not porosities, such as a solid fraction in the column n."""

import numpy as np

# Above the differences between loose and dense beds of the same grains, and between our models and measured gravels.
DIFFERENT = 0.15


def question_beds(measured, predicted):
    """Return sentences on beds whose porosity differs from the predicted one by more than DIFFERENT.

    measured: MeasuredBeds. predicted: porosity of each of them by a model that was not fitted to them; nan if there is
    none, and then nothing is reported.
    """
    return [
        _question(name_bed(bed.sample.name), bed.n, n)
        for bed, n in zip(measured, predicted, strict=True)
        if abs(bed.n - n) > DIFFERENT
    ]


def question_repeats(groups, predicted):
    """Return the sentences of question_beds on all repeats; groups: lists of MeasuredBed; predicted: one per group."""
    beds = [bed for group in groups for bed in group]
    return question_beds(beds, np.repeat(np.asarray(predicted, float), [len(group) for group in groups]))


def _question(name, n, predicted):
    numbers = f"{name}: measured {n:.3g}, predicted {predicted:.2f}"
    if abs(1.0 - n - predicted) <= DIFFERENT:
        return f"{numbers}; is {n:.3g} the solid fraction, 1 − n?"
    return f"{numbers}; check that {n:.3g} is the volume of the pores over the volume of the bed"


def name_bed(name):
    """Return the name of a bed in a sentence; "row 2" is a name that the program gave."""
    return name if name.lower().startswith(("row ", "bed ")) else f"bed {name}"

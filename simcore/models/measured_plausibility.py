"""Notices on measured porosities that are probably something else, such as a solid fraction in the column n."""

import numpy as np

# Above the differences between loose and dense beds of the same grains, and between our models and measured gravels.
DIFFERENT = 0.15
# Of all beds on average: another reading of the numbers is this close to the predictions, and the porosity that far.
CLOSE_ON_AVERAGE, FAR_ON_AVERAGE = 0.03, 0.08


def _of_solid_fraction(value):
    return 1.0 - value


def _of_void_ratio(value):
    return value / (1.0 + value)


# What a column n may have instead of the porosity, how the porosity follows, and the function that computes it.
_READINGS = (
    ("the solid fraction", "1 minus it", _of_solid_fraction),
    ("the void ratio e", "e/(1 + e)", _of_void_ratio),
)


def question_beds(measured, predicted):
    """Return sentences on beds whose porosity differs from the predicted one by more than DIFFERENT.

    measured: MeasuredBeds. predicted: porosity of each of them by a model that was not fitted to them; nan if there is
    none, and then nothing is reported. If no single bed differs so much, all beds may be questioned together.
    """
    pairs = [(bed, n) for bed, n in zip(measured, predicted, strict=True) if np.isfinite(n)]
    single = [_question(bed, n) for bed, n in pairs if abs(bed.n - n) > DIFFERENT]
    return single or _question_all(pairs)


def _question_all(pairs):
    """Return a sentence if all beds together are probably solid fractions or void ratios; pairs: bed and prediction."""
    if len(pairs) < 2:
        return []
    predicted = np.array([n for _, n in pairs])
    far = np.mean(np.abs([bed.n for bed, _ in pairs] - predicted))
    for name, remedy, reading in _READINGS:
        close = np.mean(np.abs([reading(bed.n) for bed, _ in pairs] - predicted))
        if far > FAR_ON_AVERAGE and close < CLOSE_ON_AVERAGE:
            return [
                f"The porosities differ by {far:.2f} from the predicted ones on average, but by only {close:.2f} if "
                f"their column has {name}. If it has, give {remedy} instead."
            ]
    return []


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
    readings = {name: reading(bed.n) for name, _, reading in _READINGS}
    if bed.in_percent and bed.n < 0.01:
        readings["a fraction"] = 100.0 * bed.n
    likely = [
        f"if it is {name}, write {scale * n:.4g}" for name, n in readings.items() if abs(n - predicted) <= DIFFERENT
    ]
    if likely:
        return f"{far} I{'; '.join(likely)[1:]}."
    return f"{far} Check that it is the volume of the pores over the volume of the bed."


def name_bed(name):
    """Return the name of a bed in a sentence; "row 2" is a name that the program gave."""
    return name if name.lower().startswith(("row ", "bed ")) else f"bed {name}"

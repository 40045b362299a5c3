"""Notices on measured forms that are possible, but rare for gravel, and probably mean something else."""

import numpy as np

from simcore.grains.text_lists import join_first

SLIP = 0.1  # maximum of S/I and I/L that is noticed, that of equal axes if the decimal mark of one slips
SMALL_DEVIATION = 0.06  # deviation of FL or EL below which one that is not 0 is noticed; that of gravel is 0.1 to 0.2
SHOWN = 5  # maximum number of values that a notice lists
# A row is noticed as the mean of those above it if it is one of the LAST of its sample, has FEWEST_ABOVE rows above it,
# and differs from their mean by no more than ROUNDED of it, while their standard deviation is more than SPREAD of it.
LAST, FEWEST_ABOVE, ROUNDED, SPREAD = 5, 3, 0.01, 0.05


def describe_slips(path, groups, check):
    """Return a notice on grains so thin or long that a decimal mark may have slipped in one of their axes.

    groups: lists of (where, numbers, row) by sample; check(where, numbers) returns the ratios of a row.
    """
    entries = sorted((entry for group in groups.values() for entry in group), key=lambda entry: entry[-1])
    forms = [(row, check(where, values)) for where, values, row in entries]
    rows = [str(row) for row, form in forms if min(form) <= SLIP]
    if not rows:
        return []
    ratios = "I/L" if len(forms[0][1]) == 1 else "S/I or I/L"
    return [
        f"{path}: row{'s' * (len(rows) > 1)} {join_first(rows, SHOWN)}: {ratios} is {SLIP:g} or less, which is rare "
        "for gravel; check the decimal marks"
    ]


def describe_single_rows(path, groups, noun="sample", of=""):
    """Return a notice on samples of one row, which may be a mean over grains; groups: as in describe_slips.

    noun: "sample", or "class" if each group is a sieve class. of: text such as " of the sample A", or empty.
    """
    names = [name for name, entries in groups.items() if len(entries) == 1]
    if not names:
        return []
    have = "have one row each" if len(names) > 1 else "has one row"
    return [
        f"{path}: the {_plural(noun, names)} {join_first(names, SHOWN)}{of} {have}, so that all grains have one form; "
        "if the row is a mean over grains, the porosity is too low: give a row per grain, or mean_FL, std_FL, mean_EL, "
        "std_EL"
    ]


def describe_mean_rows(path, groups, noun="sample"):
    """Return a notice on rows with the means of the rows above them, without a label.

    groups: as in describe_slips; noun: as in describe_single_rows.
    """
    rows = []
    for entries in groups.values():
        numbers = np.array([values for _, values, _ in entries])
        for k in range(max(FEWEST_ABOVE, len(numbers) - LAST), len(numbers)):
            mean, deviation = numbers[:k].mean(axis=0), numbers[:k].std(axis=0)
            if (abs(numbers[k] - mean) <= ROUNDED * mean).all() and (deviation > SPREAD * mean).all():
                rows.append(str(entries[k][-1]))
    if not rows:
        return []
    plural, have = ("s", "have") if len(rows) > 1 else ("", "has")
    return [
        f"{path}: row{plural} {join_first(rows, SHOWN)} {have} the means of the rows above of the same {noun}; if this "
        "is no grain, remove it, and other statistics below it"
    ]


def describe_small_deviations(path, samples, noun="sample", of=""):
    """Return a notice on samples whose deviation of FL or EL is small.

    samples: list of Sample, from means; noun, of: as in describe_single_rows.
    """
    names = [
        sample.name
        for sample in samples
        if any(0.0 < deviation < SMALL_DEVIATION for deviation in (sample.sigma_FL, sample.sigma_EL))
    ]
    if not names:
        return []
    return [
        f"{path}: the {_plural(noun, names)} {join_first(names, SHOWN)}{of}: std_FL or std_EL is below "
        f"{SMALL_DEVIATION:g}, which is rare for gravel; give the standard deviation over the grains, not the standard "
        "error of their mean or the variance"
    ]


def _plural(noun, names):
    return noun if len(names) == 1 else {"class": "classes"}.get(noun, f"{noun}s")

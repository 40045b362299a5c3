"""Writes the specification of a packing that checks a predicted porosity."""

from simcore.models.size_and_form.bed_forms import read_bed_forms
from simcore.packing.sieve_specification import sieve_specification
from simcore.writing import whole_file


def write_specification(path, curve, forms=None, column=None, finest=None, coarsest=None, *, draw=True) -> list[str]:
    """Write to `path` the specification of a bed with the sieve curve and the forms of the files; return the notices.

    curve, forms, column, finest, coarsest: as in predict_curve_file; without forms, the grains are synthetic pebbles of
    the Rhine's forms. draw: as in sieve_specification. ValueError if `forms` has several samples, or no forms for a
    sieve class that has mass.
    """
    bed, sample, classes = read_one_sample(forms, curve, column, finest, coarsest), None, None
    if bed.by_class:
        classes = bed.samples[0][1]
    elif forms is not None:
        sample = bed.samples[0]
    text, notices = sieve_specification(bed.curve.without_empty_ends(), bed.source, sample, classes, draw=draw)
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")
    return notices


def read_one_sample(forms, curve, column=None, finest=None, coarsest=None):
    """Return the BedForms of the only sample of the files; arguments and errors as in write_specification."""
    beds, _ = read_bed_forms(forms, curve, column, finest, coarsest)
    number = sum(len(bed.samples) for bed in beds)
    if number > 1:
        raise ValueError(f"{forms}: there are {number} samples, but --pack writes one specification; give one sample")
    return beds[0]

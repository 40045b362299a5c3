"""Writes the specification of a packing that checks a predicted porosity."""

from pathlib import Path

from simcore.models.size_and_form.bed_forms import read_bed_forms
from simcore.packing.sieve_specification import sieve_specification


def write_specification(path, curve, forms=None, column=None, finest=None, coarsest=None, *, draw=True) -> list[str]:
    """Write to `path` the specification of a bed with the sieve curve and the forms of the files; return the notices.

    curve, forms, column, finest, coarsest: as in predict_curve_file; without forms, the grains are synthetic pebbles of
    the Rhine's forms. draw: as in sieve_specification. ValueError if `forms` has several samples, or no forms for a
    sieve class that has mass.
    """
    beds, _ = read_bed_forms(forms, curve, column, finest, coarsest)
    samples = [sample for bed in beds for sample in bed.samples]
    if len(samples) > 1:
        raise ValueError(
            f"{forms}: there are {len(samples)} samples, but --pack writes one specification; give one sample"
        )
    bed, sample, classes = beds[0], None, None
    if bed.by_class:
        classes = samples[0][1]
    elif forms is not None:
        sample = samples[0]
    text, notices = sieve_specification(bed.curve.without_empty_ends(), bed.source, sample, classes, draw=draw)
    Path(path).write_text(text, encoding="utf-8")
    return notices

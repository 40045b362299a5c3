"""Writes the specification of a packing that checks a predicted porosity."""

from pathlib import Path

import numpy as np

from simcore.grains.sieve import SieveCurve
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
    text, notices = sieve_specification(_with_mass(bed.curve), bed.source, sample, classes, draw=draw)
    Path(path).write_text(text, encoding="utf-8")
    return notices


def _with_mass(curve):
    """Return the SieveCurve from its finest to its coarsest class with mass; listed curves have empty ones."""
    held = np.flatnonzero(curve.mass_fractions)
    classes = slice(held[0], held[-1] + 1)
    return SieveCurve(curve.bounds[held[0] : held[-1] + 2], curve.mass_fractions[classes], curve.name)

"""Writes the specification of a packing that checks a predicted porosity."""

from pathlib import Path

from simcore.grains.forms_by_class import class_column, read_classes
from simcore.grains.measured_forms import read_measured
from simcore.grains.sieve_table import read_sieve_table
from simcore.packing.sieve_specification import sieve_specification


def write_specification(path, curve, forms=None, column=None, finest=None, coarsest=None, *, draw=True) -> list[str]:
    """Write to `path` the specification of a bed with the sieve curve and the forms of the files; return the notices.

    curve, forms, column, finest, coarsest: as in predict_curve_file; without forms, the grains are synthetic pebbles of
    the Rhine's forms. draw: as in sieve_specification. ValueError if `forms` has several samples, or no forms for a
    sieve class that has mass.
    """
    table, _ = read_sieve_table(curve, coarsest)
    sample = classes = None
    if forms is not None and column is None and class_column(forms) is not None:
        classes, _ = read_classes(forms, class_column(forms))
    elif forms is not None:
        samples, _ = read_measured(forms, column)
        if len(samples) > 1:
            raise ValueError(
                f"{forms}: there are {len(samples)} samples, but --pack writes one specification; give one sample"
            )
        sample = samples[0]
    table, _ = table.closed(finest, coarsest).with_small_ends_closed()
    text, notices = sieve_specification(table.curve(), Path(curve), sample, classes, draw=draw)
    Path(path).write_text(text, encoding="utf-8")
    return notices

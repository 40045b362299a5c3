"""Writes the specification of a packing that checks a predicted porosity."""

from pathlib import Path

from simcore.grains.forms_by_class import class_column
from simcore.grains.measured_forms import read_measured
from simcore.grains.sieve_table import read_sieve_table
from simcore.packing.sieve_specification import sieve_specification


def write_specification(path, curve, forms=None, column=None, finest=None, coarsest=None) -> list[str]:
    """Write to `path` the specification of a bed with the sieve curve and the forms of the files; return the notices.

    curve, forms, column, finest, coarsest: as in predict_curve_file; without forms, the grains are synthetic pebbles of
    the Rhine's forms. ValueError if `forms` has several samples.
    """
    table, _ = read_sieve_table(curve, coarsest)
    sample = None
    if forms is not None:
        if column is None and class_column(forms) is not None:
            raise ValueError(
                f"{forms}: forms differ between sieve classes, but a specification has one form for all; leave out "
                "--pack"
            )
        samples, _ = read_measured(forms, column)
        if len(samples) > 1:
            raise ValueError(
                f"{forms}: there are {len(samples)} samples, but --pack writes one specification; give one sample"
            )
        sample = samples[0]
    table, _ = table.closed(finest, coarsest).with_small_ends_closed()
    text, notices = sieve_specification(table.curve(), Path(curve), sample)
    Path(path).write_text(text, encoding="utf-8")
    return notices

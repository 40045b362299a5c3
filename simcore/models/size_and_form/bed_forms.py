"""Reads the beds whose porosity is predicted: their sieve curves, and the forms of their grains.

All samples of a table of forms have one curve, or the table has a column `sieve` with the curve of each sample, as for
`fit`. Without a column of samples, the rows with one curve are then one sample. With a column `class`, each sieve class
of a sample has its own form. The model is imported where it is evaluated, because a prediction for a case only needs
`has_curves`.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.grains.class_labels import CLASS_LABEL, OPEN_END, SIZE
from simcore.grains.form_columns import MEANS, SAMPLE, recognise_columns, sample_position
from simcore.grains.forms_by_class import (
    BY_CLASS,
    class_name,
    classes_of_table,
    describe_unused_classes,
    sample_of_class,
)
from simcore.grains.measured_beds import SIEVE_NAME, CurveReader
from simcore.grains.measured_forms import read_measured, samples_of_table
from simcore.grains.sieve import SieveCurve
from simcore.grains.sieve_columns import known_unit
from simcore.grains.sieve_table import read_curve
from simcore.grains.table_file import read_table
from simcore.scene.sizes import all_cases

_UNIT = re.compile(r"[a-zµμ]*$", re.IGNORECASE)


class BedForms(NamedTuple):
    """Beds with one sieve curve.

    curve: SieveCurve. source: its file or name. samples: list of Sample, or with forms by sieve class a list of
    (name, classes), as from simcore.grains.forms_by_class.classes_of_table. by_class: whether it is the latter. places:
    of the samples among those of all beds, if the table of forms has the curves, else None.
    """

    curve: SieveCurve
    source: Path
    samples: list
    by_class: bool
    places: list | None = None

    def predict(self, fitted, level=0.95):
        """Return the table of predict_curve, one row per sample; arguments as there."""
        from simcore.models.size_and_form.bed_prediction import predict_curve

        if not self.by_class:
            return predict_curve(self.curve, self.samples, fitted, level)
        rows = [self._by_class(name, classes, fitted, level) for name, classes in self.samples]
        return pd.concat(rows, ignore_index=True)

    def one_class(self, index, n_one_class, fitted):
        """Return the one-class porosity of the grains of sample `index`: n_one_class, or by class of the curve (k,).

        n_one_class: from the row of the sample. fitted: FittedModels. A class without forms has nan.
        """
        from simcore.models.size_and_form.forms_by_class import one_class_by_class

        if not self.by_class:
            return n_one_class
        return one_class_by_class(self.curve, self.samples[index][1], fitted)

    def measured(self, index):
        """Return the Samples of the grains of sample `index`: itself, or those of the classes that have mass.

        Those of classes have the name of their class, after that of the sample if there are several.
        """
        if not self.by_class:
            return [self.samples[index]]
        name, classes = self.samples[index]
        of_classes = [
            sample_of_class(self.curve, place, classes) for place in np.flatnonzero(self.curve.mass_fractions)
        ]
        prefix = "" if name == BY_CLASS else f"{name}: "
        return [replace(sample, name=f"{prefix}{sample.name}") for sample in dict.fromkeys(of_classes)]

    def _by_class(self, name, classes, fitted, level):
        from simcore.models.size_and_form.forms_by_class import predict_by_class

        try:
            return predict_by_class(self.curve, classes, fitted, level, name=name)
        except ValueError as error:
            raise error if name == BY_CLASS else ValueError(f"sample {name}: {error}") from None


def join_tables(beds, tables):
    """Return one table of the tables of the BedForms, in the order of the table of forms.

    It has the column `curve` if each sample has its own curve.
    """
    if beds[0].places is None:
        return tables[0]
    joined = pd.concat([table.assign(curve=str(bed.source)) for bed, table in zip(beds, tables, strict=True)])
    return joined.iloc[np.argsort([place for bed in beds for place in bed.places])].reset_index(drop=True)


def refuse_curves(forms):
    """Raise ValueError if the table at the path `forms` has sieve curves, because a case is given."""
    if has_curves(forms):
        raise ValueError(
            f"{forms}: a column has the sieve curve of each sample; leave out --case, or remove the column"
        )


def has_curves(forms):
    """Return whether the table at the path `forms` has a column with the sieve curve of each sample."""
    return forms is not None and _sieve_position(read_table(forms)) is not None


def read_bed_forms(forms, curve=None, column=None, finest=None, coarsest=None):
    """Return (list of BedForms, notices): the beds of a table of forms.

    forms: path of the table, or None for the Rhine's mean form. curve: SieveCurve, path or name of the curve of all
    samples; None if the table has a column `sieve`. column: name of the column with the names of the samples. finest,
    coarsest [m]: as in simcore.grains.sieve_table.read_curve. ValueError names the file, the row and the remedy.
    """
    reader = CurveReader({name: case.curve for name, case in all_cases().items()}, finest, coarsest)
    if forms is None:
        from simcore.models.size_and_form.bed_prediction import UNKNOWN_FORMS, rhine_sample

        curve, source, notices = _given(curve, reader)
        notices = [*notices, f"no table of grains is given: the form is that of {UNKNOWN_FORMS}"]
        return [BedForms(curve, source, [rhine_sample()], False)], notices
    table = read_table(forms)
    if table.cells.empty:
        read_measured(forms, column)  # raises the error
    of_sieve = _sieve_position(table)
    if curve is not None:
        if of_sieve is not None:
            raise ValueError(
                f"{forms}: the column {table.header[of_sieve]} has the sieve curve of each sample; leave out --sieve, "
                "or remove the column"
            )
        curve, source, notices = _given(curve, reader)
        samples, of_forms, by_class = _samples(table, column)
        return [BedForms(curve, source, samples, by_class)], [
            *notices,
            *of_forms,
            *_unused(forms, curve, samples, by_class),
        ]
    if of_sieve is None:
        raise ValueError(
            f"{forms}: the sieve curve is not given; add --sieve CURVE.csv, or a column sieve to the table"
        )
    names, texts = _names(table, column, of_sieve), table.cells[of_sieve].to_dict()
    curves = _curve_of_each(forms, names, texts)
    samples, of_forms, by_class = _samples(_renamed(table, of_sieve, names, column), SAMPLE)
    beds, notices = {}, []
    for place, sample in enumerate(samples):
        name = sample[0] if by_class else sample.name
        row, text = curves[name]
        curve, more = reader.read(f"{forms}, row {row}", text, Path(forms).parent)
        notices += more
        bed = beds.setdefault(text, BedForms(curve, Path(text), [], by_class, []))
        bed.samples.append(sample)
        notices += _unused(forms, curve, [sample], by_class)
        bed.places.append(place)
    reader.check_ends()
    return list(beds.values()), [*notices, *of_forms]


def _unused(path, curve, samples, by_class):
    """Return notices on classes with forms in which the curve has no mass; samples: as in BedForms."""
    return [
        notice
        for name, classes in (samples if by_class else ())
        for notice in describe_unused_classes(path, curve, classes, name)
    ]


def _given(curve, reader):
    """Return (SieveCurve, source, notices) of a curve that is given as such, by its path or by its name."""
    if isinstance(curve, SieveCurve):
        return curve, Path(curve.name), []
    if curve is None:
        raise ValueError("the sieve curve is not given; add --sieve CURVE.csv")
    if str(curve) in reader.listed or not Path(curve).exists():
        given, notices = reader.read("--sieve", str(curve))
        reader.check_ends()
    else:
        given, notices = read_curve(curve, *reader.ends)
    return given, Path(curve), notices


def _sieve_position(table):
    """Return the position of the column with sieve curves, None without one; sieve classes are not curves."""
    for position, name in enumerate(table.header):
        if not SIEVE_NAME.fullmatch(name):
            continue
        texts = set(table.cells[position]) - {""}
        if not texts or not all(map(_is_class, texts)):
            return position
    return None


def _is_class(text):
    """Return whether a text is a sieve class or a size, without a unit or in a known one; 1.csv is a file."""
    unit = _UNIT.search(text)[0]
    is_class = any(pattern.fullmatch(text) for pattern in (CLASS_LABEL, OPEN_END, SIZE))
    return is_class and (not unit or known_unit(unit) is not None)


def _samples(table, column):
    """Return (samples, notices, by_class) of a TextTable of forms, as in BedForms."""
    by_class = class_name(table.header)
    if by_class is None or by_class == column:
        return *samples_of_table(table, column), False
    position = sample_position(table.path, table.header, column)
    if position is None:
        classes, notices = classes_of_table(table, by_class)
        return [(BY_CLASS, classes)], notices, True
    samples, notices = [], []
    names = table.cells[position]
    for name in dict.fromkeys(names):
        if not name:
            row = names.index[names == name][0]
            raise ValueError(
                f"{table.path}, row {row}: {table.header[position]} is empty; name the sample in every row"
            )
        classes, more = classes_of_table(table.without(position, rows=names == name), by_class, name)
        samples.append((name, classes))
        notices += more
    return samples, list(dict.fromkeys(notices)), True


def _names(table, column, of_sieve):
    """Return the name of the sample of each row, dict by row, for a table with a column of curves."""
    position = sample_position(table.path, table.header, column)
    if position is not None:
        return table.cells[position].to_dict()
    if recognise_columns(table.path, table.header).kind == MEANS and class_name(table.header) is None:
        return {row: f"row {row}" for row in table.cells.index}
    return table.cells[of_sieve].to_dict()


def _curve_of_each(path, names, texts):
    """Return {name: (row, text of the sieve curve)}; ValueError if a sample has none, or two."""
    curves = {}
    for row, name in names.items():
        if not texts[row]:
            raise ValueError(f"{path}, row {row}: the sieve curve is empty; name it in every row")
        first, text = curves.setdefault(name, (row, texts[row]))
        if text != texts[row]:
            raise ValueError(
                f"{path}, row {row}: the sieve curve of {name} is {texts[row]}, but in row {first} it is {text}; a "
                "sample has one sieve curve, so correct it, or rename the sample"
            )
    return curves


def _renamed(table, of_sieve, names, column):
    """Return the TextTable without its column of curves, with these names of samples in a column SAMPLE."""
    position = sample_position(table.path, table.header, column)
    others = [place for place, name in enumerate(table.header) if name.lower() == SAMPLE]
    kept = table.without(of_sieve, position, *others)
    cells = kept.cells.assign(**{"name": list(names.values())}).set_axis(range(len(kept.header) + 1), axis=1)
    return replace(kept, header=[*kept.header, SAMPLE], cells=cells)

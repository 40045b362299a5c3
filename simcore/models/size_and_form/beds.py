"""Packed beds for the fit of size and form: sieve curves, one-class porosities, porosities and their errors.

The table has one row per bed (results/reference/size_and_form.csv, columns in simcore.campaign.composition_columns):
the realised sieve curve and form statistics, by volume, of the evaluated part. Beds of U1 are the bases, which give the
one-class porosity n1. Each bed has the n1 of the base of its form, for its own process: see
simcore.models.size_and_form.bases. The n1 of beds of all forms also follows their realised statistics.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.evaluation.composition import FLOOR_FACTOR, LARGE_DIFFERENCE
from simcore.models.size_and_form.bases import PROCESS, fit_bases
from simcore.models.unified import unified_features
from simcore.reference.share_columns import realised_curve

BASE, ALL_FORMS, SPHERE = "U1", "all", "sphere"
# A bed is kept out of the fit if a share of coarse grains differs by more than this beyond its standard error.
LARGEST_DIFFERENCE = 0.03


class Beds(NamedTuple):
    """Beds with wide sieve curves, n of them. All arrays have the shape (n,)."""

    names: np.ndarray
    curves: tuple  # SieveCurve of each
    one_class: np.ndarray  # porosity n1 of a bed of one class of such grains
    reference: np.ndarray  # the same of the Rhine's grains that are placed and shaken like these
    mu_EQ: np.ndarray
    mu_EL: np.ndarray
    n: np.ndarray  # packed porosity
    error: np.ndarray  # its sampling error
    family: np.ndarray  # of the sieve curve
    form: np.ndarray  # name of the single form, or ALL_FORMS

    def select(self, chosen):
        """Return the beds for which the array (n,) of bool is true."""
        arrays = [np.asarray(field)[chosen] for field in self if field is not self.curves]
        curves = tuple(curve for curve, kept in zip(self.curves, chosen, strict=True) if kept)
        return Beds(arrays[0], curves, *arrays[1:])


def flags(table) -> pd.Series:
    """Return for each row why its bed is kept out of the fit, "" for a bed that is used.

    The rule is that of docs/appendices/size_and_form_plan.md.
    """
    halves = _beyond(table, "coarse_lower", "coarse_upper")
    parts = _beyond(table, "coarse_bed", "coarse_evaluated")
    floor, inside = table["fine_floor"], table["fine_evaluated"]
    errors = np.hypot(table["fine_floor_error"], table["fine_evaluated_error"])
    fines = (floor - inside > LARGE_DIFFERENCE * errors) & (floor > FLOOR_FACTOR * inside)
    reasons = {"sizes separate over height": halves, "coarse grains lie outside": parts, "fines on the floor": fines}
    texts = pd.Series("", table.index)
    for reason, flagged in reasons.items():
        texts[flagged] = texts[flagged].where(texts[flagged] == "", texts[flagged] + "; ") + reason
    return texts


def _beyond(table, first, second):
    errors = np.hypot(table[f"{first}_error"], table[f"{second}_error"])
    return (table[first] - table[second]).abs() > LARGEST_DIFFERENCE + errors


def form_labels(table) -> pd.Series:
    """Return the form of each bed: SPHERE, the name of the single form, or ALL_FORMS."""
    grain = table["grain"].astype(object).fillna("").astype(str)
    return grain.mask(grain == "", ALL_FORMS).mask(table["representation"] == SPHERE, SPHERE)


def read_beds(table, unified, families, others=None, process=PROCESS, spheres=False, flagged=False) -> Beds:
    """Return the wide beds of real forms, or of spheres, that are not flagged, or those that are.

    table: DataFrame of size_and_form.csv, with after_s and fall_s as in bases.process_logs. unified: PorosityModel of
    beds of one class, with the features of simcore.models.unified; it gives how n1 of beds of all forms changes with
    their realised statistics. families: dict from case to the family of its curve. others: DataFrame of bases with
    another process, with the same columns; None: the process counts as having no effect. process: the quantities of
    simcore.models.size_and_form.bases that count. ValueError if the base of a form is missing.
    """
    table = table.assign(form=form_labels(table), flag=flags(table))
    bases = table[table["case"] == BASE]
    if bases.empty:
        raise ValueError(f"size_and_form.csv has no bed of {BASE} yet, which gives the one-class porosity; pack it")
    all_bases = bases if others is None else pd.concat([bases, others.assign(form=form_labels(others))])
    fitted = fit_bases(all_bases, process if others is not None else ())
    wide = table[(table["case"] != BASE) & ((table["form"] == SPHERE) == spheres) & ((table["flag"] != "") == flagged)]
    wide = wide.reset_index(drop=True)
    missing = sorted({ALL_FORMS, *wide["form"]} - set(bases["form"]))
    if missing:
        raise ValueError(
            f"size_and_form.csv has no bed of {BASE} with the form {missing[0]}, which wide beds need; pack it"
        )
    effect = fitted.effect(wide)
    n1 = np.array(wide["form"].map(fitted.constants), float) + effect
    reference = fitted.constants[ALL_FORMS] + effect
    mixed = (wide["form"] == ALL_FORMS).to_numpy()
    if mixed.any():
        of_base = _of_statistics(unified, all_bases[all_bases["form"] == ALL_FORMS]).mean()
        n1[mixed] += _of_statistics(unified, wide[mixed]) - of_base
    names = [f"{row.case} {row.form} {row.seed}" for row in wide.itertuples()]
    curves = tuple(realised_curve(row, name) for (_, row), name in zip(wide.iterrows(), names, strict=True))
    numbers = [wide[column].to_numpy(float) for column in ("mu_EQ_evaluated", "mu_EL_evaluated", "n", "n_error")]
    labels = [wide["case"].map(families).to_numpy(str), wide["form"].to_numpy(str)]
    return Beds(np.array(names), curves, n1, reference, *numbers, *labels)


def _of_statistics(unified, rows):
    statistics = rows[[f"{kind}_{ratio}_evaluated" for ratio in ("EQ", "EL") for kind in ("mu", "sigma")]]
    statistics = statistics.rename(columns=lambda name: name.removesuffix("_evaluated"))
    return unified.predict(unified_features(statistics))

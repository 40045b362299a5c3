"""The candidates for a model of porosity from sieve curve and form, with their parameters.

    H   compressible skeleton with f and g that are flat at r = 1: compaction index K, stretch of log size by form
    L   linear skeleton with the same stretch
    F   rods on a line with the same stretch
    D   the effect of form is damped in proportion to what sizes do to the mean form:
        n = N + (n1 - n_ref) (1 - c X),  X = 1 - N / n_ref, with N the skeleton at n_ref,
        within the limits of `least_porosity` and of classes that do not interact

Each gives the one-class porosity n1 exactly for U1. n_ref is the one-class porosity of the Rhine's grains that were
placed and shaken like the bed. docs/appendices/size_and_form_plan.md has the rules by which one is
chosen.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from simcore.models.packing_models.classes import porosity_of_volume, specific_volume
from simcore.models.size_and_form.one_class import check_one_class
from simcore.models.size_and_form.skeletons import (
    by_class,
    compressible_skeleton,
    least_porosity,
    linear_skeleton,
    power_functions,
    rods_skeleton,
)
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY, by_form, by_looseness


class Parameter(NamedTuple):
    """A parameter of a candidate: the value at which a fit starts, and its bounds."""

    start: float
    low: float
    high: float


class Candidate(NamedTuple):
    """A candidate: porosity(curve, one_class, forms, law, reference, **parameters) -> (...,)."""

    name: str
    title: str
    parameters: dict  # name -> Parameter, of those that are fitted
    porosity: Callable


_COMPACTION = {"K": Parameter(4.0, 2.5, 20.0)}
_M0, _KAPPA = {"m0": Parameter(1.0, 0.7, 1.4)}, {"kappa": Parameter(0.6, -0.5, 2.0)}
_BY_FORM = {"m_EQ": Parameter(0.1, -1.0, 1.0), "m_EL": Parameter(0.0, -1.0, 1.0)}
_FUNCTIONS = {"p": Parameter(2.7, 1.5, 4.0), "s": Parameter(2.0, 1.3, 4.0)}
_DAMPING = {"c": Parameter(1.5, 0.0, 3.0)}
FIXED_Q = 2.1  # of f in power_functions, kept fixed


def _stretch(one_class, forms, reference, m0=1.0, kappa=0.0, m_EQ=None, m_EL=None):
    if m_EQ is None and m_EL is None:
        return by_looseness(one_class, m0, kappa, reference)
    if forms is None:
        raise ValueError("the stretch by form needs the mean EQ and EL of the grains; give `forms`")
    return by_form(*forms, m0, m_EQ or 0.0, m_EL or 0.0)


def _functions(p=None, s=None):
    return {} if p is None and s is None else {"functions": power_functions(p or 2.7, FIXED_Q, s or 2.0)}


def _h(curve, one_class, forms=None, law="number", reference=REFERENCE_POROSITY, *, K=4.0, p=None, s=None, **stretch):
    m = _stretch(one_class, forms, reference, **stretch)
    return compressible_skeleton(curve, one_class, K, m, law, **_functions(p, s))


def _l(curve, one_class, forms=None, law="number", reference=REFERENCE_POROSITY, *, p=None, s=None, **stretch):
    m = _stretch(one_class, forms, reference, **stretch)
    return linear_skeleton(curve, one_class, m, law, **_functions(p, s))


def _f(curve, one_class, forms=None, law="number", reference=REFERENCE_POROSITY, **stretch):
    return rods_skeleton(curve, one_class, _stretch(one_class, forms, reference, **stretch), law)


def _damped(skeleton):
    def porosity(curve, one_class, forms=None, law="number", reference=REFERENCE_POROSITY, *, c=1.5, **parameters):
        N = skeleton(curve, reference, forms, law, reference, **parameters)
        n1 = porosity_of_volume(specific_volume(by_class(curve, one_class)) @ curve.mass_fractions)
        n = N + (n1 - reference) * np.maximum(1 - c * (1 - N / reference), 0)
        return np.clip(n, least_porosity(curve, one_class), n1)

    return porosity


_POWER = "ratios of sizes to a power that depends on"
_BY_POROSITY, _BY_FORMS = f"{_POWER} the one-class porosity", f"{_POWER} the form"

CANDIDATES = {
    candidate.name: candidate
    for candidate in (
        Candidate("H", f"compressible packing model, {_BY_POROSITY}", _COMPACTION | _M0 | _KAPPA, _h),
        Candidate("H_form", f"compressible packing model, {_BY_FORMS}", _COMPACTION | _M0 | _BY_FORM, _h),
        Candidate(
            "H_free", f"compressible packing model, f and g fitted, {_BY_POROSITY}",
            _COMPACTION | _KAPPA | _FUNCTIONS, _h,
        ),
        Candidate("L", f"linear packing model, {_BY_POROSITY}", _M0 | _KAPPA, _l),
        Candidate("L_free", f"linear packing model, f and g fitted, {_BY_POROSITY}", _KAPPA | _FUNCTIONS, _l),
        Candidate("F", f"rods on a line, {_BY_POROSITY}", _M0 | _KAPPA, _f),
        Candidate(
            "D_H", "compressible packing model, damped effect of form",
            _COMPACTION | _M0 | _DAMPING, _damped(_h),
        ),
        Candidate("D_F", "rods on a line, damped effect of form", _M0 | _DAMPING, _damped(_f)),
    )
}  # fmt: skip


def predict(name, curve, one_class, parameters=None, forms=None, law="number", reference=REFERENCE_POROSITY):
    """Return the porosity (...,) of a bed with this sieve curve by a candidate; a float for one bed.

    name: in CANDIDATES. curve: SieveCurve. one_class: porosity of beds of one class of such grains, a number, (..., 1)
    for all classes, or (..., k) by class. parameters: dict; those that are left out have their start values. forms:
    pair of mean EQ and mean EL, each like one_class; only for the stretch by form. law: as in
    simcore.models.packing_models.curves. reference: one-class porosity of the Rhine's grains, placed and shaken like
    these; a number. ValueError if the candidate or a parameter is unknown, if a one-class porosity is outside its
    range, or if no porosity between 0 and 1 results.
    """
    if name not in CANDIDATES:
        raise ValueError(f"candidate {name!r} is unknown; the candidates are {', '.join(CANDIDATES)}")
    candidate = CANDIDATES[name]
    values = {key: parameter.start for key, parameter in candidate.parameters.items()}
    unknown = set(parameters or {}) - set(values)
    if unknown:
        raise ValueError(f"candidate {name} has no parameter {sorted(unknown)[0]!r}; it has {', '.join(values)}")
    check_one_class(one_class)
    n = candidate.porosity(curve, one_class, forms, law, reference, **values | (parameters or {}))
    if not np.all((n > 0) & (n < 1)):
        raise ValueError(
            f"{curve.name}: candidate {name} gives the porosity {np.min(n):.3g}; the curve is outside its range"
        )
    return float(n) if np.ndim(one_class) == 0 else n

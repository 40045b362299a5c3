"""Stretch of log size: how the form of the grains changes the effective size ratio.

Size ratios r enter the packing models as r^m. Looser grains have larger pores relative to their size, so that a filler
of a given ratio fits in them as a smaller one would: m > 1. A power keeps r = 1 and r = 0, so that splitting a class
changes nothing. If forms differ between classes, the coarser grain of a pair gives m, because the pore is between
coarse grains. Two rules are compared:

    looseness   m = m0 (e / e_ref)^κ,  e = n1 / (1 - n1) one-class void ratio, e_ref that of the Rhine's grains
    form        m = m0 + mQ (1/EQ - 1/EQ_ref) + mL (1/EL - 1/EL_ref)

e and e_ref belong to beds that were placed and shaken in the same way, so that a loose process is not taken for form.
"""

import numpy as np

REFERENCE_POROSITY = 0.342  # of the Rhine's mean form, by the model of beds of one form of Rettinger et al. (2022)
REFERENCE_EQ, REFERENCE_EL = 0.441, 0.682  # Rettinger et al. (2022), Table 2: mean FL 0.647 times EL, and mean EL


def by_looseness(one_class, m0=1.0, kappa=0.0, reference=REFERENCE_POROSITY):
    """Return m, with the shape of the one-class porosities.

    m0 > 0: m of the Rhine's grains; kappa: exponent. reference: one-class porosity of the Rhine's grains that were
    placed and shaken like these.
    """
    return m0 * (void_ratio(one_class) / void_ratio(reference)) ** kappa


def by_form(mu_EQ, mu_EL, m0=1.0, m_EQ=0.0, m_EL=0.0):
    """Return m from the means of EQ and EL, of all grains or by class; ValueError where it is not positive."""
    mu_EQ, mu_EL = np.asarray(mu_EQ, float), np.asarray(mu_EL, float)
    m = m0 + m_EQ * (1 / mu_EQ - 1 / REFERENCE_EQ) + m_EL * (1 / mu_EL - 1 / REFERENCE_EL)
    if not np.all(m > 0):
        raise ValueError(f"the stretch exponent {np.min(m):.3g} is not positive; the form is outside the model's range")
    return m


def void_ratio(porosity):
    """Return e = n / (1 - n)."""
    return np.asarray(porosity, float) / (1 - np.asarray(porosity, float))

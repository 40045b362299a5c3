"""Words for readers instead of the names that tables contain: values of columns, and formulas with indices."""

import re

from markupsafe import Markup, escape

from simcore.campaign.study_tables import OWN_CURVE
from simcore.models.feature_words import feature_in_words

SHAPE_KINDS = {
    "polyhedron": "polyhedra",
    "ellipsoid": "ellipsoids",
    "sphere": "spheres",
    "mixed": "shapes of several kinds",
}
VALUES = {
    "case": {OWN_CURVE: "of the study itself"},
    "choice": {"random": "drawn from the measured grains", "form_distribution": "drawn from a distribution"},
    "fill": {"bed": "just above the bed", "r22": "as Rettinger et al."},
    "model": {
        "single_form": "one form: L/S and L/I",
        "single_form_EQ": "one form: L/S alone",
        "form_mixture": "distribution of form",
        "form_mixture_r22": "distribution of form, terms of Rettinger et al.",
        "unified": "unified",
        "separate": "separate models",
        "r22": "Rettinger et al.",
    },
    "quantity": {"D": "sieve size", "FL": "flatness", "EL": "elongation", "angle": "angle of the long axis"},
    "source": {"synthetic": "synthetic pebbles", "scans": "scanned grains"},
    "kind": SHAPE_KINDS | {"continuous": "drawn from a distribution", "discrete": "drawn from the measured grains"},
    "shape_kind": SHAPE_KINDS,
    "measure": {
        name + end: words + more
        for name, words in (
            ("sphericity", "sphericity"),
            ("facet_share", "share of the surface in the ten largest facets"),
            ("relative_sphericity", "sphericity relative to the ellipsoid"),
        )
        for end, more in (("", ""), ("_300", ", at most 300 faces"))
    },
}
_OF_FEATURES = ("term", "with_term", "feature", "features")


def value_in_words(column, value):
    """Return the text of a value of a text column: "L/S" for the feature EQ_inv; unknown values as they are."""
    if column in _OF_FEATURES:
        return ", ".join(feature_in_words(name) for name in str(value).split())
    if isinstance(value, bool) or str(value) in ("True", "False"):
        return "yes" if str(value) == "True" else "no"
    if column == "study":
        return str(value).replace("_", " ")
    if column == "source":
        # The numbers in brackets are those of the list of references of Rettinger et al., and theirs is the paper.
        text = re.sub(r"^\[(\d+)\]$", r"Rettinger et al., reference \1", VALUES["source"].get(str(value), str(value)))
        return text.replace("paper ", "Rettinger et al., ")
    return VALUES.get(column, {}).get(str(value), str(value))


def formula_markup(text):
    """Return a formula of simcore.models.formulas with indices and fractions, its terms unbreakable.

    "n = 0.28 + 0.03 µ_EQ⁻¹" becomes 0.28 + 0.03 / µ with the index EQ.
    """
    if not isinstance(text, str):
        return ""
    terms = re.split(r" (?=[+−] )", text)
    return Markup(" ").join(Markup('<span class="term">{}</span>').format(_term_markup(term)) for term in terms)


def _term_markup(term):
    term = re.sub(r" ([µσ]_\w+)⁻¹", r" / \1", term)
    marked = re.sub(r"([µσ])_(E[QL])", r"\1<sub>\2</sub>", str(escape(term)))
    return Markup(re.sub(r"^n =", "<i>n</i> =", marked).replace("⁻¹", "<sup>−1</sup>").replace("²", "<sup>2</sup>"))

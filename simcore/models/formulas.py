"""Fitted models as formulas, from their tables of coefficients."""

import pandas as pd

# What a feature is called in a formula: by the axes L >= I >= S where a bed has one form, else by mean and deviation.
SYMBOLS = {
    "EQ_inv": "L/S",
    "EL_inv": "L/I",
    "mu_EQ_inv": "µ_EQ⁻¹",
    "sigma_EQ_inv": "σ_EQ⁻¹",
    "mu_EL_inv": "µ_EL⁻¹",
    "sigma_EL_inv": "σ_EL⁻¹",
    "relative_variance_EQ": "(σ_EQ/µ_EQ)²",
    "relative_variance_EL": "(σ_EL/µ_EL)²",
}
BEDS = {
    "single_form": "of one form",
    "form_mixture": "with a distribution of form",
    "unified": "of one form or a distribution",
}


def formulas(rows):
    """One row a model: what beds it is of, its formula, error and range, and the study's formula.

    rows: as from PorosityModel.to_rows, several models after each other; with columns source (of the grains) and
    r22_coefficient these are told too. Models that BEDS does not name are left out. Returns a DataFrame with columns
    beds, case, source, porosity, error (cross-validated, mean absolute), samples, range and study, None where nothing
    is known.
    """
    keys = [key for key in ("model", "source", "case") if key in rows]
    table = []
    for values, terms in rows.groupby(keys, sort=False):
        said = dict(zip(keys, values, strict=True))
        if said["model"] not in BEDS:
            continue
        table.append(
            {
                "beds": BEDS[said["model"]],
                "case": said["case"],
                "source": said.get("source"),
                "porosity": _formula(terms, "coefficient"),
                "error": terms["mean_absolute_error"].iloc[0],
                "samples": terms["samples"].iloc[0],
                "range": ", ".join(
                    f"{_symbol(row.term)} {row.feature_min:.2g} to {row.feature_max:.2g}"
                    for row in terms.itertuples()
                    if row.term in ("EQ_inv", "EL_inv", "mu_EQ_inv", "mu_EL_inv")
                ),
                "r22": _formula(terms, "r22_coefficient") if "r22_coefficient" in terms else None,
            }
        )
    return pd.DataFrame(table)


def _formula(terms, column):
    """n = 0.265 + 0.0233 L/S − ..., terms without a value left out; None without an intercept."""
    known = terms[terms[column].notna()].set_index("term")[column]
    if "intercept" not in known:
        return None
    parts = [f"{known['intercept']:.3f}"]
    for term, value in known.drop("intercept").items():
        parts.append(f"{'−' if value < 0 else '+'} {abs(value):.3g} {_symbol(term)}")
    return "n = " + " ".join(parts)


def _symbol(term):
    return SYMBOLS.get(term, term)

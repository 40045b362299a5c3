"""Write fitted models as formulas, from their tables of coefficients."""

import pandas as pd

# Symbol of each feature in a formula: the axes L >= I >= S for beds of one form, else mean and standard deviation.
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
    """Return one row per model: its kind of bed, its formula, error and range, and the formula of Rettinger et al.

    rows: as from PorosityModel.to_rows, several models after each other. The columns source (of the grains) and
    r22_coefficient (of Rettinger et al. 2022) are optional. Models that BEDS does not list are left out. Returns a
    DataFrame with columns beds, case, source, porosity (the formula), error (cross-validated, mean absolute), samples,
    range and r22 (the formula of Rettinger et al.); source and r22 are None where `rows` does not have them.
    """
    keys = [key for key in ("model", "source", "case") if key in rows]
    table = []
    for values, terms in rows.groupby(keys, sort=False):
        labels = dict(zip(keys, values, strict=True))
        if labels["model"] not in BEDS:
            continue
        table.append(
            {
                "beds": BEDS[labels["model"]],
                "case": labels["case"],
                "source": labels.get("source"),
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
    """Return a formula such as n = 0.265 + 0.0233 L/S, without terms that have no value; None without an intercept."""
    values = terms[terms[column].notna()].set_index("term")[column]
    if "intercept" not in values:
        return None
    parts = [f"{values['intercept']:.3f}"]
    for term, value in values.drop("intercept").items():
        parts.append(f"{'−' if value < 0 else '+'} {abs(value):.3g} {_symbol(term)}")
    return "n = " + " ".join(parts)


def _symbol(term):
    return SYMBOLS.get(term, term)

"""Words for the features of models: "L/S" for EQ_inv, "1/mean EQ" for mu_EQ_inv."""

import re

from simcore.grains.form import FORM_FACTORS

# Features whose formula is shorter than its name
_RATIOS = {"EQ_inv": "L/S", "EL_inv": "L/I", "FL_inv": "I/S", "EQ": "S/L", "EL": "I/L", "FL": "S/I"}
_SPREADS = {f"relative_variance_{name}": f"(std. dev. {name} / mean {name})²" for name in FORM_FACTORS}
_FEATURE = re.compile(rf"(mu_|sigma_)?(1/)?({'|'.join(FORM_FACTORS)})(_inv)?")


def feature_in_words(name):
    """Return a feature of a model as text: "L/S", "mean EQ", "1/std. dev. EL"; unknown names as they are."""
    if name in _RATIOS or name in _SPREADS:
        return _RATIOS.get(name) or _SPREADS[name]
    match = _FEATURE.fullmatch(name)
    if not match:
        return name
    statistic, inner, factor, outer = match.groups()
    factor = f"1/{factor}" if inner else factor
    words = {"mu_": "mean ", "sigma_": "std. dev. ", None: ""}[statistic] + factor
    if not outer:
        return words
    return f"1/({words})" if inner and statistic else f"1/{words}"

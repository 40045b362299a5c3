"""How much of our difference to Rettinger et al. (2022) in beds of long grains comes from their stretched lattice.

    python -m benchmarks.studies.long_grains

It compares difference_long_lattice.csv, packed on a lattice that is stretched by the mean form of the grains, with the
same grains and seeds in form_mixture.csv, and with the model of mixtures of Rettinger et al. config/differences.yaml
has the rule of comparison. Another table has the difference of all sets to that model by FL/EL, the factor of the space
that a stretched lattice gives a grain. It takes seconds.
"""

import numpy as np
import pandas as pd

from simcore.paths import REFERENCE
from simcore.reference.columns import COMMITTED_NAMES, SPECIFIED_FORM
from simcore.reference.r22_tables import read_r22_table

STRETCHED, CAMPAIGN = "difference_long_lattice.csv", "form_mixture.csv"
SETS = [COMMITTED_NAMES.get(name, name) for name in SPECIFIED_FORM]
MU_FL, MU_EL, SIGMA_FL, SIGMA_EL = SETS
JUDGED = ((0.8, 0.4), (0.6, 0.4), (0.4, 0.4), (0.7, 0.5))  # mean FL and EL of the sets over which the share is taken
DEVIATION = 0.2  # standard deviation of FL and of EL in these sets


def by_r22(rows):
    """Return the porosity (n,) of sets of forms by the model of mixtures of Rettinger et al., U1."""
    model = read_r22_table("models").query("model == 'form_mixture' and case == 'U1'").iloc[0]
    features = {name: 1.0 / rows[name.removesuffix("_inv")] for name in ("mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv")}
    return model["intercept"] + sum(model[name] * values for name, values in features.items())


def campaign():
    """Return the rows of the campaign with `difference`, their porosity minus that by Rettinger et al."""
    rows = pd.read_csv(REFERENCE / CAMPAIGN)
    return rows.assign(difference=rows["n"] - by_r22(rows), space=rows[MU_FL] / rows[MU_EL])


def stretched():
    """Return one row per stretched packing: the set, seed, difference to Rettinger et al., `change` and its error."""
    rows = pd.read_csv(REFERENCE / STRETCHED)
    pairs = rows.merge(campaign(), on=[*SETS, "seed"], suffixes=("_stretched", ""))
    # The grains are the same, and most of their sampling error with them: the error of the change is an upper bound.
    error = np.hypot(pairs["n_error_stretched"], pairs["n_error"])
    return pairs.assign(change=pairs["n_stretched"] - pairs["n"], change_error=error)


def explained(pairs, rows):
    """Return the share of the difference to Rettinger et al. that the stretch explains, and its standard error.

    pairs: as of `stretched`; a judged set with equal mean FL and EL is not stretched. rows: as of `campaign`.
    """
    judged = pd.DataFrame(JUDGED, columns=[MU_FL, MU_EL]).assign(**{SIGMA_FL: DEVIATION, SIGMA_EL: DEVIATION})
    of_sets = rows.merge(judged, on=SETS).query("seed == 1")
    changes = pairs.merge(judged, on=SETS)
    total = of_sets["difference"].sum()
    return -changes["change"].sum() / total, np.sqrt(np.square(changes["change_error"]).sum()) / total


def main() -> None:
    """Print both tables and the share."""
    rows = campaign()
    means = rows.groupby(["space", MU_FL, MU_EL, SIGMA_EL])["difference"].mean().unstack()
    print("Porosity minus that by Rettinger et al., by the standard deviation of EL and by FL/EL")
    print(means.to_string(float_format="%+.4f"))
    if not (REFERENCE / STRETCHED).exists():
        print(
            f"{STRETCHED} has no packings yet; pack them with snakemake --cores 1 --configfile config/differences.yaml "
            "-- difference_long_lattice, and then the target collect"
        )
        return
    pairs = stretched()
    columns = [*SETS, "seed", "n", "n_stretched", "change", "change_error", "difference"]
    print(pairs[columns].to_string(index=False, float_format="%.4f"))
    share, error = explained(pairs, rows)
    print(f"the stretch explains {share:.2f} ± {error:.2f} of the difference over the judged sets")


if __name__ == "__main__":
    main()

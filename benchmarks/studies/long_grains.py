"""Parts of our difference to Rettinger et al. (2022) in beds of long grains.

    python -m benchmarks.studies.long_grains

It compares difference_long_lattice.csv, packed on a lattice that is stretched by the mean form of the grains, with the
same grains and seeds in form_mixture.csv, and with the model of mixtures of Rettinger et al. Another table has the
difference of all sets to that model by FL/EL, the factor of the space that a stretched lattice gives a grain. The last
table divides the difference of six sets into parts, from the packings of difference_long_grains.csv and
difference_long_wide.csv. config/differences.yaml has the rules of both comparisons. It takes seconds.
"""

import numpy as np
import pandas as pd

from simcore.evaluation.confidence import student_quantile
from simcore.models.fitting import fit_reference_models
from simcore.models.unified import feature_table
from simcore.paths import REFERENCE
from simcore.reference.columns import COMMITTED_NAMES, SPECIFIED_FORM
from simcore.reference.r22_tables import read_r22_models

STRETCHED, CAMPAIGN = "difference_long_lattice.csv", "form_mixture.csv"
GRAINS, WIDE = "difference_long_grains.csv", "difference_long_wide.csv"
OURS, SCANS, THEIRS = "synthetic", "scans", "rhine"  # sources of grains; the last one has two of Rettinger et al.
TOTAL, PARTS = "difference", ("faces", "grains", "scans", "width", "misfit", "open")
LARGE = 0.02  # difference of the sets that are also judged alone
SETS = [COMMITTED_NAMES.get(name, name) for name in SPECIFIED_FORM]
MU_FL, MU_EL, SIGMA_FL, SIGMA_EL = SETS
JUDGED = ((0.8, 0.4), (0.6, 0.4), (0.4, 0.4), (0.7, 0.5))  # mean FL and EL of the sets over which the share is taken
DEVIATION = 0.2  # standard deviation of FL and of EL in these sets


def by_r22(rows):
    """Return the porosity (n,) of sets of forms by the model of mixtures of Rettinger et al., U1."""
    model = read_r22_models()["form_mixture", "U1"]
    return model.porosity(pd.DataFrame({name: 1.0 / rows[name.removesuffix("_inv")] for name in model.slopes.index}))


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
    changes = pairs.merge(of_sets[[*SETS, "seed"]], on=[*SETS, "seed"])
    total = of_sets["difference"].sum()
    return -changes["change"].sum() / total, np.sqrt(np.square(changes["change_error"]).sum()) / total


def divided(rows, misfit, grains, wide):
    """Return a table of the sets of `grains` with TOTAL and PARTS, by the rule in config/differences.yaml.

    rows: as of `campaign`. misfit (n,): porosity by our linear model of mixtures minus that of these rows. grains,
    wide: rows of GRAINS and of WIDE. A part is nan if a packing of it is missing.
    """
    rows = rows.assign(misfit=misfit)[rows["seed"] == 1].set_index(SETS)
    of_source, wide = (
        {source: part.groupby(SETS)["n"].mean() for source, part in table.groupby("source")} for table in (grains, wide)
    )
    sets = grains.set_index(SETS).index.unique()
    rows = rows.loc[sets]
    ours, scans, theirs, spacious = (
        part.get(source, pd.Series(dtype=float)).reindex(sets)
        for part, source in ((of_source, OURS), (of_source, SCANS), (of_source, THEIRS), (wide, THEIRS))
    )
    table = pd.DataFrame({TOTAL: rows["difference"]}).assign(
        faces=ours - rows["n"], grains=theirs - ours, scans=scans - ours, width=spacious - theirs, misfit=rows["misfit"]
    )
    return table.assign(open=spacious + rows["misfit"] - (rows["n"] - rows["difference"]))


def summarised(table):
    """Return mean, standard error, whether it is significant, and share of TOTAL of each part of `divided`."""
    values, number = table[list(PARTS)], table[list(PARTS)].count()
    error = values.std() / np.sqrt(number)
    limit = [student_quantile(0.95, count - 1) if count > 1 else np.nan for count in number]
    totals = pd.Series({part: table[TOTAL][values[part].notna()].mean() for part in PARTS})
    share = values.mean() / totals * np.where(values.columns == "open", 1.0, -1.0)
    return pd.DataFrame(
        {
            "sets": number,
            "mean": values.mean(),
            "standard error": error,
            "significant": values.mean().abs() > np.array(limit) * error,
            "share": share,
        }
    )


def our_misfit(rows):
    """Return the porosity by our linear model of mixtures in U1 minus that of the rows of form_mixture.csv (n,)."""
    model = fit_reference_models().models["form_mixture", "U1"]
    features = feature_table({name: rows[name].to_numpy() for name in ("mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL")})
    return model.predict(features) - rows["n"].to_numpy()


def print_parts(rows) -> None:
    """Print the parts of the difference of each set, and their means; rows: as of `campaign`."""
    if not (REFERENCE / GRAINS).exists():
        return
    grains = pd.read_csv(REFERENCE / GRAINS)
    wide = pd.read_csv(REFERENCE / WIDE) if (REFERENCE / WIDE).exists() else grains.iloc[:0]
    table = divided(rows, our_misfit(rows), grains, wide).sort_values(TOTAL, ascending=False)
    print(table.reset_index().to_string(index=False, float_format="%.4f"))
    for title, sets in (("all sets", table), (f"sets of {LARGE:g} and more", table[table[TOTAL] >= LARGE])):
        print(f"Parts of the difference, {title}")
        print(summarised(sets).to_string(float_format="%.4f"))


def main() -> None:
    """Print the tables and the share."""
    rows = campaign()
    of_sets = rows.groupby(["space", *SETS])["difference"].mean()
    means = of_sets.groupby(["space", MU_FL, MU_EL, SIGMA_EL]).mean().unstack()
    print("Porosity minus that by Rettinger et al., by the standard deviation of EL and by FL/EL")
    print(means.to_string(float_format="%+.4f"))
    print_parts(rows)
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

"""How the form of grains acts on the porosity of beds of one sieve class, inserted as a rain and on lattices.

    python -m benchmarks.studies.base_forms

The beds are the bases of real forms of size_and_form.csv and those of base_forms.csv, which are a rain. The formula of
simcore.models.unified is fitted to them, and compared with the same model of beds on lattices, which `predict` uses
(docs/appendices/size_and_form_plan.md, "Bases of more forms"). Printed are the coefficients of both, the porosity of
each bed by both, and that of beds with the same forms on lattices, from single_form.csv and form_mixture.csv. Seconds.
"""

import numpy as np
import pandas as pd

from benchmarks.studies.size_and_form_fit import STUDY, read_rows
from simcore.grains.statistics import STATISTICS
from simcore.models.fitting import fit_reference_models
from simcore.models.regression import fit
from simcore.models.size_and_form.beds import ALL_FORMS, BASE, form_labels
from simcore.models.unified import UNIFIED, unified_features
from simcore.paths import REFERENCE
from simcore.reference.columns import COMMITTED_NAMES, SPECIFIED_FORM

MORE_FORMS = "base_forms"
SETS = [COMMITTED_NAMES.get(name, name) for name in SPECIFIED_FORM]


def evaluated_statistics(rows):
    """Return the STATISTICS of the evaluated part of each bed by volume, for `unified_features`."""
    return rows[[f"{name}_evaluated" for name in STATISTICS]].set_axis(list(STATISTICS), axis=1)


def statistics_by_number(rows):
    """Return the STATISTICS over the grains of beds of one sieve class, each counted once, as in models of one class.

    They are those of the beds on lattices with the same forms. By volume they differ where forms do, because long
    grains of a sieve class are the larger ones. A bed of one form has the same by number and by volume.
    """
    statistics = evaluated_statistics(rows)
    statistics.loc[rows["form"] == ALL_FORMS] = of_all_forms().to_numpy()
    mixed = pd.read_csv(REFERENCE / "form_mixture.csv").query("case == @BASE").groupby(SETS)[list(STATISTICS)].mean()
    is_mixed = rows[SETS].notna().all(axis=1)
    statistics.loc[is_mixed] = mixed.reindex(pd.MultiIndex.from_frame(rows.loc[is_mixed, SETS])).to_numpy()
    return statistics


def of_all_forms() -> pd.Series:
    """Return the STATISTICS of the 63 synthetic forms, which beds of all forms have in equal numbers."""
    axes = _single_forms().drop_duplicates("grain")
    ratios = {"EQ": axes["S"] / axes["L"], "EL": axes["I"] / axes["L"]}
    kinds = {"mu": np.mean, "sigma": np.std}
    return pd.Series({name: kinds[name.split("_")[0]](ratios[name.split("_")[1]]) for name in STATISTICS})


def _single_forms():
    rows = pd.read_csv(REFERENCE / "single_form.csv").query("case == @BASE and representation == 'polyhedron'")
    return rows[rows["source"] == "synthetic"]


def rain_bases():
    """Return the rows of the bases of real forms that are a rain, seed 1, with `form`; ValueError if none is packed."""
    plan = read_rows(STUDY)
    plan = plan[(plan["case"] == BASE) & (plan["seed"] == 1) & (plan["representation"] == "polyhedron")]
    plan = plan.assign(form=form_labels(plan))
    more = read_rows(MORE_FORMS)
    named = more["grain"].fillna(more[SETS].map("{:g}".format).agg("_".join, axis=1))
    return pd.concat([plan, more.assign(form=named)], ignore_index=True)


def rain_model(rows=None):
    """Return the unified model of beds that are a rain, a PorosityModel; rows: as of `rain_bases`."""
    rows = rain_bases() if rows is None else rows
    features = unified_features(statistics_by_number(rows))
    return fit(features[list(UNIFIED)], rows["n"].to_numpy(), "unified", BASE)


def on_lattices(rows):
    """Return the mean porosity over the seeds of beds on lattices with the forms of each row; nan if there is none."""
    single = _single_forms().groupby("grain")["n"].mean()
    mixed = pd.read_csv(REFERENCE / "form_mixture.csv").query("case == @BASE").groupby(SETS)["n"].mean()
    sets = pd.MultiIndex.from_frame(rows[SETS])
    return rows["grain"].map(single).fillna(pd.Series(mixed.reindex(sets).to_numpy(), rows.index))


def compare_coefficients(rain, lattice):
    """Return a table of the coefficients of two models; `ratio`: their difference over its standard error."""
    of_model = {"lattice": lattice, "rain": rain}
    tables = [
        model.to_rows().set_index("term")[["coefficient", "std_error"]].add_suffix(f"_{name}")
        for name, model in of_model.items()
    ]
    table = tables[0].join(tables[1])
    difference = table["coefficient_rain"] - table["coefficient_lattice"]
    error = np.hypot(table["std_error_rain"], table["std_error_lattice"])
    return table.assign(difference=difference, error=error, ratio=difference / error)


def compare_beds(rows, rain, lattice):
    """Return one row per bed: form, mu_EQ, mu_EL, n, and minus n: rain, lattice (models) and on_lattices (beds)."""
    statistics = statistics_by_number(rows)
    features = unified_features(statistics)
    table = rows[["form", "n", "n_error"]].assign(mu_EQ=statistics["mu_EQ"], mu_EL=statistics["mu_EL"])
    models = {"rain": rain.predict(features) - rows["n"], "lattice": lattice.predict(features) - rows["n"]}
    return table.assign(**models, on_lattices=on_lattices(rows) - rows["n"]).sort_values("mu_EL")


def main() -> None:
    """Print the coefficients and the beds."""
    try:
        rows = rain_bases()
    except ValueError as error:
        raise SystemExit(f"base_forms: {error}") from None
    rain, lattice = rain_model(rows), fit_reference_models().models["unified", BASE]
    print(compare_coefficients(rain, lattice).to_string(float_format="%.4f"))
    beds = compare_beds(rows, rain, lattice)
    print(beds.to_string(index=False, float_format="%.4f"))
    rms = {name: np.sqrt(np.mean(np.square(beds[name].dropna()))) for name in ("rain", "lattice", "on_lattices")}
    print(f"{len(beds)} beds, root mean square differences:", ", ".join(f"{k} {value:.4f}" for k, value in rms.items()))
    at_all = beds[beds["form"] == ALL_FORMS]["lattice"].item()
    print(
        "of these, a part is the same for all beds: at the Rhine's forms, the model of beds on lattices errs by "
        f"{at_all:+.4f}"
    )


if __name__ == "__main__":
    main()

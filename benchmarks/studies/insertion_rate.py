"""How the rate of insertion, the time of shaking and the size of the grains change porosity, from beds on lattices.

    python -m benchmarks.studies.insertion_rate

It prints the bases of lattice_beds.csv, base_time.csv, base_rate.csv and base_size.csv in results/reference with their
rates of insertion, and the slopes of the one-class porosity on the logarithms of the three quantities. A second table
has the same bases as a rain (size_and_form.csv), and the part of the difference that the slopes explain. Below it are
the coefficients of 1/EL over the single forms of this table, in fits with 1/EQ. A third one compares all beds that were
packed on a lattice and as a rain: porosity and rate by both, and the step from one class of the same form to the sieve
curve. A fourth one lists these steps beside those of measured gravels. A fifth one has the share of the effect of form
that remains in the beds of a curve: the slope of their porosity against that of one class, over the forms that were
packed. It takes seconds.
"""

import numpy as np
import pandas as pd

from benchmarks.studies.scatter import CORRECTED_FROM, PRESET
from benchmarks.studies.size_and_form_fit import describe_bases, read_rows
from simcore.models.size_and_form.bases import RATE, fit_bases, process_logs
from simcore.models.size_and_form.beds import ALL_FORMS, BASE, SPHERE, form_labels
from simcore.paths import CONFIG, REFERENCE
from simcore.reference.r22_tables import read_r22_table

CONFIGURATION = CONFIG / "insertion_rate.yaml"
LATTICE, OTHER_BASES = "lattice_beds", ("base_time", "base_rate", "base_size")
LATTICE_OF_OTHERS = "wide_both"
FEWEST_FORMS = 3
KEY = ["case", "form", "seed"]  # identifies a bed


def bases():
    """Return the rows of all bases on lattices."""
    rows = [read_rows(name, CONFIGURATION) for name in (LATTICE, *OTHER_BASES)]
    rows[0] = rows[0][rows[0]["case"] == BASE]
    return pd.concat(rows, ignore_index=True)


def bases_table():
    """Return one row per base on a lattice: case, form, spacing, rate in kg/(m² s), time_s, n, n_error."""
    rows = bases()
    rows = rows.assign(form=form_labels(rows), rate=np.exp(process_logs(rows)[RATE]))
    return rows[["case", "form", "spacing", "rate", "time_s", "n", "n_error"]].sort_values(["form", "rate"])


def bases_as_rain():
    """Return one row per base that was packed by both processes, with the difference that the insertion makes.

    Columns: form, n_lattice, n_rain, difference (rain minus lattice) and its error, explained (the part that rate of
    insertion and time of shaking explain, by the slopes of all bases on lattices) and rest. log_<quantity>: difference
    of the logarithm of a quantity that has such a slope.
    """
    fitted = fitted_to_bases()
    tables = []
    for rows in (read_rows(LATTICE, CONFIGURATION), read_rows()):
        rows = rows[(rows["case"] == BASE) & (rows["seed"] == 1)]
        rows = rows.assign(form=form_labels(rows), effect=fitted.effect(rows))
        tables.append(pd.concat([rows[["form", "n", "n_error", "effect"]], process_logs(rows)], axis=1))
    pairs = tables[0].merge(tables[1], on="form", suffixes=("_lattice", "_rain"))
    difference = pairs["n_rain"] - pairs["n_lattice"]
    explained = pairs["effect_rain"] - pairs["effect_lattice"]
    table = pairs[["form", "n_lattice", "n_rain"]].assign(
        difference=difference,
        error=np.hypot(pairs["n_error_lattice"], pairs["n_error_rain"]),
        explained=explained,
        rest=difference - explained,
    )
    logs = {f"log_{name}": pairs[f"{name}_rain"] - pairs[f"{name}_lattice"] for name in fitted.slopes}
    return table.assign(**logs)


def fitted_to_bases():
    """Return the constants and slopes of the bases on lattices."""
    return fit_bases(bases().assign(form=form_labels(bases())))


def elongation_coefficients(pairs):
    """Return the coefficients of 1/EL and their standard errors, DataFrame (2, columns), in fits of columns of `pairs`.

    pairs: of bases_as_rain. The columns difference, explained and rest are fitted by least squares on 1/EQ and 1/EL
    over the single forms. The error of the difference follows from the sampling errors, since six residuals determine
    it poorly; that of the explained part from the errors of the slopes, which are taken as independent.
    """
    beds = read_rows()
    beds = beds.assign(form=form_labels(beds)).query("case == @BASE and seed == 1").set_index("form")
    pairs = pairs[~pairs["form"].isin([ALL_FORMS, SPHERE])]
    means = beds.loc[pairs["form"], ["mu_EQ_evaluated", "mu_EL_evaluated"]].to_numpy()
    # The coefficient of 1/EL is this row times the values.
    row = np.linalg.pinv(np.column_stack([np.ones(len(means)), 1.0 / means]))[2]
    errors = {"difference": float(np.sqrt(np.sum((row * pairs["error"]) ** 2)))}
    of_slopes = [error * (row @ pairs[f"log_{name}"]) for name, error in fitted_to_bases().std_errors.items()]
    errors["explained"] = float(np.sqrt(np.sum(np.square(of_slopes))))
    errors["rest"] = float(np.hypot(errors["difference"], errors["explained"]))
    values = {name: [float(row @ pairs[name]), error] for name, error in errors.items()}
    return pd.DataFrame(values, index=["coefficient of 1/EL", "its error"])


def paired_beds():
    """Return one row per bed that was packed by both processes: KEY and, of each, n, n_error, rate and step.

    rate: of insertion, in kg/(m² s). step: n less that of one class of the form by the same process, nan without one.
    """
    tables = {}
    for name, rows in (("lattice", read_rows(LATTICE, CONFIGURATION)), ("rain", read_rows())):
        rows = rows.assign(form=form_labels(rows), rate=np.exp(process_logs(rows)[RATE]))
        tables[name] = rows[[*KEY, "n", "n_error", "rate"]]
    pairs = tables["lattice"].merge(tables["rain"], on=KEY, suffixes=("_lattice", "_rain"))
    bases = pairs[pairs["case"] == BASE].groupby("form").mean(numeric_only=True)
    steps = {name: pairs[f"n_{name}"] - pairs["form"].map(bases[f"n_{name}"]) for name in tables}
    return pairs.assign(**{f"step_{name}": step for name, step in steps.items()})


def measured_steps():
    """Return one row per measured gravel: case and step from U1, measured and of beds of all forms by each process.

    Measured: by Rettinger et al. (2022), Table 3, in a cylinder. Errors are standard errors of the packed steps. On
    lattices, U7 and B50 were packed with the same settings in LATTICE_OF_OTHERS; they are means over seeds.
    """
    measured = read_r22_table("table3_cases").set_index("case")["n_exp"]
    steps = {"measured": measured - measured[BASE]}
    for name, rows in (("lattice", read_rows(LATTICE, CONFIGURATION)), ("rain", read_rows())):
        beds = rows[(form_labels(rows) == ALL_FORMS) & (rows["seed"] == 1)].set_index("case")[["n", "n_error"]]
        if name == "lattice":
            others = _means_over_seeds(pd.read_csv(REFERENCE / f"{LATTICE_OF_OTHERS}.csv"))
            beds = pd.concat([beds, others.drop(index=beds.index, errors="ignore")])
        steps[name] = beds["n"] - beds["n"][BASE]
        steps[f"{name}_error"] = np.hypot(beds["n_error"], beds["n_error"][BASE])
    return pd.DataFrame(steps).loc[[case for case in measured.index if case != BASE]].rename_axis("case").reset_index()


def _means_over_seeds(rows):
    """Return mean porosity n of the beds of each case and its standard error n_error.

    It is the root mean square of their sampling errors over the root of their number. Seeds whose errors are known to
    be too large are left out of this mean square.
    """
    first = rows["case"].map(lambda case: CORRECTED_FROM.get(f"{case}{PRESET}", 0))
    beds, right = rows.groupby("case"), rows[rows["seed"] >= first].groupby("case")
    error = np.sqrt(right["n_error"].agg(lambda errors: np.square(errors).mean()) / beds.size())
    return pd.DataFrame({"n": beds["n"].mean(), "n_error": error})


def form_slopes(pairs):
    """Return one row per sieve curve with three forms or more: case, forms, slope_lattice and slope_rain.

    slope: of the porosity of beds of the curve against that of one class of the same forms, by the same process.
    """
    rows = []
    for case, beds in pairs[pairs["case"] != BASE].dropna().groupby("case"):
        forms = beds["form"].nunique()
        if forms >= FEWEST_FORMS:
            slopes = {
                f"slope_{name}": np.polyfit(beds[f"n_{name}"] - beds[f"step_{name}"], beds[f"n_{name}"], 1)[0]
                for name in ("lattice", "rain")
            }
            rows.append({"case": case, "forms": forms} | slopes)
    return pd.DataFrame(rows, columns=["case", "forms", "slope_lattice", "slope_rain"])


def main() -> None:
    """Print the tables."""
    print(bases_table().to_string(index=False, float_format="%.4g"))
    print(describe_bases(bases()))
    rain = bases_as_rain()
    print(rain.to_string(index=False, float_format="%.4f"))
    print(elongation_coefficients(rain).to_string(float_format="%.4f"))
    pairs = paired_beds()
    print(pairs.to_string(index=False, float_format="%.4f"))
    print(measured_steps().to_string(index=False, float_format="%.4f"))
    print(form_slopes(pairs).to_string(index=False, float_format="%.2f"))


if __name__ == "__main__":
    main()

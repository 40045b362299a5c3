"""Page of the two papers: where each of their tables and figures is here, its size, and the difference.

papers.yaml lists the tables and figures. Sizes and differences are computed from the committed rows.
"""

import functools
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from benchmarks.studies.mixtures_wide import is_rhine, specified_statistics
from docs.generate.markdown import table
from simcore.campaign.deposit_findings import findings
from simcore.campaign.deposits import curve, read_deposits
from simcore.evaluation.confidence import error_of_mean
from simcore.evaluation.rounding import with_decimals
from simcore.grains.form import FORM_FACTORS
from simcore.grains.form import features as form_features
from simcore.grains.sieve import read_cases
from simcore.grains.statistics import STATISTICS
from simcore.models.regression import fit
from simcore.models.single_form import SINGLE_FORM
from simcore.models.tables import over_seeds
from simcore.paths import CONFIG, REFERENCE
from simcore.reference.committed_rows import fitted_forms, read_mixtures
from simcore.reference.r22_comparison import ROUNDING, add_reference
from simcore.reference.r22_tables import read_r22_models, read_r22_table, rhine_statistics
from simcore.report.figures.models import R22_SPHERES

LISTED = Path(__file__).with_name("papers.yaml")
_HEAD = """# The two papers, table by table

Scree reproduces Rettinger et al. (2022) and Baram and Lind (arXiv:1110.2792). This page lists their tables and figures:
where each is here, how large our version is, and how far the results are apart. Differences are ours minus theirs; ±
is the standard error of both together. The numbers follow from the committed tables in `results/reference/`. [What the
campaigns find](findings.md) explains them, and has the command that draws figures 8 to 12 from these tables.
"""
_TITLES = {"r22": "Rettinger et al. (2022)", "baram_lind": "Baram and Lind"}
VARIANCE_FACTOR = 1.83  # of the azimuths of long axes, docs/reference/deposits.md, "Preferred azimuths"


def listed():
    """Return the tables and figures: dict from the paper to a list of dicts as in papers.yaml."""
    return yaml.safe_load(LISTED.read_text(encoding="utf-8"))


def page():
    """Return the page of the two papers."""
    parts = [_HEAD]
    for paper, entries in listed().items():
        rows = []
        for entry in entries:
            size, difference = _compare(entry)
            rows.append([entry["item"], entry["shows"], entry["here"], size, difference])
        parts += [f"## {_TITLES[paper]}", table(["there", "what it shows", "here", "size here", "difference"], rows)]
    return "\n\n".join(parts) + "\n"


def _compare(entry):
    """Return the size of our version and its difference, as texts."""
    if "picture" in entry:
        return entry["picture"], "a picture"
    if "absent" in entry:
        return "", entry["absent"]
    return _study(entry["study"]) if "study" in entry else COMPARED[entry["compared"]]()


def _rows(name):
    return pd.read_csv(REFERENCE / f"{name}.csv")


def _apart(difference, error):
    """Describe a difference with its standard error."""
    return f"{_signed(difference)} ± {error:.4f} ({abs(difference) / error:.1f} standard errors)"


def _feature(name):
    """Return the name of a feature as the texts have it."""
    return name.replace("_inv", "⁻¹")


def _signed(value, digits=4):
    return with_decimals(value, digits, "+")


def _study(study):
    """Compare the rows of a study with the table of the paper, case by case."""
    packed, open_ = _not_packed(study)
    if not (REFERENCE / f"{study}.csv").exists():
        return packed, open_
    rows = _beside_theirs(study)
    return packed, _apart_by_case(rows["case"], rows["difference"], rows["z"]) or "the paper has no such beds"


def _beside_theirs(study):
    """Return the means over the seeds of a study, with the values of Rettinger et al. from `add_reference`."""
    rows = _rows(study).rename(columns={"n_error": "n_std_error"})
    settings = [name for name in ("case", "shaking_s", "width_m", "height_m", "mass_kg") if name in rows]
    columns = {"n": "mean", "n_std_error": error_of_mean}
    means = rows.groupby(settings, sort=False, dropna=False)[list(columns)].agg(columns)
    return add_reference(means.reset_index(), study)


def _apart_by_case(cases, differences, in_errors):
    """Describe the range of differences of each case and the largest one in standard errors; empty without any."""
    table = pd.DataFrame({"case": cases, "apart": differences, "z": in_errors}).dropna()
    texts = []
    for case, rows in table.groupby("case", sort=False):
        ends = list(dict.fromkeys(_signed(value, 3) for value in (rows["apart"].min(), rows["apart"].max())))
        up_to = "up to " if len(rows) > 1 else ""
        texts.append(f"{case} {' to '.join(ends)} ({up_to}{rows['z'].abs().max():.1f} standard errors)")
    return "; ".join(texts)


def _not_packed_of(cases):
    """Return the words on sieve curves without packings; empty without such curves."""
    return f"; {' and '.join(cases)} {'are' if len(cases) > 1 else 'is'} not packed" if cases else ""


def _not_packed(study):
    planned = _rows("collected").set_index("study").loc[study]
    return f"{planned.packings} of {planned.planned} packings", "not packed yet"


def _factors():
    return f"all {len(FORM_FACTORS)}", "none: they are definitions"


def _forms():
    ours, theirs = _rows("grains/statistics"), rhine_statistics()
    ours = ours.iloc[0]
    texts = [f"mean {ratio} {_signed(ours[f'mu_{ratio}'] - theirs[f'mu_{ratio}'], 3)}" for ratio in ("FL", "EL")]
    return f"{ours.n_samples} synthetic grains", ", ".join(texts) + ", because they are made to have these statistics"


def _factor_correlations():
    ours = pd.read_csv(REFERENCE / "grains" / "correlations.csv", index_col=0)
    theirs = read_r22_table("correlations").query("feature == 'FL~EL'")["r"].iloc[0]
    texts = f"r of FL with EL {_signed(ours.loc['FL', 'EL'] - theirs, 3)}, because the grains are made to have theirs"
    return (
        f"{len(ours)} factors, {len(_rows('grains/forms'))} synthetic grains",
        f"{texts}; we have no other value of theirs",
    )


def _components():
    ours = _rows("grains/components").set_index("component")["cumulative"]
    return "as Fig. 3", f"two components explain {100 * ours['PC2']:.1f} % of the variance; theirs: two suffice"


def _normality():
    ours = _rows("grains/statistics").iloc[0]
    values = (f"{ratio} p = {ours[f'shapiro_p_{ratio}']:.2f}" for ratio in ("FL", "EL"))
    return f"{ours.n_samples} synthetic grains", (
        f"{', '.join(values)}; none is below 0.05, as theirs, because forms are drawn again if one is"
    )


def _curves():
    return f"all {len(read_cases(CONFIG / 'cases.tsv'))}", "none: they are given"


def _faces():
    ours = _rows("grains/decimation_summary").set_index("target")["volume_change_percent"]
    theirs = read_r22_table("table4_mesh_resolution").drop_duplicates("faces").set_index("faces")
    theirs = theirs["volume_change_percent"].drop("original").rename(lambda faces: int(str(faces).removeprefix("<=")))
    texts = (
        f"{faces} faces {_signed(ours[faces], 2)} % (theirs {_signed(value, 1)} %)" for faces, value in theirs.items()
    )
    packed, open_ = _not_packed("mesh_resolution")
    if (REFERENCE / "mesh_resolution.csv").exists():
        open_ = _porosity_over_faces(_rows("mesh_resolution")) or "of no pair of beds yet"
    grains = _rows("grains/decimation")["grain"].nunique()
    return f"volumes of {grains} grains; {packed}", f"volume: {', '.join(texts)}; porosity {open_}"


def _porosity_over_faces(rows, base="300"):
    """Compare beds of grains of several numbers of faces with those of `base` faces, as text; empty without a pair."""
    theirs = read_r22_table("table4_mesh_resolution")
    theirs = theirs.assign(faces=theirs["faces"].str.removeprefix("<=")).set_index(["case", "faces"])["n"]
    texts = []
    for case, beds in rows.assign(faces=rows["faces"].astype(str)).groupby("case", sort=False):
        means = beds.groupby("faces", sort=False).agg(n=("n", "mean"), error=("n_error", error_of_mean))
        if base not in means.index:
            continue
        for faces, bed in means.drop(base).iterrows():
            error = np.hypot(bed["error"], means["error"][base])
            texts.append(
                f"{case} {faces if faces == 'original' else f'{faces} faces'} "
                f"{_signed(bed['n'] - means['n'][base], 3)} ± {error:.3f} "
                f"(theirs {_signed(theirs[case, faces] - theirs[case, base], 3)})"
            )
    return f"minus that of {base} faces: {', '.join(texts)}" if texts else ""


def _shaking_cylinder():
    rows = _rows("shaking_cylinder")
    seeds = f"{_count(rows.groupby(['case', 'shaking_s']).size().min(), 'seed')} of 3"
    return f"{len(rows)} packings of half the mass, {seeds}", _study("shaking_cylinder")[1]


def _count(number, noun):
    """Return a number with its noun: 1 seed, 2 seeds."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


def _validation():
    rows = _beside_theirs("validation").set_index("case")
    apart, z = rows["difference"], rows["z"].abs()
    close = int((rows["experiment_error_percent"].abs() <= 5.0).sum())
    return (
        f"{len(_rows('validation'))} of {3 * len(read_cases(CONFIG / 'cases.tsv'))} packings",
        f"{_signed(apart.min(), 3)} ({apart.idxmin()}) to {_signed(apart.max(), 3)} ({apart.idxmax()}); "
        f"{int((z <= 2).sum())} of {len(z)} within two standard errors; {close} within 5 % of the experiment",
    )


def _single(case):
    forms = fitted_forms(_rows("single_form"))
    rows = forms[(forms["case"] == case) & (forms["source"] == "synthetic") & (forms["representation"] == "polyhedron")]
    beds = over_seeds(rows, "grain")
    features = form_features(*(beds[axis].to_numpy() for axis in "LIS"))[list(SINGLE_FORM)]
    model = fit(features, beds["n"].to_numpy(), "single_form", case)
    FL, EL = rhine_statistics()[["mu_FL", "mu_EL"]]
    of_form = np.array([1.0, 1 / (FL * EL), 1 / EL])  # the intercept and the features of SINGLE_FORM
    error = float(np.sqrt(of_form @ np.array(model.covariance) @ of_form))
    mean = _rows("models/single_form_mean_form").query("case == @case and source == 'synthetic'").iloc[0]
    size = f"{rows['grain'].nunique()} of 63 forms, {len(rows)} packings of {rows['grains'].median():.0f} grains"
    # Without several classes there is no chance in the masses of the classes.
    note = "" if case == "U1" else "; all forms share one draw of sizes, and ± does not contain its chance"
    return size, f"at the mean form {_apart(mean.n - mean.r22_n, np.hypot(error, ROUNDING))}{note}"


def _correlation():
    ours = _rows("models/single_form_correlations").dropna(subset="r22_r")
    texts = []
    for (case, source), rows in ours.groupby(["case", "source"], sort=False):
        apart = (f"{_feature(row.feature)} {_signed(row.r - row.r22_r, 3)}" for row in rows.itertuples())
        texts.append(f"{case}, {source}: {', '.join(apart)}")
    return "as Eqs. 17 to 19, and 63 scans in U1", "difference of r: " + "; ".join(texts)


def _prediction_of_forms():
    ours = _rows("models/single_form_second_features").query("feature == 'EL_inv' and source == 'synthetic'")
    errors = (f"{row.case} {row.mean_absolute_error:.4f} (theirs {row.r22_error:.4f})" for row in ours.itertuples())
    return "as Eqs. 17 to 19", "errors of predictions: " + ", ".join(errors)


def _second_feature():
    ours = _rows("models/single_form_second_features").query("case == 'U1' and source == 'synthetic'")
    error = ours.set_index("feature")["mean_absolute_error"]
    theirs = read_r22_table("table9_second_factor_mae").set_index("case").loc["U1"] * 1e-3
    return "as Eq. 17", (
        f"with EL⁻¹ error {error['EL_inv']:.4f} (theirs {theirs['EL_inv']:.4f}); the best is {error.idxmin()} with "
        f"{error.min():.4f} (theirs {theirs.idxmin()} with {theirs.min():.4f})".replace("_inv", "⁻¹")
    )


def _ellipsoids():
    row = _rows("models/shape_kinds").iloc[0]
    ellipsoids = _rows("single_form").query("representation == 'ellipsoid'")
    seeds = _count(ellipsoids.query("case == @row.case").groupby("grain").size().min(), "seed")
    open_ = [case for case in ("U7", "B50") if case not in set(ellipsoids["case"])]
    size = f"{row.case}, {row.forms} forms, {seeds}" + _not_packed_of(open_)
    return size, (
        f"ellipsoids and grains differ by {row.rms_difference:.4f} (root mean square), theirs by "
        f"{row.r22_rms_difference:.4f}"
    )


def _spheres():
    rows = _rows("near_spheres").query("shape_kind == 'sphere'")
    seeds = _count(len(rows), "seed")
    error = float(np.hypot(error_of_mean(rows["n_error"]), 10 * ROUNDING))
    return f"{rows['grains'].iloc[0]} grains, {seeds}", _apart(rows["n"].mean() - R22_SPHERES["U1"], error)


def _mixtures():
    rows = read_mixtures(REFERENCE / "form_mixture.csv").query("case == 'U1'")
    grains = _rows("form_mixture")["grains"].median()
    model = read_r22_models()["form_mixture", "U1"]
    predicted = model.porosity(1.0 / rows[list(STATISTICS)].add_suffix("_inv"))
    apart = (rows["n"] - predicted).groupby(rows["sample"]).mean()
    size = f"{len(apart)} of 52 sets, {len(rows)} packings of {grains:.0f} grains"
    return size, (
        f"packings minus their model: mean {_signed(apart.mean())} ± {apart.sem():.4f}, root mean square "
        f"{np.sqrt((apart**2).mean()):.4f}, at most {_signed(apart[apart.abs().idxmax()])}"
    )


def _mixtures_U7():
    rows = _rows("mixtures_wide")
    sets = rows[~is_rhine(rows)]
    if sets.empty:
        return "0 of 52 sets", "not packed yet"
    model = read_r22_models()["form_mixture", "U7"]
    apart = sets["n"] - model.porosity(1.0 / specified_statistics(sets).add_suffix("_inv"))
    texts = [_signed(apart.mean()) + (f" ± {apart.sem():.4f}" if len(sets) > 1 else "")]
    texts += [f"at most {_signed(apart[apart.abs().idxmax()])}"] if len(sets) > 1 else []
    return f"{len(sets)} of 52 sets, inserted as a rain", f"packings minus their model: {', '.join(texts)}"


def _number_of_features(sets):
    return sets[[name for name in sets if name.endswith("_inv")]].sum(axis=1)


def _all_four(sets):
    return sets[_number_of_features(sets) == 4].iloc[0]


def _feature_sets():
    rows = _rows("models/form_mixture_feature_sets").query("case == 'U1'")
    first, last = rows[_number_of_features(rows) == 1].iloc[0], _all_four(rows)
    return "as Eq. 23", (
        f"with µ_EQ⁻¹ alone error {first.mean_absolute_error:.4f} (theirs {first.r22_error:.4f}); with all four "
        f"{last.mean_absolute_error:.4f} ({last.r22_error:.4f})"
    )


def _prediction_of_mixtures():
    row = _all_four(_rows("models/form_mixture_feature_sets").query("case == 'U1'"))
    return "as Eq. 23, U1", f"R² {row.r_squared:.3f} (theirs {row.r22_r_squared:.3f})"


def _application():
    rows = _rows("application").query("case == 'U1'")
    theirs = read_r22_table("table11_application").set_index("case").loc["U1"]
    texts, rain = [], _rows("mixtures_wide")
    rain = rain[is_rhine(rain)]
    for choice, name, words in (
        ("form_distribution", "continuous", "forms drawn from a distribution"),
        ("random", "discrete", "grains drawn one by one"),
    ):
        n = rows[rows["choice"] == choice]["n"]
        texts.append(f"{words} {_apart(n.mean() - theirs[f'{name}_simulated'], np.hypot(n.sem(), ROUNDING))}")
    if rain.empty:
        return f"U1, {len(rows)} packings{_not_packed_of(['U7'])}", "; ".join(texts)
    theirs = read_r22_table("table11_application").set_index("case").loc["U7", "continuous_simulated"]
    error = float(np.hypot(error_of_mean(rain["n_error"]), ROUNDING))
    texts.append(f"U7, forms drawn from a distribution, as a rain {_apart(rain['n'].mean() - theirs, error)}")
    return f"U1, {len(rows)} packings; U7, {len(rain)}", "; ".join(texts)


@functools.cache
def _deposits():
    return read_deposits(REFERENCE / "deposits.csv")


@functools.cache
def _densest_forms():
    """Return the densest forms of three families of deposits: a table with their family as index."""
    return findings(_deposits())["maxima"].query("of == 'solid_fraction'").set_index("family")


def _densest():
    rows, row = _deposits(), _densest_forms().loc["diagonal"]
    return f"{len(rows)} deposits of {rows['grains'].min()} to {rows['grains'].max()} grains", (
        f"η = ζ at the maximum {row.ratio:.3f} ± {row.ratio_error:.3f} instead of 1.6"
    )


def _spheroids():
    tops, texts = _densest_forms(), []
    for name in ("prolate", "oblate"):
        apart = tops.value[name] - tops.value["diagonal"]
        error = np.hypot(tops.value_error[name], tops.value_error["diagonal"])
        texts.append(f"{name} {_signed(apart)} ± {error:.4f}")
    packings = " and ".join(str(len(curve(_deposits(), name))) for name in ("prolate", "oblate"))
    return f"{packings} deposits", (
        f"solid fraction of the densest, relative to the densest of all: {', '.join(texts)}; theirs are below it too"
    )


def _spread():
    rows = _deposits().query("family == 'sizes'")
    means = rows.groupby(["eta", "spread"])["solid_fraction"].mean().unstack()
    apart = means.sub(means[0.0], axis=0)
    texts = (
        f"S = {spread:g} {_signed(apart[spread].min(), 3)} to {_signed(apart[spread].max(), 3)}"
        for spread in apart.columns[1:]
    )
    return f"{len(rows)} deposits of {len(means)} forms", (
        f"change of the solid fraction: {', '.join(texts)}; theirs hardly changes for small and moderate S"
    )


def _coordination():
    rows = curve(_deposits(), "diagonal")
    means = rows.groupby("ratio")["coordination_number"].mean()
    return f"{len(rows)} deposits with η = ζ", (
        f"{means[1.0]:.1f} contacts for spheres, {means[1.6]:.1f} at η = ζ = 1.6, {means[2.5]:.1f} at 2.5; theirs fall "
        "again for large η and ζ"
    )


def _azimuth():
    texts = []
    for name, factor, words in (("contact_normal", 1.0, "contacts"), ("long_axis", VARIANCE_FACTOR, "long axes")):
        values = _deposits()[f"azimuth_p2_{name}"].dropna() ** (1.0 / factor)
        texts.append(f"{int((values < 0.05).sum())} of {len(values)} deposits for {words}")
    return f"{len(_deposits())} deposits", (
        f"p for a preferred direction is below 0.05 in {' and in '.join(texts)}, where chance gives one in 20; p of "
        f"long axes is corrected for parallel neighbours (c = {VARIANCE_FACTOR}); theirs prefer none"
    )


def _crossings():
    rows = _rows("deposit_crossings").set_index("direction")
    contact, axis = (np.degrees(rows.loc[name, ["angle", "std_error"]]) for name in ("contact_normal", "long_axis"))
    return f"{rows['forms'].max()} forms", (
        f"contacts {contact.iloc[0]:.1f}° ± {contact.iloc[1]:.1f}°, long axes {axis.iloc[0]:.1f}° ± {axis.iloc[1]:.1f}°"
    )


COMPARED = {
    "factors": _factors,
    "forms": _forms,
    "factor_correlations": _factor_correlations,
    "components": _components,
    "normality": _normality,
    "curves": _curves,
    "faces": _faces,
    "shaking_cylinder": _shaking_cylinder,
    "validation": _validation,
    "single_U1": lambda: _single("U1"),
    "single_U7": lambda: _single("U7"),
    "single_B50": lambda: _single("B50"),
    "correlation": _correlation,
    "prediction_of_forms": _prediction_of_forms,
    "second_feature": _second_feature,
    "ellipsoids": _ellipsoids,
    "spheres": _spheres,
    "mixtures": _mixtures,
    "mixtures_U7": _mixtures_U7,
    "feature_sets": _feature_sets,
    "prediction_of_mixtures": _prediction_of_mixtures,
    "application": _application,
    "densest": _densest,
    "spheroids": _spheroids,
    "spread": _spread,
    "coordination": _coordination,
    "azimuth": _azimuth,
    "crossings": _crossings,
}

"""Porosity of a bed of measured grains, by our models and by the study's, with how far either can be trusted."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from simcore.grains.measured_forms import read_samples
from simcore.models.files import read_models
from simcore.models.mixtures import MIXTURE
from simcore.models.regression import fit_and_validate
from simcore.models.single_form import SINGLE_FORM
from simcore.models.tables import over_seeds
from simcore.models.unified import STATISTICS, fit_unified, unified_features
from simcore.paths import R22_TABLES, REFERENCE
from simcore.reference.r22_tables import read_study_table

ONE_CLASS = "one-class"  # any single sieve class
_OF_ONE_CLASS = "U1"
# What the table of a study calls the means over the grains, and the reference rows what was asked for.
_OF_A_STUDY = {"EQ": "mu_EQ", "EL": "mu_EL"}
_NOMINAL = {
    f"{kind}_{feature}_nominal": f"{word}_{feature}"
    for feature in ("FL", "EL")
    for kind, word in (("mu", "mean"), ("sigma", "std"))
}
# Means and standard deviations of FL and EL of the mixtures that stand behind Eqs. 23 and 24 (the study, Fig. 11).
STUDY_MIXTURES = {"mu": (0.4, 0.8), "sigma": (0.1, 0.2)}
# Share of the least deviation fitted below which a bed is taken for one form by the study's models: 1/sigma of its
# model for distributions would run to any porosity.
NEARLY_ONE_FORM = 0.5
FEW_GRAINS = 30  # whose spread of form is not known well


@dataclass(frozen=True)
class FittedModels:
    """models: dict from (name, case) to PorosityModel; behind: from the same, which rows they come from, in words."""

    models: dict
    behind: dict

    def cases(self):
        """The cases for which there is a model."""
        return sorted({case for _, case in self.models})


def fit_reference_models(folder=REFERENCE, source=None, seed=0):
    """Models fitted to the packings that are committed with the code: FittedModels.

    folder: single_form.csv and form_mixture.csv, one row a packing, of the largest campaign. A model for which it has
    no rows, or too few, is fitted to the tables of the default campaign in default/ (single_form.csv,
    form_mixtures.csv); the unified model takes both kinds of bed from one campaign. source: of the grains of single
    forms, such as "synthetic"; None: all. Beds of ellipsoids are left out: real grains have facets.
    """
    folder, found = Path(folder), FittedModels({}, {})
    campaigns = [(folder, "form_mixture.csv"), (folder / "default", "form_mixtures.csv")]
    forms = {place / "single_form.csv": None for place, _ in campaigns if (place / "single_form.csv").exists()}
    forms = {path: read_single_forms(path) for path in forms}
    sources = {name for table in forms.values() for name in table["source"]}
    if source is not None and source not in sources:
        said = ", ".join(sorted(sources - {""})) or "none"
        raise ValueError(f"{folder}: has no grains of source {source}; there are {said}")
    for place, name in campaigns:
        single, mixture = place / "single_form.csv", place / name
        ones = forms.get(single)
        if ones is not None and source is not None:
            ones = ones[ones["source"] == source]
        many = _read_mixtures(mixture) if mixture.exists() else None
        models, behind = _fit_campaign(ones, many, seed), {}
        for kind, case in models:
            what, table, path = ("forms", ones, single) if kind == "single_form" else ("mixtures", many, mixture)
            packings = int((table["case"] == case).sum())
            behind[kind, case] = (
                f"{_short(single)} and {mixture.name}, {models[kind, case].n_samples} beds"
                if kind == "unified"
                else f"{_short(path)}, {models[kind, case].n_samples} {what} in {packings} packings"
            )
            if kind != "single_form":
                behind[kind, case] += ", its error that of mean forms left out"
        for key in models.keys() - found.models.keys():
            found.models[key], found.behind[key] = models[key], behind[key]
    if not found.models:
        raise ValueError(f"{folder}: neither it nor its default/ has tables of packings to fit models to")
    return found


def _fit_campaign(forms, mixtures, seed):
    """Models of a campaign's packings; either table may be None. What too few of them carry is left out."""
    models = {}
    if forms is not None:
        for case, rows in over_seeds(forms, "grain").groupby("case"):
            if len(rows) >= len(SINGLE_FORM) + 3:
                features = pd.DataFrame({"EQ_inv": rows.L / rows.S, "EL_inv": rows.L / rows.I})
                models["single_form", case] = fit_and_validate(features, rows.n, "single_form", case, seed)
    if mixtures is not None:
        for case, rows in over_seeds(mixtures, "sample").groupby("case"):
            # Sets of one mean form are left out together, as for the unified model: so their errors compare.
            groups = rows.groupby(["mean_FL", "mean_EL"]).ngroup()
            if len(rows) - groups.value_counts().max() > len(MIXTURE) + 1 and groups.nunique() > 2:
                features = unified_features(rows)[list(MIXTURE)]
                models["form_mixture", case] = fit_and_validate(features, rows.n, "form_mixture", case, seed, groups)
    if forms is not None and mixtures is not None:
        models |= fit_unified(forms, mixtures, seed)
    return models


def read_campaign_models(folder):
    """The models of a campaign's folder results/models, from its netCDF files: FittedModels."""
    models, behind = {}, {}
    files = [Path(folder) / f"{name}.nc" for name in ("single_form", "form_mixture", "unified")]
    for path in filter(Path.exists, files):
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            mark = ", test only" if dataset.attrs.get("test_only") else ""
        for key, model in read_models(path).items():
            if key[0] == path.stem:
                models[key], behind[key] = model, f"{model.n_samples} beds{mark}: {path}"
    if not models:
        names = ", ".join(path.name for path in files)
        raise ValueError(f"{folder}: has no model in {names}; give the folder results/models of a campaign")
    return FittedModels(models, behind)


def predict_samples(samples, case, fitted, level=0.95, study=R22_TABLES):
    """Porosity of each sample by each model that holds for it, DataFrame with one row a sample and model.

    samples: list of simcore.grains.measured_forms.Sample; case: of a model, or ONE_CLASS: size does not matter then,
    for porosity depends on ratios of sizes, so that U1's model serves any one sieve class. level: of the prediction
    intervals.

    Columns: the fields of Sample, taken_as ("one form" or "a distribution"), by ("ours" or "study"), model, preferred
    (of ours: the one to take), n, lower, upper (nan for the study, which publishes no covariance), outside (in words,
    empty where the sample lies within what was fitted). Of a distribution that of our models is preferred whose
    cross-validated error is smaller, among those that were fitted to such features; where none was, the unified one,
    which holds for narrow distributions too. ValueError where neither has a model of the case, or for a sample.
    """
    case = _OF_ONE_CLASS if case == ONE_CLASS else case
    published = read_study_table("models", study).query("case == @case").set_index("model")
    if case not in fitted.cases() and published.empty:
        known = sorted({*fitted.cases(), *read_study_table("models", study)["case"]})
        raise ValueError(f"case {case}: no model was fitted to it; there are {', '.join(known)}, {ONE_CLASS}")
    rows = []
    for sample in samples:
        statistics = {"taken_as": "one form" if sample.one_form else "a distribution", **vars(sample)}
        features = _features(sample)
        found = [*_ours(sample, features, case, fitted, level), *_studys(sample, features, published, study)]
        if not found:
            raise ValueError(
                f"case {case}, sample {sample.name}: no model, ours or the study's, was fitted to beds of {case} with "
                f"a distribution of form, only of one form; give grains one by one, a sample each, or take another case"
            )
        rows += [{**statistics, **each} for each in found]
    return pd.DataFrame(rows)


def describe(table, case, fitted, level=0.95):
    """The predictions as text for people: a row a sample, then the models and what lies outside them."""
    of = _OF_ONE_CLASS if case == ONE_CLASS else case
    lines = [f"Porosity of a bed, case {of}, with {100 * level:g} % prediction intervals"]
    if case == ONE_CLASS:
        lines.append("(any one sieve class packs alike whatever its size, for only ratios of sizes matter: U1's model)")
    if of not in fitted.cases():
        lines.append(f"None of our packings is of {of}, only of {', '.join(fitted.cases())}: the study's model alone")
    else:
        for kind in table.loc[~table.groupby("name").preferred.transform("any"), "taken_as"].unique():
            form = kind if kind == "one form" else "a distribution of form"
            lines.append(f"Too few of our packings of {of} have {form}: the study's model alone for these samples")
    shown = [["sample", "grains", "taken as", "FL", "EL", "ours", "by", "other of ours", "study"]]
    for _, rows in table.groupby("name", sort=False):
        one = rows.iloc[0]
        taken = rows[rows.preferred]
        other, study = rows[(rows.by == "ours") & ~rows.preferred], rows[rows.by == "study"]
        shown.append(
            [
                str(one["name"]),
                str(one.grains) if one.grains else "-",
                one.taken_as,
                f"{one.mu_FL:.3f} ± {one.sigma_FL:.3f}",
                f"{one.mu_EL:.3f} ± {one.sigma_EL:.3f}",
                _cell(taken),
                taken.model.iloc[0] if len(taken) else "-",
                _cell(other),
                _cell(study),
            ]
        )
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    lines += ["", *("  ".join(text.ljust(w) for text, w in zip(row, widths, strict=True)).rstrip() for row in shown)]
    lines += ["", "Models"]
    for (by, name), _ in table.groupby(["by", "model"], sort=False):
        lines.append(f"  {_equation(by, name, of, fitted)}")
    wrong = table[table.outside != ""]
    if len(wrong):
        lines += ["", "* outside what the model was fitted to: an extrapolation, of which its interval does not know"]
        lines += [f"  {row['name']}, {row.by} {row.model}: {row.outside}" for _, row in wrong.iterrows()]
    lines.append("")
    if (table.grains == 0).any():
        lines.append("From means and deviations alone, FL and EL are taken for independent, as the study does.")
    few = table[(table.grains > 1) & (table.grains < FEW_GRAINS)].name.unique()
    if len(few):
        lines.append(f"Fewer than {FEW_GRAINS} grains do not tell how widely form is spread: {', '.join(few)}.")
    if (table.grains > 0).any() and (table.taken_as != "one form").any():
        lines.append("Intervals do not hold the error of a sample's own statistics, which are those of its grains.")
    lines.append("An interval holds the bed of a new sample, packed as those behind the model; the study has none.")
    return "\n".join(lines)


def as_json(table, case, fitted, level=0.95):
    """The predictions as JSON text: the models, and for each sample its predictions."""
    of = _OF_ONE_CLASS if case == ONE_CLASS else case
    common = ["name", "grains", "taken_as", "mu_FL", "sigma_FL", "mu_EL", "sigma_EL", "mu_EQ", "sigma_EQ"]
    own = ["by", "model", "preferred", "n", "lower", "upper", "outside"]
    samples = []
    for _, rows in table.groupby("name", sort=False):
        samples.append(
            {**_plain(rows.iloc[0][common]), "predictions": [_plain(row) for _, row in rows[own].iterrows()]}
        )
    models = [
        {
            "model": name,
            "case": model.case,
            "behind": fitted.behind[name, where],
            "coefficients": dict(zip(model.terms, model.coefficients, strict=True)),
            "cross_validated_error": model.mean_absolute_error,
        }
        for (name, where), model in fitted.models.items()
        if where == of
    ]
    return json.dumps({"case": of, "level": level, "models": models, "samples": samples}, indent=1, allow_nan=False)


def predict_file(path, case, models=None, source=None, column=None, level=0.95, form="text"):
    """What `python -m simcore predict` prints; form: "text", "csv" or "json"."""
    if not 0 < level < 1:
        raise ValueError(f"level {level:g}: a number between 0 and 1 is needed, such as 0.95")
    if models is not None and source is not None:
        raise ValueError("--source chooses among committed rows; a campaign's models (--models) are fitted already")
    samples = read_samples(path, column)
    fitted = fit_reference_models(source=source) if models is None else read_campaign_models(models)
    table = predict_samples(samples, case, fitted, level)
    if form == "csv":
        return table.rename(columns={"name": "sample"}).to_csv(index=False).rstrip("\n")
    return (as_json if form == "json" else describe)(table, case, fitted, level)


def _features(sample):
    """All features of the models, a table of one row; 1/sigma is infinite for one form."""
    statistics = pd.DataFrame([{name: getattr(sample, name) for name in STATISTICS}])
    features = unified_features(statistics)
    return features.assign(EQ_inv=features.mu_EQ_inv, EL_inv=features.mu_EL_inv)


def _ours(sample, features, case, fitted, level):
    """Rows of our models, the preferred one marked."""
    rows = []
    for name in ("single_form" if sample.one_form else "form_mixture", "unified"):
        model = fitted.models.get((name, case))
        if model is None or not np.isfinite(features[list(model.features)]).all(axis=None):
            continue
        n, lower, upper = (float(value[0]) for value in model.predict_interval(features, level))
        outside = "; ".join(
            f"{feature} = {value:.4g}, fitted from {low:.4g} to {high:.4g}"
            for feature, value, low, high in model.outside(features)[0]
        )
        rows.append(
            {
                "by": "ours",
                "model": name,
                "preferred": False,
                "n": n,
                "lower": lower,
                "upper": upper,
                "outside": outside,
            }
        )
    if rows:
        chosen = rows[0]
        if not sample.one_form:
            inside = [row for row in rows if not row["outside"]] or rows[-1:]
            chosen = min(inside, key=lambda row: fitted.models[row["model"], case].mean_absolute_error)
        chosen["preferred"] = True
    return rows


def _studys(sample, features, published, folder):
    """The row of the study's model, if it has one for this case and kind of bed."""
    least = NEARLY_ONE_FORM * STUDY_MIXTURES["sigma"][0]
    nearly = not sample.one_form and max(sample.sigma_FL, sample.sigma_EL) < least
    name = "single_form" if sample.one_form or nearly else "form_mixture"
    if name not in published.index:
        return []
    slopes = published.loc[name].drop(["intercept", "case", "equation_arxiv"]).dropna().astype(float)
    n = published.loc[name, "intercept"] + float(features[slopes.index].to_numpy()[0] @ slopes.to_numpy())
    if name == "single_form":
        # The range is not published; its grains are the first data set of its Table 2.
        grains = read_study_table("table2_form_statistics", folder).iloc[0]
        ranges = {
            f"mu_{X}": (
                grains[f"mu_{X}"] - 2 * grains[f"sigma_{X}"],
                min(grains[f"mu_{X}"] + 2 * grains[f"sigma_{X}"], 1.0),
            )
            for X in ("FL", "EL")
        }
    else:
        ranges = {f"{kind}_{X}": STUDY_MIXTURES[kind] for kind in ("mu", "sigma") for X in ("FL", "EL")}
    outside = "; ".join(
        f"{key} = {getattr(sample, key):.4g}, fitted from {low:.3g} to {high:.3g}"
        for key, (low, high) in ranges.items()
        if not low <= getattr(sample, key) <= high
    )
    if nearly:
        outside = "; ".join(filter(None, [f"sigma_FL and sigma_EL are below {least:g}: taken for one form", outside]))
    row = {"by": "study", "model": name, "preferred": False, "n": float(n), "lower": np.nan, "upper": np.nan}
    return [{**row, "outside": outside}]


def read_single_forms(path):
    """Packings of one form each, meshes alone: case, source ("" if none is named), grain with source, L, I, S, n."""
    table = pd.read_csv(path)
    if "representation" in table:
        table = table[table.representation == "mesh"]
    if "source" not in table:
        table = table.assign(source="")
    table = table.assign(grain=table.source + " " + table.grain)
    if not {"L", "I", "S"} <= set(table):
        table = table.assign(L=1 / table.EL, I=1.0, S=table.FL)
    return table[["case", "source", "grain", "L", "I", "S", "n"]]


def _read_mixtures(path):
    """Packings of mixtures: case, sample, n, mean_FL, mean_EL as asked for, and statistics over their grains."""
    table = pd.read_csv(path)
    if "mu_EQ" not in table:
        table = table.rename(columns=_OF_A_STUDY)
    table = table.rename(columns=_NOMINAL)
    sample = table[list(_NOMINAL.values())].astype(str).agg(" ".join, axis=1)
    return table.assign(sample=sample)[["case", "sample", "n", "mean_FL", "mean_EL", *STATISTICS]]


def _short(path):
    root = REFERENCE.parents[1]
    return str(path.relative_to(root) if path.is_relative_to(root) else path)


def _cell(rows):
    if rows.empty:
        return "-"
    row = rows.iloc[0]
    mark = "*" if row.outside else ""
    interval = f" ({row.lower:.3f} to {row.upper:.3f})" if np.isfinite(row.lower) else ""
    return f"{row.n:.3f}{mark}{interval}"


def _equation(by, name, case, fitted):
    if by == "study":
        row = read_study_table("models").query("case == @case and model == @name").iloc[0]
        slopes = row.drop(["model", "case", "intercept", "equation_arxiv"]).dropna()
        text = _terms(row["intercept"], slopes.index, slopes)
        return f"study {name}: {text}; its Eq. {row['equation_arxiv']}"
    model = fitted.models[name, case]
    text = _terms(model.coefficients[0], model.features, model.coefficients[1:])
    error = f"cross-validated error {model.mean_absolute_error:.4f} (mean), {model.median_absolute_error:.4f} (median)"
    return f"ours {name}: {text}; {error}; {fitted.behind[name, case]}"


def _terms(intercept, names, slopes):
    return f"n = {intercept:.4f}" + "".join(f" {slope:+.4f} {name}" for name, slope in zip(names, slopes, strict=True))


def _plain(row):
    """A dict for JSON, where a number that is not finite is null."""
    values = {key: value.item() if isinstance(value, np.generic) else value for key, value in row.items()}
    return {
        key: None if isinstance(value, float) and not np.isfinite(value) else value for key, value in values.items()
    }

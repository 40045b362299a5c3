"""Fit porosity models to the committed packings, or read those of a campaign."""

from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from simcore.models.files import load_models, read_models
from simcore.models.measured_file import is_file_of_fit, not_written_by_fit, read_curve_models, read_measured_models
from simcore.models.mixtures import MIXTURE, groups_of_means
from simcore.models.regression import fewest_samples, fit_and_validate
from simcore.models.single_form import SINGLE_FORM
from simcore.models.size_and_form.curve_correction import read_correction
from simcore.models.tables import over_seeds
from simcore.models.unified import fit_unified, unified_features
from simcore.paths import REFERENCE, project_name
from simcore.reference.committed_rows import fitted_forms, read_mixtures, read_single_forms


@dataclass(frozen=True)
class FittedModels:
    """Fitted models and the rows that they were fitted to.

    models: dict from (name, case) to PorosityModel; behind: dict from the same keys to a description of these rows;
    only_kind: dict from some of these keys to "one form" or "a distribution of form", for a model that is evaluated for
    both kinds of bed and was fitted to one kind only. curve: CurveCorrection of the model of size and form to measured
    beds with sieve curves, or None.
    """

    models: dict
    behind: dict
    only_kind: dict = field(default_factory=dict)
    curve: object = None

    def cases(self):
        """Return the cases for which there is a model, sorted."""
        return sorted({case for _, case in self.models})


def fit_reference_models(folder=REFERENCE, source=None, seed=0):
    """Fit the models to the packings that are committed with the code: FittedModels.

    folder: contains single_form.csv and form_mixture.csv of the largest campaign, with one row per packing. A model for
    which these have no rows, or too few, is fitted to the tables of the default campaign in default/ (single_form.csv,
    form_mixtures.csv); the unified model takes both kinds of packing from one campaign. source: source of the grains
    of single forms, such as "synthetic"; None: all sources together, whereas the report of the committed rows fits each
    source by itself. Which rows are fitted otherwise is the rule of simcore.reference.committed_rows. ValueError if
    there are no rows, or none of that source.
    """
    folder, fitted = Path(folder), FittedModels({}, {})
    campaigns = [
        (folder / "single_form.csv", folder / "form_mixture.csv"),
        (folder / "default" / "single_form.csv", folder / "default" / "form_mixtures.csv"),
    ]
    forms = {single: read_single_forms(single) for single, _ in campaigns if single.exists()}
    sources = {name for table in forms.values() for name in table["source"]}
    if source is not None and source not in sources:
        available = ", ".join(sorted(sources - {""})) or "none"
        raise ValueError(f"{folder}: there are no grains of source {source}; choose one of the sources: {available}")
    for single, mixture in campaigns:
        single_forms = forms.get(single)
        if single_forms is not None:
            single_forms = fitted_forms(single_forms, source)
        mixtures = read_mixtures(mixture) if mixture.exists() else None
        models = _fit_campaign(single_forms, mixtures, seed, fitted.models)
        fitted.models.update(models)
        for key in models:
            fitted.behind[key] = _describe_rows(key, models[key], (single, single_forms), (mixture, mixtures))
    if not fitted.models:
        raise ValueError(
            f"{folder}: neither this folder nor its default/ has tables of packings with enough rows to fit a model"
        )
    return fitted


def _fit_campaign(single_forms, mixtures, seed, fitted):
    """Fit the models to a campaign's packings; either table may be None.

    Models whose key is in `fitted` and models with too few packings are left out.
    """
    models = {}
    if single_forms is not None:
        for case, rows in over_seeds(single_forms, "grain").groupby("case"):
            if ("single_form", case) not in fitted and len(rows) >= fewest_samples(SINGLE_FORM):
                features = pd.DataFrame({"EQ_inv": rows.L / rows.S, "EL_inv": rows.L / rows.I})
                models["single_form", case] = fit_and_validate(features, rows.n, "single_form", case, seed)
    if mixtures is not None:
        for case, rows in over_seeds(mixtures, "sample").groupby("case"):
            if ("form_mixture", case) in fitted:
                continue
            if (groups := groups_of_means(rows, least=3)) is not None:
                features = unified_features(rows)[list(MIXTURE)]
                models["form_mixture", case] = fit_and_validate(features, rows.n, "form_mixture", case, seed, groups)
    if single_forms is not None and mixtures is not None:
        fitted_cases = [case for name, case in fitted if name == "unified"]
        single_forms, mixtures = (table[~table["case"].isin(fitted_cases)] for table in (single_forms, mixtures))
        models |= fit_unified(single_forms, mixtures, seed)
    return models


def _describe_rows(key, model, single, mixture):
    """Describe the rows to which a model (name, case) was fitted; single, mixture: each (path, table)."""
    name, case = key
    if name == "unified":
        rows = f"{project_name(single[0])} and {mixture[0].name}, {model.n_samples} beds"
    else:
        noun, (path, table) = ("forms", single) if name == "single_form" else ("mixtures", mixture)
        packings = int((table["case"] == case).sum())
        rows = f"{project_name(path)}, {model.n_samples} {noun} in {packings} packings"
    return rows if name == "single_form" else f"{rows}, cross-validated on left-out mean forms"


def read_campaign_models(path):
    """Read FittedModels from a campaign's folder results/models, from one of its netCDF files, or from a file of `fit`.

    ValueError if there is no model.
    """
    path = Path(path)
    if not path.exists():
        raise ValueError(f"{path}: there is no such folder or file of models; correct the path after --models")
    if is_file_of_fit(path):
        return FittedModels(*read_measured_models(path), _read_curve_correction(path))
    models, behind = {}, {}
    files = [path / f"{name}.nc" for name in ("single_form", "form_mixture", "unified")]
    for file in [path] if path.is_file() else filter(Path.exists, files):
        mark = ", test only" if load_models(file).attrs.get("test_only") else ""
        for key, model in read_models(file).items():
            if key[0] == file.stem:
                models[key], behind[key] = model, f"{model.n_samples} beds{mark}: {file}"
    if not models:
        names = ", ".join(file.name for file in files)
        raise ValueError(
            f"{path}: there is no model in {names}; give the folder results/models of a campaign, or the file of a "
            "model that `fit` wrote"
        )
    return FittedModels(models, behind)


def _read_curve_correction(path):
    """Return the CurveCorrection in a file of `fit`, or None."""
    content = read_curve_models(path)
    if content is None:
        return None
    values, *of_one_class = content
    try:
        return read_correction(values, FittedModels(*of_one_class))
    except (ValueError, KeyError, TypeError):
        raise ValueError(not_written_by_fit(path)) from None

"""Write models that were fitted to measured beds to a JSON file, and read them for `predict`."""

import json
import math
from dataclasses import fields
from pathlib import Path

from simcore.models.regression import PorosityModel
from simcore.models.scatter import with_least
from simcore.writing import whole_file

MEASURED = "measured"  # name of such a model
_FORMAT = "scree models of measured beds, 1"
_TUPLES = ("features", "coefficients", "std_errors", "lower", "upper", "bootstrap_lower", "bootstrap_upper")


def write_measured_models(path, models, curve=None):
    """Write models to the file at `path`.

    models: list of (PorosityModel, description, only_kind), one per case; the description says what was fitted to which
    beds; only_kind: "one form" or "a distribution of form" if all beds are of this kind, else None. curve:
    CurveCorrection of the model of size and form, or None; its one-class models are written with it.
    """
    content = [
        {"fitted": description, "only_kind": only_kind, **_without_nan(model.to_dict())}
        for model, description, only_kind in models
    ]
    content = {"format": _FORMAT, "models": content}
    if curve is not None:
        content["curve"] = {"correction": _without_nan(curve.to_dict()), "one_class": _entries(curve.one_class)}
    text = json.dumps(content, indent=1, allow_nan=False)
    with whole_file(path) as part:
        part.write_text(text + "\n", encoding="utf-8")


def is_file_of_fit(path):
    """Return whether a path of models is taken for a file of `fit`, and not for a folder or a file of a campaign."""
    return Path(path).is_file() and Path(path).suffix != ".nc"


def _entries(fitted):
    """Return the entries of FittedModels with their own names."""
    return [
        {"behind": fitted.behind.get(key, ""), "only_kind": fitted.only_kind.get(key), **_without_nan(model.to_dict())}
        for key, model in fitted.models.items()
    ]


def read_curve_models(path):
    """Return the correction of the model of size and form in a file of write_measured_models, or None.

    It is a tuple: plain values of the CurveCorrection, and dicts of its one-class models as in read_measured_models.
    ValueError if the file is not of this kind.
    """
    content = _read(path).get("curve")
    if content is None:
        return None
    try:
        values = {key: _with_nan(value) for key, value in content["correction"].items()}
        values["behind"] = f"{values['behind']}: {path}"
        return values, *_read_models(content["one_class"], lambda entry: entry["behind"])
    except (ValueError, KeyError, TypeError, AttributeError):
        raise ValueError(not_written_by_fit(path)) from None


def _read(path):
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        if content["format"] != _FORMAT:
            raise ValueError
        return content
    except (ValueError, KeyError, TypeError):
        raise ValueError(not_written_by_fit(path)) from None


def not_written_by_fit(path):
    """Return the message on a file that is not of this kind."""
    return f"{path}: this is not a file of models that `fit` wrote; write it again with --out"


def read_measured_models(path):
    """Read the models of a file of write_measured_models.

    Returns dicts from (MEASURED, case): to the PorosityModel, to a description of the beds behind it, and, where all
    beds are of one kind, to this kind. ValueError if the file is not of this kind.
    """
    content = _read(path)
    try:
        return _read_models(content["models"], lambda entry: f"{entry['fitted']}: {path}", MEASURED)
    except (ValueError, KeyError, TypeError, AttributeError):
        raise ValueError(not_written_by_fit(path)) from None


def _read_models(entries, describe, name=None):
    """Return the dicts of read_measured_models. describe(entry): beds behind a model. name: of all models, or None."""
    models, behind, only_kind = {}, {}, {}
    for entry in entries:
        model = _read_model(entry)
        key = (name or model.name, model.case)
        models[key], behind[key] = model, describe(entry)
        if entry["only_kind"] is not None:
            only_kind[key] = entry["only_kind"]
    return models, behind, only_kind


def _read_model(entry):
    """Return the PorosityModel of an entry of the file."""
    entry = {"scatter_line": None, "form_mixture_error": None} | entry  # which files of earlier versions lack
    values = {field.name: _with_nan(entry[field.name]) for field in fields(PorosityModel)}
    values |= {name: tuple(values[name]) for name in (*_TUPLES, "minimum", "maximum")}
    values["covariance"] = tuple(map(tuple, values["covariance"]))
    for name in ("degrees_of_freedom", "scatter_line", "form_mixture_error"):
        if entry[name] is None:
            values[name] = None
    if values["scatter_line"] is not None:
        line = tuple(map(float, values["scatter_line"]))
        line = with_least(line, values["scatter"]) if len(line) == 2 else line  # of files of earlier versions
        if len(line) != 4:
            raise ValueError
        values["scatter_line"] = line
    size = len(values["features"]) + 1
    if not (size == len(values["coefficients"]) == len(values["covariance"]) and math.isfinite(values["scatter"])):
        raise ValueError
    return PorosityModel(**values)


def _without_nan(value):
    """Return a value of a model with None in place of nan, which JSON has not."""
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and math.isnan(value) else value


def _with_nan(value):
    if isinstance(value, list):
        return [_with_nan(item) for item in value]
    return math.nan if value is None else value

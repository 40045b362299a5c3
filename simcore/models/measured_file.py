"""Write models that were fitted to measured beds to a JSON file, and read them for `predict`."""

import json
import math
from dataclasses import fields
from pathlib import Path

from simcore.models.regression import PorosityModel

MEASURED = "measured"  # name of such a model
_FORMAT = "scree models of measured beds, 1"
_TUPLES = ("features", "coefficients", "std_errors", "lower", "upper", "bootstrap_lower", "bootstrap_upper")


def write_measured_models(path, models):
    """Write models to the file at `path`.

    models: list of (PorosityModel, description, only_kind), one per case; the description says what was fitted to which
    beds; only_kind: "one form" or "a distribution of form" if all beds are of this kind, else None.
    """
    content = [
        {"fitted": description, "only_kind": only_kind, **_without_nan(model.to_dict())}
        for model, description, only_kind in models
    ]
    text = json.dumps({"format": _FORMAT, "models": content}, indent=1, allow_nan=False)
    Path(path).write_text(text + "\n", encoding="utf-8")


def read_measured_models(path):
    """Read the models of a file of write_measured_models.

    Returns dicts from (MEASURED, case): to the PorosityModel, to a description of the beds behind it, and, where all
    beds are of one kind, to this kind. ValueError if the file is not of this kind.
    """
    models, behind, only_kind = {}, {}, {}
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        if content["format"] != _FORMAT:
            raise ValueError
        for entry in content["models"]:
            model = _read_model(entry)
            key = (MEASURED, model.case)
            models[key], behind[key] = model, f"{entry['fitted']}: {path}"
            if entry["only_kind"] is not None:
                only_kind[key] = entry["only_kind"]
    except (ValueError, KeyError, TypeError, AttributeError):
        raise ValueError(f"{path}: this is not a file of models that `fit` wrote; write it again with --out") from None
    return models, behind, only_kind


def _read_model(entry):
    """Return the PorosityModel of an entry of the file."""
    values = {field.name: _with_nan(entry[field.name]) for field in fields(PorosityModel)}
    values |= {name: tuple(values[name]) for name in (*_TUPLES, "minimum", "maximum")}
    values["covariance"] = tuple(map(tuple, values["covariance"]))
    if entry["degrees_of_freedom"] is None:
        values["degrees_of_freedom"] = None
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

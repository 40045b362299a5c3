"""Tables as a page shows them: headings in words, numbers rounded to their errors, meanings of the columns."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from markupsafe import Markup

from simcore.evaluation.rounding import error_decimals, rounded
from simcore.grains.form import FORM_FACTORS
from simcore.reference.columns import find_column, setting_column
from simcore.reference.columns.headings import ERRORS, HEADINGS, find_heading
from simcore.reference.named_tables import NAMES, read_named_table
from simcore.reference.r22_tables import read_r22_table
from simcore.report.words import value_in_words

# Longer text is broken into lines.
LONG_TEXT = 28
# Columns that are shown only on request, since few readers need them.
DETAILS = (
    "n_std",
    "n_seed_error",
    "sigma_FL",
    "sigma_EL",
    "sigma_EQ",
    "r22_n_std",
    "grains",
    "n_exact",
    "coordination_number",
    "cpu_h",
    "r_FL_EL",
    "r_size_FL",
    "r_size_EL",
    "cpu_h_per_run",
    "model_difference",
    "bootstrap_lower_95",
    "bootstrap_upper_95",
    "feature_min",
    "feature_max",
    "r_squared",
    "rmse",
    "scatter",
    "scatter_intercept",
    "scatter_slope",
    "median_absolute_error",
    "folds",
    "repeats",
    "spearman_r",
    "p_value",
    "seeds",
    "inserted",
    "kept",
    "samples",
    "not_normal",
    "code",
    "machine",
    *(f"shapiro_{letter}_{name}" for letter in "Wp" for name in ("FL", "EL")),
    *(f"{name}_change_percent_largest" for name in ("volume", "flatness", "elongation", "sphericity")),
)
# Columns of results, which are shown even if all rows have the same value
_RESULTS = {"n", "n_exact", "r22_n", "difference", "z", "experiment_n", "coefficient", "formula", "samples"}
# What was measured follows the porosity, so that a narrow page shows it without scrolling.
_MEASURED = ("experiment_n", "experiment_error_percent")
# Of these only in tables of porosities; they are the results of others.
_DETAILS_OF_POROSITY = {"sigma_FL", "sigma_EL", "sigma_EQ", "grains", "cpu_h"}
_COUNTS = ("grains", "samples")
# Units of the quantities whose trends over height have a unit: factor from SI, and unit.
TREND_UNITS = {"D": (1e3, "mm"), "angle": (57.29577951308232, "°")}
_SMALLEST_SHARE = 5e-4  # components that explain less of the variance are rounding errors


class ShownColumn(NamedTuple):
    """One column of a table: its heading, its meaning, and whether it is text or shown on request only."""

    name: str
    words: str
    unit: str
    meaning: str
    is_text: bool = False
    is_detail: bool = False


class Cell(NamedTuple):
    """One cell: its text, and the value by which its column is sorted."""

    text: str
    key: str = ""


class ShownTable(NamedTuple):
    """What a page shows of a table."""

    columns: list
    rows: list  # of lists of Cell
    same: list  # of (heading, text) of columns that have one value in all rows
    factors: list  # of (abbreviation, meaning) of the form factors in the table


def read_table(path):
    """Read a CSV file without the column `note`, because the banner of the page has the same text."""
    return read_named_table(path).drop(columns="note", errors="ignore")


def show_table(rows, name, details=DETAILS):
    """Return the ShownTable of a DataFrame.

    name: of its file, such as "tables/validation", which selects the meanings of the columns. details: columns that are
    shown on request. A number with an error is rounded to it; both are in one cell. Columns without values, and the
    name of the study, are left out; columns with one value in all of several rows are listed once.
    """
    rows = rows.drop(columns=[column for column in rows if rows[column].isna().all()] if len(rows) else [])
    if {"component", "explained"} <= set(rows):
        rows = rows[rows["explained"] >= _SMALLEST_SHARE]
    if {"quantity", "mean", "mean_std_error"} <= set(rows):
        rows = _with_units(rows)
    errors = _errors(rows)
    names = [column for column in rows if column not in set(ERRORS.values()) & _used(rows)]
    if "study" in names and rows["study"].nunique() == 1:
        names.remove("study")
    if {"flatness", "elongation"} <= set(names):  # the specified form of all grains
        names = [column for column in names if column not in ("FL", "EL")]
    if {"n", *_MEASURED} <= set(names):
        names = [column for column in names if column not in _MEASURED]
        names[names.index("n") + 1 : names.index("n") + 1] = _MEASURED
    if "n" not in names:
        details = [name for name in details if name not in _DETAILS_OF_POROSITY]
    if {"n", "runs"} <= set(names) and not {"grain", "choice"} & set(names):
        details = (*details, "FL", "EL", "EQ")  # the study does not vary the form, or specifies it
    same = [column for column in names if len(rows) > 1 and _is_constant(rows[column], column)]
    same = [column for column in same if column not in details or column in _COUNTS]
    shown = [column for column in names if column not in same]
    same = [column for column in same if rows[column].iloc[0] != 0.0]  # standard deviations of beds of one form
    behind = [column for column in shown if column in details]
    if len(behind) < len(shown):
        shown = [column for column in shown if column not in behind] + behind
    else:
        behind = []
    columns = [_column(rows, column, name, column in errors, column in behind) for column in shown]
    cells = {column: _cells(rows, column, errors.get(column)) for column in (*shown, *same)}
    return ShownTable(
        columns,
        [list(row) for row in zip(*(cells[column] for column in shown), strict=True)],
        [(_title(_column(rows, column, name, False, False)), cells[column][0].text) for column in same],
        _factors(rows),
    )


def table_name(path):
    """Return the name of a table's file for `show_table`: its folder and its stem."""
    path = Path(path)
    return f"{path.parent.name}/{path.stem}"


def _used(rows):
    """Return the columns of errors whose values have a column in the table."""
    return {error for value, error in ERRORS.items() if value in rows and error in rows}


def _with_units(trends):
    """Return trends over height in the units of TREND_UNITS, which the names of the quantities then have."""
    trends = trends.copy()
    for quantity, (factor, unit) in TREND_UNITS.items():
        of_it = trends["quantity"] == quantity
        trends.loc[of_it, ["mean", "mean_std_error"]] *= factor
        trends.loc[of_it, "quantity"] = f"{value_in_words('quantity', quantity)} [{unit}]"
    return trends


def _errors(rows):
    """Return the errors of the columns that have some, dict of arrays; that of a difference follows from z."""
    errors = {value: rows[error].to_numpy(float) for value, error in ERRORS.items() if value in rows and error in rows}
    if {"difference", "z"} <= set(rows) and "difference" not in errors:
        with np.errstate(divide="ignore", invalid="ignore"):
            errors["difference"] = np.abs(rows["difference"].to_numpy(float) / rows["z"].to_numpy(float))
    return errors


def _is_constant(values, name):
    is_result = name in _RESULTS or name.startswith("porosity_")
    return not is_result and values.notna().all() and values.nunique() == 1


def _is_text(values):
    return not pd.api.types.is_numeric_dtype(values) or pd.api.types.is_bool_dtype(values)


def _column(rows, name, table, has_error, is_detail):
    heading, column = find_heading(name), find_column(table, name) or setting_column(name)
    unit = heading.unit if heading.unit is not None else column.unit if column else ""
    meaning = column.meaning if column else heading.words
    if has_error:
        error = find_column(table, ERRORS.get(name, ""))
        meaning += f"; after ±: {error.meaning if error else 'its standard error'}"
    return ShownColumn(name, heading.words, unit, _without_names(meaning), _is_text(rows[name]), is_detail)


def _without_names(meaning):
    """Return the meaning of a column with the headings of other columns instead of their names."""
    named = re.sub(r"\b\w+_\w+\b", lambda match: find_heading(match[0]).words, meaning)
    return re.sub(r"\bn\b", "the porosity", named)


def _title(column):
    return column.words + (f" [{column.unit}]" if column.unit else "")


def _cells(rows, name, errors):
    """Return the cells of a column; errors: of its values, or None."""
    heading, values = find_heading(name), rows[name]
    if _is_text(values):
        return [_text_cell(name, value) for value in values]
    numbers = heading.factor * values.to_numpy(float)
    if errors is None:
        return [Cell(_number(value, heading), _key(value)) for value in numbers]
    errors = heading.factor * errors
    return [
        Cell(rounded(value, error, heading.decimals or 3, heading.sign), _key(value))
        for value, error in zip(numbers, errors, strict=True)
    ]


def _text_cell(name, value):
    if pd.isna(value):
        return Cell("")
    if isinstance(value, Markup):
        return Cell(value, value.striptags())
    try:
        number = float("name" if name in NAMES else value)  # settings such as the number of faces, among words
    except (TypeError, ValueError):
        return Cell(value_in_words(name, value), value_in_words(name, value))
    return Cell(_number(number, find_heading(name)) if not isinstance(value, bool) else value_in_words(name, value))


def _number(value, heading):
    """Return a number without an error as text."""
    if not np.isfinite(value):
        return ""
    if heading.decimals is not None:
        return rounded(value, decimals=heading.decimals, sign=heading.sign)
    if value == int(value) and abs(value) < 1e6:
        return f"{int(value)}".replace("-", "−")
    if abs(value) >= 1e6:
        power = int(np.floor(np.log10(abs(value))))
        return f"{value / 10.0**power:.2f}·10{str(power).translate(str.maketrans('0123456789', '⁰¹²³⁴⁵⁶⁷⁸⁹'))}"
    return rounded(value, decimals=error_decimals(abs(value), digits=3, max_decimals=6))


def _key(value):
    return f"{value:.10g}" if np.isfinite(value) else ""


def _factors(rows):
    """Return the abbreviations of form factors in a table with their meanings."""
    texts = " ".join(str(value) for name in ("feature", "features", "term") if name in rows for value in rows[name])
    named = {name for name in rows if name not in HEADINGS} | set(texts.replace("_", " ").replace("/", " ").split())
    factors = [name for name in FORM_FACTORS if name in named]
    if not factors:
        return []
    described = read_r22_table("form_factors").set_index("abbreviation")
    factors = [name for name in factors if name in described.index]
    return [(name, f"{described.loc[name, 'name']}, {described.loc[name, 'definition']}") for name in factors]

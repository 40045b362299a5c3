"""What came out of a study, in sentences made from its table."""

import numpy as np
import pandas as pd

from simcore.evaluation.rounding import rounded
from simcore.reference.columns.headings import find_heading
from simcore.report.words import value_in_words

CLEAR = 2.0  # a difference of more standard errors is not explained by the scatter of packings
FEW = 3  # with fewer rows a figure shows less than the sentence
_SWEEPS = ("shaking_s", "width_m", "faces", "contact_time_s", "steps_per_contact_time", "mass_kg", "drop_height")
# Columns of a study's table that it does not vary.
_NOT_VARIED = {"study", "source", "seed", "packing"}


def outcome(table, missing="The table has no porosities."):
    """Return the sentences on a study, a list of str.

    table: a study's table of means with values of Rettinger et al., as from r22_tables.add_reference, or the pairs of
    polyhedra and ellipsoids from shape_kinds.pair_shape_kinds.
    """
    if "n_mesh" in table:
        return _pairs(table)
    if "n" not in table or table["n"].notna().sum() == 0:
        return [missing]
    if "n_std_error" not in table:
        table = table.assign(n_std_error=np.nan)
    if "experiment_n" in table and table["experiment_n"].notna().any():
        return [*_experiment(table), *_published(table)]
    sweep = next((name for name in _SWEEPS if name in table and table[name].nunique() > 1), None)
    if sweep and not {"grain", "mean_FL"} & set(table):
        return [*_sweep(table, sweep), *_published(table)]
    if {"flatness", "elongation"} <= set(table) and "grain" not in table:
        return _round_ones(table)
    if "EQ" in table and table["EQ"].nunique() > 1 and {"grain", "mean_FL"} & set(table):
        return [*_forms(table), *_published(table)]
    return [*_range(table), *_published(table)]


def shows_more(table):
    """Return whether a figure of this table shows more than its sentence."""
    return len(table) >= FEW


def _experiment(table):
    """Compare with the measured porosities, one sentence on the range and one on each curve that is far off."""
    rows = table[table["experiment_n"].notna()]
    percent = rows["experiment_error_percent"]
    within = int((percent.abs() <= 5.0).sum())
    sentence = (
        f"The simulated porosity differs from the measured one by {_signed(percent.min(), 1)} to "
        f"{_signed(percent.max(), 1)} %"
        if len(rows) > 1
        else f"The simulated porosity differs from the measured one by {_signed(percent.iloc[0], 1)} %"
    )
    sentences = [
        f"{sentence}; {within} of {len(rows)} sieve curves are within 5 %." if len(rows) > 1 else f"{sentence}."
    ]
    published = rows["r22_error_percent"].dropna() if "r22_error_percent" in rows else pd.Series(dtype=float)
    if len(published) > 1:
        sentences.append(
            f"The packings of Rettinger et al. for the same curves differ by {_signed(published.min(), 1)} to "
            f"{_signed(published.max(), 1)} %."
        )
    return sentences


def _sweep(table, name):
    """Return the change between the ends of the varied setting, for each sieve curve."""
    heading, sentences = find_heading(name), []
    for case, rows in table.groupby("case", sort=False) if "case" in table else [("", table)]:
        if len(rows) < 2:
            continue
        numbers = pd.to_numeric(rows[name], errors="coerce")
        rows = rows.assign(order=numbers.fillna(np.inf)).sort_values("order", kind="stable")
        lowest, highest = rows.iloc[0], rows.iloc[-1]
        error = np.hypot(lowest["n_std_error"], highest["n_std_error"])
        change = highest["n"] - lowest["n"]
        ends = " to ".join(_setting(row[name], name, heading) for row in (lowest, highest))
        verdict = "more than" if abs(change) > CLEAR * error else "not more than"
        start = f"{case}: from" if case else "From"
        sentences.append(
            f"{start} {ends} the porosity changes by {rounded(change, error, sign='+')}, {verdict} twice its standard "
            "error."
        )
    return sentences or _range(table)


def _setting(value, name, heading):
    """Return the value of a setting with its unit; name: of its column, heading: its Heading."""
    number = pd.to_numeric(pd.Series([value]), errors="coerce").iloc[0]
    if not np.isfinite(number):
        return f"{value_in_words(name, value)} {heading.words.split(',')[0]}"
    unit = heading.unit or {"shaking_s": "s of shaking", "mass_kg": "kg"}.get(name, heading.words.split(",")[0])
    return f"{heading.factor * number:g} {unit}"


def _round_ones(table):
    """Return the porosity of spheres and the lowest one of ellipsoids near them."""
    rows = table.assign(ratio=1.0 / (table["flatness"].fillna(1.0) * table["elongation"].fillna(1.0)))
    lowest = rows.loc[rows["n"].idxmin()]
    sentences = [
        f"The porosity is lowest for {_ratio(lowest)}: {rounded(lowest['n'], lowest['n_std_error'])}."
        if len(rows) > 1
        else f"The porosity for {_ratio(lowest)} is {rounded(lowest['n'], lowest['n_std_error'])}."
    ]
    spheres = rows[np.isclose(rows["ratio"], 1.0)]
    if len(spheres) and not np.isclose(lowest["ratio"], 1.0):
        sphere = spheres.iloc[0]
        error = np.hypot(sphere["n_std_error"], lowest["n_std_error"])
        more = rounded(sphere["n"] - lowest["n"], error)
        sentences.append(
            f"Spheres have {rounded(sphere['n'], sphere['n_std_error'])}, which is {more} more: slightly flattened "
            "grains pack more densely than spheres."
        )
    return sentences


def _ratio(row):
    return "spheres" if np.isclose(row["ratio"], 1.0) else f"L/S = {row['ratio']:.1f}"


def _forms(table):
    """Return the range of porosity over the forms, for each sieve curve and source of grains."""
    sentences = []
    keys = [name for name in ("source", "case") if name in table and table[name].nunique() > 1]
    for values, rows in table.groupby(keys, sort=False) if keys else [((), table)]:
        low, high = rows.loc[rows["n"].idxmin()], rows.loc[rows["n"].idxmax()]
        names = ", ".join(value_in_words(name, value) for name, value in zip(keys, values, strict=True))
        ratio, what = ("L/S", "forms") if "grain" in table else ("mean L/S", "distributions of form")
        text = (
            f"the porosity rises from {rounded(low['n'], low['n_std_error'])} ({ratio} = {1.0 / low['EQ']:.1f}) to "
            f"{rounded(high['n'], high['n_std_error'])} ({ratio} = {1.0 / high['EQ']:.1f}) over {len(rows)} {what}."
        )
        text = f"{names}: {text}" if names else text
        sentences.append(text[0].upper() + text[1:])
    return sentences


def _range(table):
    """Return the porosity of the only setting, or the lowest and the highest one."""
    low, high = table.loc[table["n"].idxmin()], table.loc[table["n"].idxmax()]
    if len(table) == 1:
        return [f"The porosity is {rounded(low['n'], low['n_std_error'])}."]
    error = np.hypot(low["n_std_error"], high["n_std_error"])
    difference = high["n"] - low["n"]
    verdict = "more than" if difference > CLEAR * error else "not more than"
    return [
        f"The porosity is between {rounded(low['n'], low['n_std_error'])} ({_label(table, low)}) and "
        f"{rounded(high['n'], high['n_std_error'])} ({_label(table, high)}); the difference of "
        f"{rounded(difference, error)} is {verdict} twice its standard error."
    ]


def _label(table, row):
    """Return the settings that differ between the rows of a table, as text."""
    return ", ".join(
        f"{find_heading(name).words} {value_in_words(name, row[name])}"
        for name in varied_columns(table)
        if pd.notna(row[name])
    )


def varied_columns(table):
    """Return the names of the columns before the results of a study's table that differ between its rows."""
    end = next((list(table).index(name) for name in ("runs", "n") if name in table), 0)
    return [name for name in list(table)[:end] if name not in _NOT_VARIED and table[name].nunique() > 1]


def _published(table):
    """Return the mean difference to the values of Rettinger et al. where they give some."""
    if "difference" not in table or table["difference"].notna().sum() == 0:
        return []
    rows = table[table["difference"].notna()]
    if len(rows) == 1:
        row = rows.iloc[0]
        error = abs(row["difference"] / row["z"]) if row["z"] else np.nan
        return [f"This is {rounded(row['difference'], error, sign='+')} from the value of Rettinger et al."]
    mean, spread = rows["difference"].mean(), np.sqrt(np.mean(rows["difference"] ** 2))
    kind = "the model" if {"grain", "mean_FL"} & set(rows) else "the values"
    return [
        f"Compared with {kind} of Rettinger et al., the porosities of {len(rows)} settings differ by "
        f"{_signed(mean, 3)} on average and by {spread:.3f} root mean square."
    ]


def _pairs(table):
    """Compare polyhedra with their equivalent ellipsoids."""
    sentences = []
    for case, rows in table.groupby("case", sort=False):
        difference = rows["n_mesh"] - rows["n_ellipsoid"]
        error = difference.sem() if len(rows) > 1 else np.hypot(rows["n_mesh_error"], rows["n_ellipsoid_error"]).iloc[0]
        looser = int((difference > 0).sum())
        sentences.append(
            f"{case}: the porosity of polyhedra minus that of their ellipsoids is "
            f"{rounded(difference.mean(), error, sign='+')} on average over {len(rows)} forms; polyhedra are looser "
            f"for {looser} of them."
        )
    return sentences


def _signed(value, decimals):
    return rounded(value, decimals=decimals, sign="+")

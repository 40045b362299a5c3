"""What came out of a study, in sentences made from its table."""

import numpy as np
import pandas as pd
from scipy.special import chdtrc  # scipy.stats has the same values but loads slowly

from simcore.campaign.study_tables import OWN_CURVE
from simcore.evaluation.rounding import rounded
from simcore.reference.columns import find_column, setting_column, setting_is_optional
from simcore.reference.columns.headings import find_heading
from simcore.report.words import value_in_words

CLEAR = 2.0  # a difference of two packings by more standard errors is not explained by their scatter
CHANCE = 0.05  # probability, below which the differences of several settings are not explained by their scatter
FEW = 3  # with fewer rows a figure shows less than the sentence
# Settings of which a study varies one: its figure is a curve, and its sentence is about the lowest and highest value.
SWEEPS = ("shaking_s", "width_m", "faces", "contact_time_s", "steps_per_contact_time", "mass_kg", "drop_height")
# Columns of the form of the grains, which may vary with the setting that a sentence is about.
_OF_FORM = {"case", "grain", "shape_kind", "flatness", "elongation", "mean_FL", "std_FL", "mean_EL", "std_EL"}
_OF_FORM |= {"FL", "EL", "EQ"}
# Columns of a study's table that it does not vary.
_NOT_VARIED = {"study", "source", "seed", "packing"}


def outcome(table, missing="The table has no porosities."):
    """Return the sentences on a study, a list of str.

    table: a study's table of means with values of Rettinger et al., as from r22_comparison.add_reference, or the pairs
    of polyhedra and ellipsoids from shape_kinds.pair_shape_kinds.
    """
    if "n_mesh" in table:
        return _pairs(table)
    if "n" not in table or table["n"].notna().sum() == 0:
        return [missing]
    if "n_std_error" not in table:
        table = table.assign(n_std_error=np.nan)
    if "experiment_n" in table and table["experiment_n"].notna().any():
        return [*_experiment(table), *_published(table)]
    sweep = next((name for name in SWEEPS if name in table and table[name].nunique() > 1), None)
    of_forms = bool({"grain", "mean_FL"} & set(table)) and differ_in_form(table)
    if sweep and not of_forms:
        return [*_sweep(table, sweep), *_published(table)]
    if {"flatness", "elongation"} <= set(table) and "grain" not in table:
        return _round_ones(table)
    if of_forms:
        return [*_forms(table), *_published(table)]
    return [*_range(table), *_published(table)]


def differ_in_form(table):
    """Return whether the rows of a study's table are beds of grains of different mean form."""
    return "EQ" in table and bool(table["EQ"].max() - table["EQ"].min() > 1e-6)


def shows_more(table):
    """Return whether a figure of this table shows more than its sentence."""
    return len(table) >= FEW


def _experiment(table):
    """Compare with the measured porosities, one sentence on the range and one on each curve that is far off."""
    rows = table[table["experiment_n"].notna()]
    percent = rows["experiment_error_percent"]
    within = int((percent.abs() <= 5.0).sum())
    what = "settings" if rows["case"].duplicated().any() else "sieve curves"
    sentence = (
        f"The simulated porosity differs from the measured one by {_signed(percent.min(), 1)} to "
        f"{_signed(percent.max(), 1)} %"
        if len(rows) > 1
        else f"The simulated porosity differs from the measured one by {_signed(percent.iloc[0], 1)} %"
    )
    sentences = [f"{sentence}; {within} of {len(rows)} {what} are within 5 %." if len(rows) > 1 else f"{sentence}."]
    published = rows["r22_error_percent"].dropna() if "r22_error_percent" in rows else pd.Series(dtype=float)
    if len(published) > 1:
        sentences.append(
            f"The packings of Rettinger et al. for the same curves differ by {_signed(published.min(), 1)} to "
            f"{_signed(published.max(), 1)} %."
        )
    return sentences


def _sweep(table, name):
    """Return the change between the ends of the varied setting, for each sieve curve.

    If other settings vary independently of it, it is the mean of the changes at each of them. Settings that vary
    together with it, such as the mass with the width of a box, belong to it.
    """
    heading, sentences = find_heading(name), []
    alone = not table.duplicated([column for column in ("case", name) if column in table]).any()
    others = [] if alone else [column for column in varied_columns(table) if column not in ("case", name)]
    several = "case" in table and table["case"].nunique() > 1
    for case, rows in table.groupby("case", sort=False) if "case" in table else [("", table)]:
        numbers = pd.to_numeric(rows[name], errors="coerce")
        rows = rows.assign(order=numbers.fillna(np.inf)).sort_values("order", kind="stable")
        lowest, highest = rows[name].iloc[0], rows[name].iloc[-1]
        changes, squares = [], []
        for _, alike in rows.groupby(others, sort=False, dropna=False) if others else [((), rows)]:
            alike = alike[alike["n"].notna()]
            low, high = alike[alike[name] == lowest], alike[alike[name] == highest]
            if lowest != highest and len(low) and len(high):
                changes.append(high["n"].iloc[0] - low["n"].iloc[0])
                squares.append(low["n_std_error"].iloc[0] ** 2 + high["n_std_error"].iloc[0] ** 2)
        if not changes:
            continue
        change, error = np.mean(changes), np.sqrt(np.sum(squares)) / len(changes)
        ends = " to ".join(_setting(value, name, heading) for value in (lowest, highest))
        named = case and (several or case != OWN_CURVE)
        text = f"{value_in_words('case', case)}: from" if named else "From"
        text = f"{text} {ends} the porosity changes by {rounded(change, error, sign='+')}"
        if others:
            words = " and ".join(find_heading(column).words for column in others)
            text += f" on average over {len(changes)} settings of {words}"
        sentences.append(f"{text}{_verdict(change, error)}.")
    return sentences or _range(table)


def _verdict(difference, error):
    """Return whether a difference of two porosities is clear, in words after a comma; "" if its error is unknown."""
    if not np.isfinite(error):
        return ""
    return f", {'more' if abs(difference) > CLEAR * error else 'not more'} than twice its standard error"


def _setting(value, name, heading):
    """Return the value of a setting with its unit; name: of its column, heading: its Heading."""
    number = pd.to_numeric(pd.Series([value]), errors="coerce").iloc[0]
    if not np.isfinite(number):
        return f"{value_in_words(name, value)} {heading.words.split(',')[0]}"
    unit = heading.unit or {"shaking_s": "s of shaking", "mass_kg": "kg"}.get(name, heading.words.split(",")[0])
    return f"{heading.factor * number:g} {unit}"


def _round_ones(table):
    """Return the porosity of spheres and the lowest one of ellipsoids near them, for each sieve curve."""
    table = table.assign(ratio=1.0 / (table["flatness"].fillna(1.0) * table["elongation"].fillna(1.0)))
    sentences = []
    for named, rows in _groups(table, ["case"]):
        lowest = rows.loc[rows["n"].idxmin()]
        start = f"{named}: the" if named else "The"
        value = rounded(lowest["n"], lowest["n_std_error"])
        if len(rows) == 1:
            sentences.append(f"{start} porosity for {_ratio(lowest)} is {value}.")
            continue
        sentences.append(f"{start} porosity is lowest for {_ratio(lowest)}: {value}.")
        spheres = rows[np.isclose(rows["ratio"], 1.0)]
        if len(spheres) and not np.isclose(lowest["ratio"], 1.0):
            sphere = spheres.iloc[0]
            error = np.hypot(sphere["n_std_error"], lowest["n_std_error"])
            more = sphere["n"] - lowest["n"]
            sentences.append(
                f"Spheres have {rounded(sphere['n'], sphere['n_std_error'])}, which is {rounded(more, error)} more"
                f"{_verdict(more, error)}."
            )
    return sentences


def _ratio(row):
    return "spheres" if np.isclose(row["ratio"], 1.0) else f"L/S = {row['ratio']:.1f}"


def _forms(table):
    """Return the range of porosity over the forms, for each source of grains, sieve curve and other setting."""
    sentences = []
    for names, rows in _groups(table, ["source", "case"]):
        low, high = rows.loc[rows["n"].idxmin()], rows.loc[rows["n"].idxmax()]
        ratio, what = ("L/S", "forms") if "grain" in table else ("1/mean S/L", "distributions of form")
        form = [name for name in ("grain", "mean_FL", "std_FL", "mean_EL", "std_EL") if name in rows]
        count = len(rows[form].drop_duplicates())
        text = (
            f"the porosity rises from {rounded(low['n'], low['n_std_error'])} ({ratio} = {1.0 / low['EQ']:.1f}) to "
            f"{rounded(high['n'], high['n_std_error'])} ({ratio} = {1.0 / high['EQ']:.1f}) over {count} {what}."
        )
        text = f"{names}: {text}" if names else text
        sentences.append(text[0].upper() + text[1:])
    return sentences


def _groups(table, first):
    """Return (label, rows) of the rows that differ only in form; first: columns that the labels begin with."""
    keys = [name for name in first if name in table and table[name].nunique() > 1]
    keys += other_settings(table)
    if not keys:
        return [("", table)]
    groups = []
    for values, rows in table.groupby(keys, sort=False, dropna=False):
        names = [
            value_in_words(name, value) if name in first else named_setting(name, value)
            for name, value in zip(keys, values, strict=True)
        ]
        groups.append((", ".join(names), rows))
    return groups


def other_settings(table):
    """Return the columns of a study's table that differ between its rows, but for those of sieve curve and form."""
    return [name for name in varied_columns(table) if name not in _OF_FORM]


def _range(table):
    """Return the porosity of the only setting, or the lowest and the highest one."""
    low, high = table.loc[table["n"].idxmin()], table.loc[table["n"].idxmax()]
    if len(table) == 1:
        return [f"The porosity is {rounded(low['n'], low['n_std_error'])}."]
    ends = (
        f"The porosity is between {rounded(low['n'], low['n_std_error'])} ({_label(table, low)}) and "
        f"{rounded(high['n'], high['n_std_error'])} ({_label(table, high)})"
    )
    if len(table) == 2:
        error = np.hypot(low["n_std_error"], high["n_std_error"])
        difference = high["n"] - low["n"]
        return [f"{ends}; the difference is {rounded(difference, error)}{_verdict(difference, error)}."]
    rows = table[table["n_std_error"] > 0.0]
    if len(rows) < len(table):
        return [f"{ends}."]
    weights = rows["n_std_error"] ** -2.0
    squares = float(np.sum(weights * (rows["n"] - np.average(rows["n"], weights=weights)) ** 2))
    # The greatest difference of many settings is often more than twice its error by chance; hence a test of all.
    explained = chdtrc(len(rows) - 1, squares) > CHANCE
    what = "the standard errors explain the differences" if explained else "they differ by more than chance"
    return [f"{ends}; among the {len(rows)} settings {what}."]


def _label(table, row):
    """Return the settings that differ between the rows of a table, as text."""
    return ", ".join(
        named_setting(name, row[name])
        for name in varied_columns(table)
        if pd.notna(row[name]) or setting_is_optional(name)
    )


def named_setting(name, value):
    """Return the value of a column after its heading, a number in the unit of the heading."""
    heading = find_heading(name)
    if pd.isna(value) and setting_is_optional(name):
        return f"{heading.words} by default"
    if isinstance(value, (int, float, np.number)) and not isinstance(value, bool):
        column = find_column("tables/study", name) or setting_column(name)
        unit = heading.unit if heading.unit is not None else column.unit if column else ""
        return f"{heading.words} {heading.factor * value:g} {unit}".rstrip()
    return f"{heading.words} {value_in_words(name, value)}"


def varied_columns(table):
    """Return the names of the columns before the results of a study's table that differ between its rows."""
    end = next((list(table).index(name) for name in ("runs", "n") if name in table), 0)
    names = [name for name in list(table)[:end] if name not in _NOT_VARIED]
    return [name for name in names if table[name].nunique(dropna=not setting_is_optional(name)) > 1]


def _published(table):
    """Return the mean difference to the values of Rettinger et al. where they give some."""
    if "difference" not in table or table["difference"].notna().sum() == 0:
        return []
    rows = table[table["difference"].notna()]
    if len(rows) == 1:
        row = rows.iloc[0]
        error = abs(row["difference"] / row["z"]) if row["z"] else np.nan
        what = "This" if len(table) == 1 else f"The porosity for {_label(table, row)}"
        return [f"{what} is {rounded(row['difference'], error, sign='+')} from the value of Rettinger et al."]
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

"""Error against run time of packings: effect of each setting on porosity, and the cheapest settings for an error.

A study varies one setting of a base, over several seeds. Its first setting is the reference, which is the most
accurate. The error of another setting is its difference to the reference, paired by seed where both have the seed,
because packings of one seed have the same grains.
"""

import itertools

import numpy as np
import pandas as pd

WISHED = (0.01, 0.005, 0.002)  # allowed errors of porosity
# Columns that tell beds apart whose porosities differ by themselves: they are no settings that a study changes.
OF_BED = ("grain", "case", "mean_FL", "std_FL", "mean_EL", "std_EL")


def porosity_errors(packings: pd.DataFrame, varied: list[str]) -> pd.DataFrame:
    """Return one row per setting, in the order in which the settings first appear in `packings`.

    packings: one row per packing, with the columns study, seed, n, cpu_s and those of `varied`; the first setting is
    the reference. Columns: study, varied, setting (text), seeds, n, n_std_error (over seeds), difference (mean n minus
    that of the reference), difference_std_error, cpu_s (median), cpu_ratio (to the reference). The standard errors of
    settings with one packing are nan.
    """
    keys = [key for key in varied if key != "seed"]
    table = packings.assign(setting=[_label(row, keys) for _, row in packings.iterrows()])
    order = table.setting.unique()
    reference = table[table.setting == order[0]].set_index("seed")
    rows = []
    for setting in order:
        runs = table[table.setting == setting].set_index("seed")
        difference, error = compare(runs.n, reference.n)
        rows.append(
            {
                "study": table.study.iloc[0],
                "varied": ", ".join(keys),
                "setting": setting,
                "seeds": len(runs),
                "n": runs.n.mean(),
                "n_std_error": runs.n.std() / np.sqrt(len(runs)),
                "difference": difference,
                "difference_std_error": error,
                "cpu_s": runs.cpu_s.median(),
                "cpu_ratio": runs.cpu_s.median() / reference.cpu_s.median(),
            }
        )
    return pd.DataFrame(rows)


def name_changes(packings: pd.DataFrame, varied: list[str]) -> pd.Series:
    """Return the settings in which each packing differs from the first as text, such as "fill r22"; "ours" if equal."""
    keys = [key for key in varied if key != "seed"]
    spelled = packings[keys].map(str)
    return pd.Series(
        [
            ", ".join(f"{key} {row[key]}" for key in keys if row[key] != spelled.iloc[0][key]) or "ours"
            for _, row in spelled.iterrows()
        ],
        index=packings.index,
    )


def change_errors(tables: list[pd.DataFrame], varied: list[list[str]]) -> pd.DataFrame:
    """Return the effect of each change on porosity: rows of `porosity_errors` with the columns OF_BED, for all studies.

    tables: packings of each study; varied: names of the keys that each study varies. Beds that differ in a column of
    OF_BED each have their own reference; beds of which there is one setting are left out. ValueError if none are left.
    """
    parts = []
    for packings, names in zip(tables, varied, strict=True):
        kinds = [column for column in OF_BED if column in packings and (column in ("grain", "case") or column in names)]
        changed = [name for name in names if name not in kinds]
        groups = packings.groupby(kinds, sort=False, dropna=False) if kinds else [((), packings)]
        for values, rows in groups:
            errors = porosity_errors(rows.assign(change=name_changes(rows, changed)), ["change"])
            if len(errors) > 1:
                parts.append(errors.assign(**dict(zip(kinds, values, strict=True))))
    if not parts:
        studies = ", ".join(sorted({table.study.iloc[0] for table in tables}))
        raise ValueError(
            f"the studies {studies} have one setting of each bed, so that there is no difference; vary a setting under "
            "`varies`"
        )
    return pd.concat(parts, ignore_index=True)


def study_errors(tables: list[pd.DataFrame], rows: list[list[dict]]) -> pd.DataFrame:
    """Return the rows of `porosity_errors` of several studies; ValueError if a setting has one packing.

    tables: packings of each study; rows: for each study, the rows of its packings from simcore.campaign.studies.
    """
    parts = [porosity_errors(table, own[0]["varied"]) for table, own in zip(tables, rows, strict=True)]
    errors = pd.concat(parts, ignore_index=True)
    for row in errors[errors.seeds < 2].itertuples():
        raise ValueError(f"study {row.study}: {row.setting} has one seed; an error needs two or more seeds")
    return errors


def work_precision_of_studies(errors, studies, titles, rows) -> pd.DataFrame:
    """Return the rows of `work_precision_runs`; the base of each study is marked as its default.

    errors: of `study_errors`; studies: names, with rows in the same order; titles: dict by name.
    """
    defaults = {study: base_setting(own) for study, own in zip(studies, rows, strict=True)}
    return work_precision_runs(errors, titles, defaults)


def compare(runs: pd.Series, reference: pd.Series) -> tuple[float, float]:
    """Return the mean difference of runs to reference, both indexed by seed, and its standard error.

    If two or more seeds are common to both, the difference is paired over these seeds, which removes the common effect
    of the grains of a seed. Otherwise it is the difference of the means, with the scatter of both.
    """
    both = runs.index.intersection(reference.index)
    if len(both) > 1:
        paired = runs[both] - reference[both]
        return float(paired.mean()), float(paired.std() / np.sqrt(len(both)))
    variance = runs.var() / len(runs) + reference.var() / len(reference)
    return float(runs.mean() - reference.mean()), float(np.sqrt(variance))


def work_precision_runs(errors: pd.DataFrame, titles: dict[str, str], defaults: dict[str, str]) -> pd.DataFrame:
    """Return the rows of `porosity_errors` as a table of simcore.verification.work_precision; each study is a case.

    titles: dict of the studies. defaults: dict of the setting of each study that the other studies keep. The error of
    the reference is the noise of the seeds: the median standard error of the study's differences.
    """
    parts = []
    for study, rows in errors.groupby("study", sort=False):
        noise = rows.difference_std_error.iloc[1:].median()
        parts.append(
            pd.DataFrame(
                {
                    "case": titles[study],
                    "quantity": "porosity",
                    "method": "against the first setting",
                    "setting": rows.setting,
                    "default": rows.setting == defaults[study],
                    "repeat": 0,
                    "error": rows.difference.abs().mask(rows.cpu_ratio == 1.0, noise),
                    "error_std": rows.difference_std_error,
                    "cpu_s": rows.cpu_s,
                    "reference_error": noise,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def base_setting(rows: list[dict]) -> str:
    """Return the setting of a study that the other studies keep, "" if it has none.

    rows: dicts {varied, is_base} from simcore.campaign.studies.
    """
    return next(
        (_label(row["varied"], [k for k in row["varied"] if k != "seed"]) for row in rows if row["is_base"]), ""
    )


def cheapest_settings(errors: pd.DataFrame, wished=WISHED) -> pd.DataFrame:
    """Return for each allowed error the cheapest combination of settings, one of each study.

    errors: rows of `porosity_errors` of several studies. The error of a combination is bounded by the sum of the
    magnitudes of the measured differences, and its cost is taken as the product of the cost ratios; both are valid if
    settings act independently. Columns: wished_error, one column per study with its setting, error_bound,
    error_std_error (of the sum), cpu_ratio (to the combination of all references).
    """
    parts = [rows for _, rows in errors.groupby("study", sort=False)]
    table = []
    for limit in wished:
        best = None
        for chosen in itertools.product(*(part.itertuples() for part in parts)):
            bound = sum(abs(row.difference) for row in chosen)
            ratio = float(np.prod([row.cpu_ratio for row in chosen]))
            if bound <= limit and (best is None or ratio < best["cpu_ratio"]):
                best = {
                    "wished_error": limit,
                    **{row.study: row.setting for row in chosen},
                    "error_bound": bound,
                    "error_std_error": float(np.sqrt(sum(row.difference_std_error**2 for row in chosen))),
                    "cpu_ratio": ratio,
                }
        table.append(best)
    return pd.DataFrame(table)


def _label(row, keys):
    """Return the setting of a packing as text, such as "0.001" or "40 explicit", without values that are not set."""
    values = [row[key] for key in keys if not _is_unset(row[key])]
    return " ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values) or "not set"


def _is_unset(value):
    return value is None or value != value

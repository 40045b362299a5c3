"""Error against run time of packings: what each setting does to porosity, and the cheapest settings for a wished error.

A study changes one setting on a base, over several seeds. Its first setting is the reference, the most accurate. The
error of another is its difference to that, paired by seed where both have the seed: the grains of a seed are the same.
"""

import itertools

import numpy as np
import pandas as pd

WISHED = (0.01, 0.005, 0.002)  # errors in porosity


def porosity_errors(packings: pd.DataFrame, varied: list[str]) -> pd.DataFrame:
    """One row a setting, in the order in which they first stand in `packings`.

    packings: one row a packing, with the columns study, seed, n, cpu_s and those of `varied`; the setting that stands
    first is the reference. Columns: study, varied, setting (text), seeds, n, n_std_error (over seeds), difference
    (mean n less the reference's), difference_std_error, cpu_s (median), cpu_ratio (to the reference).
    ValueError where a setting has no packing or one seed only.
    """
    keys = [key for key in varied if key != "seed"]
    table = packings.assign(setting=[_label(row, keys) for _, row in packings.iterrows()])
    order = table.setting.unique()
    reference = table[table.setting == order[0]].set_index("seed")
    rows = []
    for setting in order:
        runs = table[table.setting == setting].set_index("seed")
        if len(runs) < 2:
            raise ValueError(f"study {table.study.iloc[0]}: {setting} has one seed; give two or more for an error")
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
    """In words what each packing has otherwise than the first one, such as "fill study"; "ours" where nothing is."""
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
    """What each change does to porosity: rows of `porosity_errors` with the column grain, study by study.

    tables: packings of each study; varied: names of what each study varies. Each grain has a reference of its own.
    """
    parts = []
    for packings, names in zip(tables, varied, strict=True):
        packings = packings.assign(change=name_changes(packings, names))
        groups = packings.groupby("grain", sort=False) if "grain" in packings else [("", packings)]
        parts += [porosity_errors(rows, ["change"]).assign(grain=grain) for grain, rows in groups]
    return pd.concat(parts, ignore_index=True)


def study_errors(tables: list[pd.DataFrame], rows: list[list[dict]]) -> pd.DataFrame:
    """Rows of `porosity_errors` of several studies.

    tables: packings of each study; rows: of each study the rows of its packings as simcore.campaign.studies has them.
    """
    parts = [porosity_errors(table, own[0]["varied"]) for table, own in zip(tables, rows, strict=True)]
    return pd.concat(parts, ignore_index=True)


def work_precision_of_studies(errors, studies, titles, rows) -> pd.DataFrame:
    """Rows of `work_precision_runs`, the base of each study marked as its default.

    errors: of `study_errors`; studies: names, with rows in the same order; titles: by name.
    """
    defaults = {study: base_setting(own) for study, own in zip(studies, rows, strict=True)}
    return work_precision_runs(errors, titles, defaults)


def compare(runs: pd.Series, reference: pd.Series) -> tuple[float, float]:
    """Mean difference of runs to reference, both with the seed as index, and its standard error.

    Over the seeds that both have, where these are two or more: what the grains of a seed do to both is then taken out.
    Otherwise of the means, each with its own scatter.
    """
    both = runs.index.intersection(reference.index)
    if len(both) > 1:
        paired = runs[both] - reference[both]
        return float(paired.mean()), float(paired.std() / np.sqrt(len(both)))
    variance = runs.var() / len(runs) + reference.var() / len(reference)
    return float(runs.mean() - reference.mean()), float(np.sqrt(variance))


def work_precision_runs(errors: pd.DataFrame, titles: dict[str, str], defaults: dict[str, str]) -> pd.DataFrame:
    """Rows of `porosity_errors` as a table of simcore.verification.work_precision, each study a case.

    titles: of the studies. defaults: the setting of each that the other studies hold to. The reference's own error is
    the noise of the seeds: the median standard error of the study's differences. The reference has no error but that.
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
    """The setting of a study that the other studies hold to. rows: dicts {varied, is_base} as simcore.campaign.studies
    has them.

    "" where the study has none.
    """
    return next(
        (_label(row["varied"], [k for k in row["varied"] if k != "seed"]) for row in rows if row["is_base"]), ""
    )


def cheapest_settings(errors: pd.DataFrame, wished=WISHED) -> pd.DataFrame:
    """For each wished error the setting of every study that together cost least.

    errors: rows of `porosity_errors` of several studies. The error of a combination is bounded by the sum of the
    differences' magnitudes, as they are measured, and its cost taken as the product of the cost ratios: both hold where
    settings act independently. Columns: wished_error, one for each study with the setting, error_bound,
    error_std_error (of the sum), cpu_ratio (to the references of all).
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
    """The setting of a packing in words, such as "0.001" or "40 explicit"; what is not set is left out."""
    values = [row[key] for key in keys if not _is_unset(row[key])]
    return " ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values) or "not set"


def _is_unset(value):
    return value is None or value != value

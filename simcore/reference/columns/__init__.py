"""The columns of all tables: name, unit, meaning, name in the committed rows, and the key that is varied.

`describe_columns` returns those of one table. Each group of tables has one file in this package: studies, deposits,
models, campaign, page, verification, benchmarks, and r22 for the published tables of Rettinger et al. (2022).
"""

from fnmatch import fnmatch
from pathlib import PurePath

from simcore.reference.columns import benchmarks, campaign, deposits, models, page, r22, studies, verification
from simcore.reference.columns.column import Column
from simcore.reference.columns.studies import (
    COLUMN_OF_KEY,
    COLUMNS,
    COMMITTED_NAMES,
    FORM,
    SPECIFIED_FORM,
    SPECIFIED_MEANS,
    study_names,
)
from simcore.scene.specification import read_schema

__all__ = [
    "COLUMNS",
    "COLUMN_OF_KEY",
    "COMMITTED_NAMES",
    "FORM",
    "SPECIFIED_FORM",
    "SPECIFIED_MEANS",
    "TABLES",
    "Column",
    "describe_columns",
    "find_column",
    "setting_column",
    "setting_is_optional",
    "study_names",
]

# Groups of columns of each table, by patterns of its path in results/reference or in the results of a campaign; the
# first pattern that fits is valid, and of equal names the first group. A table without a pattern is one of a study.
TABLES = {
    "*gathered": (campaign.LEDGERS,),
    "report/*": (page.PAGE, models.MODELS, COLUMNS),
    "*collected": (campaign.LEDGERS,),
    "deposits": (deposits.DEPOSITS,),
    "*deposits/maxima": (deposits.MAXIMA,),
    "*deposits/symmetry": (deposits.SYMMETRY,),
    "*deposits/changes": (deposits.CHANGES, deposits.DEPOSITS),
    "*deposits/crossings": (deposits.CROSSINGS,),
    "deposit_crossings": (deposits.CROSSINGS,),
    "*deposits/*": (deposits.DEPOSITS,),
    "r22/correlations": (r22.CORRELATIONS,),
    "r22/form_factors": (r22.FORM_FACTORS,),
    "r22/models": (r22.MODELS,),
    "r22/polyhedron_ellipsoid_difference": (r22.DIFFERENCE,),
    "r22/table2_*": (r22.FORM_STATISTICS,),
    "r22/table3_*": (r22.CASES,),
    "r22/table6_*": (r22.VALIDATION,),
    "r22/table9_*": (r22.SECOND_FACTOR,),
    "r22/table10_*": (r22.FEATURE_SETS,),
    "r22/table11_*": (r22.APPLICATION,),
    "r22/*": (r22.POROSITIES,),
    "beard_weyl_1973": (models.SORTED_SANDS,),
    "bed_size": (benchmarks.BED_SIZE, COLUMNS),
    "contact_law": (benchmarks.CONTACT_LAW,),
    "ellipsoid_contact": (benchmarks.ELLIPSOID_CONTACT,),
    "features": (benchmarks.FEATURES,),
    "height": (benchmarks.HEIGHT,),
    "inflated": (benchmarks.INFLATED,),
    "ranks": (benchmarks.RANKS,),
    "scaling": (benchmarks.SCALING,),
    "settling": (benchmarks.SETTLING,),
    "step_cost": (benchmarks.STEP_COST,),
    "base_*": (studies.COMPOSITION, COLUMNS),
    "form_by_size": (studies.COMPOSITION, COLUMNS),
    "lattice_beds": (studies.COMPOSITION, COLUMNS),
    "mixtures_wide": (studies.COMPOSITION, COLUMNS),
    "size_and_form": (studies.COMPOSITION, COLUMNS),
    "size_and_form_known": (models.KNOWN_BEDS, COLUMNS),
    "size_and_form_mixtures": (models.KNOWN_BEDS, COLUMNS),
    "size_and_form_slopes": (models.FORM_SLOPES,),
    "size_models_measured": (benchmarks.SIZE_MODELS,),
    "sorted_sands": (models.SORTED_SANDS,),
    "tilted_impacts": (benchmarks.TILTED_IMPACTS,),
    "stability*": (benchmarks.STABILITY,),
    "wide_cost": (benchmarks.WIDE_COST, COLUMNS),
    "verification*": (verification.OUTSIDE,),
    "work_precision/cheapest_settings": (verification.CHEAPEST_SETTINGS,),
    "work_precision/packings": (verification.PACKINGS,),
    "work_precision/rest": (verification.REST,),
    "work_precision/rows": (COLUMNS,),
    "work_precision/*": (verification.PRECISION,),
    "differences": (verification.PACKINGS,),
    "grains/*": (campaign.GRAINS,),
    "tables/*_features": (studies.FEATURES, COLUMNS),
    "*/cost": (campaign.COST, COLUMNS),
    "committed/biases": (campaign.BIASES,),
    "committed/*_porosities": (COLUMNS,),
    "*/application_predictions": (models.APPLICATION, models.MODELS, COLUMNS),
    "models/application": (models.APPLICATION, models.MODELS, COLUMNS),
    "committed/single_form_mean_form": (models.MEAN_FORM, COLUMNS),
    "models/size_and_form_*": (models.SIZE_AND_FORM, models.MODELS, COLUMNS),
    "models/*": (models.MODELS, COLUMNS),
    # Finished campaigns and committed rows have their tables of models beside those of studies.
    "default/models/application": (models.APPLICATION, models.MODELS, COLUMNS),
    "default/models/*": (models.MODELS, COLUMNS),
    "committed/form_mixture": (models.MODELS, COLUMNS),
    "committed/single_form": (models.MODELS, COLUMNS),
    "*_correlations": (models.MODELS, COLUMNS),
    "*_feature_sets": (models.MODELS, COLUMNS),
    "*_second_features": (models.MODELS, COLUMNS),
    "*/shape_kind*": (models.MODELS, COLUMNS),
    "*/unified": (models.MODELS, COLUMNS),
}


def describe_columns(table):
    """Return the possible columns of a table: dict from their names in this table to Column.

    table: path of the table in results/reference or in the folder of a campaign's results, with or without the ending,
    such as "work_precision/rest.csv" or "models/unified". Names that end with * stand for all names that begin so.
    """
    path = PurePath(table)
    name = path.with_suffix("").as_posix() if path.suffix == ".csv" else path.as_posix()
    groups = next((groups for pattern, groups in TABLES.items() if fnmatch(name, pattern)), (COLUMNS,))
    described = {}
    for group in groups:
        for column in group:
            for column_name in filter(None, (column.name, column.committed)):
                described.setdefault(column_name, column)
    return described


def find_column(table, name):
    """Return the Column `name` of a table, or None if it is not described; table: as in `describe_columns`."""
    described = describe_columns(table)
    if name in described:
        return described[name]
    return next((column for key, column in described.items() if key.endswith("*") and fnmatch(name, key)), None)


def setting_column(name):
    """Return the Column of a setting of a packing that a study varies, from its schema; None unless one key ends so."""
    schema = _setting(name)
    return schema and Column(name, schema.get("x-unit", ""), schema["description"].strip().rstrip("."))


def setting_is_optional(name):
    """Return whether a column is a quantity that a packing need not have: then an empty cell is its default."""
    schema = _setting(name)
    return schema is not None and "x-unit" in schema and "default" in schema and schema["default"] is None


def _setting(name):
    """Return the schema of the setting in a column, or None unless one key ends with the name of the column."""
    found = [schema for key, schema in _settings(read_schema("packing")) if key == name]
    return found[0] if len(found) == 1 else None


def _settings(schema):
    """Yield the last part of each key of a schema, with the schema of its value."""
    for key, value in schema.get("properties", {}).items():
        if "description" in value:
            yield key, value
        yield from _settings(value)

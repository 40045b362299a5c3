"""Page of the columns of all tables, from simcore.reference.columns."""

import importlib

from docs.generate.markdown import code, sentence, table
from simcore.reference.columns import COLUMNS, TABLES
from simcore.reference.columns.column import Column

# Groups of columns, in the order of the page: module of simcore.reference.columns, name there, title.
GROUPS = (
    ("studies", "COLUMNS", "Studies and committed rows"),
    ("studies", "COMPOSITION", "Composition of beds with wide sieve curves"),
    ("studies", "FEATURES", "Features of the packings of a study"),
    ("models", "MODELS", "Models"),
    ("models", "KNOWN_BEDS", "Beds of known porosity"),
    ("models", "FORM_SLOPES", "Effect of form in wide sieve curves"),
    ("models", "SORTED_SANDS", "Sands of several sortings"),
    ("models", "SIZE_AND_FORM", "Candidates for size and form"),
    ("models", "APPLICATION", "Packings to which no model was fitted"),
    ("models", "MEAN_FORM", "Porosity at the mean form"),
    ("campaign", "COST", "Cost of the studies"),
    ("campaign", "LEDGERS", "Gathered packings"),
    ("campaign", "BIASES", "Biases of the settings"),
    ("campaign", "GRAINS", "Grains of a set"),
    ("page", "PAGE", "Tables of the report page alone"),
    ("deposits", "DEPOSITS", "Deposits of ellipsoids"),
    ("deposits", "CHANGES", "Changes of a deposit"),
    ("deposits", "MAXIMA", "Densest deposits"),
    ("deposits", "SYMMETRY", "Exchange of eta and zeta"),
    ("deposits", "CROSSINGS", "Angles at which densities cross"),
    ("verification", "PRECISION", "Error against CPU time"),
    ("verification", "PACKINGS", "Errors of the settings of packings"),
    ("verification", "CHEAPEST_SETTINGS", "Cheapest settings"),
    ("verification", "REST", "Beds at rest"),
    ("verification", "OUTSIDE", "Packings with known results"),
    ("benchmarks", "FEATURES", "Cost of features"),
    ("benchmarks", "STEP_COST", "Cost of a time step"),
    ("benchmarks", "SCALING", "Cost over the number of grains"),
    ("benchmarks", "RANKS", "Speed of MPI ranks"),
    ("benchmarks", "SETTLING", "Time to a finished bed"),
    ("benchmarks", "STABILITY", "Maps of stability"),
    ("benchmarks", "BED_SIZE", "Size of the bed"),
    ("benchmarks", "HEIGHT", "Ends of a bed"),
    ("benchmarks", "INFLATED", "Search with inflated grains"),
    ("benchmarks", "ELLIPSOID_CONTACT", "Contacts of ellipsoids"),
    ("benchmarks", "TILTED_IMPACTS", "Impacts of nearly parallel faces"),
    ("benchmarks", "WIDE_COST", "Cost of wide sieve curves"),
    ("benchmarks", "CONTACT_LAW", "Time step of contact laws"),
    ("benchmarks", "SIZE_MODELS", "Models of the sieve curve"),
    ("r22", "FORM_FACTORS", "Rettinger et al.: form factors"),
    ("r22", "FORM_STATISTICS", "Rettinger et al.: statistics of form"),
    ("r22", "CASES", "Rettinger et al.: sieve curves"),
    ("r22", "POROSITIES", "Rettinger et al.: porosity against a setting"),
    ("r22", "VALIDATION", "Rettinger et al.: comparison with experiments"),
    ("r22", "SECOND_FACTOR", "Rettinger et al.: second form factor"),
    ("r22", "FEATURE_SETS", "Rettinger et al.: sets of features"),
    ("r22", "APPLICATION", "Rettinger et al.: application"),
    ("r22", "MODELS", "Rettinger et al.: models"),
    ("r22", "CORRELATIONS", "Rettinger et al.: correlations"),
    ("r22", "DIFFERENCE", "Rettinger et al.: polyhedra and ellipsoids"),
)

_HEAD = """# Columns of the tables

The tables of a campaign (`results/`) and the committed tables (`results/reference/`) have these columns. A table has
only those that it needs. A number without a unit is dimensionless. A name
that ends with `*` represents all names that begin so. Some columns have another name in the committed rows. A study may
vary a key of the specification; the column then has its values.
"""


def groups():
    """Return the groups of columns: dict from title to the tuple of Columns."""
    return {title: getattr(importlib.import_module(f"simcore.reference.columns.{module}"), name)
            for module, name, title in GROUPS}  # fmt: skip


def page():
    """Return the page of the columns."""
    parts = [_HEAD]
    for title, columns in groups().items():
        parts += [f"## {title}", _tables(columns), _rows(columns)]
    return "\n\n".join(filter(None, parts)) + "\n"


def _tables(columns):
    patterns = [code(pattern) for pattern, group in TABLES.items() if any(columns is part for part in group)]
    if columns is COLUMNS:
        return "All tables have these columns, unless another group below lists them."
    return "Tables: " + ", ".join(patterns) + "."


def _rows(columns: tuple[Column, ...]):
    """Return a table of columns; the unit is left out if no column has one."""
    rows = [[code(column.name), column.unit, _meaning(column)] for column in columns]
    if any(column.unit for column in columns):
        return table(["column", "unit", "meaning"], rows)
    return table(["column", "meaning"], [[name, meaning] for name, _, meaning in rows])


def _meaning(column):
    """Return the meaning of a column with its key and its name in the committed rows, if it has these."""
    parts = [sentence(column.meaning)]
    if column.key:
        parts.append(f"Key: [`{column.key}`](packing_settings.md#{column.key}).")
    if column.committed:
        parts.append(f"In committed rows: {code(column.committed)}.")
    return " ".join(parts)

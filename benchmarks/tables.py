"""Numbers of tables that are committed."""

DIGITS = 6


def significant(table):
    """Return a DataFrame whose numbers have DIGITS significant digits, so that machines write the same text."""
    numbers = table.select_dtypes("float").columns
    return table.assign(**{name: table[name].map(lambda value: float(f"{value:.{DIGITS}g}")) for name in numbers})

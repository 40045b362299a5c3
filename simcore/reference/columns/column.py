"""One column of a table."""

from typing import NamedTuple


class Column(NamedTuple):
    """A column of a table: name, unit and meaning; a name that ends with * stands for all names that begin so."""

    name: str
    unit: str  # "" for a dimensionless number and for text
    meaning: str
    committed: str = ""  # name in the committed rows; "" if it is the same or there is no such column
    key: str = ""  # key of the specification, if a study may vary it under this name
    statistic: str = ""  # name in simcore.grains.statistics, if it is a statistic over the grains of a packing


NOTE = Column("note", "", "test only, if the rows are those of a test of the workflow")

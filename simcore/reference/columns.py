"""The columns of all tables of studies: name, unit, meaning, name in the committed rows, and the key that they vary.

A table of a study has one row a packing (`simcore.campaign.study_tables.tabulate`) or one a setting (`summarise`);
committed rows are in results/reference. Both take the names of their columns from here.
"""

from typing import NamedTuple


class Column(NamedTuple):
    """A column of the tables of studies."""

    name: str
    unit: str  # "" for a number without one, and for text
    meaning: str
    committed: str = ""  # name in the committed rows; "" where it has the same one or none
    key: str = ""  # of the specification, where a study may vary it under this name
    statistic: str = ""  # name in simcore.grains.statistics, of a statistic over the grains of a packing


COLUMNS = (
    Column("study", "", "name of the study"),
    Column("packing", "", "name of the packing within its study"),
    Column("source", "", "name of the grains' source"),
    Column("case", "", "sieve curve", key="sizes.case"),
    Column("width_m", "m", "width or diameter of the domain", key="domain.width"),
    Column("height_m", "m", "height of the domain", key="domain.height"),
    Column("mass_kg", "kg", "mass of grains that the specification states", key="amount.mass"),
    Column("grains_asked", "", "number of grains that the specification states", key="amount.grains"),
    Column("shaking_s", "s", "duration of shaking", key="shaking.duration"),
    Column("contact_time_s", "s", "contact time", key="numerics.contact_time"),
    Column("shape_kind", "", "shape of the grains, as the study varies it", key="shapes.kind"),
    Column("grain_source", "", "source of the grains, as the study varies it", key="grains.source"),
    Column("mean_FL", "", "mean flatness that was asked for", "mu_FL_nominal", "shapes.flatness.mean"),
    Column("std_FL", "", "standard deviation of flatness asked for", "sigma_FL_nominal", "shapes.flatness.std"),
    Column("mean_EL", "", "mean elongation that was asked for", "mu_EL_nominal", "shapes.elongation.mean"),
    Column("std_EL", "", "standard deviation of elongation asked for", "sigma_EL_nominal", "shapes.elongation.std"),
    Column("flatness", "", "flatness S/I of all grains that was asked for"),
    Column("elongation", "", "elongation I/L of all grains that was asked for"),
    Column("choice", "", "how the shapes of the grains are chosen"),
    Column("faces", "", "faces of a polyhedron at most, or original"),
    Column("accuracy", "", "preset of numerical settings"),
    Column("grain", "", "name of the grain whose form all grains have"),
    Column("kind", "", "shape of the grains: polyhedron, ellipsoid, sphere or mixed", "representation"),
    Column("seed", "", "seed of the packing"),
    Column("run", "", "number of a repeated packing: its seed"),
    Column("runs", "", "number of packings of a setting"),
    Column("grains", "", "number of grains"),
    Column("L", "m", "longest axis, mean over the grains"),
    Column("I", "m", "intermediate axis, mean over the grains"),
    Column("S", "m", "shortest axis, mean over the grains"),
    Column("FL", "", "flatness S/I, mean over the grains", statistic="mu_FL"),
    Column("EL", "", "elongation I/L, mean over the grains", "mu_EL", statistic="mu_EL"),
    Column("EQ", "", "equancy S/L, mean over the grains", "mu_EQ", statistic="mu_EQ"),
    Column("sigma_FL", "", "standard deviation of flatness over the grains", statistic="sigma_FL"),
    Column("sigma_EL", "", "standard deviation of elongation over the grains", statistic="sigma_EL"),
    Column("sigma_EQ", "", "standard deviation of equancy over the grains", statistic="sigma_EQ"),
    Column("n", "", "bulk porosity by volume-equivalent spheres"),
    Column("n_std_error", "", "sampling error of n", "n_error"),
    Column("n_std", "", "standard deviation of n over the packings of a setting"),
    Column("n_seed_error", "", "standard error of the mean of n over the seeds"),
    Column("n_exact", "", "bulk porosity by slices of the grains themselves"),
    Column("n_std_error_exact", "", "sampling error of n_exact"),
    Column("coordination_number", "", "mean number of contacts of a grain in the bulk"),
    Column("spearman_D", "", "rank correlation of grain size with height"),
    Column("steps", "", "number of time steps"),
    Column("cpu_s", "s", "CPU time of the packing"),
    Column("cpu_h", "h", "CPU time of all packings of a row"),
    Column("warnings", "", "warnings of the packing, one line each"),
    # Of the table of trends over height.
    Column("quantity", "", "quantity whose change over height is measured"),
    Column("mean", "", "mean of the quantity over the grains, in its own unit"),
    Column("mean_std_error", "", "standard error of that mean"),
    Column("spearman_r", "", "rank correlation of the quantity with height"),
    Column("p_value", "", "probability of so large a correlation without any order"),
    Column("relative_change", "", "change from the lower to the upper end of the bed, over the mean"),
    Column("relative_change_std_error", "", "standard error of the relative change"),
)

COLUMN_OF_KEY = {column.key: column.name for column in COLUMNS if column.key}
COMMITTED_NAMES = {column.name: column.committed for column in COLUMNS if column.committed}
# Statistics over the grains of a packing: name of the column, and in simcore.grains.statistics.
FORM = {column.name: column.statistic for column in COLUMNS if column.statistic}
# Distributions of form that were asked for, and their statistics over the grains.
ASKED_FOR = {"mean_FL": "mu_FL", "mean_EL": "mu_EL", "std_FL": "sigma_FL", "std_EL": "sigma_EL"}


def study_names(*names):
    """The names in the tables of studies of these columns, or of all, dict by their names in the committed rows."""
    return {COMMITTED_NAMES[name]: name for name in names or COMMITTED_NAMES}

"""The columns of all tables of studies: name, unit, meaning, name in the committed rows, and the key that is varied.

A table of a study has one row per packing (`simcore.campaign.study_tables.tabulate`) or per setting (`summarise`);
committed rows are in results/reference. The names of the columns of both are defined here.
"""

from typing import NamedTuple

# Sieve curves of the measured gravels of Rettinger et al. (2022)
R22_CASES = ("U1", "U3", "U5", "U7", "B30", "B50", "B70")


class Column(NamedTuple):
    """A column of the tables of studies."""

    name: str
    unit: str  # "" for a dimensionless number and for text
    meaning: str
    committed: str = ""  # name in the committed rows; "" if it is the same or there is no such column
    key: str = ""  # key of the specification, if a study may vary it under this name
    statistic: str = ""  # name in simcore.grains.statistics, if it is a statistic over the grains of a packing


COLUMNS = (
    Column("study", "", "name of the study"),
    Column("packing", "", "name of the packing within its study"),
    Column("source", "", "name of the grains' source"),
    Column("case", "", "sieve curve", key="sizes.case"),
    Column("width_m", "m", "width or diameter of the domain", key="domain.width"),
    Column("height_m", "m", "height of the domain", key="domain.height"),
    Column("mass_kg", "kg", "mass of grains in the specification", key="amount.mass"),
    Column("grains_asked", "", "number of grains in the specification", key="amount.grains"),
    Column("shaking_s", "s", "duration of shaking", key="shaking.duration"),
    Column("contact_time_s", "s", "contact time", key="numerics.contact_time"),
    Column("shape_kind", "", "shape of the grains, if the study varies it", key="shapes.kind"),
    Column("grain_source", "", "source of the grains, if the study varies it", key="grains.source"),
    Column("mean_FL", "", "specified mean of flatness", "mu_FL_nominal", "shapes.flatness.mean"),
    Column("std_FL", "", "specified standard deviation of flatness", "sigma_FL_nominal", "shapes.flatness.std"),
    Column("mean_EL", "", "specified mean of elongation", "mu_EL_nominal", "shapes.elongation.mean"),
    Column("std_EL", "", "specified standard deviation of elongation", "sigma_EL_nominal", "shapes.elongation.std"),
    Column("flatness", "", "flatness S/I of all grains in the specification"),
    Column("elongation", "", "elongation I/L of all grains in the specification"),
    Column("choice", "", "how the shapes of the grains are chosen"),
    Column("faces", "", "maximum number of faces of a polyhedron, or original"),
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
    # Columns of the table of trends over height
    Column("quantity", "", "quantity whose change over height is measured"),
    Column("mean", "", "mean of the quantity over the grains, in its own unit"),
    Column("mean_std_error", "", "standard error of that mean"),
    Column("spearman_r", "", "rank correlation of the quantity with height"),
    Column("p_value", "", "probability of at least this correlation without a trend"),
    Column("relative_change", "", "change from the lower to the upper end of the bed, divided by the mean"),
    Column("relative_change_std_error", "", "standard error of the relative change"),
    # Columns of the table of packing models on measured gravels, size_models_measured.csv
    Column("model", "", "name of a packing model, a candidate or a river predictor"),
    Column("K", "", "compaction index of a model that has one"),
    Column("given", "", "what the model is given"),
    Column("classes", "", "how a sieve class enters: one size, its geometric mean; or divided into narrow parts"),
    *[Column(f"error_{case}", "", f"predicted minus measured porosity of {case}") for case in R22_CASES],
    Column("rms_error", "", "root mean square of the errors of all gravels but U1"),
    Column("slope_U7", "", "change of the porosity of U7 over the change of the one-class porosity, between forms"),
    Column("slope_B50", "", "the same of B50"),
)

COLUMN_OF_KEY = {column.key: column.name for column in COLUMNS if column.key}
COMMITTED_NAMES = {column.name: column.committed for column in COLUMNS if column.committed}
# Statistics over the grains of a packing: dict from the name of the column to that in simcore.grains.statistics
FORM = {column.name: column.statistic for column in COLUMNS if column.statistic}
# Distributions of form in the specification: dict from their columns to the statistics over the grains
ASKED_FOR = {"mean_FL": "mu_FL", "mean_EL": "mu_EL", "std_FL": "sigma_FL", "std_EL": "sigma_EL"}


def study_names(*names):
    """Return the names of these columns, or of all, in the tables of studies; dict by name in the committed rows."""
    return {COMMITTED_NAMES[name]: name for name in names or COMMITTED_NAMES}

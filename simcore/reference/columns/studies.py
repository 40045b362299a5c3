"""Columns of the tables of studies and of the committed rows of their packings.

A table of a study has one row per packing (`simcore.campaign.study_tables.tabulate`) or per setting (`summarise`);
committed rows are in results/reference.
"""

from simcore.reference.columns.column import NOTE, Column

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
    Column("coordination_number", "", "mean number of contacts of a grain with other grains, over all grains"),
    Column("spearman_D", "", "rank correlation of grain size with height"),
    Column("steps", "", "number of time steps"),
    Column("cpu_s", "s", "CPU time of the packing"),
    Column("cpu_h", "h", "CPU time of all packings of a row"),
    Column("warnings", "", "warnings of the packing, one line each"),
    NOTE,
    # Settings that single studies vary
    Column("dashpot", "", "how the dashpot is evaluated: explicit or implicit", key="numerics.dashpot"),
    Column("steps_per_contact_time", "", "time steps per contact time", key="numerics.steps_per_contact_time"),
    Column("polyhedron_contact", "", "patch, point or inflated contact", key="numerics.polyhedron_contact"),
    Column("friction_law", "", "law of friction", key="material.friction_law"),
    Column("domain_type", "", "periodic box or cylinder", key="domain.type"),
    Column("end_of_contact", "", "normal force at the end of a contact", key="material.end_of_contact"),
    Column("orientation", "", "orientation at insertion", key="generation.orientation"),
    Column("eta_mean", "", "specified mean of eta, the longest over the middle axis", key="shapes.eta.mean"),
    Column("eta_std", "", "specified standard deviation of eta", key="shapes.eta.std"),
    Column("zeta_mean", "", "specified mean of zeta, the middle over the shortest axis", key="shapes.zeta.mean"),
    Column("zeta_std", "", "specified standard deviation of zeta", key="shapes.zeta.std"),
    Column("grains_seed", "", "seed of the synthetic grains", key="grains.seed"),
    Column("draw", "", "draw of sizes and forms: random or quota", key="sizes.draw"),
    Column("by_size", "", "distributions of form for ranges of sieve size", key="shapes.by_size"),
    Column("fill", "", "insertion height: bed or r22", key="generation.fill"),
    Column("spacing", "m", "distance of lattice points at insertion", key="generation.spacing"),
    Column("stretch_x", "", "factor of the distances of lattice points along x", key="generation.stretch_x"),
    Column("stretch_z", "", "factor of the distances of lattice points along z", key="generation.stretch_z"),
    Column(
        "batch_solid_fraction",
        "",
        "volume fraction of the grains in the zone of a batch at insertion",
        key="generation.solid_fraction",
    ),
    Column("drop_height", "m", "clearance between the bed and a new batch", key="generation.drop_height"),
    Column(
        "max_unbalanced_force",
        "",
        "limit of the mean net force on a grain over the mean contact force, at rest",
        key="convergence.max_unbalanced_force",
    ),
    # Comparison with Rettinger et al. (2022), simcore.reference.r22_comparison.add_reference
    Column("r22_n", "", "porosity by Rettinger et al.: from their tables, or by their fitted model"),
    Column("r22_n_std", "", "standard deviation of their porosity over their runs"),
    Column("r22_n_error", "", "standard error of r22_n"),
    Column("difference", "", "n minus r22_n"),
    Column("z", "", "difference divided by the standard error of both porosities"),
    Column("experiment_n", "", "porosity measured in the laboratory, by Rettinger et al."),
    Column("experiment_n_std", "", "standard deviation of experiment_n"),
    Column("experiment_error_percent", "%", "difference of n to experiment_n, relative to the latter"),
    Column("r22_error_percent", "%", "the same difference for the packings of Rettinger et al."),
    Column("cpu_h_per_run", "h", "CPU time of a packing, mean of the row"),
    Column("r22_volume_change_percent", "%", "change of the grains' volume by decimation, by Rettinger et al."),
    Column("r22_runtime_h", "h", "run time of their packing"),
    Column("model_n", "", "porosity by our model of mixtures"),
    Column("model_difference", "", "model_n minus r22_n"),
    # Columns of the table of trends over height
    Column("quantity", "", "quantity whose change over height is measured"),
    Column("mean", "", "mean of the quantity over the grains, in its own unit"),
    Column("mean_std_error", "", "standard error of that mean"),
    Column("spearman_r", "", "rank correlation of the quantity with height"),
    Column("p_value", "", "probability of at least this correlation without a trend"),
    Column("relative_change", "", "change from the lower to the upper end of the bed, divided by the mean"),
    Column("relative_change_std_error", "", "standard error of the relative change"),
    Column("packings", "", "number of packings of a row"),
    Column("seeds", "", "number of seeds of a row"),
    Column("spearman_z", "", "weighted mean rank correlation in units of its standard error without a trend"),
    Column("isotropic", "rad", "mean angle to the vertical if directions are isotropic"),
)

# Rows with the composition of the evaluated part (simcore.campaign.composition_columns)
COMPOSITION = (
    Column("share_*", "", "share of this sieve class in the evaluated part, by volume"),
    Column("mu_*", "", "mean of flatness, elongation or equancy over the evaluated part, by volume"),
    Column("sigma_*", "", "its standard deviation"),
    Column("coarse_*", "", "share by volume of the coarse grains, the coarser half of the bed; _error: standard error"),
    Column("fine_*", "", "share by volume of the fine grains, the finest tenth of the bed; _error: standard error"),
    Column("time_s", "s", "simulated time, from the first grain to rest; the bed was shaken during most of it"),
)

# Table of features: statistics over the grains of a packing (simcore.grains.statistics)
FEATURES = (
    Column("sample", "", "settings without the seed, equal for packings that differ only in their seed"),
    Column("kind", "", "discrete: forms are drawn from the grain set; continuous: from a distribution"),
    Column("mu_*", "", "mean of a form factor, or of its inverse (1/), over the grains; _inv: its inverse"),
    Column("sigma_*", "", "standard deviation of a form factor, or of its inverse (1/); _inv: its inverse"),
)

COLUMN_OF_KEY = {column.key: column.name for column in COLUMNS if column.key}
COMMITTED_NAMES = {column.name: column.committed for column in COLUMNS if column.committed}
# Statistics over the grains of a packing: dict from the name of the column to that in simcore.grains.statistics
FORM = {column.name: column.statistic for column in COLUMNS if column.statistic}
# Distributions of form in the specification: dict from their columns to the statistics over the grains
SPECIFIED_FORM = {"mean_FL": "mu_FL", "mean_EL": "mu_EL", "std_FL": "sigma_FL", "std_EL": "sigma_EL"}
SPECIFIED_MEANS = ("mean_FL", "mean_EL")


def study_names(*names):
    """Return the names of these columns, or of all, in the tables of studies; dict by name in the committed rows."""
    return {COMMITTED_NAMES[name]: name for name in names or COMMITTED_NAMES}

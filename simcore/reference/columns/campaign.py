"""Columns of the tables of a campaign: cost, gathered packings, biases of settings, and the grains."""

from simcore.grains.form import FORM_FACTORS
from simcore.reference.columns.column import NOTE, Column

COST = (
    Column("study", "", "name of the study, or all"),
    Column("packings", "", "number of packings"),
    Column("grains", "", "number of grains of all packings"),
    Column("cpu_h", "h", "CPU time of all packings"),
    Column("cpu_h_per_packing", "h", "CPU time of a packing"),
    Column("grain_steps", "", "sum over the packings of grains times time steps"),
    Column("cpu_us_per_grain_step", "µs", "CPU time per grain and time step"),
    Column("r22_cpu_h", "h", "core-hours of the program of Rettinger et al. for as many grain-steps"),
)
# gathered.csv has one row per packing, collected.csv one per study
LEDGERS = (
    *COST,
    Column("source", "", "name of the grains' source"),
    Column("packing", "", "name of the packing within its study"),
    Column("settings", "", "digest of the settings that decide the porosity"),
    Column(
        "grain_set",
        "",
        "name of the set of grains with a digest of their files; empty: no grains are read, or before it was recorded",
    ),
    Column("cpu_s", "s", "CPU time of the packing"),
    Column("code", "", "version of the code that packed, digest of its sources, and commit"),
    Column("evaluation", "", "the same of the code that evaluated the packing; empty: before it was recorded"),
    Column("table", "", "file with the rows"),
    Column("planned", "", "number of packings that the campaign plans"),
    Column("cpu_h_estimated", "h", "CPU time of the gathered packings by the cost model"),
    Column("cpu_h_left_estimated", "h", "estimated CPU time of the packings that are not gathered yet"),
    Column("command", "", "command of the campaign"),
    Column("machine", "", "machine and versions of libraries with which the packings were made"),
)
BIASES = (
    Column("of", "", "what differs: settings, size of the bed, time of shaking or insertion"),
    Column("setting", "", "setting whose bias is given"),
    Column("against", "", "setting that it is compared with"),
    Column("bed", "", "packings that were compared"),
    Column("inserted", "", "where grains were inserted in these packings"),
    Column("kind", "", "grains or ellipsoids"),
    Column("beds", "", "number of pairs of packings"),
    Column("difference", "", "mean difference in porosity of setting minus against"),
    Column("difference_std_error", "", "standard error of difference"),
    Column("source", "", "committed table with the packings"),
)
# Tables of the grain set, simcore.grains.tables
GRAINS = (
    Column("grain", "", "name of the grain"),
    Column("L_mm", "mm", "longest axis of the mass-equivalent ellipsoid"),
    Column("I_mm", "mm", "intermediate axis of the mass-equivalent ellipsoid"),
    Column("S_mm", "mm", "shortest axis of the mass-equivalent ellipsoid"),
    Column("D_mm", "mm", "sieve size"),
    Column("volume_mm3", "mm³", "volume"),
    Column("faces", "", "number of faces"),
    Column("sphericity", "", "surface of the sphere of the same volume over the surface of the grain"),
    Column("hull_ratio", "", "volume of the grain's convex hull over that of the grain"),
    *(Column(name, "", "form factor, defined in form_factors.csv of results/reference/r22") for name in FORM_FACTORS),
    # Decimation
    Column("target", "", "maximum number of faces"),
    *(
        Column(f"{name}_change_percent{end}", "%", f"change of the {name} by decimation{of}")
        for name in ("volume", "flatness", "elongation", "sphericity")
        for end, of in (("", ""), ("_largest", ", largest absolute value over the grains"))
    ),
    # Statistics of the set
    Column("source", "", "this set, or the data set of Rettinger et al."),
    Column("size_min_mm", "mm", "smallest sieve size"),
    Column("size_max_mm", "mm", "largest sieve size"),
    Column("n_samples", "", "number of grains"),
    Column("mu_FL", "", "mean flatness"),
    Column("sigma_FL", "", "standard deviation of flatness, of a sample"),
    Column("mu_EL", "", "mean elongation"),
    Column("sigma_EL", "", "standard deviation of elongation, of a sample"),
    Column("shapiro_W_FL", "", "W of the Shapiro-Wilk test of flatness"),
    Column("shapiro_p_FL", "", "p-value of the Shapiro-Wilk test of flatness"),
    Column("shapiro_W_EL", "", "W of the Shapiro-Wilk test of elongation"),
    Column("shapiro_p_EL", "", "p-value of the Shapiro-Wilk test of elongation"),
    Column("r_FL_EL", "", "Pearson's correlation of flatness and elongation"),
    Column("r_size_FL", "", "Pearson's correlation of the logarithm of size and flatness"),
    Column("r_size_EL", "", "Pearson's correlation of the logarithm of size and elongation"),
    Column("type", "", "kind of material, by Rettinger et al."),
    Column("not_normal", "", "factors whose distribution is not normal, by Rettinger et al."),
    # Principal components and shapes
    Column("component", "", "principal component of the standardised form factors"),
    Column("explained", "", "share of the variance that the component explains"),
    Column("cumulative", "", "share of the variance that it explains with all before it"),
    Column("measure", "", "measure of shape, simcore.grains.scan_shapes"),
    *(
        Column(f"{prefix}{name}", "", f"{word} of the measure over the {grains}")
        for prefix, grains in (("", "grains of the set"), ("scans_", "65 scanned grains"))
        for name, word in (("min", "minimum"), ("max", "maximum"), ("mean", "mean"), ("std", "standard deviation"))
    ),
    Column("within", "", "whether all grains are in the range of the scanned grains"),
    NOTE,
)

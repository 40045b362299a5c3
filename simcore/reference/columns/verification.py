"""Columns of the tables of verification: error against CPU time, rest of a bed, packings with known results."""

from simcore.reference.columns.column import NOTE, Column

_MACHINE = Column("machine", "", "machine, versions of libraries and digest of the code")
_UNIT = "rad for attitude and normal, else none"
PRECISION = (
    Column("case", "", "what is computed"),
    Column("quantity", "", "quantity whose error is given"),
    Column("method", "", "algorithm"),
    Column("setting", "", "numerical setting of the algorithm, such as the number of steps"),
    Column("default", "", "whether the setting is the default of the program"),
    Column("repeat", "", "number of the repetition of a run"),
    Column("error", _UNIT, "absolute error, median over the repetitions"),
    Column("error_std", _UNIT, "standard error of error"),
    Column("cpu_s", "s", "CPU time, median over the repetitions"),
    Column("cpu_least", "s", "smallest CPU time of the repetitions"),
    Column("cpu_most", "s", "largest CPU time of the repetitions"),
    Column("reference_error", _UNIT, "error of the solution with which others are compared"),
    Column("on_front", "", "whether no other setting is as good in both error and CPU time and better in one"),
    _MACHINE,
)
# Error in porosity of each setting of a study
PACKINGS = (
    Column("study", "", "name of the study"),
    Column("varied", "", "settings that the study varies"),
    Column("setting", "", "values of these settings"),
    Column("grain", "", "name of the grain whose form all grains have"),
    Column("seeds", "", "number of packings"),
    Column("n", "", "porosity, mean over the seeds"),
    Column("n_std_error", "", "standard error of n, over the seeds"),
    Column("difference", "", "difference in porosity to the first setting of the study, paired by seed"),
    Column("difference_std_error", "", "standard error of difference"),
    Column("cpu_s", "s", "CPU time of a packing, median"),
    Column("cpu_ratio", "", "CPU time over that of the first setting of the study"),
    NOTE,
    _MACHINE,
)
CHEAPEST_SETTINGS = (
    Column("wished_error", "", "allowed error of porosity"),
    Column("precision_*", "", "setting of this study in the cheapest combination"),
    Column("error_bound", "", "sum of the magnitudes of the differences in porosity"),
    Column("error_std_error", "", "standard error of the sum"),
    Column("cpu_ratio", "", "product of the CPU time ratios of the settings"),
    _MACHINE,
)
REST = (
    Column("shape", "", "shape of the grains"),
    Column("dashpot", "", "how the dashpot is evaluated: explicit or implicit"),
    Column("steps", "", "time steps per contact time"),
    Column("kinetic_energy", "", "largest kinetic energy of the free bed, over its weight times the mean sieve size"),
    Column("unbalanced_force", "", "mean net force on a grain over the mean contact force, at the end"),
    Column("mean_overlap", "m", "mean overlap of contacts at the end"),
    Column("coordination", "", "mean number of contacts of a grain at the end"),
    Column("mean_height", "m", "mass-averaged height of the grains at the end"),
    Column("cpu_s", "s", "CPU time of the steps"),
    _MACHINE,
)
# Packings compared with known results
OUTSIDE = (
    Column("name", "", "name of the case"),
    Column("quantity", "", "quantity that is compared, all of them dimensionless"),
    Column("seeds", "", "number of packings"),
    Column("measured", "", "mean over the seeds"),
    Column("std_error", "", "standard error of measured"),
    Column("low", "", "lower end of the band that the source gives"),
    Column("high", "", "upper end of the band that the source gives"),
    Column("inside", "", "whether measured is inside the band"),
    Column("cpu_s", "s", "CPU time of all packings of the row"),
    Column("source", "", "publication from which the band is taken"),
    _MACHINE,
)

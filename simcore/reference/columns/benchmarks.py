"""Columns of the committed tables that benchmarks write: speed, and single studies."""

from simcore.reference.columns.column import Column

# Sieve curves of the measured gravels of Rettinger et al. (2022)
R22_CASES = ("U1", "U3", "U5", "U7", "B30", "B50", "B70")

_SHAPE = Column("shape", "", "shape of the grains")
_GRAINS = Column("grains", "", "number of grains")
_DIGEST = Column("digest", "", "digest of the code that was measured")
_LOAD = Column("load_average", "", "load average of the machine at the end")
_CONTACTS = Column("contacts_per_grain", "", "contacts over the number of grains; each contact counts once")
_PAIRS = Column("near_pairs_per_grain", "", "listed candidate pairs over the number of grains")
_CPU = Column("cpu_us_per_grain_step", "µs", "CPU time per grain and time step, mean of ten stretches of time steps")
_WALL = Column("wall_us_per_grain_step", "µs", "wall time per grain and time step")
_FACES = Column("faces", "", "maximum number of faces of a polyhedron")

FEATURES = (
    Column("what", "", "kind of grains, or the feature that differs from the first row of its shape"),
    _SHAPE,
    Column("bed", "", "same: the bed of the first row; own: poured with the feature"),
    _GRAINS,
    _CPU,
    Column("ratio", "", "CPU time over that of the row without the feature"),
    Column("cpu_us_per_contact_step", "µs", "CPU time per contact and time step"),
    _CONTACTS,
    _PAIRS,
    Column("solid_fraction", "", "solid fraction of the bed"),
    Column("bytes_per_grain", "B", "memory of the arrays of the grains, per grain"),
    Column("cpu_us_least", "µs", "smallest CPU time per grain and time step of the stretches"),
    Column("cpu_us_most", "µs", "largest CPU time per grain and time step of the stretches"),
    _DIGEST,
)
SCALING = (
    _SHAPE,
    _FACES,
    _GRAINS,
    Column("threads", "", "number of threads"),
    _CPU,
    _WALL,
    Column("speedup", "", "wall time of one thread over that of these threads"),
    _CONTACTS,
    _PAIRS,
    Column("steps", "", "number of time steps measured"),
    _LOAD,
    _DIGEST,
)
STEP_COST = (
    Column("what", "", "bed of 2000 grains, or touching pair, of which a step or a query is measured"),
    Column("code", "", "program, with its version"),
    Column("median_us", "µs", "median of the runs: CPU time per grain and time step, or of a query"),
    Column("lowest_us", "µs", "the same, of the fastest run"),
    Column("highest_us", "µs", "the same, of the slowest run"),
    _CONTACTS,
    Column("runs", "", "number of runs, in turns with those of the other rows"),
    _LOAD,
    _DIGEST,
)
RANKS = (
    _SHAPE,
    _FACES,
    _GRAINS,
    Column("ranks", "", "number of MPI processes"),
    _WALL,
    Column("speedup", "", "wall time of the smallest number of ranks over that of these ranks"),
    Column("exchange_share", "", "share of the wall time for communication and waiting"),
    Column("bytes_per_step_and_rank", "B", "data that a rank sends in a time step"),
    Column("ghosts_per_own", "", "grains of other ranks that a rank stores, over its own grains"),
    Column("pairs_twice_share", "", "share of the candidate pairs that two ranks compute"),
    Column("steps", "", "number of time steps measured"),
    Column("runs", "", "number of runs, of which the median is given"),
    _LOAD,
    _DIGEST,
)
SETTLING = (
    Column("code", "", "program"),
    Column("version", "", "version of the program"),
    Column("settings", "", "preset, or settings of the other program"),
    Column("seed", "", "seed of the packing"),
    _GRAINS,
    _FACES,
    Column("cpu_s", "s", "CPU time of the packing"),
    Column("simulated_s", "s", "simulated time"),
    Column("n", "", "bulk porosity from exact slices"),
    Column("n_std_error", "", "sampling error of n"),
    Column("coordination", "", "mean number of contacts of a grain"),
    Column("mean_overlap_m", "m", "mean overlap of contacts"),
    Column("max_overlap_m", "m", "largest overlap of a contact"),
    Column("max_speed_m_s", "m/s", "largest speed of a grain at the end"),
    _DIGEST,
)
_OF_AXIS = "given in the meaning"
STABILITY = (
    Column("map", "", "scene and the two settings that are varied"),
    Column("x", _OF_AXIS, "second setting of the map; a contact time is in s, the speed of an impact in m/s"),
    Column("y", _OF_AXIS, "time steps per contact time, or contact time in s"),
    Column("outcome", "", "stable, vibrating, soft, refused, stopped or wrong (benchmarks/studies/stability.py)"),
    Column("overlap", "", "largest overlap over the thickness of the thinner grain"),
    Column("cpu_s", "s", "CPU time of the scene"),
    Column("message", "", "error of a scene that was refused or stopped, or what is not right in one that ended"),
)
BED_SIZE = (
    Column("width_mm", "mm", "width of the periodic box"),
    Column("grain", "", "name of the grain whose form all grains have"),
)
HEIGHT = (
    Column("study", "", "study of the packings"),
    Column("end", "", "end of the bed: floor or surface"),
    Column("grains_from_it", "", "distance of a layer from this end, in mean sieve sizes"),
    Column("beds", "", "number of packings"),
    Column("difference", "", "porosity of the layer minus that of the middle of the bed"),
    Column("std_error", "", "standard error of difference, over the packings"),
)
INFLATED = (
    Column("kind", "", "kind of pairs"),
    Column("pairs", "", "number of pairs"),
    Column("size_a", "m", "sieve size of the first grain"),
    Column("size_b", "m", "sieve size of the second grain"),
    Column("longer", "", "factor on the lengths of the grains"),
    Column("mean_L_over_S", "", "mean ratio of the longest to the shortest axis"),
    Column("overlap", "m", "overlap of each pair"),
    Column("lost", "", "share of the pairs that the search does not report as touching"),
    Column("short", "", "share of the pairs with less than 0.99 of the overlap"),
    Column("mean_share", "", "reported overlap over the overlap, mean; lost pairs count as 0"),
    Column("share_5_percent", "", "5 % quantile of the same"),
    Column("angle_90_percent", "rad", "90 % quantile of the error of the normal, without lost pairs"),
    Column("angle_99_percent", "rad", "99 % quantile of the same"),
    Column("us", "µs", "CPU time of a search"),
)
_OF_UNIT = "given in unit"
ELLIPSOID_CONTACT = (
    Column("measure", "", "what is measured: error of the depth or the normal, energy gained in impacts, cost"),
    Column("form", "", "ratios of the axes"),
    Column("depth", "", "overlap over the radius of the sphere of the larger grain's volume"),
    Column("construction", "", "construction of the contact"),
    Column("n", "", "number of values"),
    Column("mean", _OF_UNIT, "mean value"),
    Column("standard_error", _OF_UNIT, "standard error of mean"),
    Column("std", _OF_UNIT, "standard deviation of the values"),
    Column("median_size", _OF_UNIT, "median of the magnitudes"),
    Column("largest_size", _OF_UNIT, "largest magnitude"),
    Column("unit", "", "unit of the values"),
)
TILTED_IMPACTS = (
    Column("form", "", "form of the body: a cube, a flat block or a prism that leans"),
    Column("against", "", "what it falls on: the floor or its like"),
    Column("polyhedron_contact", "", "where polyhedra press: patch or point"),
    Column("restitution", "", "coefficient of restitution of the contacts"),
    Column("impacts", "", "number of impacts that ended within 3000 steps"),
    Column("stopped", "", "number of impacts that a check of the simulation stopped"),
    Column("least_ratio", "", "least energy after an impact over that before"),
    Column("largest_ratio", "", "largest of the same"),
    Column("share_off_by_tenth", "", "share of the impacts that change the energy by more than a tenth"),
    Column("share_gaining", "", "share of the impacts that gain more than a thousandth of the energy"),
    _DIGEST,
)
WIDE_COST = (
    Column("settings", "", "study of config/wide.yaml whose settings the packing has"),
    Column("shapes", "", "source of the grains"),
    Column("grain_steps", "", "grains times time steps"),
)
_OF_SCENE = "longest stable step in the scene `{}` (benchmarks/studies/contact_law.py); empty if all tried are stable"
CONTACT_LAW = (
    Column("dashpot", "", "how dashpots enter the step: implicit or explicit"),
    Column("overlap_of", "", "overlap that the law has: that of the linear law at rest, of equals, or in an impact"),
    Column("mass_ratio", "", "mass of the stone over that of the pebble"),
    Column("exponent", "", "p, if the force of a spring is proportional to the overlap to the power p"),
    Column("relative_overlap", "", "static overlap over the diameter of the pebble"),
    Column("relative_impact_overlap", "", "largest overlap of an impact over the diameter of the pebble"),
    Column("restitution", "", "restitution of the pebble and the stone, at a fifth of step_s"),
    *[Column(f"{scene}_step_s", "s", _OF_SCENE.format(scene)) for scene in ("loaded", "impact", "alone")],
    Column("step_s", "s", "longest step that is stable in all scenes"),
    Column("one_contact_bound_s", "s", "bound on the step from the force of the stone and the overlap"),
    Column("two_contact_bound_s", "s", "the same, with the force on the floor"),
)
SIZE_MODELS = (
    Column("model", "", "name of a packing model, a candidate or a river predictor"),
    Column("K", "", "compaction index of a model that has one"),
    Column("given", "", "what the model is given"),
    Column("classes", "", "how a sieve class enters: one size, its geometric mean; or divided into narrow parts"),
    *[Column(f"error_{case}", "", f"predicted minus measured porosity of {case}") for case in R22_CASES],
    Column("rms_error", "", "root mean square of the errors of all gravels but U1"),
    Column("slope_U7", "", "change of the porosity of U7 over the change of the one-class porosity, between forms"),
    Column("slope_B50", "", "the same of B50"),
)

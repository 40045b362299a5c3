"""Columns of the published tables of Rettinger et al. (2022), results/reference/r22."""

from simcore.reference.columns.column import Column

_POROSITY = (Column("n", "", "porosity"), Column("n_std", "", "standard deviation of porosity over the runs"))
_CASE = Column("case", "", "sieve curve")

FORM_FACTORS = (
    Column("abbreviation", "", "abbreviation of the form factor"),
    Column("name", "", "name of the form factor"),
    Column("definition", "", "formula in the axes L >= I >= S"),
    Column("range", "", "range of its values"),
)
FORM_STATISTICS = (
    Column("source", "", "data set"),
    Column("type", "", "kind of material"),
    Column("size_min_mm", "mm", "smallest size"),
    Column("size_max_mm", "mm", "largest size"),
    Column("n_samples", "", "number of grains"),
    Column("mu_FL", "", "mean flatness"),
    Column("sigma_FL", "", "standard deviation of flatness"),
    Column("mu_EL", "", "mean elongation"),
    Column("sigma_EL", "", "standard deviation of elongation"),
    Column("not_normal", "", "factors whose distribution is not normal"),
)
CASES = (
    _CASE,
    Column("m_*", "", "mass fraction of the sieve class between these two sizes [mm]"),
    Column("n_exp", "", "porosity measured in the laboratory"),
    Column("n_exp_std", "", "standard deviation of n_exp"),
    Column("generation_spacing_mm", "mm", "distance of lattice points at insertion"),
)
# Tables 4, 5, 7 and 8: porosity against a setting
POROSITIES = (
    _CASE,
    Column("faces", "", "maximum number of faces of a grain, or original"),
    Column("volume_change_percent", "%", "change of the volume by decimation"),
    Column("runtime_h", "h", "run time"),
    Column("t_s", "s", "duration of shaking"),
    Column("width_m", "m", "width of the periodic box"),
    Column("mass_kg", "kg", "mass of the grains"),
    *_POROSITY,
)
VALIDATION = (
    _CASE,
    Column("run*", "", "porosity of this run"),
    Column("mean", "", "mean porosity over the runs"),
    Column("std", "", "standard deviation over the runs"),
    Column("error", "", "difference of mean to the measured porosity"),
    Column("relative_error_percent", "%", "the same, relative to the measured porosity"),
)
_FACTORS = ("FL", "EL", "EL_inv", "EQ_inv", "ASF", "ASF_inv", "IFI", "IFI_inv", "IRI", "IRI_inv", "OPI", "OPI_inv")
SECOND_FACTOR = (
    _CASE,
    *(
        Column(name, "1e-3", f"cross-validated mean absolute error of porosity by the model of EQ_inv and {name}")
        for name in (*_FACTORS, "DRI", "DRI_inv")
    ),
)
FEATURE_SETS = (
    *(
        Column(f"{statistic}_{factor}_inv", "", f"1 if the inverse of {statistic} of {factor} is in the set, else 0")
        for statistic in ("mu", "sigma")
        for factor in ("EQ", "EL")
    ),
    Column("U1_mae_1e-3", "1e-3", "cross-validated mean absolute error of porosity, sieve curve U1"),
    Column("U1_R2", "", "coefficient of determination, sieve curve U1"),
    Column("U7_mae_1e-3", "1e-3", "cross-validated mean absolute error of porosity, sieve curve U7"),
    Column("U7_R2", "", "coefficient of determination, sieve curve U7"),
)
APPLICATION = (
    _CASE,
    Column("predicted", "", "porosity by the model of mixtures"),
    Column("continuous_simulated", "", "porosity of packings with forms drawn from a distribution"),
    Column("continuous_abs_error_1e-3", "1e-3", "absolute difference of the two"),
    Column("discrete_simulated", "", "porosity of packings with forms drawn from the grains"),
    Column("discrete_abs_error_1e-3", "1e-3", "absolute difference to predicted"),
)
MODELS = (
    Column("model", "", "name of the model"),
    _CASE,
    Column("intercept", "", "intercept of the linear model of porosity"),
    *(
        Column(f"{statistic}{factor}_inv", "", f"coefficient of the inverse of {words}{factor}")
        for statistic, words in (("", ""), ("mu_", "the mean of "), ("sigma_", "the standard deviation of "))
        for factor in ("EQ", "EL")
    ),
    Column("equation_arxiv", "", "number of the equation in the arXiv version"),
)
CORRELATIONS = (
    Column("study", "", "single_form or form_mixture"),
    _CASE,
    Column("feature", "", "feature of form"),
    Column("r", "", "Pearson's correlation of the feature with porosity"),
)
DIFFERENCE = (
    _CASE,
    Column("rms_difference", "", "root mean square difference in porosity of polyhedra to their ellipsoids"),
)

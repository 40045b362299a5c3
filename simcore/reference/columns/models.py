"""Columns of the tables of models: coefficients, correlations, feature sets, predictions, kinds of shape."""

from simcore.reference.columns.column import Column

MODELS = (
    # Coefficients, PorosityModel.to_rows
    Column("model", "", "name of the model; in comparisons: unified, separate or r22"),
    Column("term", "", "intercept, or the feature that the coefficient multiplies"),
    Column("coefficient", "", "coefficient of the linear model of porosity"),
    Column("std_error", "", "standard error of the coefficient by least squares"),
    Column("lower_95", "", "lower end of its 95 % confidence interval by least squares"),
    Column("upper_95", "", "upper end of its 95 % confidence interval by least squares"),
    Column("bootstrap_lower_95", "", "lower end of its 95 % confidence interval by a bootstrap, from 12 samples on"),
    Column("bootstrap_upper_95", "", "upper end of its 95 % confidence interval by a bootstrap, from 12 samples on"),
    Column("feature_min", "", "smallest value of the feature in the fit"),
    Column("feature_max", "", "largest value of the feature in the fit"),
    Column("r_squared", "", "coefficient of determination"),
    Column("rmse", "", "root mean square residual of porosity over the samples of the fit"),
    Column("scatter", "", "standard deviation of porosity about the model, for its degrees of freedom"),
    Column("scatter_intercept", "", "scatter at 0 of its line over the first feature; empty: it is constant"),
    Column("scatter_slope", "", "slope of the scatter over the first feature; empty: it is constant"),
    Column("mean_absolute_error", "", "mean cross-validated error of porosity"),
    Column("median_absolute_error", "", "median cross-validated error of porosity"),
    Column("samples", "", "number of samples of the fit; packings that differ only in their seed are one"),
    Column("r22_coefficient", "", "coefficient of Rettinger et al. (2022)"),
    Column("packed_by", "", "this campaign, or committed rows"),
    Column("with_term", "", "second coefficient of a covariance"),
    Column("covariance", "", "covariance of the coefficients of term and with_term, or of two parameters"),
    # Correlations
    Column("feature", "", "feature of form; _inv: its inverse"),
    Column("rank", "", "place of the feature by the magnitude of r, within a case"),
    Column("r", "", "Pearson's correlation of the feature with porosity"),
    Column("r_first", "", "Pearson's correlation of the feature with inverse equancy"),
    Column("kept", "", "whether the feature's correlation with inverse equancy is low enough for a second feature"),
    Column("r22_r", "", "correlation with porosity by Rettinger et al."),
    # Sets of features, cross-validated
    Column("features", "", "features of the model"),
    Column("mu_EQ_inv", "", "1 if the inverse of the mean equancy is in the set, else 0"),
    Column("sigma_EQ_inv", "", "1 if the inverse of the standard deviation of equancy is in the set, else 0"),
    Column("mu_EL_inv", "", "1 if the inverse of the mean elongation is in the set, else 0"),
    Column("sigma_EL_inv", "", "1 if the inverse of the standard deviation of elongation is in the set, else 0"),
    Column("folds", "", "number of folds of the cross-validation"),
    Column("repeats", "", "number of times that it is repeated with other folds"),
    Column("r22_error", "", "mean cross-validated error by Rettinger et al."),
    Column("r22_r_squared", "", "coefficient of determination by Rettinger et al."),
    Column("single_form_error", "", "mean cross-validated error over the packings of one form"),
    Column("form_mixture_error", "", "mean cross-validated error over the packings with a distribution of form"),
    Column("bias", "", "mean of predicted minus simulated porosity"),
    Column("error_without_bias", "", "mean error after the bias is subtracted"),
    Column("single_forms", "", "number of packings of one form, averaged over seeds"),
    Column("form_mixtures", "", "number of packings with a distribution of form, averaged over seeds"),
    # Polyhedra compared with their mass-equivalent ellipsoids
    Column("n_mesh", "", "porosity of polyhedra, mean over seeds"),
    Column("n_ellipsoid", "", "porosity of their mass-equivalent ellipsoids, mean over seeds"),
    Column("n_mesh_error", "", "standard error of n_mesh"),
    Column("n_ellipsoid_error", "", "standard error of n_ellipsoid"),
    Column("rms_difference", "", "root mean square difference in porosity of polyhedra to their ellipsoids"),
    Column("mean_difference", "", "mean difference in porosity of polyhedra to their ellipsoids"),
    Column("forms", "", "number of forms that are compared"),
    Column("r22_rms_difference", "", "rms_difference of Rettinger et al."),
)
# Candidates for size and form, fitted to packed beds
SIZE_AND_FORM = (
    Column("model", "", "name of a candidate, or of a packing model of the literature"),
    Column("parameters", "", "number of fitted parameters"),
    Column("chosen", "", "yes for the model that the rule chooses"),
    Column("error_by_family", "", "weighted mean absolute error, each bed predicted without its family of curves"),
    Column("excess_by_family", "", "error_by_family minus that of the best model"),
    Column("excess_std_error_by_family", "", "standard error of excess_by_family"),
    Column("error_by_form", "", "weighted mean absolute error, each bed predicted without its form"),
    Column("excess_by_form", "", "error_by_form minus that of the best model"),
    Column("excess_std_error_by_form", "", "standard error of excess_by_form"),
    Column("bias", "", "weighted mean of predicted minus packed porosity, each bed predicted without its family"),
    Column("rms_error", "", "weighted root mean square of the same difference"),
    Column("coverage", "", "share of beds within the 95 % prediction interval, each predicted without its family"),
    Column("fitted", "", "fitted parameters with standard errors"),
    Column("parameter", "", "name of a fitted parameter"),
    Column("with_parameter", "", "second parameter of a covariance"),
    Column("value", "", "value of the parameter"),
    Column("at_bound", "", "yes if the parameter is at a bound, where its standard error is not valid"),
    Column("bed", "", "sieve curve, form and seed of a packed bed"),
    Column("family", "", "family of sieve curves that are left out together"),
    Column("form", "", "single form of the grains, or all"),
    Column("n_one_class", "", "porosity of a bed of one sieve class of these grains, packed by the same process"),
    Column("widest", "", "size below which 99 % of the mass is, over that of 1 %"),
    Column("gap", "", "largest ratio of sizes between which 1 % of the mass is, without the finest and coarsest 1 %"),
    Column("predicted_*", "", "porosity by a model, fitted without the bed's family"),
)
# Beds of known porosity, predicted from their sieve curve
KNOWN_BEDS = (
    Column("set", "", "measured, packed, packed by r22 (Rettinger et al.), or published (their models)"),
    Column("n_one_class", "", "porosity of U1 of the same set, from which the bed is predicted"),
    Column("predicted", "", "porosity by the model of size and form"),
    Column("half_width", "", "half width of the stated 95 % interval of `predicted`, for a known porosity of U1"),
    Column("error_*", "", "predicted minus known porosity by a model"),
)
# How much of the effect of form on U1 remains in wide curves
FORM_SLOPES = (
    Column("model", "", "Rettinger et al. (their published models), our packings of one form, or a model"),
    Column("slope_U7", "", "change of the porosity of U7 over that of U1, between 63 forms of which each fills a bed"),
    Column("slope_B50", "", "the same of B50"),
    Column("slope_U7_std_error", "", "standard error by the rounding of published coefficients, or of fitted ones"),
    Column("slope_B50_std_error", "", "the same of B50"),
    Column("slope_mixtures", "", "change of the porosity of U7 over that of U1, between 52 distributions of form"),
)
# Sands of Beard and Weyl (1973)
SORTED_SANDS = (
    Column("grain_size", "", "grain size of the sand; mean of eight: the mean over all grain sizes"),
    Column("sorting", "", "class of sorting"),
    Column("trask_sorting", "", "root of the ratio of the quartiles of size, middle of the class of sorting"),
    Column("log_deviation", "", "standard deviation of ln D of a log-normal curve with this sorting"),
    Column("outside", "", "yes if the curve is wider than those for which the errors of the model are known"),
    Column("n", "", "measured porosity of the wet-packed sand"),
    Column("source", "", "where the porosity was read"),
    Column("predicted_*", "", "porosity by a model, from that of the best sorted sand of the same grain size"),
)
# Packings to which no model was fitted
APPLICATION = (
    Column("kind", "", "discrete: forms are drawn from the grain set; continuous: from a distribution"),
    Column("simulated", "", "porosity of the packings, mean over seeds"),
    Column("predicted", "", "porosity by the model of mixtures"),
    Column("abs_error", "", "absolute difference of predicted to simulated"),
    Column("unified_predicted", "", "porosity by the unified model"),
    Column("unified_abs_error", "", "absolute difference of unified_predicted to simulated"),
    Column("r22_predicted", "", "porosity by the model of Rettinger et al."),
    Column("r22_simulated", "", "porosity of their packings"),
    Column("r22_abs_error", "", "absolute difference of the two"),
)
# Porosity at the mean form of the grains of Rettinger et al.
MEAN_FORM = (
    Column("FL", "", "mean flatness of the grains of Rettinger et al."),
    Column("EL", "", "mean elongation of the grains of Rettinger et al."),
    Column("n", "", "porosity by our model of single forms"),
    Column("lower_95", "", "lower end of the 95 % prediction interval"),
    Column("upper_95", "", "upper end of the 95 % prediction interval"),
    Column("r22_n", "", "porosity by the model of Rettinger et al."),
)

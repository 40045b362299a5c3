"""Headings of columns for readers: words instead of names, the unit that is printed, decimals, and errors.

The names, units of the files and meanings are in the other modules of this package.
"""

from typing import NamedTuple

from simcore.grains.form import FORM_FACTORS


class Heading(NamedTuple):
    """How a page shows a column."""

    words: str
    decimals: int | None = None  # of numbers without an error; None: three significant digits
    unit: str | None = None  # printed instead of that of the file
    factor: float = 1.0  # from the unit of the file to the printed one
    sign: str = ""  # "+" also writes the sign of positive numbers


_ERROR = "mean error of porosity"
_R22 = "Rettinger et al."
HEADINGS = {
    # Settings
    "study": Heading("study"),
    "packing": Heading("packing"),
    "source": Heading("source of the grains"),
    "case": Heading("sieve curve"),
    "width_m": Heading("width", 0, "mm", 1e3),
    "height_m": Heading("height", 0, "mm", 1e3),
    "mass_kg": Heading("mass"),
    "grains_asked": Heading("grains, specified", 0),
    "shaking_s": Heading("shaking", 1),
    "contact_time_s": Heading("contact time", 2, "ms", 1e3),
    "shape_kind": Heading("shape"),
    "grain_source": Heading("source of the grains"),
    "mean_FL": Heading("flatness, mean", 2),
    "std_FL": Heading("flatness, std. dev.", 2),
    "mean_EL": Heading("elongation, mean", 2),
    "std_EL": Heading("elongation, std. dev.", 2),
    "flatness": Heading("flatness S/I", 3),
    "elongation": Heading("elongation I/L", 3),
    "choice": Heading("choice of forms"),
    "faces": Heading("faces, at most", 0),
    "accuracy": Heading("preset"),
    "grain": Heading("grain"),
    "kind": Heading("kind of grains"),
    "seed": Heading("seed", 0),
    "run": Heading("run", 0),
    "runs": Heading("packings", 0),
    "dashpot": Heading("dashpot"),
    "steps_per_contact_time": Heading("steps per contact time", 0),
    "polyhedron_contact": Heading("contact of polyhedra"),
    "friction_law": Heading("law of friction"),
    "end_of_contact": Heading("force at the end of a contact"),
    "draw": Heading("draw of sizes"),
    "by_size": Heading("forms by sieve size"),
    "orientation": Heading("orientation at insertion"),
    "fill": Heading("insertion height"),
    "spacing": Heading("spacing at insertion", 1, "mm", 1e3),
    "stretch_x": Heading("stretch of the lattice along x", 2),
    "stretch_z": Heading("stretch of the lattice along z", 2),
    "batch_solid_fraction": Heading("solid fraction at insertion", 3),
    "drop_height": Heading("drop height", 1, "mm", 1e3),
    "max_unbalanced_force": Heading("limit of the unbalanced force", 2),
    # Results of packings
    "grains": Heading("grains", 0),
    "L": Heading("longest axis L", 2, "mm", 1e3),
    "I": Heading("middle axis I", 2, "mm", 1e3),
    "S": Heading("shortest axis S", 2, "mm", 1e3),
    "FL": Heading("flatness S/I", 3),
    "EL": Heading("elongation I/L", 3),
    "EQ": Heading("equancy S/L", 3),
    "sigma_FL": Heading("flatness, std. dev.", 3),
    "sigma_EL": Heading("elongation, std. dev.", 3),
    "sigma_EQ": Heading("equancy, std. dev.", 3),
    "mu_FL": Heading("flatness S/I, mean", 3),
    "mu_EL": Heading("elongation I/L, mean", 3),
    "mu_EQ": Heading("equancy S/L, mean", 3),
    "n": Heading("porosity", 3),
    "n_std_error": Heading("sampling error of porosity", 4),
    "n_std": Heading("std. dev. over the packings", 4),
    "n_seed_error": Heading("error from the scatter over seeds", 4),
    "n_exact": Heading("porosity, by exact slices", 3),
    "n_std_error_exact": Heading("sampling error, by exact slices", 4),
    "coordination_number": Heading("contacts per grain", 2),
    "spearman_D": Heading("rank correlation of size with height", 2),
    "steps": Heading("time steps", 0),
    "cpu_s": Heading("CPU time", 0),
    "cpu_h": Heading("CPU time", 2),
    "warnings": Heading("warnings"),
    # Rettinger et al., experiments, models
    "r22_n": Heading(f"porosity, {_R22}", 3),
    "r22_n_std": Heading(f"std. dev. over runs, {_R22}", 3),
    "r22_n_error": Heading(f"error, {_R22}", 4),
    "difference": Heading("difference", 3, sign="+"),
    "difference_std_error": Heading("error of the difference", 4),
    "z": Heading("difference over its error", 1, sign="+"),
    "experiment_n": Heading("porosity, experiment", 3),
    "experiment_n_std": Heading("std. dev., experiment", 3),
    "experiment_error_percent": Heading("ours over experiment", 1, sign="+"),
    "r22_error_percent": Heading(f"{_R22} over experiment", 1, sign="+"),
    "cpu_h_per_run": Heading("CPU time of a packing", 3),
    "r22_volume_change_percent": Heading(f"change of volume, {_R22}", 2, sign="+"),
    "r22_runtime_h": Heading(f"run time, {_R22}", 1),
    "model_n": Heading("porosity, our model", 3),
    "model_difference": Heading(f"our model minus that of {_R22}", 3, sign="+"),
    # Trends over height
    "quantity": Heading("quantity"),
    "mean": Heading("mean"),
    "mean_std_error": Heading("error of the mean"),
    "rank": Heading("place", 0),
    "spearman_r": Heading("rank correlation with height", 3, sign="+"),
    "spearman_z": Heading("rank correlation over its error", 1, sign="+"),
    "p_value": Heading("p value", 3),
    "relative_change": Heading("change over the height", 1, "%", 100.0, "+"),
    "relative_change_std_error": Heading("error of the change", 1, "%", 100.0),
    "packings": Heading("packings", 0),
    "seeds": Heading("seeds", 0),
    "isotropic": Heading("mean angle without a preferred direction", 1, "°", 57.29577951308232),
    # Cost and gathered rows
    "cpu_h_per_packing": Heading("CPU time per packing", 3),
    "grain_steps": Heading("grains times steps"),
    "cpu_us_per_grain_step": Heading("CPU time per grain and step", 2),
    "r22_cpu_h": Heading(f"CPU time, {_R22}", 1),
    "planned": Heading("planned", 0),
    "code": Heading("version of the code"),
    "machine": Heading("machine"),
    "cpu_h_estimated": Heading("CPU time, estimated", 1),
    "cpu_h_left_estimated": Heading("CPU time left, estimated", 1),
    # Biases
    "of": Heading("cause"),
    "setting": Heading("setting"),
    "against": Heading("compared with"),
    "bed": Heading("packings compared"),
    "inserted": Heading("insertion"),
    "beds": Heading("pairs", 0),
    # Models
    "model": Heading("model"),
    "term": Heading("term"),
    "coefficient": Heading("coefficient", 4),
    "std_error": Heading("error of the coefficient", 4),
    "lower_95": Heading("95 % interval, lower end", 4),
    "upper_95": Heading("95 % interval, upper end", 4),
    "bootstrap_lower_95": Heading("bootstrap, lower end", 4),
    "bootstrap_upper_95": Heading("bootstrap, upper end", 4),
    "feature_min": Heading("fitted from", 2),
    "feature_max": Heading("fitted to", 2),
    "r_squared": Heading("R²", 3),
    "rmse": Heading("root mean square residual", 4),
    "scatter": Heading("std. dev. about the model", 4),
    "mean_absolute_error": Heading(f"{_ERROR}, cross-validated", 4),
    "median_absolute_error": Heading("median error of porosity, cross-validated", 4),
    "samples": Heading("samples", 0),
    "r22_coefficient": Heading(f"coefficient, {_R22}", 3),
    "packed_by": Heading("packings of"),
    "feature": Heading("feature of form"),
    "r": Heading("correlation with porosity", 3, sign="+"),
    "r_first": Heading("correlation with L/S", 3, sign="+"),
    "kept": Heading("allowed as second feature"),
    "r22_r": Heading(f"correlation, {_R22}", 3, sign="+"),
    "features": Heading("features"),
    "mu_EQ_inv": Heading("1/mean EQ", 0),
    "sigma_EQ_inv": Heading("1/std. dev. EQ", 0),
    "mu_EL_inv": Heading("1/mean EL", 0),
    "sigma_EL_inv": Heading("1/std. dev. EL", 0),
    "folds": Heading("folds", 0),
    "repeats": Heading("repetitions", 0),
    "r22_error": Heading(f"{_ERROR}, {_R22}", 4),
    "r22_r_squared": Heading(f"R², {_R22}", 3),
    "single_form_error": Heading(f"{_ERROR}, one form", 4),
    "form_mixture_error": Heading(f"{_ERROR}, distributions", 4),
    "bias": Heading("predicted minus simulated, mean", 4, sign="+"),
    "error_without_bias": Heading(f"{_ERROR} without the bias", 4),
    "single_forms": Heading("beds of one form", 0),
    "form_mixtures": Heading("beds with a distribution", 0),
    "n_mesh": Heading("porosity, polyhedra", 3),
    "n_ellipsoid": Heading("porosity, ellipsoids", 3),
    "n_mesh_error": Heading("error, polyhedra", 4),
    "n_ellipsoid_error": Heading("error, ellipsoids", 4),
    "rms_difference": Heading("difference, root mean square", 4),
    "mean_difference": Heading("difference, mean", 4, sign="+"),
    "forms": Heading("forms", 0),
    "r22_rms_difference": Heading(f"difference, {_R22}, root mean square", 4),
    "simulated": Heading("porosity, simulated", 3),
    "predicted": Heading("porosity, model of mixtures", 3),
    "abs_error": Heading("its error", 4),
    "unified_predicted": Heading("porosity, unified model", 3),
    "unified_abs_error": Heading("error of the unified model", 4),
    "r22_predicted": Heading(f"porosity, model of {_R22}", 3),
    "r22_simulated": Heading(f"simulated, {_R22}", 3),
    "r22_abs_error": Heading(f"error of the model of {_R22}", 4),
    # Tables of the page alone
    "kind_of_bed": Heading("beds"),
    "formula": Heading("porosity"),
    "fitted_range": Heading("fitted range"),
    "r22_formula": Heading(f"porosity, {_R22}"),
    "example": Heading("grains"),
    "study_title": Heading("study"),
    "compared": Heading("settings in common", 0),
    "own_n": Heading("porosity, this campaign", 3),
    "committed_n": Heading("porosity, committed", 3),
    "effect": Heading("effect on the porosity"),
    # The set of grains
    "size_min_mm": Heading("smallest size", 1),
    "size_max_mm": Heading("largest size", 1),
    "n_samples": Heading("grains", 0),
    "shapiro_W_FL": Heading("Shapiro-Wilk W, flatness", 3),
    "shapiro_p_FL": Heading("Shapiro-Wilk p, flatness", 3),
    "shapiro_W_EL": Heading("Shapiro-Wilk W, elongation", 3),
    "shapiro_p_EL": Heading("Shapiro-Wilk p, elongation", 3),
    "r_FL_EL": Heading("correlation of flatness and elongation", 2, sign="+"),
    "r_size_FL": Heading("correlation of size and flatness", 2, sign="+"),
    "r_size_EL": Heading("correlation of size and elongation", 2, sign="+"),
    "type": Heading("material"),
    "not_normal": Heading("not normally distributed"),
    "target": Heading("faces, at most", 0),
    "component": Heading("principal component"),
    "explained": Heading("variance explained", 1, "%", 100.0),
    "cumulative": Heading("with all before it", 1, "%", 100.0),
    "measure": Heading("measure of shape"),
    "min": Heading("minimum"),
    "max": Heading("maximum"),
    "std": Heading("std. dev."),
    "scans_min": Heading("scans, minimum"),
    "scans_max": Heading("scans, maximum"),
    "scans_mean": Heading("scans, mean"),
    "scans_std": Heading("scans, std. dev."),
    "within": Heading("within the range of scans"),
    **{
        f"{name}_change_percent{end}": Heading(f"{name}, {words}", 2, sign=sign)
        for name in ("volume", "flatness", "elongation", "sphericity")
        for end, words, sign in (("", "mean change", "+"), ("_largest", "largest change", ""))
    },
}
# Column of the error with which the numbers of a column are printed; it is then no column of its own.
ERRORS = {
    "n": "n_std_error",
    "n_exact": "n_std_error_exact",
    "r22_n": "r22_n_error",
    "experiment_n": "experiment_n_std",
    "difference": "difference_std_error",
    "coefficient": "std_error",
    "mean": "mean_std_error",
    "relative_change": "relative_change_std_error",
    "n_mesh": "n_mesh_error",
    "n_ellipsoid": "n_ellipsoid_error",
}


def find_heading(name):
    """Return the Heading of a column; the name in words if there is none."""
    if name in HEADINGS:
        return HEADINGS[name]
    if name.startswith("porosity_"):
        return Heading(f"porosity, {name.removeprefix('porosity_')}")
    if name in FORM_FACTORS:
        return Heading(name, 2, sign="+")
    return Heading(name.replace("_", " "))

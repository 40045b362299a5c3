"""Columns of the tables of deposits of ellipsoids, simcore.campaign.deposits and simcore.campaign.deposit_findings."""

from simcore.reference.columns.column import NOTE, Column

# Results that are averaged over seeds and compared between settings
_RESULTS = (
    Column("solid_fraction", "", "solid fraction of the bulk"),
    Column("coordination_number", "", "mean number of contacts of a grain in the bulk"),
    Column("coordination_number_without_rattlers", "", "the same, without grains that bear no load"),
    Column("rattler_fraction", "", "share of grains in the bulk that bear no load"),
    Column("P2_contact_normal", "", "mean Legendre polynomial P2 of the angle of contact normals to the vertical"),
    Column("P2_long_axis", "", "the same for the long axes of the grains"),
    Column("P2_short_axis", "", "the same for the short axes of the grains"),
)
DEPOSITS = (
    Column("family", "", "family of the study: map, diagonal, prolate, oblate, sizes, forms, bridge or change"),
    Column("study", "", "name of the study"),
    Column("packing", "", "name of the packing within its study"),
    Column("eta", "", "ratio a/b of the semi-axes a >= b >= c, or the mean of its distribution"),
    Column("zeta", "", "ratio b/c of the semi-axes, or the mean of its distribution"),
    Column("std_eta", "", "standard deviation of eta in the specification"),
    Column("std_zeta", "", "standard deviation of zeta in the specification"),
    Column("spread", "", "spread of size: (r_max - r_min) / (r_max + r_min) of the radii"),
    Column("law", "", "law of the normal force"),
    Column("shaking_s", "s", "duration of shaking"),
    Column("seed", "", "seed of the packing"),
    Column("grains", "", "number of grains, or its mean over packings"),
    Column("bulk_grains", "", "number of grains in the evaluated bulk"),
    *_RESULTS,
    Column("azimuth_p2_contact_normal", "", "p-value of uniform azimuths against one preferred direction"),
    Column("azimuth_p4_contact_normal", "", "p-value of uniform azimuths against two directions at right angles"),
    Column("azimuth_p2_long_axis", "", "p-value against one preferred direction of the long axes"),
    Column("azimuth_p4_long_axis", "", "p-value against two directions of the long axes at right angles"),
    Column("bulk_height_in_long_axes", "", "height of the bulk in long axes of a grain of the mid-range radius"),
    Column("mean_overlap", "", "mean overlap of contacts over the diameter of the sphere of a grain's volume"),
    Column("steps", "", "number of time steps, or its mean over packings"),
    Column("time_s", "s", "simulated time, or its mean over packings"),
    Column("last_insertion_s", "s", "simulated time at which the last grain was inserted"),
    Column("cpu_s", "s", "CPU time, of all packings of a row"),
    Column("change", "", "settings that differ from those of the study's first packing; none: no setting"),
    Column("packings", "", "number of packings of a row"),
    *(Column(f"{name}_error", "", f"standard error over the seeds of {name}") for name, *_ in _RESULTS),
    NOTE,
)
# Effect of each change: the mean differences of the results, paired by seed
CHANGES = (
    Column("pairs", "", "number of pairs of packings with the same seed"),
    *(Column(name, "", f"mean difference to the unchanged setting: {meaning}") for name, _, meaning, *_ in _RESULTS),
)
MAXIMA = (
    Column("of", "", "result whose maximum is given"),
    Column("family", "", "line of forms: diagonal (eta = zeta), prolate (zeta = 1) or oblate (eta = 1)"),
    Column("ratio", "", "eta, or zeta of oblate forms, at the maximum"),
    Column("ratio_error", "", "standard error of ratio, by a bootstrap"),
    Column("value", "", "value at the maximum"),
    Column("value_error", "", "standard error of value, by a bootstrap"),
    Column("packings", "", "number of packings near the maximum that are fitted"),
    Column("half_width", "", "half width of the window about the highest mean, in ln(ratio)"),
    Column("misfit_p", "", "p-value of the test whether the means deviate from the fit by more than the seeds scatter"),
    Column("above_prolate", "", "the diagonal's maximum minus that of prolate forms, in standard errors"),
    Column("above_oblate", "", "the diagonal's maximum minus that of oblate forms, in standard errors"),
)
SYMMETRY = (
    Column("of", "", "result that is compared between forms (eta, zeta) and (zeta, eta)"),
    Column("pairs", "", "number of pairs of forms"),
    Column("mean", "", "mean difference of the form with the larger eta to the other"),
    Column("mean_error", "", "standard error of mean, over the pairs"),
    Column("rms", "", "root mean square difference"),
    Column("largest", "", "largest absolute difference"),
    Column("expected_rms", "", "root mean square difference that the scatter over seeds alone would cause"),
)
CROSSINGS = (
    Column("direction", "", "contact normals or long axes"),
    Column("angle", "rad", "angle to the vertical at which the densities of all forms are equal"),
    Column("std_error", "rad", "standard error of angle"),
    Column("forms", "", "number of forms with at least two seeds"),
)

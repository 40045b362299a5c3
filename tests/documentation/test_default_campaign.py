"""The numbers in docs/appendices/default_campaign.md are those of results/reference/default."""

import pandas as pd

from simcore.paths import REFERENCE, ROOT

PAGE = " ".join((ROOT / "docs" / "appendices" / "default_campaign.md").read_text(encoding="utf-8").split())


def table(name):
    return pd.read_csv(REFERENCE / "default" / f"{name}.csv")


def test_its_cost():
    everything = table("cost").set_index("study").loc["all"]
    assert f"has {everything.packings:.0f} packings" in PAGE and f"took {everything.cpu_h:.2f} CPU hours" in PAGE
    assert f"would take {everything.r22_cpu_h:.0f} hours for their {1e-9 * everything.grain_steps:.1f} billion" in PAGE


def test_porosities_of_the_application_the_cylinder_and_spheres():
    for row in table("application").itertuples():
        assert f"| {row.n:.3f} ± {row.n_std_error:.3f}; our model of mixtures" in PAGE
    for row in table("validation").itertuples():
        words = (
            f"| {row.case} in a cylinder (experiment {row.experiment_n:.3f}) | {row.n:.3f} ± {row.n_std_error:.3f} |"
        )
        assert words in PAGE
    spheres = table("near_spheres").query("shape_kind == 'sphere'").iloc[0]
    assert f"| spheres | {spheres.n:.3f} ± {spheres.n_std_error:.3f} |" in PAGE


def test_porosities_of_the_densest_ellipsoids():
    rows = table("near_spheres").assign(ratio=lambda rows: 1.0 / (rows.elongation * rows.flatness))
    rows = rows.query("1.55 < ratio < 1.85")
    least, largest = rows.n_std_error.min(), rows.n_std_error.max()
    assert f"| {rows.n.min():.3f} to {rows.n.max():.3f}, each ± {least:.3f} to {largest:.3f} |" in PAGE


def test_its_models():
    single = table("models/single_form").query("model == 'single_form' and case == 'U1'").set_index("term")
    mixture = table("models/form_mixture").query("case == 'U1'").set_index("term")
    of_single, of_mixture = single.coefficient, mixture.coefficient
    assert (
        "n = {:.3f} + {:.3f} EQ⁻¹ + {:.3f} EL⁻¹, R² {:.3f}, error {:.4f} |".format(
            *of_single[["intercept", "EQ_inv", "EL_inv"]], single.r_squared.iloc[0], single.mean_absolute_error.iloc[0]
        )
        in PAGE
    )
    words = (
        "n = {:.3f} + {:.3f} µ_EQ⁻¹ − {:.3f} σ_EQ⁻¹ + {:.3f} µ_EL⁻¹ − {:.3f} σ_EL⁻¹, R² {:.3f}, error {:.4f} |".format(
            *of_mixture[["intercept", "mu_EQ_inv", "sigma_EQ_inv", "mu_EL_inv", "sigma_EL_inv"]].abs(),
            mixture.r_squared.iloc[0],
            mixture.mean_absolute_error.iloc[0],
        )
    )
    assert words in PAGE
    assert list(of_mixture[of_mixture < 0.0].index) == ["sigma_EQ_inv", "sigma_EL_inv"]
    best = table("models/single_form_correlations").iloc[0]
    assert best.feature == "EQ_inv" and f"| {best.r:.3f} | {best.r22_r:.3f} |" in PAGE
    for row in table("models/application").itertuples():
        assert f"our model of mixtures: {row.predicted:.3f} |" in PAGE
    assert f"| {table('models/shape_kinds').rms_difference.iloc[0]:.3f}, denser where" in PAGE


def test_larger_beds_are_looser():
    """The same forms and mixtures in beds of 1200 grains, means over their seeds, minus the default campaign."""
    large = pd.read_csv(REFERENCE / "single_form.csv")
    large = large.query("source == 'synthetic' and case == 'U1' and representation == 'polyhedron'")
    of_forms = large.groupby("grain").n.mean() - table("single_form").set_index("grain").n
    large = pd.read_csv(REFERENCE / "form_mixture.csv").query("case == 'U1'")
    names = {
        f"{kind}_{name}_nominal": f"{long}_{name}"
        for kind, long in (("mu", "mean"), ("sigma", "std"))
        for name in ("FL", "EL")
    }
    means = large.rename(columns=names).groupby(list(names.values())).n.mean()
    of_mixtures = means - table("form_mixtures").set_index(list(names.values())).n
    texts = [f"{each.mean():.4f} ± {each.sem():.4f}" for each in (of_forms.dropna(), of_mixtures.dropna())]
    assert of_forms.count() == of_mixtures.count() == 12
    assert f"are looser by {texts[0]}, and the same mixtures by {texts[1]}." in PAGE

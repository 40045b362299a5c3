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

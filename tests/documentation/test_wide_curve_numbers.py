"""The numbers in docs/explanation/wide_sieve_curves.md are those of the committed rows."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.base_forms import compare_beds, compare_coefficients, rain_bases, rain_model
from benchmarks.studies.insertion_rate import (
    CONFIGURATION,
    LATTICE,
    bases,
    bases_as_rain,
    bases_table,
    elongation_coefficients,
    form_slopes,
    measured_steps,
    paired_beds,
)
from benchmarks.studies.scatter import pooled_ratio, read_tables, scatter_table
from benchmarks.studies.size_and_form_fit import read_rows
from benchmarks.studies.wide_cost import compare_means, compare_r22, paired
from simcore.evaluation.confidence import student_quantile
from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.bases import RATE, fit_bases
from simcore.models.size_and_form.beds import form_labels
from simcore.paths import REFERENCE, ROOT
from simcore.scene.domain import Domain, lattice_sites
from simcore.scene.sizes import all_cases

PAGE = (ROOT / "docs" / "explanation" / "wide_sieve_curves.md").read_text(encoding="utf-8")
CYLINDER = (ROOT / "docs" / "appendices" / "cylinder.md").read_text(encoding="utf-8")
COST = pd.read_csv(REFERENCE / "wide_cost.csv")


def row_of(word):
    """Return the cells of the only row of a table of the page that contains `word`."""
    (line,) = (line for line in PAGE.splitlines() if line.startswith("|") and word in line)
    return [cell.strip() for cell in line.strip("|").split("|")]


@pytest.mark.parametrize("settings", ["wide_short", "wide_soft", "wide_both", "wide_rain", "wide_filled"])
def test_cost_and_difference_of_each_setting(settings):
    (row,) = paired(COST).query("settings == @settings and case == 'U5'").itertuples()
    _, difference, cost, verdict = row_of(f"(`{settings}`)")
    assert difference == f"{row.difference:+.4f} ± {row.error:.4f}".replace("-", "−")
    assert cost == f"{row.cost:.2f}" and verdict.startswith(row.verdict)


def test_pairs_of_U7():
    (row,) = paired(COST).query("settings == 'wide_both' and case == 'U7'").itertuples()
    grains = COST.query("settings == 'wide_quota' and case == 'U7'")["grains"]
    change = f"{row.difference:+.4f} ± {row.error:.4f}, at {row.cost:.2f} of the CPU time".replace("-", "−")
    assert row.pairs == 3 and row.verdict == "accepted"
    text = f"of {grains.min()} to {grains.max()} grains: both settings together change the porosity by {change}"
    assert text in " ".join(PAGE.split())


def test_pairs_of_B50():
    (row,) = paired(COST).query("settings == 'wide_both' and case == 'B50'").itertuples()
    beds = COST.query("case == 'B50' and settings in ('wide_both', 'wide_quota')")
    pairs = beds.pivot_table(index="seed", columns="settings", values=["n", "grains"]).dropna()
    *first, last = (pairs[("n", "wide_both")] - pairs[("n", "wide_quota")]).map(lambda n: f"{n:+.4f}".replace("-", "−"))
    mean = f"{row.difference:+.4f} ± {row.error:.4f}, at {row.cost:.2f} of the CPU time".replace("-", "−")
    assert row.pairs == len(pairs) == 6 and row.verdict == "not accepted"
    text, grains = " ".join(PAGE.split()), pairs[("grains", "wide_quota")]
    assert f"For B50 six pairs are packed, of {grains.min():.0f} to {grains.max():.0f} grains." in text
    assert f"Their mean difference is {mean}" in text
    assert f"the pairs differ by {', '.join(first)} and {last}." in text
    half = student_quantile(0.95, len(pairs) - 1) * row.error
    assert f"with 95 % confidence it is at most {max(half - row.difference, half + row.difference):.3f}." in text
    needed = len(pairs) * (row.error / 0.0015) ** 2
    assert 8 < needed <= 9 and "about nine pairs would be needed" in text


def test_beds_with_the_settings_of_r22():
    rows = pd.read_csv(REFERENCE / "difference_wide.csv")
    compared = compare_r22(COST, rows)
    differences = ", ".join(f"{-difference:+.4f}" for difference in compared["difference"])
    assert f"| `wide_random`, shaken for 2 s | {differences} |" in PAGE
    n = rows.pivot_table(index="seed", columns=["polyhedron_contact", "steps_per_contact_time"], values="n")
    change = n["point", 40] - n["patch", 10]
    assert f"| +{change.mean():.4f} ± {change.sem():.4f} | {len(change)} |" in CYLINDER
    assert f"| patches and ten implicit steps, shaken for 1 s | +{change.mean():.4f} in the mean |" in PAGE
    for parts in (n["point", 10] - n["patch", 10], n["point", 40] - n["point", 10]):
        assert "| {} | 2 |".format(", ".join(f"{part:+.4f}" for part in parts.dropna())) in CYLINDER


def test_filled_beds_of_B50():
    (row,) = paired(COST).query("settings == 'wide_filled' and case == 'B50'").itertuples()
    assert row.pairs == 3
    assert f"Those of B50 are looser by {row.difference:.4f} ± {row.error:.4f} over three seeds." in PAGE


def test_filled_beds_of_one_class():
    (row,) = paired(COST).query("settings == 'wide_filled' and case == 'U1'").itertuples()
    assert f"and those of U1 by {row.difference:.4f} ± {row.error:.4f}" in PAGE


def test_what_longer_shaking_takes_away_of_the_difference_of_filled_beds():
    n = COST.query("case == 'U5'").pivot_table(index="seed", columns="settings", values="n")
    before, after = n.wide_filled - n.wide_quota, n.wide_filled_long - n.wide_quota
    for seed in after.dropna().index:
        assert f"| {seed} | {before[seed]:+.3f} | {after[seed]:+.3f} |" in PAGE
    words = " ".join(PAGE.split())
    (row,) = paired(COST).query("settings == 'wide_filled_long'").itertuples()
    assert f"The remaining {row.difference:.4f} ± {row.error:.4f} is due to the insertion itself" in words
    assert row.pairs == 3


def test_both_draws_have_the_same_mean_and_cost():
    (row,) = compare_means(COST).query("settings == 'wide_random'").itertuples()
    words = " ".join(PAGE.split())
    assert (
        f"differ by {row.difference:.4f} ± {row.error:.4f}, and a packing takes the same CPU time, {row.cost:.2f}"
        in words
    )


def test_directions_of_the_grains():
    trends = pd.read_csv(REFERENCE / "trends.csv").query("seed == 1 and case == 'U5'").set_index(["study", "quantity"])
    angles = np.degrees(trends[["mean", "mean_std_error"]].xs("angle", level="quantity"))
    text = {study: f"{mean:.1f} ± {error:.1f}°" for study, mean, error in angles.itertuples()}
    assert (
        row_of("dense batch, shaken for 2.0 s and for 5.9 s")[1]
        == f"{text['wide_filled']} and {text['wide_filled_long']}"
    )
    assert (
        row_of("| lattice | 6")[1] == text["wide_quota"]
        and row_of("rain of 0.03 of the volume |")[1] == text["wide_rain"]
    )
    assert (
        row_of("random directions, for")[1] == f"{np.degrees(1.0):.1f}°"
    )  # the mean of arccos |z| over the sphere is 1
    studies = ["wide_filled", "wide_filled_long", "wide_quota", "wide_rain"]
    changes = trends.loc[pd.IndexSlice[studies, ["D", "FL", "EL"]], :]
    assert len(changes) == 12 and (changes.relative_change.abs() < 2 * changes.relative_change_std_error).all()
    assert f"{changes.grains.min()} to {changes.grains.max()} grains" in PAGE


def test_steps_from_one_class_to_wide_curves():
    steps = measured_steps()
    assert list(steps["case"]) == ["U3", "U5", "U7", "B30", "B50", "B70"]
    for step in steps.itertuples():
        rain, lattice = (
            "" if np.isnan(n) else f"{n:.3f} ± {error:.3f}".replace("-", "−")
            for n, error in ((step.rain, step.rain_error), (step.lattice, step.lattice_error))
        )
        assert (
            f"| {step.case} | {step.measured:.3f} | ".replace("-", "−") + f"{rain} | {lattice}".rstrip() + " |" in PAGE
        )


def test_beds_of_one_class_on_lattices_and_as_a_rain():
    beds = bases_as_rain()
    assert set(beds["form"]) == {"G04", "G08", "G26", "G32", "G50", "G59", "all", "sphere"}
    for bed in beds.itertuples():
        name = {"all": "all forms", "sphere": "spheres"}.get(bed.form, bed.form)
        (line,) = (line for line in PAGE.splitlines() if line.startswith(f"| {name} |"))
        *_, lattice, rain, rest = (cell.strip() for cell in line.strip("|").split("|"))
        assert lattice.startswith(f"{bed.n_lattice:.3f} ±") and rain.startswith(f"{bed.n_rain:.3f} ±")
        assert rest == f"{bed.rest:+.3f} ± {bed.error:.3f}".replace("-", "−")


def test_share_of_the_effect_of_form_that_remains():
    slopes = form_slopes(paired_beds())
    assert set(slopes["case"]) == {"R2_65", "U5"}
    for row in slopes.itertuples():
        ending = f"| {row.forms} | {row.slope_lattice:.2f} | {row.slope_rain:.2f} |"
        assert any(row.case in line and line.endswith(ending) for line in PAGE.splitlines())


def test_scatter_over_seeds():
    table = scatter_table(read_tables())
    shown = table[table["case"].isin(["U5", "U5 spheres", "B50, preset wide"])]
    assert len(shown) == 6
    for row in shown.itertuples():
        scatter = f"| {row.std:.4f} ({row.std_lower:.4f} to {row.std_upper:.4f}) | {row.stated:.4f} | {row.chi2:.1f} |"
        begin = f"| {row.draw} | " if row.case == "U5 spheres" else f"| {row.draw} | {row.n:.4f} "
        assert f"{begin}{scatter}" in PAGE or f"{begin}{scatter[2:]}" in PAGE, scatter
    table = table.set_index(["case", "draw"])
    ratio = table["variance_ratio"].map("{:.2f}".format)
    assert f"the variance over the seeds is {ratio['U5', 'quota']} of that" in PAGE
    assert f"By quota the variance is {ratio['U5 spheres', 'quota']} of that" in PAGE
    fine, coarse = table.loc[("U5", "quota")], table.loc[("B50, preset wide", "quota")]
    assert f"By quota the variance is {ratio['B50, preset wide', 'quota']} of that by random draws, for B50 as" in PAGE
    for quota in (fine, coarse):
        assert quota.seeds == 8 and 0.97 < quota.variance_ratio / quota.limit < 1.0
        assert f"just below the limit of {quota.limit:.3f}" in PAGE


def test_means_of_both_draws_of_b50():
    beds = COST.query("case == 'B50'").groupby("settings")["n"].agg(["mean", "sem"])
    random, quota = beds.loc["wide_both_random"], beds.loc["wide_both"]
    difference, error = quota["mean"] - random["mean"], np.hypot(quota["sem"], random["sem"])
    assert f"The means of both draws of B50 differ by {difference:.3f} ± {error:.3f}" in " ".join(PAGE.split())


def test_chance_in_one_wide_bed():
    findings = (ROOT / "docs" / "reference" / "findings.md").read_text(encoding="utf-8")
    scatter = scatter_table(read_tables()).set_index(["case", "draw"])["std"].map("{:.4f}".format)
    for name, case in (("U5", "U5"), ("B50", "B50, preset wide")):
        line = f"| chance in one packing of {name}, sizes at random; by quota |"
        assert f"{line} {scatter[case, 'random']}; {scatter[case, 'quota']} |" in findings


def test_scatter_of_small_beds_of_mixed_forms():
    page = (ROOT / "docs" / "explanation" / "porosity.md").read_text(encoding="utf-8")
    table = scatter_table(read_tables())
    (row,) = table[table["case"] == "U1, distributions of form"].itertuples()
    assert f"scatter by {row.std:.4f}." in page and f"| now | {row.stated:.4f} | {row.chi2:.1f} |" in page
    assert f"set its limits, {row.chi2_lower:.1f} and {row.chi2_upper:.1f}," in " ".join(page.split())
    assert row.chi2_lower < row.chi2 < row.chi2_upper


def test_beds_that_a_rain_makes_denser_and_looser_than_the_model_of_lattices():
    rows = rain_bases()
    beds = compare_beds(rows, rain_model(rows), fit_reference_models().models["unified", "U1"])
    denser = (beds["lattice"] - beds["rain"]).sort_values()
    assert beds["mu_EL"][denser.index[-1]] < 0.5 and beds["mu_EQ"][denser.index[0]] < 0.3
    most, least = f"{denser.iloc[-1]:.3f}", f"{-denser.iloc[0]:.3f}"
    assert f"is up to {most} denser than predicted, and a bed of flat grains up to {least} looser" in " ".join(
        PAGE.split()
    )
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert f"long grains are up to {most} denser than predicted, and flat grains up to {least} looser" in readme
    findings = " ".join((ROOT / "docs" / "reference" / "findings.md").read_text(encoding="utf-8").split())
    assert f"flat grains looser by up to {least}, and long grains denser by up to {most}." in findings


def test_coefficients_of_rain_and_lattices():
    """Three pages have them."""
    table = compare_coefficients(rain_model(), fit_reference_models().models["unified", "U1"])
    plan = (ROOT / "docs" / "appendices" / "size_and_form_plan.md").read_text(encoding="utf-8")
    names = {"1/µ_EQ": ("mu_EQ_inv", 4), "1/µ_EL": ("mu_EL_inv", 4)}
    names |= {"(σ_EL/µ_EL)²": ("relative_variance_EL", 2), "(σ_EQ/µ_EQ)²": ("relative_variance_EQ", 2)}
    for label, (term, places) in names.items():
        row, of_lattices = table.loc[term], max(places, 3)
        expected = (
            f"| {label} | {row.coefficient_lattice:.{of_lattices}f} ± {row.std_error_lattice:.{of_lattices}f} | "
            f"{row.coefficient_rain:.{places}f} ± {row.std_error_rain:.{places}f} | "
            f"{row.difference:+.{places}f} ± {row.error:.{places}f} |"
        )
        assert expected.replace("-", "−") in plan
    ratios = table["ratio"].abs()
    words = " ".join(plan.split())
    assert f"by {ratios['mu_EL_inv']:.1f} standard errors, and by {ratios['mu_EQ_inv']:.1f} in equancy" in words
    row = table.loc["mu_EL_inv"]
    lattices = f"{row.coefficient_lattice:.4f} ± {row.std_error_lattice:.4f} for 1/µ_EL"
    assert lattices in PAGE and f"{row.coefficient_rain:.4f} ± {row.std_error_rain:.4f}:".replace("-", "−") in PAGE
    findings = (ROOT / "docs" / "reference" / "findings.md").read_text(encoding="utf-8")
    of_both = f"{row.coefficient_lattice:.3f} ± {row.std_error_lattice:.3f}; {row.coefficient_rain:.3f}"
    assert f"{of_both} ± {row.std_error_rain:.3f} |".replace("-", "−") in findings


def test_rate_explains_most_of_what_elongation_does_on_lattices():
    words, pairs = " ".join(PAGE.split()), bases_as_rain()
    table = elongation_coefficients(pairs)
    value, error = table.loc["coefficient of 1/EL"], table.loc["its error"]
    difference = f"{value.difference:.3f} ± {error.difference:.3f}".replace("-", "−")
    assert f"the coefficients of 1/EL differ by {difference}" in words
    explained, rest = (f"{value[part]:.3f} ± {error[part]:.3f}".replace("-", "−") for part in ("explained", "rest"))
    assert f"time of shaking explain {explained} of it. The rest of {rest} may be chance" in words
    assert abs(value.rest) < 2 * error.rest
    rates = bases_table().query("case == 'U1' and spacing.isna() and time_s < 4").set_index("form")["rate"]
    assert f"from {rates['G59']:.0f} kg/(m² s) for G59 to {rates['G08']:.0f} for G08" in words
    single = [name for name in rates.index if name.startswith("G")]
    assert rates[single].idxmin() == "G59" and rates[single].idxmax() == "G08"


def area_of_a_site(width, spacing):
    """Return the area of a site of the lattice in a periodic box of this width, over that without stretching."""
    sites = lattice_sites(Domain("periodic", width, 1.0), spacing, 0.0, 1e-6)
    return width**2 / len(sites) / (np.sqrt(0.75) * spacing**2)


def test_stretching_of_the_lattice_changes_the_rate_of_insertion():
    """A site takes one grain, so that the rate is proportional to the sites per area."""
    rate = paired_beds().query("form == 'all'").set_index("case")["rate_lattice"]
    beds = read_rows(LATTICE, CONFIGURATION).drop_duplicates("case").set_index("case")
    spacing = {case: all_cases()[case].generation_spacing for case in ("U1", "U5")}
    stretched = {case: area_of_a_site(beds.loc[case, "width_m"], spacing[case]) for case in spacing}
    unstretched = rate["U1"] * stretched["U1"] / (rate["U5"] * stretched["U5"])
    in_a_wide_box = unstretched * area_of_a_site(0.2, spacing["U5"]) / area_of_a_site(0.2, spacing["U1"])
    words = " ".join(PAGE.split())
    assert round(rate["U1"] / rate["U5"]) == 4 and "U5 is inserted about four times more slowly" in words
    assert (
        f"in a box of 200 mm the ratio would be {in_a_wide_box:.1f}, without any stretching {unstretched:.1f}." in words
    )
    assert f"stretched to {stretched['U1']:.1f} times the area of a site" in words
    findings = (ROOT / "docs" / "reference" / "findings.md").read_text(encoding="utf-8")
    denser = fit_bases(bases().assign(form=form_labels(bases()))).slopes[RATE] * np.log(stretched["U1"])
    assert f"{stretched['U1']:.1f} times the area of a site for U1 | about −{denser:.3f}, by the slope" in findings


def test_walls_change_the_differences_between_curves():
    """Porosity in the cylinder minus that on lattices in periodic boxes, from the steps of both."""
    steps = measured_steps().set_index("case")
    cylinder = pd.read_csv(REFERENCE / "validation.csv").groupby("case")["n"].mean()
    (base,) = (row.n_lattice for row in bases_as_rain().itertuples() if row.form == "all")
    wall = (cylinder - base - steps["lattice"]).dropna()
    of_base, words = cylinder["U1"] - base, " ".join(PAGE.split())
    assert set(wall.index) == {"U3", "U5", "U7", "B50"}
    assert f"by {of_base:.3f} for U1, and by {wall.min():.3f} to {wall.max():.3f} for U3, U5, U7 and B50" in words
    without = (steps["measured"] - wall + of_base).map(lambda step: f"{step:.3f}".replace("-", "−"))
    listed = f"{without['U3']} for U3, {without['U5']} for U5, {without['U7']} for U7 and {without['B50']} for B50"
    assert f"the measured ones would be {listed}" in words
    assert (steps["rain"] - steps["measured"]).abs().max().round(3) == 0.012


def test_variance_by_quota_over_all_sets_and_the_independent_seeds():
    table = scatter_table(read_tables())
    ratio, low, high = pooled_ratio(table)
    words = " ".join(PAGE.split())
    assert table["variance_ratio"].notna().sum() == 3 and f"the ratio is {ratio:.2f} ({low:.2f} to {high:.2f})" in words
    assert f"{1 / high:.0f} {1 / low:.0f}" == "2 10" and "worth two to ten by random draws" in words
    later = COST.query("case == 'B50' and seed >= 5").groupby("settings")
    chi2 = {name: (rows.n.var() * (len(rows) - 1)) / (rows.n_error**2).mean() for name, rows in later}
    assert f"{chi2['wide_both_random']:.1f} at random and {chi2['wide_both']:.1f} by quota" in words


def test_boxes_of_wide_curves():
    page = (ROOT / "docs" / "appendices" / "process.md").read_text(encoding="utf-8")
    theirs = pd.read_csv(REFERENCE / "r22" / "table7_domain_size.csv").set_index(["case", "width_m"])
    for row in pd.read_csv(REFERENCE / "domain_size.csv").itertuples():
        other = theirs.loc[row.case, row.width_m] if (row.case, row.width_m) in theirs.index else None
        compared = "" if other is None else f"{other.n:.3f} ± {other.n_std:.3f} "
        size = f"| {row.case} | {1e3 * row.width_m:.0f} mm | {row.mass_kg:g} kg | {row.grains}"
        assert f"{size} | {row.n:.3f} ± {row.n_error:.3f} | {compared}|" in page
    assert theirs.loc["U7"].n.max() - theirs.loc["U7"].n.min() < 1e-3

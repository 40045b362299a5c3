"""Numbers of the model of size and form in the texts are those of its tables."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import yaml

from benchmarks.studies.mixtures_wide import SETS, comparison, is_rhine, judgement, slopes, specified_statistics
from benchmarks.studies.size_and_form_fit import describe_halves, read_rows, unstretched_errors, usable_beds
from benchmarks.studies.size_and_form_validation import KNOWN, OF_DISTRIBUTIONS, OURS, PACKED_FORMS, R22
from benchmarks.studies.sorted_sands import TABLE as SANDS
from benchmarks.studies.sorted_sands import log_normal
from simcore.evaluation.confidence import student_quantile
from simcore.models.fitting import fit_reference_models
from simcore.models.packing_models.curves import span
from simcore.models.prediction import predict_preferred
from simcore.models.size_and_form.bed_prediction import rhine_one_class, rhine_sample
from simcore.models.size_and_form.beds import BASE, flags
from simcore.models.size_and_form.choice import Score, choose
from simcore.models.size_and_form.comparison import Comparison
from simcore.models.size_and_form.known_beds import MEASURED, PUBLISHED
from simcore.models.size_and_form.sized_model import NOT_FITTED, current_model
from simcore.models.size_and_form.stretch import REFERENCE_POROSITY
from simcore.paths import CONFIG, REFERENCE, ROOT
from simcore.reference.r22_tables import read_r22_models
from simcore.scene.sizes import all_cases
from simcore.scene.specification import resolve

PLAN, HOW_TO, FINDINGS = (
    "docs/appendices/size_and_form_plan.md",
    "docs/how_to/predict_from_a_sieve_curve.md",
    "docs/reference/findings.md",
)
CASES = ("slope_U7", "slope_B50")


@pytest.fixture(scope="module")
def chosen():
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_candidates.csv")
    return table[table["chosen"] == "yes"].iloc[0]


def states(page, *texts):
    content = " ".join((ROOT / page).read_text(encoding="utf-8").split())
    return [text for text in texts if text not in content] == []


def test_errors_of_left_out_beds(chosen):
    errors = f"{chosen.error_by_family:.4f}", f"{chosen.error_by_form:.4f}"
    assert states(PLAN, f"| {chosen.model}; chosen by the rule | {chosen.parameters} | {' | '.join(errors)} |")
    beds = pd.read_csv(REFERENCE / "models" / "size_and_form_beds.csv")
    assert states(
        FINDINGS, f"one formula, {len(beds)} beds", f"error {errors[0]} for a family", f"{errors[1]} for a form"
    )


def test_coarse_grains_in_the_halves_of_the_beds():
    rows = read_rows()
    rows = rows[rows["case"] != BASE]
    beds, _, shares = describe_halves(rows).partition(" wide beds, upper less lower half: ")
    of_errors, of_volume = shares.split("; of the volume +")
    mean, rms = of_errors.split(" standard errors, rms ")
    assert beds.endswith(" 61") and len(rows) == 61
    assert states(
        PLAN,
        f"61 wide beds coarse grains are slightly more frequent in the upper half, by {of_volume} of the volume.",
        f"mean of {mean.removeprefix('mean ')} standard errors and a root mean square of {rms}",
    )
    unflagged = rows[flags(rows) == ""]
    assert len(rows) - len(unflagged) == 9
    share = describe_halves(unflagged).rpartition("+")[2]
    assert states(PLAN, f"Without the nine flagged beds it is {share}.")


def test_the_rule_that_keeps_no_model_chooses_the_same(chosen):
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_candidates.csv")
    table = table[table["model"] != NOT_FITTED]
    scores = [
        {row.model: Score(*row[1:]) for row in table[["model", *columns]].itertuples(index=False)}
        for kind in ("family", "form")
        for columns in [[f"error_by_{kind}", f"excess_by_{kind}", f"excess_std_error_by_{kind}"]]
    ]
    numbers = dict(zip(table["model"], table["parameters"], strict=True))
    assert choose(*scores, numbers) == chosen.model
    assert states(PLAN, f"rule of choice without the paragraph that keeps a model also chooses {chosen.model}.")


def test_what_the_stretch_contributes():
    committed = pd.read_csv(REFERENCE / "models" / "size_and_form_beds.csv")
    beds = usable_beds(read_rows())
    fitted = Comparison(pd.DataFrame(), {}, {"L": committed["predicted_L"].to_numpy()}, "L", scatter=0.0034)
    table = unstretched_errors(beds, fitted)
    without, stretched = table.loc["L without stretch"].map("{:.4f}".format), table.loc["L"].map("{:.4f}".format)
    assert states(PLAN, f"from 0.0060 to {without['all']}.")
    assert states(PLAN, f"the twelve beds of one form, from {without['one form']} to {stretched['one form']};")
    assert states(PLAN, f"it is {without['all forms']} without and {stretched['all forms']} with the stretch.")
    assert states(FINDINGS, f"({stretched['all']} and 0.0060; {without['all']} without the two parameters")
    one_form = np.array(beds.form)[np.array(beds.form) != "all"]
    assert (len(one_form), len(set(one_form)), len(beds.n)) == (12, 3, 39)


def test_fitted_parameters(chosen):
    names = {"m0": "m0", "kappa": "κ"}
    table = pd.read_csv(REFERENCE / "models" / "size_and_form_parameters.csv")
    table = table[table["model"] == chosen.model]
    assert set(table["parameter"]) == set(names)
    for row in table.itertuples():
        assert states(HOW_TO, f"| {names[row.parameter]} | {row.value:.2f} ± {row.std_error:.2f} |")


def test_how_much_of_the_effect_of_form_remains():
    slopes = pd.read_csv(REFERENCE / "size_and_form_slopes.csv").set_index("model")
    ours = [f"{slopes.loc[OURS, case]:.2f} ± {slopes.loc[OURS, case + '_std_error']:.2f}" for case in CASES]
    theirs = [f"{slopes.loc[R22, case]:.2f}" for case in CASES]
    packed = [
        f"{slopes.loc[PACKED_FORMS, case]:.2f} ± {slopes.loc[PACKED_FORMS, case + '_std_error']:.2f}" for case in CASES
    ]
    words = f"{'; '.join(packed)} in packings of twelve forms each; {'; '.join(ours)} by that formula"
    assert states(FINDINGS, f"| {words} | {'; '.join(theirs)} |")
    for page in (PLAN, HOW_TO):
        assert states(page, *ours, f"{theirs[0]} and {theirs[1]}")


def test_how_many_beds_of_known_porosity_are_inside_their_intervals():
    words = {3: "three", 4: "four", 5: "Five", 8: "eight", 9: "nine", 10: "ten"}
    known, mixtures = (pd.read_csv(REFERENCE / name) for name in (KNOWN, OF_DISTRIBUTIONS))
    inside, of_mixtures = ((beds["predicted"] - beds["n"]).abs() <= beds["half_width"] for beds in (known, mixtures))
    measured = known["set"] == MEASURED
    total, beds = inside.sum() + of_mixtures.sum(), len(known) + len(mixtures)
    assert states(
        HOW_TO,
        f"{words[total]} of {beds} beds are inside",
        f"{words[inside[measured].sum()]} of the six measured gravels are inside the intervals, and "
        f"{words[inside[~measured].sum()].lower()} of the other fourteen beds",
    )
    assert known["set"].nunique() + 1 == 5 and measured.sum() == 6 and (~measured).sum() == 14


def test_distributions_of_form_in_u7():
    mixtures = pd.read_csv(REFERENCE / OF_DISTRIBUTIONS)
    errors = mixtures["predicted"] - mixtures["n"]
    mean, deviation = f"{errors.mean():.3f}", f"{errors.std():.3f}"
    assert states(PLAN, f"is {mean} too loose on average, with a standard deviation of {deviation}. The difference")
    assert states(HOW_TO, f"are {mean} lower than predicted, with a standard deviation of {deviation}. The difference")
    assert np.polyfit(mixtures["n_one_class"], errors, 1)[0] > 0.0  # it grows with the porosity of U1
    slopes = pd.read_csv(REFERENCE / "size_and_form_slopes.csv").set_index("model")["slope_mixtures"]
    assert states(PLAN, f"slope over these distributions is {slopes[OURS]:.2f} and theirs {slopes[R22]:.2f}")


def test_u7_at_the_mean_form():
    known = pd.read_csv(REFERENCE / KNOWN)
    bed = known[(known["set"] == PUBLISHED) & (known["case"] == "U7")].iloc[0]
    left = bed.predicted - bed.n - 0.009  # tests/documentation/test_size_and_form_page.py has the shaking
    assert states(PLAN, f"L predicts {bed.predicted:.3f}, and their model gives {bed.n:.3f}", f"leaves {left:+.3f}.")


def test_sands_that_are_not_wider_than_the_packed_beds():
    sands = pd.read_csv(REFERENCE / SANDS, keep_default_na=False)
    best = sands["n"].to_numpy()[sands.groupby("grain_size")["log_deviation"].transform("idxmin")]
    narrow = (sands["outside"] != "yes") & (sands["log_deviation"] > sands["log_deviation"].min())
    predicted, model = sands[f"predicted_{OURS}"], current_model()
    half = student_quantile(0.95, model.freedom) * model.error * (best - predicted)
    errors = predicted - sands["n"]
    assert narrow.sum() == 14
    outside = (errors.abs() > half)[narrow].sum()
    assert states(HOW_TO, f"{outside} of them are outside the interval of the step to the curve, and the prediction is "
                          f"{errors[narrow].mean():.3f} too high on average")  # fmt: skip


def test_sands_that_are_wider_than_the_packed_beds():
    sands = pd.read_csv(REFERENCE / SANDS, keep_default_na=False)
    groups = (sands[f"predicted_{OURS}"] - sands["n"]).groupby(sands["sorting"])
    of_moderate = groups.agg(["mean", "min", "max"]).loc["moderately"]
    mean, least, most = (f"{value:+.3f}".replace("-", "−") for value in of_moderate)
    poorly, very_poorly = (f"{-groups.mean()[sorting]:.2f}" for sorting in ("poorly", "very poorly"))
    error = groups.std()["moderately"] / np.sqrt(groups.size()["moderately"])
    curve = log_normal(sands["log_deviation"][sands["sorting"] == "moderately"].iloc[0])
    width = f"span {span(curve):.0f} : 1"
    assert states(
        HOW_TO,
        f"moderately sorted ones, which {width}, by {mean} ± {error:.3f} on average, and by {least} to {most} from",
        f"seven sands that {width} [agree with it]",
        f"by {poorly} on average for poorly sorted sands, and by {very_poorly} for very poorly sorted ones",
    )


def test_the_forms_of_the_picture_of_mixtures():
    fitted = fit_reference_models()
    of_rhine, rhine = rhine_one_class(fitted), rhine_sample()
    mean_form = replace(rhine, sigma_FL=0.0, sigma_EL=0.0, sigma_EQ=0.0, mu_EQ=rhine.mu_FL * rhine.mu_EL)
    of_mean_form = predict_preferred(mean_form, "U1", fitted)["n"]
    assert states(
        HOW_TO,
        f"one class has the porosity {REFERENCE_POROSITY:.3f} by the model of synthetic grains.",
        f"gives {of_mean_form:.3f} for this form, and {of_rhine:.3f} for the Rhine's gravel",
    )


def test_students_t_of_the_step_to_the_curve():
    assert states(HOW_TO, f"For the step to the curve it is {student_quantile(0.95, current_model().freedom):.1f},")


def test_the_range_of_validity_is_that_of_the_packed_beds():
    beds = pd.read_csv(REFERENCE / "models" / "size_and_form_beds.csv")
    cases = all_cases()
    binary = [cases[name].curve for name in beds["bed"].str.split().str[0] if name.startswith("R")]
    held = [np.flatnonzero(curve.mass_fractions) for curve in binary]
    ratios = [curve.bounds[coarse] / curve.bounds[fine] for curve, (fine, coarse) in zip(binary, held, strict=True)]
    shares = [100.0 * curve.mass_fractions[-1 - np.argmax(curve.mass_fractions[::-1] > 0.0)] for curve in binary]
    n1 = beds["n_one_class"]
    assert states(
        HOW_TO,
        f"| one-class porosity of the packed beds with wide curves | {n1.min():.2f} to {n1.max():.2f} |",
        f"| ratio of the sizes of packed binary curves | {min(ratios):.1f} to {max(ratios):.1f} |",
        f"| share of coarse grains in packed binary curves | {min(shares):.0f} to {max(shares):.0f} % |",
        f"| width of the sieve curve: 98 % of the mass | within {current_model().widest:.1f} : 1 |",
        "| gap of the sieve curve: the widest range of sizes with at most 1 % of the mass | within "
        f"{current_model().gap:.1f} : 1 |",
    )
    model = fit_reference_models().models["unified", "U1"]
    for quantity, feature in (
        ("form, 1/µ_EQ", "mu_EQ_inv"),
        ("form, 1/µ_EL", "mu_EL_inv"),
        ("spread of form, (σ_EQ/µ_EQ)²", "relative_variance_EQ"),
        ("spread of form, (σ_EL/µ_EL)²", "relative_variance_EL"),
    ):
        index = model.features.index(feature)
        low, high = model.minimum[index], model.maximum[index]
        assert states(HOW_TO, f"| {quantity} | {low:.2f} to {high:.2f} |")
    finest = min(curve.bounds[:-1][curve.mass_fractions > 0.0].min() for curve in map(curve_of, beds["bed"]))
    assert states(HOW_TO, f"the smallest packed grains have {1e3 * finest:.1f} mm")


def test_the_packed_beds_have_the_stated_friction_and_shaking():
    configuration = yaml.safe_load((CONFIG / "size_and_form.yaml").read_text(encoding="utf-8"))
    fixes = configuration["studies"]["size_and_form"]["fixes"]
    needed = {"sizes": {"case": "U1"}, "amount": {"mass": "1 kg"}, "domain": fixes["domain"] | {"width": "63 mm"}}
    settings = resolve(fixes | needed, "packing")
    assert settings["shaking"]["duration"] == 1.0
    assert states(HOW_TO, f"| friction coefficient between grains | {settings['material']['friction']:g} |")


def curve_of(bed):
    return all_cases()[bed.split()[0]].curve


def test_errors_of_the_packing_models_on_beds_of_known_porosity():
    """The columns are this model and four others, and the rows three sets of beds."""
    known = pd.read_csv(REFERENCE / KNOWN)
    models = ["size and form", "linear", "linear mixture", "compressible, K = 4.75", "rods"]
    errors = known[[f"error_{name}" for name in models]].pow(2).groupby(known["set"]).mean().pow(0.5)
    for kind, words in (
        ("measured", "six measured gravels, U3 to B70"),
        ("packed", "the same, packed by us in the same cylinder"),
        ("packed by r22", "the same, packed by Rettinger et al."),
    ):
        assert states(HOW_TO, " | ".join([f"| {words}", *(f"{error:.4f}" for error in errors.loc[kind])]))


def test_beds_of_U7_with_a_distribution_of_form():
    table = comparison()
    rhine, sets = table[is_rhine(table)], table[~is_rhine(table)]
    numbers = dict(enumerate("no one two three four five six seven eight nine ten eleven twelve".split()))
    rules, lattices, slope = judgement(table), judgement(table, "lattices"), slopes(table)
    rule = rules.loc["Rhine"]
    error = np.sqrt(np.sum(rhine["n_error"] ** 2)) / len(rhine)
    all_forms = read_rows("size_and_form").query("case == 'U7' and representation == 'polyhedron' and grain.isna()")
    of_all = " and ".join(f"{n:.3f}" for n in all_forms["n"])
    their_model = read_r22_models()["form_mixture", "U7"]
    apart = sets["n"] - their_model.porosity(1.0 / specified_statistics(sets).add_suffix("_inv"))
    above = f"{apart.mean():.3f} ± {apart.sem():.3f}"
    narrow, wide = (sets[sets["sigma_FL_nominal"] == deviation] for deviation in (0.1, 0.2))

    def rms(beds):
        return np.sqrt(np.mean((beds["rain"] - beds["n"]) ** 2))

    for row in table.itertuples():
        FL, sigma_FL, EL, sigma_EL = (getattr(row, name) for name in SETS)
        errors = " | ".join(f"{value - row.n:+.4f}" for value in (row.rain, row.lattices, row.predict))
        form = f"{FL:g} ± {sigma_FL:g}, {EL:g} ± {sigma_EL:g}"
        assert states(PLAN, f"| {form} | {row.seed} | {row.n:.3f} ± {row.n_error:.3f} | {errors} |".replace("-", "−"))
    assert states(
        PLAN,
        f"Of the twelve beds {numbers[len(table)]} are packed (",
        f"the mean error is {rule['error']:+.4f} ± {error:.4f} (sampling), and".replace("-", "−"),
        f"By the {numbers[len(rhine)]} seeds the prediction is not confirmed, but only just;",
        f"with the effect of form of lattices it is {lattices.loc['Rhine', 'error']:+.4f}.".replace("-", "−"),
        f"For the {numbers[len(sets)]} of eight sets that are packed the root mean square of the errors is "
        f"{rules.loc['sets', 'error']:.4f}, and the limit is 0.010, so that they are not confirmed either;",
        f"with the effect of form of lattices it is {lattices.loc['sets', 'error']:.4f}.",
        f"The {numbers[len(narrow)]} sets with deviations of 0.1 have {rms(narrow):.4f}, the {numbers[len(wide)]} with "
        f"deviations of 0.2 {rms(wide):.4f}.",
        f"one of the latter, 0.5 ± 0.2 and 0.7 ± 0.2, is {-(wide['rain'] - wide['n']).min():.3f} looser than predicted",
        f"changes by {slope['packed']:.2f} ± {slope['error']:.2f} of the predicted one-class porosity, and the "
        f"prediction by {slope['predicted']:.2f} of it.",
        f"the {numbers[len(sets)]} sets are looser than Eq. 24 by {above}.",
        f"Beds of all forms in U7, which are part of the fit, have {of_all}.",
    )
    by_command = sets["n"] - sets["predict"]
    assert states(
        PLAN,
        f"it is {rhine['one_class_predict'].mean():.3f}, and that of beds that were made like these "
        f"{rhine['one_class_rain'].mean():.3f}. With it the mean error for the Rhine's distribution is "
        f"{(rhine['predict'] - rhine['n']).mean():+.4f} ± {error:.4f} (sampling), and the root mean square for the "
        f"{numbers[len(sets)]} sets is {np.sqrt(np.mean(by_command**2)):.4f}. The bed that is "
        f"{(wide['n'] - wide['rain']).max():.3f} looser than the model gives from a rain is "
        f"{by_command.max():.3f} looser",
    )
    assert states(
        HOW_TO,
        f"{numbers[len(sets)].capitalize()} of these distributions were packed: their beds are looser than the formula "
        f"by {above}, and differ from the prediction by {by_command.min():+.3f} to {by_command.max():+.3f}.".replace(
            "-", "−"
        ),
        f"four beds have {rhine['n'].mean():.3f} ± {error:.3f}",
    )
    assert rules["confirmed"].tolist() == [False, False] and abs(rule["error"]) < 1.2 * rule["limit"]
    assert states(
        FINDINGS,
        f"in U7, as a rain: forms from its distribution | {rhine['n'].mean():.3f} ± {error:.3f}; `predict` gives "
        f"{rhine['predict'].mean():.3f} for these sizes, from beds of U1 on lattices; from our rain beds of U1 the "
        f"formula of form and sieve curve gives {rhine['rain'].mean():.3f} | 0.288 |",
        f"packed minus computed from rain beds of U1 | {-rule['error']:+.3f} ± {error:.3f} for the Rhine's gravel; "
        f"{(wide['n'] - wide['rain']).max():+.3f} ± {wide['n_error'].max():.3f} for flat grains of widely varying form",
        f"| {numbers[len(sets)]} distributions of form in U7, without a fit to them | root mean square error of "
        f"`predict` {np.sqrt(np.mean(by_command**2)):.4f}; computed from rain beds of U1 "
        f"{rules.loc['sets', 'error']:.4f}, above the limit of 0.010 that was set before | no formula | |",
    )

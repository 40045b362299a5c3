"""Fits of the candidates to beds made by a known candidate, and the rows from which beds are read."""

import numpy as np
import pandas as pd
import pytest

from simcore.models.regression import fit
from simcore.models.size_and_form.bases import PROCESS, TIME, fit_bases
from simcore.models.size_and_form.beds import ALL_FORMS, BASE, Beds, flags, read_beds
from simcore.models.size_and_form.candidates import CANDIDATES
from simcore.models.size_and_form.comparison import PREFERENCE, compare, coverage, parameter_rows
from simcore.models.size_and_form.fit import (
    Fit,
    fit_candidate,
    predict_beds,
    predict_left_out,
    scatter_between_beds,
)
from simcore.models.size_and_form.sized_model import NOT_FITTED
from simcore.models.unified import UNIFIED, unified_features
from simcore.reference.share_columns import share_columns
from simcore.scene.sizes import all_cases

CURVES = ("R2_70", "R4_70", "R4_50", "U5", "LN100", "B50", "FR250", "GAP")
TRUE = {"m0": 1.1, "kappa": 0.5}
ERROR = 0.002
FALL = 0.24  # [s], time of the fall of a grain from the top of the box


def made_beds(seed=1, scatter=0.0, parameters=None, name="L"):
    """Return beds of all CURVES at three one-class porosities, made by a candidate, with errors of ERROR."""
    rng = np.random.default_rng(seed)
    names, n1 = np.tile(CURVES, 3), np.repeat([0.33, 0.36, 0.40], len(CURVES))
    curves = tuple(all_cases()[name].curve for name in names)
    size = len(names)
    EQ = 0.441 - 0.8 * (n1 - 0.36) + rng.normal(0, 0.02, size)
    family = np.array([all_cases()[name].family for name in names])
    form = np.repeat(["a", "b", "c"], len(CURVES))
    beds = Beds(
        names,
        curves,
        n1,
        np.full(size, 0.342),
        EQ,
        np.full(size, 0.68),
        np.zeros(size),
        np.full(size, ERROR),
        family,
        form,
    )
    exact = predict_beds(name, beds, parameters or TRUE)
    return beds._replace(n=exact + rng.normal(0, np.hypot(ERROR, scatter), size))


def test_parameters_of_a_known_model_come_back():
    beds = made_beds()
    found = fit_candidate("L", beds, 0.0)
    for key, error in found.std_errors().items():
        assert 0 < error < 0.2
        assert abs(found.parameters[key] - TRUE[key]) < 3 * error
    np.testing.assert_allclose(found.predicted, predict_beds("L", beds, found.parameters), atol=1e-12)
    assert found.at_bound == ()


def test_standard_errors_agree_with_the_scatter_over_draws():
    fits = [fit_candidate("L", made_beds(seed), 0.0) for seed in range(12)]
    for key in TRUE:
        scatter = np.std([found.parameters[key] for found in fits], ddof=1)
        assert 0.5 < scatter / fits[0].std_errors()[key] < 1.7


def test_a_parameter_at_its_bound_is_named():
    assert fit_candidate("L", made_beds(parameters={"m0": 1.38, "kappa": 1.999}), 0.0).at_bound == ("kappa",)


def test_scatter_between_beds_is_found():
    found = [scatter_between_beds(made_beds(seed, scatter=0.004), "L") for seed in range(3)]
    assert np.mean(found) == pytest.approx(0.004, abs=0.0015)
    assert scatter_between_beds(made_beds(3), "L") < 0.0015


def test_left_out_beds_are_not_seen():
    """A family whose porosities are far off does not change its own prediction."""
    beds = made_beds()
    off = beds.family == "log_normal"
    disturbed = beds._replace(n=beds.n + np.where(off, 0.05, 0.0))
    before, after = (predict_left_out("L", each, each.family, 0.0) for each in (beds, disturbed))
    np.testing.assert_allclose(before[off], after[off], atol=1e-7)
    assert np.abs(before[~off] - after[~off]).max() > 1e-3


def test_the_model_that_made_the_beds_is_chosen():
    result = compare(made_beds(), names=("L", "F"), scatter=0.0, in_use=None)
    assert result.chosen == "L" and list(result.table["model"][result.table["chosen"] == "yes"]) == ["L"]
    errors = result.table.set_index("model")["error_by_family"]
    assert errors["L"] < 1.3 * ERROR and errors["F"] > 1.8 * ERROR and errors["rods"] > 2 * ERROR
    assert result.table["excess_by_family"].min() == 0.0
    unfitted = result.table.iloc[-1]
    assert unfitted["model"] == NOT_FITTED and unfitted["error_by_family"] == unfitted["error_by_form"] > 2 * ERROR
    rows = parameter_rows(result.fits, 5)
    assert list(rows["model"] + " " + rows["parameter"]) == ["L m0", "L kappa", "F m0", "F kappa"]
    assert set(PREFERENCE) == set(CANDIDATES)


def test_intervals_of_parameters_take_students_t_of_the_families():
    fit = Fit("L", {"m0": 1.0, "kappa": 0.6}, np.diag([1e-4, 0.01]), np.zeros(0), ("m0",))
    at_bound, kappa = parameter_rows({"L": fit}, 5).itertuples(index=False)
    assert np.isnan(at_bound.lower_95) and np.isnan(at_bound.upper_95) and at_bound.at_bound == "yes"
    # Tables of Student's t have 2.571 for 5 degrees of freedom and a probability of 0.95.
    assert kappa.std_error == pytest.approx(0.1) and kappa.at_bound == ""
    assert [kappa.lower_95, kappa.upper_95] == pytest.approx([0.6 - 0.2571, 0.6 + 0.2571], abs=1e-4)


def test_intervals_of_a_family_follow_from_the_errors_of_the_others():
    """Errors of 0.1 of the decrease are covered everywhere; in a family with an error of 0.9 no bed is covered."""
    beds = made_beds()
    beds = beds._replace(error=np.zeros(len(beds.n)))
    sign = np.where(np.arange(len(beds.n)) % 2, 1.0, -1.0)
    decrease = beds.one_class - beds.n
    assert coverage(beds, beds.n + 0.1 * sign * decrease) == 1.0
    off = beds.family == "log_normal"
    assert coverage(beds, beds.n - np.where(off, 0.9, 0.1 * sign) * decrease) == 1.0 - off.mean()
    two = beds.select(np.isin(beds.family, ["log_normal", "fractal"]))
    assert np.isnan(coverage(two, two.n))


def test_intervals_of_packed_beds_contain_their_sampling_errors():
    """A bed without any decrease of porosity is covered if its prediction is as near as the sampling error."""
    beds = made_beds()
    predicted = np.where(np.arange(len(beds.n)) == 0, beds.one_class, beds.n)
    beds = beds._replace(n=np.where(np.arange(len(beds.n)) == 0, beds.one_class + ERROR, beds.n))
    assert coverage(beds, predicted) == 1.0
    exact = beds._replace(error=np.zeros(len(beds.n)))
    assert coverage(exact, predicted) == 1.0 - 1.0 / len(beds.n)


def test_fewer_beds_than_parameters_are_refused():
    beds = made_beds()
    few = np.arange(len(beds.n)) < 1
    with pytest.raises(ValueError, match="candidate L: 1 beds are too few for 2 parameters"):
        fit_candidate("L", beds.select(few), 0.0)


@pytest.fixture(scope="module")
def unified():
    rng = np.random.default_rng(0)
    features = unified_features(
        pd.DataFrame(rng.uniform(0.1, 0.8, (30, 4)), columns=["mu_EQ", "sigma_EQ", "mu_EL", "sigma_EL"])
    )[list(UNIFIED)]
    return fit(features, 0.2 + 0.05 * features["mu_EQ_inv"], "unified", "U1")


def row(case="U7", grain="", n=0.3, **changes):
    curve = all_cases()[case].curve
    shares = share_columns(np.column_stack([curve.bounds[:-1], curve.bounds[1:]]), curve.mass_fractions)
    zeros = {f"{name}{end}": 0.0 for name in ("coarse_lower", "coarse_upper") for end in ("_error",)}
    form = {"mu_EQ": 0.5, "sigma_EQ": 0.0 if grain else 0.1, "mu_EL": 0.7, "sigma_EL": 0.0 if grain else 0.1}
    return {
        "case": case, "grain": grain, "representation": "polyhedron", "seed": 1, "n": n, "n_error": 0.003,
        "time_s": 1.5, "after_s": 1.0, "fall_s": FALL, "mass_kg": 1.0, "width_m": 0.1,
        "coarse_lower": 0.5, "coarse_upper": 0.5, "coarse_bed": 0.5, "coarse_bed_error": 0.0, "coarse_evaluated": 0.5,
        "coarse_evaluated_error": 0.01, "fine_floor": 0.1, "fine_floor_error": 0.01, "fine_evaluated": 0.1,
        "fine_evaluated_error": 0.01, **zeros, **shares, **{f"{key}_evaluated": value for key, value in form.items()},
        **changes,
    }  # fmt: skip


def test_beds_have_the_porosity_of_their_base(unified):
    rows = [row(BASE, n=0.31), row(BASE, "G01", n=0.36), row(BASE, "G01", n=0.35, seed=2), row(grain="G01"), row()]
    rows += [row(representation="sphere"), row(BASE, representation="sphere"), row(coarse_upper=0.6)]
    beds = read_beds(pd.DataFrame(rows), unified, {name: case.family for name, case in all_cases().items()})
    assert beds.form.tolist() == ["G01", ALL_FORMS] and beds.family.tolist() == ["log_normal"] * 2
    np.testing.assert_allclose(beds.one_class, [0.355, 0.31], atol=1e-9)
    np.testing.assert_allclose(beds.curves[0].mass_fractions, all_cases()["U7"].curve.mass_fractions, atol=1e-9)
    np.testing.assert_allclose(beds.curves[0].bounds, all_cases()["U7"].curve.bounds)


SLOPES = {"time": -0.01, "rate": 0.006, "size": 0.02}


def made_bases(scatter=0.0, seed=0, n_error=1e-4):
    """Return bases of two forms, packed in many ways; SLOPES apply about 0.31 and 0.36 at time, rate, size 1."""
    rng = np.random.default_rng(seed)
    rows = []
    for form, constant in (("", 0.31), ("G01", 0.36)):
        for time_s, after_s, mass, case in (
            (1.5, 1.0, 1.0, "U1"), (4.0, 3.5, 1.0, "U1"), (1.2, 1.0, 1.0, "U1"), (3.0, 1.0, 2.0, "U1"),
            (1.5, 1.0, 1.0, "ONE_fine"), (1.5, 1.0, 3.0, "ONE_coarse"),
        ):  # fmt: skip
            curve = all_cases()[case].curve
            size = np.log(np.sqrt(curve.bounds[1:] * curve.bounds[:-1])[curve.mass_fractions > 0][0])
            rate = np.log(mass / (0.01 * (time_s - after_s + FALL)))
            n = constant + SLOPES["time"] * np.log(time_s) + SLOPES["rate"] * rate + SLOPES["size"] * size
            n += scatter * rng.standard_normal()
            rows.append(row(case, form, n=n, n_error=n_error, time_s=time_s, after_s=after_s, mass_kg=mass))
    return pd.DataFrame(rows)


def test_slopes_of_the_process_come_back():
    rows = made_bases()
    fitted = fit_bases(rows.assign(form=rows["grain"]))
    assert fitted.slopes == pytest.approx(SLOPES, abs=1e-9)
    np.testing.assert_allclose(rows["n"], rows["grain"].map(fitted.constants) + fitted.effect(rows), atol=1e-9)
    of_time = rows.assign(form=rows["grain"], n=0.3 + 0.01 * np.log(rows["time_s"]))
    assert fit_bases(of_time, (TIME,)).slopes == pytest.approx({"time": 0.01}, abs=1e-9)


def test_a_slope_below_the_sampling_errors_is_left_out_however_small_the_residuals_are():
    """In a fit with few degrees of freedom, residuals may be small by chance."""
    rows = made_bases(n_error=0.015)
    fitted = fit_bases(rows.assign(form=rows["grain"]))
    assert list(fitted.slopes) == ["size"] and fitted.std_errors["size"] > 2e-3


def test_slopes_within_chance_are_left_out():
    """Without an effect a slope remains by chance only, in about a twentieth of the draws."""
    rows = made_bases()
    n, kept = rows["grain"].map({"": 0.31, "G01": 0.36}), 0
    for seed in range(40):
        noise = 0.003 * np.random.default_rng(seed).standard_normal(len(rows))
        kept += len(fit_bases(rows.assign(form=rows["grain"], n=n + noise)).slopes)
    assert 0 < kept < 0.2 * 40 * len(PROCESS)
    assert fit_bases(rows.assign(form=rows["grain"]), ()).slopes == {}


def test_few_bases_give_slopes_of_what_varies_most():
    """Three bases of one form leave one slope: that on the size, which varies most."""
    rows = made_bases()
    rows = rows[(rows["grain"] == "") & (rows["after_s"] == 1.0) & (rows["time_s"] == 1.5)]
    rows = pd.concat([rows, rows.iloc[:1].assign(grain="G02")])
    assert len(rows) == 4 and set(fit_bases(rows.assign(form=rows["grain"])).slopes) == {"size"}


def test_one_class_porosity_is_that_for_the_process_of_the_bed(unified):
    bases = made_bases()
    first = bases["case"] == BASE
    wide = row(grain="G01", time_s=6.0, after_s=1.0, mass_kg=2.0)
    families = {name: case.family for name, case in all_cases().items()}
    table = pd.concat([bases[first], pd.DataFrame([wide])], ignore_index=True)
    beds = read_beds(table, unified, families, bases[~first])
    curve = all_cases()["U7"].curve
    size = curve.mass_fractions @ (0.5 * np.log(curve.bounds[1:] * curve.bounds[:-1]))
    rate = np.log(2.0 / (0.01 * (5.0 + FALL)))
    expected = 0.36 + SLOPES["time"] * np.log(6.0) + SLOPES["rate"] * rate + SLOPES["size"] * size
    np.testing.assert_allclose(beds.one_class, [expected], atol=1e-9)
    np.testing.assert_allclose(
        read_beds(table, unified, families).one_class, bases[first].n[bases.grain == "G01"].mean()
    )


def test_beds_of_all_forms_follow_their_own_base_and_their_realised_forms(unified):
    rows = [row(BASE, n=0.31), row(BASE, "G01", n=0.36), row(grain="G01"), row(), row(mu_EQ_evaluated=0.4)]
    families = {name: case.family for name, case in all_cases().items()}
    beds = read_beds(pd.DataFrame(rows), unified, families)
    # The model `unified` of these tests is 0.2 + 0.05 / EQ.
    np.testing.assert_allclose(beds.one_class, [0.36, 0.31, 0.31 + 0.05 * (1 / 0.4 - 1 / 0.5)], atol=1e-9)
    with pytest.raises(ValueError, match="no bed of U1 with the form all"):
        read_beds(pd.DataFrame(rows[1:]), unified, families)


def test_flagged_beds_are_read_by_themselves(unified):
    rows = [row(BASE, n=0.31), row(), row(coarse_upper=0.6, n=0.29)]
    kept, out = (read_beds(pd.DataFrame(rows), unified, {"U7": "log_normal"}, flagged=f) for f in (False, True))
    assert kept.n.tolist() == [0.3] and out.n.tolist() == [0.29]
    assert len(read_beds(pd.DataFrame(rows[:2]), unified, {"U7": "log_normal"}, flagged=True).n) == 0


def test_spheres_follow_the_base_of_spheres(unified):
    sphere = {"representation": "sphere"}
    rows = [row(BASE, n=0.31), row(), row(BASE, n=0.37, **sphere), row(n=0.33, **sphere)]
    beds = read_beds(pd.DataFrame(rows), unified, {"U7": "log_normal"}, spheres=True)
    assert beds.form.tolist() == ["sphere"] and beds.n.tolist() == [0.33]
    np.testing.assert_allclose(beds.one_class, [0.37], atol=1e-9)


def test_a_fixed_parameter_is_not_fitted():
    found = fit_candidate("L", made_beds(), 0.0, fixed={"kappa": TRUE["kappa"]})
    assert list(found.parameters) == ["m0"] and found.covariance.shape == (1, 1)
    assert abs(found.parameters["m0"] - TRUE["m0"]) < 3 * found.std_errors()["m0"]


def test_a_form_without_its_base_is_refused(unified):
    table = pd.DataFrame([row(BASE), row(grain="G01")])
    with pytest.raises(ValueError, match="no bed of U1 with the form G01"):
        read_beds(table, unified, {"U7": "log_normal"})
    with pytest.raises(ValueError, match="no bed of U1 yet"):
        read_beds(pd.DataFrame([row()]), unified, {"U7": "log_normal"})


def test_flags_follow_the_rule():
    rows = [
        row(),
        row(coarse_upper=0.529), row(coarse_upper=0.531), row(coarse_upper=0.54, coarse_upper_error=0.02),
        row(coarse_bed=0.541), row(coarse_bed=0.539),
        row(fine_floor=0.16, fine_floor_error=0.001), row(fine_floor=0.14, fine_floor_error=0.001),
    ]  # fmt: skip
    halves, parts, floor = "sizes separate over height", "coarse grains lie outside", "fines on the floor"
    assert list(flags(pd.DataFrame(rows))) == ["", "", halves, "", parts, "", floor, ""]

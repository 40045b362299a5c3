"""Slopes of the work-precision studies, from small versions of the figures' data, and their references."""

import numpy as np
import pytest

from simcore.dem.shapes.polyhedra import ELLIPSOID, POLYHEDRON
from simcore.verification import contact_query, one_contact, rotation
from simcore.verification.work_precision import observed_order, settings_table


@pytest.fixture(scope="module")
def impacts():
    return settings_table(one_contact.impact_runs(steps=(20, 40, 80), phases=128, repeats=1))


def orders(table, **chosen):
    rows = table[np.logical_and.reduce([table[key] == value for key, value in chosen.items()])]
    assert len(rows) > 1
    return observed_order(rows["setting"], rows["error"])


ENDS = pytest.mark.parametrize("end", ["attractive", "clamped"])


@ENDS
def test_the_explicit_dashpot_is_of_first_order(impacts, end):
    for quantity in ("restitution, mean", "tangential restitution, mean", "tangential restitution, one impact"):
        found = orders(impacts, case=end, method="explicit", quantity=quantity)
        np.testing.assert_allclose(found, 1.0, atol=0.15)


def test_the_implicit_dashpot_is_of_second_order_on_average(impacts):
    """Contacts are clamped: with attraction the second-order term nearly vanishes here (test_dashpot)."""
    found = orders(impacts, case="clamped", method="implicit", quantity="restitution, mean")
    np.testing.assert_allclose(found, 2.0, atol=0.15)
    found = orders(impacts, case="clamped", method="implicit", quantity="restitution, one impact")
    np.testing.assert_allclose(found, 1.0, atol=0.15)


@ENDS
def test_the_implicit_dashpot_is_nearer_at_the_same_steps(impacts, end):
    for quantity in impacts["quantity"].unique():
        rows = impacts[(impacts["case"] == end) & (impacts["quantity"] == quantity)]
        explicit, implicit = (rows[rows["method"] == name]["error"].to_numpy() for name in ("explicit", "implicit"))
        # Where the contact pulls, both have the same first-order error of the tangential restitution.
        assert (implicit < (1.02 if quantity.startswith("tangential") else 1.0) * explicit).all()


# e_t of an impact at e_n = 0.1, µ = 0.5 by angle from the normal: attractive, clamped (2e6 steps per contact)
OBLIQUE = {
    5: (0.71036, 0.70049),
    15: (0.71032, 0.70035),
    30: (0.71137, 0.70404),
    45: (0.71709, 0.72413),
    60: (0.72147, 0.73953),
    70: (0.74423, 0.77202),
    80: (0.87609, 0.88956),
    85: (0.93852, 0.94520),
}


@pytest.mark.parametrize("angle", OBLIQUE)
def test_the_reference_of_an_oblique_impact(angle):
    """The reference has the digits of the table, which was computed with small steps."""
    for attractive, stated in zip((True, False), OBLIQUE[angle], strict=True):
        found = one_contact.reference_impact(attractive, np.radians(angle))
        assert found.tangential == pytest.approx(stated, abs=1e-5)
        assert found.normal == pytest.approx(0.1 if attractive else 0.252729, abs=1e-6)


@ENDS
def test_small_steps_tend_to_the_reference(end):
    """Extrapolated from first order, the compiled step agrees with the reference to the square of its error."""
    attractive = end == "attractive"
    exact = one_contact.reference_impact(attractive)
    coarse, fine = (
        np.array([part.mean() for part in one_contact.simulate("explicit", attractive, n, 64, repeats=0)[:2]])
        for n in (400, 800)
    )
    off = 2.0 * fine - coarse - [exact.normal, exact.tangential]
    # The limit is the second-order part of errors of 1e-3 plus the error of the reference, 6e-8.
    assert np.abs(off).max() < 5e-6


def test_impulse_of_the_reference():
    for attractive in (True, False):
        fall = one_contact._Fall(0.1, attractive)
        assert fall.impulse(0.0, fall.end) == pytest.approx(one_contact.impulse_by_quadrature(attractive), rel=1e-12)


STEPS_IN_THE_ASYMPTOTIC_RANGE = {1: (1600, 3200, 6400), 2: (200, 400, 800), 4: (50, 100, 200)}


@pytest.mark.parametrize("case", ["top", "plate"])
def test_orders_of_rotation(case):
    table = settings_table(rotation.rotation_runs((50, 100, 200, 400, 800, 1600, 3200, 6400), repeats=1, tops=[case]))
    for method, order in rotation.ORDERS.items():
        chosen = table[table["setting"].isin(STEPS_IN_THE_ASYMPTOTIC_RANGE[order])]
        found = orders(chosen, case=case, method=method, quantity="attitude")
        # First-order schemes still have errors of a tenth of a radian there; the fourth order begins to show round-off.
        np.testing.assert_allclose(found, order, atol=0.5 if order == 4 else 0.2)
    energy = orders(
        table[table["setting"].isin((200, 400, 800))], case=case, method=next(iter(rotation.ORDERS)), quantity="energy"
    )
    np.testing.assert_allclose(energy, 2.0, atol=0.1)


def test_the_reference_of_rotation():
    """Attitude of the top after 20 s and its angular velocity after 5 s; the error of both is near round-off."""
    attitude, unknown = rotation.reference_attitude(rotation.TOPS["top"])
    stated = np.array([0.58403954, -0.35261047, 0.20195319, -0.7026938])
    assert rotation.attitude_error(attitude, stated) < 3e-8  # the digits of the table
    np.testing.assert_allclose(
        rotation.body_spin(rotation.TOPS["top"], 5.0), [-0.16435043, -0.98640202, 0.8219917], atol=1e-8
    )
    for top in rotation.TOPS.values():
        assert rotation.reference_attitude(top)[1] < 1e-11
    assert unknown < 1e-12


@pytest.fixture(scope="module")
def queries():
    return settings_table(
        contact_query.query_runs((64, 256, 1024, 4096), tolerances=(), repeats=1, pairs=16, again=False)
    )


@pytest.mark.parametrize("case, slope", [("polyhedra", 0.5), ("ellipsoids", 1.0)])
def test_directions_come_near_as_their_spacing(queries, case, slope):
    """n directions are n^(−1/2) apart; the error of the overlap is as this angle, for smooth bodies as its square."""
    rows = queries[(queries["case"] == case) & (queries["method"] == contact_query.SCAN)].query("quantity == 'depth'")
    found = -np.polyfit(np.log(rows["setting"].astype(float)), np.log(rows["error"]), 1)[0]
    assert found == pytest.approx(slope, abs=0.25)


def test_our_query_is_exact_to_round_off(queries):
    rows = queries[queries["method"] == contact_query.OUR_STYLE].set_index(["case", "quantity"])["error"]
    for case in ("polyhedra", "ellipsoids"):
        assert rows[case, "depth"] < 16 * np.finfo(float).eps
        assert rows[case, "normal"] < 1e-13


@pytest.mark.parametrize("kind", [POLYHEDRON, ELLIPSOID])
def test_pairs_are_pressed_to_their_depth(kind):
    made = contact_query.make_pairs(kind, 8)
    truth = contact_query.true_contacts(made)
    np.testing.assert_allclose(truth.depth / made.size, contact_query.DEPTH, rtol=0.05)
    np.testing.assert_allclose(np.linalg.norm(truth.normal, axis=1), 1.0, rtol=1e-14)
    assert truth.depth_error < 1e-14 and truth.normal_error < 1e-12

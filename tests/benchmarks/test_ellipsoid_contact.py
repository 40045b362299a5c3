"""The benchmark of ellipsoid contacts: the errors of the contact constructions have the right signs and orders."""

import numpy as np
import pytest

from benchmarks.studies import ellipsoid_contact as benchmark


def gains(form, construction, depth):
    return benchmark.impact_gains(form, construction, depth, np.random.default_rng(1), n=200, steps=100)


@pytest.mark.parametrize("construction", benchmark.RULES)
def test_elastic_spheres_keep_their_energy_by_every_rule(construction):
    # The limit is twice the error of leapfrog, (π / 100)² / 4, if a contact starts and ends at any phase of a step.
    assert np.abs(gains("sphere", construction, 1e-2)).max() < 2 * (np.pi / 100) ** 2 / 4


def test_elastic_ellipsoids_keep_their_energy_as_the_construction_allows():
    """The common normal leaves the error of the step, and the potential leaves a share proportional to the depth."""
    assert np.abs(gains("golden", "common_normal", 1e-2)).max() < 4 * (np.pi / 100) ** 2 / 4
    deep, shallow = (gains("golden", "potential", depth) for depth in (1e-2, 1e-3))
    assert np.abs(deep).mean() / np.abs(shallow).mean() == pytest.approx(10.0, rel=0.3)
    assert np.abs(deep).max() < 0.05
    # Without the correction the force deviates from the normal by 20 degrees at any depth, so the error does not fall.
    uncorrected = [np.abs(gains("golden", "contact_vector", depth)).mean() for depth in (1e-2, 1e-3)]
    assert uncorrected[0] / uncorrected[1] == pytest.approx(1.0, rel=0.1) and min(uncorrected) > 0.1


def test_rows_of_depths_and_costs(monkeypatch, capsys):
    monkeypatch.setattr(benchmark, "PAIRS", 20)
    monkeypatch.setattr(benchmark, "FORMS", {form: benchmark.FORMS[form] for form in ("sphere", "golden")})
    benchmark.depths(np.random.default_rng(1))
    rows = [line.split(",") for line in capsys.readouterr().out.splitlines()]
    assert len(rows) == 2 * 3 * 5 and all(len(each) == 11 for each in rows)
    largest = {tuple(each[:4]): float(each[9]) for each in rows}
    for depth in ("0.0001", "0.001", "0.01"):
        # The tolerance is the rounding error of offsets of order 2, in units of the depth.
        tolerance = 100 * np.finfo(float).eps / float(depth)
        assert largest["depth", "sphere", depth, "potential"] < tolerance
        assert largest["depth", "golden", depth, "common_normal"] < tolerance
        assert largest["depth", "golden", depth, "potential"] > 0.05
        assert largest["normal", "golden", depth, "potential"] < 100.0 * float(depth) < 10.0
        assert largest["normal", "golden", depth, "contact_vector"] > 10.0

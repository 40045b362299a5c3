"""Comparison of packings: groups, pairs of equal seed, errors, settings, and `scree compare`."""

import json

import numpy as np
import pytest
from scipy.stats import t as student
from scipy.stats import ttest_ind

from simcore.__main__ import main
from simcore.evaluation import comparison
from simcore.evaluation.comparison import CODE, compare
from simcore.evaluation.comparison_text import comparison_text
from simcore.packing.file import write_packing
from tests.helpers.packings import make_packing, sphere_lattice, touching_pairs


def bed(kind="sc", seed=1, friction=0.5, **attrs):
    """Return a lattice bed of touching 10 mm spheres whose specification has these settings."""
    centres, width = sphere_lattice(kind, 3, 8)
    contacts, images = touching_pairs(centres, width)
    scene = {"name": f"bed_{seed}", "seed": seed, "material": {"friction": friction}, "domain": {"width": 0.03}}
    return make_packing(
        1e-2 * centres, 5e-3, width=1e-2 * width, contacts=contacts, images=images, scene=json.dumps(scene), seed=seed,
        **attrs,
    )  # fmt: skip


@pytest.fixture
def stand_in(monkeypatch):
    """Replace the evaluation by numbers from the packings' attributes, so that the differences are given."""

    def evaluate(packing, cut):
        n = packing.attrs["n"]
        values = {"grains": 9, "n": n, "n_exact": n - 0.01, "coordination": 10 * n, "D50": 1e-2, "FL": 1.0, "EL": 1.0}
        return values | {"bed_top": 0.1} | {f"{name}_std_error": 0.004 for name in ("n", "n_exact", "coordination")}

    monkeypatch.setattr(comparison, "_evaluate", evaluate)


def difference(result, quantity="n"):
    (row,) = result.differences[result.differences.quantity == quantity].itertuples()
    return row


def test_packings_that_differ_in_the_seed_are_one_group(stand_in):
    beds = {"a": bed(seed=1, n=0.4), "b": bed(seed=2, n=0.41), "c": bed(seed=1, friction=0.3, n=0.38)}
    result = compare(beds)
    assert list(result.packings.group) == ["A", "A", "B"]
    assert result.settings.to_dict("index") == {"material.friction": {"A": "0.5", "B": "0.3"}}


def test_groups_are_paired_by_seed(stand_in):
    a = {f"a{seed}": bed(seed=seed, n=n) for seed, n in ((1, 0.40), (2, 0.44), (3, 0.36), (7, 0.9))}
    b = {f"b{seed}": bed(seed=seed, friction=0.3, n=n) for seed, n in ((3, 0.35), (1, 0.38), (2, 0.43))}
    row = difference(compare(a | b))
    assert row.pairs == 3 and row.difference == pytest.approx(-0.04 / 3)
    error = np.std([-0.02, -0.01, -0.01], ddof=1) / np.sqrt(3)
    assert row.std_error == pytest.approx(error)
    assert row.high - row.difference == pytest.approx(4.302652729 * error)  # Student's t for two degrees of freedom
    # The scatter over seeds cancels: without pairs the error would be ten times as large.
    assert row.std_error < 0.1 * np.std([0.40, 0.44, 0.36], ddof=1)


def test_one_pair_has_the_errors_within_its_packings(stand_in):
    row = difference(compare({"a": bed(seed=4, n=0.4), "b": bed(seed=4, friction=0.3, n=0.39)}))
    assert (row.pairs, row.std_error) == (1, pytest.approx(0.004 * np.sqrt(2)))
    assert row.high - row.low == pytest.approx(2 * 1.959963985 * row.std_error)


def test_one_common_seed_of_several_is_no_pair(stand_in):
    """The means of all seeds have their scatter; a single pair would leave the others out."""
    a, b = (0.40, 0.42), (0.36, 0.38)
    beds = {f"a{seed}": bed(seed=seed, n=n) for seed, n in zip((1, 2), a, strict=True)}
    beds |= {f"b{seed}": bed(seed=seed, friction=0.3, n=n) for seed, n in zip((2, 3), b, strict=True)}
    row = difference(compare(beds))
    assert row.pairs == 0 and row.difference == pytest.approx(-0.04)
    assert row.std_error == pytest.approx(0.01 * np.sqrt(2.0))


def test_groups_without_a_common_seed_are_compared_by_their_means(stand_in):
    a = {f"a{seed}": bed(seed=seed, n=n) for seed, n in ((1, 0.40), (2, 0.42))}
    row = difference(compare(a | {"b": bed(seed=9, friction=0.3, n=0.38)}))
    assert row.pairs == 0 and row.difference == pytest.approx(-0.03)
    assert row.std_error == pytest.approx(np.hypot(0.01, 0.004))  # over two seeds, and within one packing
    # Welch: only the scatter over seeds has few degrees of freedom (one).
    freedom = (0.01**2 + 0.004**2) ** 2 / 0.01**4
    assert row.high - row.difference == pytest.approx(student.ppf(0.975, freedom) * row.std_error)


def test_two_groups_of_several_seeds_have_the_freedom_of_welch(stand_in):
    """The groups have standard errors of 0.01 and 0.02 over two seeds; the expected interval is that of scipy."""
    a, b = (0.40, 0.42), (0.36, 0.40)
    beds = {f"a{seed}": bed(seed=seed, n=n) for seed, n in zip((1, 2), a, strict=True)}
    beds |= {f"b{seed}": bed(seed=seed, friction=0.3, n=n) for seed, n in zip((3, 4), b, strict=True)}
    row = difference(compare(beds))
    expected = ttest_ind(b, a, equal_var=False).confidence_interval(0.95)
    assert (row.low, row.high) == pytest.approx((expected.low, expected.high))


def test_one_packing_by_two_versions_of_the_code_makes_two_groups(stand_in):
    beds = {"old": bed(n=0.4, code_version="1+a (x)"), "new": bed(n=0.41, code_version="1+b (y)")}
    result = compare(beds)
    assert list(result.packings.group) == ["A", "B"] and difference(result).pairs == 1
    assert result.settings.to_dict("index") == {CODE: {"A": "1+a", "B": "1+b"}}
    beds["new"].attrs["code_version"] = "1+a (y)"  # another commit with the same code
    assert compare(beds).settings.empty


def test_a_group_of_several_versions_of_the_code_is_named(stand_in):
    versions = ("1+a (x)", "1+b (y)", "1+a (z)")
    beds = {f"a{seed}": bed(seed=seed, n=0.4, code_version=code) for seed, code in enumerate(versions)}
    assert "Group A has packings of several versions of the code: 1+a, 1+b." in comparison_text(compare(beds))
    del beds["a1"]
    assert "versions" not in comparison_text(compare(beds))


def test_files_without_a_specification_are_groups_of_their_own(stand_in):
    beds = {name: make_packing([[0, 0, 0]], 1e-3, n=0.4) for name in ("a", "b")}
    result = compare(beds)
    assert list(result.packings.group) == ["A", "B"] and difference(result).pairs == 0
    assert "no specification" in comparison_text(result)


def test_the_means_of_groups_have_errors_over_seeds_or_within_one_packing(stand_in):
    porosities = {1: 0.40, 2: 0.42, 3: 0.41}
    beds = {f"a{seed}": bed(seed=seed, n=n) for seed, n in porosities.items()}
    result = compare(beds | {"b": bed(friction=0.3, n=0.38)})
    mean, error = 0.41, 0.01 / np.sqrt(3)
    first, second = (line for line in comparison_text(result).splitlines() if line.startswith(("A   ", "B   ")))
    assert first.split()[1] == "3" and f"{mean:.4f} ± {error:.4f}" in first
    within = result.packings.set_index("label").loc["b", "n_std_error"]
    assert second.split()[1] == "1" and f"0.3800 ± {within:.4f}" in second


def test_the_numbers_are_those_of_the_beds():
    """Simple and body-centred cubic lattices have 6 and 8 contacts in their bulk, and known porosities."""
    period = 2e-2 / np.sqrt(3.0)
    result = compare({"sc": bed(), "bcc": bed("bcc", friction=0.3)}, cut=2 * period)
    simple, centred = result.packings.itertuples()
    assert simple.n == pytest.approx(1 - np.pi / 6, abs=0.06) and centred.n < simple.n
    assert simple.grains == 72 and simple.D50 == pytest.approx(1e-2) and (simple.FL, simple.EL) == (1.0, 1.0)
    assert simple.coordination == pytest.approx(6 - 2 / 8)  # the outer layers lack one contact each
    row = difference(result, "coordination")
    assert row.difference == pytest.approx(centred.coordination - simple.coordination)


def test_the_command_prints_tables(tmp_path, capsys):
    write_packing(tmp_path / "a.nc", bed())
    write_packing(tmp_path / "b.nc", bed("bcc", friction=0.3))
    paths = [str(tmp_path / name) for name in ("a.nc", "b.nc")]
    assert main(["compare", *paths, "--cut", "12 mm"]) == 0
    text = capsys.readouterr().out
    result = compare({paths[0]: bed(), paths[1]: bed("bcc", friction=0.3)}, 12e-3)
    for row in result.packings.itertuples():
        assert f"{row.n:.4f} ± {row.n_std_error:.4f}" in text
    assert "B − A" in text and "1 pair of equal seed" in text and "material.friction  0.5  0.3" in text
    write_packing(tmp_path / "c.nc", bed(seed=2))
    assert main(["compare", paths[0], str(tmp_path / "c.nc"), "--cut", "12 mm"]) == 0
    text = capsys.readouterr().out
    assert "there is one group" in text and "(over 2 seeds)" in text


def test_wrong_input_is_one_line(tmp_path, capsys):
    write_packing(tmp_path / "a.nc", bed())
    write_packing(tmp_path / "b.nc", bed(seed=2))
    a, b = str(tmp_path / "a.nc"), str(tmp_path / "b.nc")
    for arguments, message in (
        ([a], "1 packing is given; give at least two"),
        ([a, a], "given twice"),
        ([a, f"{tmp_path}/../{tmp_path.name}/a.nc"], "given twice"),
        ([a, b, "--cut", "1 m"], "a.nc: the bed is"),
        ([a, str(tmp_path / "none.nc")], "there is no such file"),
    ):
        assert main(["compare", *arguments]) == 2
        printed = capsys.readouterr().err
        assert message in printed and printed.count("\n") == 1

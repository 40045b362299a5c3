"""Share of the difference to Rettinger et al. in beds of long grains that a stretched lattice explains."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.studies.long_grains import (
    GRAINS,
    JUDGED,
    LARGE,
    PARTS,
    SETS,
    TOTAL,
    WIDE,
    by_r22,
    campaign,
    divided,
    explained,
    our_misfit,
    summarised,
)
from simcore.evaluation.rounding import with_decimals
from simcore.paths import REFERENCE, ROOT
from simcore.reference.columns import find_column


def made(changes):
    """Return pairs with these changes, and rows of the campaign with a difference of 0.04 in each judged set."""
    sets = pd.DataFrame([(FL, EL, 0.2, 0.2) for FL, EL in JUDGED], columns=SETS)
    rows = sets.assign(seed=1, difference=0.04)
    other = rows.iloc[:1].assign(**{SETS[2]: 0.1, SETS[3]: 0.1, "difference": 0.5})
    pairs = sets.assign(seed=1, change=changes, change_error=0.004)
    return pairs[pairs["change"] != 0], pd.concat([rows, other, rows.assign(seed=2)])


def test_the_share_is_that_of_all_judged_sets_also_of_those_that_are_not_stretched():
    share, error = explained(*made([-0.03, -0.02, 0.0, -0.014]))
    assert share == pytest.approx(0.064 / 0.16) and error == pytest.approx(np.sqrt(3) * 0.004 / 0.16)


def test_further_seeds_do_not_count_in_the_share():
    pairs, rows = made([-0.03, -0.02, 0.0, -0.014])
    assert explained(pd.concat([pairs, pairs.assign(seed=2)]), rows) == explained(pairs, rows)


def test_the_campaign_has_every_judged_set_and_is_compared_with_the_published_model():
    rows = campaign()
    for FL, EL in JUDGED:
        assert ((rows[SETS] == [FL, EL, 0.2, 0.2]).all(axis=1) & (rows["seed"] == 1)).sum() == 1
    first = rows.iloc[0]
    expected = 0.287 + 0.032 / first["mu_EQ"] - 0.003 / first["sigma_EQ"] + 0.011 / first["mu_EL"]
    assert by_r22(rows)[0] == pytest.approx(expected) and first["difference"] == pytest.approx(first["n"] - expected)


def test_the_stretch_of_the_lattice_is_a_column_of_the_rows():
    assert find_column("difference_long_lattice", "stretch_z").key == "generation.stretch_z"


def made_parts(sources):
    """Return two sets whose porosity falls by 0.01 with faces, 0.02 with the grains of others and 0.005 with width."""
    sets = pd.DataFrame([(0.6, 0.4, 0.2, 0.2), (0.8, 0.4, 0.2, 0.2)], columns=SETS)
    rows = pd.concat([sets.assign(seed=1, n=[0.46, 0.44], difference=[0.05, 0.04]), sets.assign(seed=2, n=0.9)])
    n = {"synthetic": [0.45, 0.43], "scans": [0.44, 0.43], "rhine": [0.43, 0.41]}
    grains = pd.concat([sets.assign(source=source, n=n[source]) for source in sources])
    wide = sets.assign(source="rhine", n=[0.425, 0.405])
    return rows, [-0.01, -0.006, 0.0, 0.0], grains, wide


def test_the_parts_of_the_difference_add_up():
    table = divided(*made_parts(["synthetic", "scans", "rhine"]))
    expected = {
        "difference": [0.05, 0.04],
        "faces": [-0.01, -0.01],
        "grains": [-0.02, -0.02],
        "scans": [-0.01, 0.0],
        "width": [-0.005, -0.005],
        "misfit": [-0.01, -0.006],
        "open": [0.005, -0.001],
    }
    for part, values in expected.items():
        np.testing.assert_allclose(table[part], values, atol=1e-12, err_msg=part)
    explained_parts = table[["faces", "grains", "width", "misfit"]].sum(axis=1)
    np.testing.assert_allclose(table["difference"] + explained_parts, table["open"], atol=1e-12)
    summary = summarised(table)
    assert summary["share"]["grains"] == pytest.approx(0.02 / 0.045)
    assert summary["mean"]["misfit"] == pytest.approx(-0.008)
    assert summary["standard error"]["misfit"] == pytest.approx(0.002)
    assert not summary["significant"]["misfit"]  # 0.008 is 4 standard errors of two sets, and 12.7 are needed
    shares = summary["share"][["faces", "grains", "width", "misfit", "open"]]
    assert shares.sum() == pytest.approx(1.0)


def test_parts_of_missing_packings_are_unknown():
    rows, misfit, grains, wide = made_parts(["synthetic"])
    table = divided(rows, misfit, grains, wide.iloc[:0])
    assert table[["grains", "scans", "width", "open"]].isna().all(axis=None)
    assert summarised(table)["sets"].to_dict() == dict(zip(PARTS, (2, 0, 0, 0, 2, 0), strict=True))


def test_our_misfit_is_that_of_the_committed_model():
    misfit = our_misfit(campaign())
    assert np.abs(misfit).mean() == pytest.approx(0.006, abs=0.001)


def test_the_page_has_the_difference_of_each_set_with_the_grains_of_rettinger_et_al():
    page = (ROOT / "docs" / "appendices" / "mixtures_of_form.md").read_text(encoding="utf-8")
    rows = campaign().query("seed == 1").merge(pd.read_csv(REFERENCE / GRAINS).query("source == 'rhine'"), on=SETS)
    assert len(rows) == 6
    left = rows["difference"] + rows["n_y"] - rows["n_x"]
    for row, rest in zip(rows.itertuples(), left, strict=True):
        FL, EL, sigma_FL, sigma_EL = (getattr(row, name) for name in SETS)
        porosities = f"{row.n_x:.3f} | {row.n_y:.3f} | {row.difference:+.3f} | {rest:+.3f}"
        assert f"| {FL} | {EL} | {sigma_FL}, {sigma_EL} | {porosities} |".replace("-", "−") in page
    change = rows["n_y"] - rows["n_x"]
    words = " ".join(page.split())
    assert (
        f"by about the same amount, {-change.mean():.4f} ± {change.sem():.4f} (standard error over the sets)" in words
    )
    large = rows["difference"] >= LARGE
    shares = [-part.mean() / rows["difference"][part.index].mean() for part in (change, change[large])]
    assert (
        f"This is {shares[0]:.2f} of the mean difference over all sets, and {shares[1]:.2f} over the four sets" in words
    )


def test_the_page_has_the_parts_of_the_difference():
    page = (ROOT / "docs" / "appendices" / "mixtures_of_form.md").read_text(encoding="utf-8")
    grains = pd.read_csv(REFERENCE / GRAINS)
    table = divided(campaign(), our_misfit(campaign()), grains, grains.iloc[:0])
    judged = [summarised(sets).round(4) for sets in (table, table[table["difference"] >= LARGE])]
    for part in ("faces", "grains", "misfit"):
        cells = [
            f"{values['mean'][part]:+.4f} ± {values['standard error'][part]:.4f}, "
            f"{'significant' if values['significant'][part] else 'not significant'} | {values['share'][part]:.2f}"
            for values in judged
        ]
        assert " | ".join(cells).replace("-", "−") in page, part


def test_the_page_has_the_parts_and_the_porosities_of_the_wide_boxes():
    """Each row of its tables is made here from the committed rows."""
    page = (ROOT / "docs/appendices/mixtures_of_form.md").read_text(encoding="utf-8")
    rows, wide = campaign(), pd.read_csv(REFERENCE / WIDE)
    grains = pd.read_csv(REFERENCE / GRAINS)
    table = divided(rows, our_misfit(rows), grains, wide)
    narrow = grains[grains["source"] == "rhine"].set_index(SETS)["n"]
    for key, n in wide.set_index(SETS)["n"].items():
        FL, EL, *deviations = key
        change = with_decimals(n - narrow[key], 3, "+")
        assert f"| {FL} | {EL} | {deviations[0]}, {deviations[1]} | {narrow[key]:.3f} | {n:.3f} | {change} |" in page
    parts = [summarised(table), summarised(table[table[TOTAL] >= LARGE])]
    for part, title in {"width": "a box twice as wide, their grains", "open": "open"}.items():
        sign = "+" if part == "open" else ""
        cells = [
            f"{with_decimals(of['mean'][part], 4, sign)} ± {of['standard error'][part]:.4f}, "
            f"{'' if of['significant'][part] else 'not '}significant | {of['share'][part]:.2f}"
            for of in parts
        ]
        assert f"| {title} | {' | '.join(cells)} |" in page

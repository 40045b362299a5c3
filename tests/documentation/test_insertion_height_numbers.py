"""The effect of the insertion height on single forms, as texts state it."""

import pandas as pd
import pytest

from simcore.paths import REFERENCE, ROOT

KEY = "case == 'U1' and seed == 1 and source == 'synthetic' and representation == 'polyhedron'"


def page(path):
    return " ".join((ROOT / path).read_text(encoding="utf-8").split())


@pytest.fixture(scope="module")
def forms():
    """Return a table of the forms that were also inserted at the r22 heights, with L/S and the two effects."""
    fallen = pd.read_csv(REFERENCE / "difference_births.csv").set_index("grain")["n"]
    above = pd.read_csv(REFERENCE / "born_above_bed" / "single_form.csv").query(KEY).set_index("grain")
    point = pd.read_csv(REFERENCE / "single_form.csv").query(KEY).set_index("grain")["n"]
    return pd.DataFrame(
        {"height": above["n"] - fallen, "contacts": point - fallen, "L/S": above["L"] / above["S"]}
    ).dropna()


def test_the_mean_effects_are_on_the_pages(forms):
    height, contacts = (f"{forms[name].mean():.4f} ± {forms[name].sem():.4f}" for name in ("height", "contacts"))
    process = page("docs/appendices/process.md")
    assert f"r22 heights, {len(forms)} forms | +{height} |" in process
    assert f"the {len(forms)} forms from the r22 heights | +{contacts} |" in process
    assert f"Over {len(forms)} single forms inserted so, point contacts at 1 ms are {contacts} looser" in page(
        "docs/explanation/accuracy.md"
    )
    assert f"| {len(forms)} beds of one form each | +{height} |" in page("docs/how_to/accuracy_preset.md")
    for path in ("README.md", "docs/explanation/porosity.md"):
        assert f"0.009 to {forms['height'].mean():.3f} " in page(path)


def test_the_effect_of_the_height_by_form(forms):
    process, round_ = page("docs/appendices/process.md"), forms["height"][forms["L/S"] < 2.0]
    assert f"+{round_.min():.3f} to +{round_.max():.3f} for the six forms" in process and len(round_) == 6
    flat = forms["height"][forms["L/S"] > 3.8]
    assert set(flat.index) == {"G20", "G40", "G26"}
    assert f"G20 has +{flat['G20']:.3f}, G40 +{flat['G40']:.3f} and G26 +{flat['G26']:.3f}" in process
    assert forms["height"].max() == flat["G26"] and f"up to {flat['G26']:.2f}" in page("README.md")


def test_heights_and_boxes_of_the_set_of_long_grains():
    text = page("docs/appendices/mixtures_of_form.md")
    rows = pd.read_csv(REFERENCE / "difference_long.csv").query("shape_kind == 'polyhedron' and shaking_s == 6")
    n = rows.pivot_table(index="seed", columns=["fill", "faces"], values="n")
    changes = {faces: n["r22", faces] - n["bed", faces] for faces in (100, 300)}
    shown = {k: f"{c.mean():.3f} ± {c.sem():.3f}".replace("-", "−") for k, c in changes.items()}
    assert all(len(change.dropna()) == 3 for change in changes.values())
    assert f"| r22 heights | {shown[100]} |" in text
    assert f"| r22 heights, with 300 faces before and after | {shown[300]} |" in text
    assert f"| heights of insertion, with 300 faces | {shown[300].removeprefix('−')} |" in text
    beds = pd.read_csv(REFERENCE / "difference_long_bed.csv").query("seed == 1").set_index(["width_m", "height_m"])
    for place, words in (
        ((0.063, 0.8), "the campaign's box, packed again"),
        ((0.0945, 0.8), "1.5 times as wide"),
        ((0.063, 1.2), "twice as deep"),
    ):
        assert f"| {words} | {beds.n[place]:.3f} ± {beds.n_error[place]:.3f} |" in text
    wider, deeper = (beds.n[0.063, 0.8] - beds.n[place] for place in ((0.0945, 0.8), (0.063, 1.2)))
    explained = f"{wider:.3f} and {deeper:.3f}".replace("-", "−")
    assert f"| width and depth of the bed | {explained}, one seed each," in text

"""The biases of a study's porosities, estimated from tables of packings that differ in one setting."""

import numpy as np
import pandas as pd
import pytest

from simcore.campaign.biases import (
    INSERTIONS,
    SETTINGS,
    SHAKING,
    SIZE,
    bias_effects,
    describe_settings,
    measured_biases,
)
from simcore.scene.specification import resolve

RAW = {
    "name": "bed",
    "accuracy": "standard",
    "domain": {"width": "45 mm", "height": "0.4 m"},
    "sizes": {"case": "U1"},
    "amount": {"grains": 300},
}


def specification(**changes):
    return resolve({**RAW, **changes})


def bias_note(specifications, biases):
    """Return the effects of the settings of these packings as one text."""
    return "; ".join(f"{kind}: {text}" for kind, text in bias_effects(specifications, biases))


@pytest.fixture
def folder(tmp_path):
    """Return a folder of made-up tables with known differences.

    Draft is 0.01 looser than r22, 300 grains are 0.02 denser than 1200, and 6 s of shaking are 0.005 looser than 12 s.
    """
    n = 0.35 + 0.001 * np.arange(4)
    pd.concat(
        pd.DataFrame({"accuracy": accuracy, "case": "U1", "seed": range(4), "grains": 600, "n": n + more})
        for accuracy, more in (("r22", 0.0), ("draft", 0.01), ("standard", [0.001, 0.003, 0.001, 0.003]))
    ).to_csv(tmp_path / "accuracy.csv", index=False)
    # These packings were inserted at the heights of Rettinger et al.; their rows list the settings.
    settings = ["accuracy", "polyhedron_contact", "contact_time_s"]
    pd.concat(
        pd.DataFrame(
            {"case": "U1", **dict(zip(settings, values, strict=True)), "seed": range(4), "grains": 600}
        ).assign(n=n - 0.01 + more)
        for *values, more in (
            ("r22", "patch", 0.2e-3, 0.0),
            ("standard", "patch", 2e-3, 0.004),
            ("standard", "point", 1e-3, -0.003),
        )
    ).to_csv(tmp_path / "accuracy_heights.csv", index=False)
    # Ellipsoids are 0.005 denser at 1 ms than at 0.2 ms; rows with other steps or dashpots must be ignored.
    pd.concat(
        pd.DataFrame({"case": "U1", "grain": list("abcd"), "seed": 1, "grains": 600, "n": n + more}).assign(
            dashpot=dashpot, steps_per_contact_time=steps, contact_time_s=time
        )
        for dashpot, steps, time, more in (
            ("implicit", 10.0, 1e-3, 0.0),
            ("implicit", 10.0, 0.2e-3, 0.005),
            ("implicit", 40.0, 1e-3, 0.1),
            ("explicit", 40.0, 1e-3, 0.2),
        )
    ).to_csv(tmp_path / "difference_ellipsoid_steps.csv", index=False)
    pd.concat(
        pd.DataFrame(
            {"case": "U1", "grain": list("abcd")[:forms], "width_mm": width, "grains": grains, "n": n[:forms]}
        ).assign(n=lambda rows, more=more: rows["n"] + more)
        for width, grains, forms, more in ((63.0, 1200, 4, 0.0), (45.0, 300, 3, -0.02), (32.0, 300, 2, -0.1))
    ).to_csv(tmp_path / "bed_size.csv", index=False)
    (tmp_path / "work_precision").mkdir()
    shaking = {"study": "precision_shaking", "setting": [12, 6], "seeds": 4, "difference": [0.0, 0.005]}
    other = {"study": "precision_skin", "setting": ["not set"], "seeds": 2, "difference": [0.0]}
    rows = pd.concat([pd.DataFrame(shaking), pd.DataFrame(other)]).assign(difference_std_error=0.0003)
    rows.to_csv(tmp_path / "work_precision/packings.csv", index=False)
    # Seed 4 has no partner, and rows that also differ in the spacing must not become partners.
    in_bed = pd.DataFrame({"case": "U1", "fill": "bed", "spacing": np.nan, "seed": range(5), "grains": 600, "n": 0.35})
    other = in_bed[:4].assign(fill="r22", n=0.35 - 0.001 * np.array([8, 10, 8, 10]))
    pd.concat([in_bed, other, other.assign(spacing=0.016, n=0.2)]).to_csv(
        tmp_path / "difference_process.csv", index=False
    )
    return tmp_path


def test_differences_are_those_of_the_pairs(folder):
    found = measured_biases(folder)
    heights = found[(found.of == SETTINGS) & (found.inserted == "at the heights of Rettinger et al.")]
    smooth = heights[heights.kind == "ellipsoids"]
    assert smooth.difference.tolist() == pytest.approx([-0.005]) and smooth.beds.tolist() == [4]
    heights = heights[heights.kind == "grains"].set_index("setting").difference
    assert heights.to_dict() == pytest.approx(
        {"standard": 0.004, "standard at the deepest point and contact time 1 ms": -0.003}
    )
    found = found.drop(found.index[found.inserted == "at the heights of Rettinger et al."]).set_index(["of", "setting"])
    assert found.difference[SETTINGS, "draft"] == pytest.approx(0.01)
    assert found.difference_std_error[SETTINGS, "draft"] == pytest.approx(0.0, abs=1e-12)
    assert found.difference[SETTINGS, "standard"] == pytest.approx(0.002)
    # Four differences deviate by 0.001 from their mean: standard deviation 0.001 (4/3)^1/2, half of it for the mean.
    assert found.difference_std_error[SETTINGS, "standard"] == pytest.approx(0.5e-3 * (4 / 3) ** 0.5)
    assert found.difference[SIZE, "300 grains in 45 mm"] == pytest.approx(-0.02)
    assert found.beds[SIZE, "300 grains in 45 mm"] == 3
    assert (SIZE, "300 grains in 32 mm") not in found.index  # two pairs are too few for an error
    assert found.difference[SHAKING, "6 s"] == 0.005 and found.against[SHAKING, "6 s"] == "12 s"
    assert found.difference[INSERTIONS, "just above the bed"] == pytest.approx(0.009)
    assert found.beds[INSERTIONS, "just above the bed"] == 4
    assert len(found) == 5


def test_without_tables_there_are_no_biases(tmp_path):
    assert measured_biases(tmp_path).empty
    assert "settings: not measured for standard" in bias_note([specification()], measured_biases(tmp_path))


def test_settings_are_named_by_their_preset_and_contact_time():
    assert describe_settings(specification()) == "standard"
    softer = specification(numerics={"contact_time": "1 ms", "progress_interval": "1 s"})
    assert describe_settings(softer) == "standard with contact time 1 ms"
    point = {"contact_time": "1 ms", "polyhedron_contact": "point"}
    wide = {"max_unbalanced_force": 0.5}
    text = "standard at the deepest point and contact time 1 ms"
    assert describe_settings(specification(numerics=point, convergence=wide)) == text
    assert describe_settings(specification(convergence=wide)) is None
    assert describe_settings(specification(numerics={"polyhedron_contact": "inflated"})) is None
    assert describe_settings(specification(shaking={"duration": "1 s"})) is None
    assert describe_settings(specification(accuracy=None)) is None
    # Faces do not belong to the settings: campaign grains are already decimated, and ellipsoids have none.
    assert describe_settings(specification(faces="original")) == "standard"


def test_the_note_of_a_study_gives_the_bias_of_its_own_packings(folder):
    biases = measured_biases(folder)
    note = bias_note([specification(), specification(seed=2)], biases)
    assert (
        "settings: +0.0020 ± 0.0006 (standard instead of r22; 600 grains of all forms, inserted just above the bed)"
        in note
    )
    assert "size of the bed: −0.0200" in note and "instead of 1200 grains in 63 mm; single forms)" in note
    assert "time of shaking: +0.0050 ± 0.0003 (6 s instead of 12 s;" in note
    # The bias of the settings depends on the insertion, so a study with both kinds of insertion has none.
    poured = specification(generation={"fill": "r22"})
    assert "settings: +0.0040 ± 0.0000 (standard instead of r22; 600" in bias_note([poured], biases)
    assert "settings: not measured for standard;" in bias_note([poured, specification()], biases)
    reference = {"domain": {"width": "63 mm", "height": "0.4 m"}, "amount": {"grains": 1200}}
    note = bias_note([specification(**reference)], biases)
    assert "none for 1200 grains in 63 mm, the reference; others differ from it by −0.02" in note
    cylinder = {"domain": {"type": "cylinder", "width": "64 mm", "height": "0.5 m"}, "amount": {"mass": "0.3 kg"}}
    note = bias_note([specification(shaking={"duration": t}, **cylinder) for t in ("1 s", "2 s")], biases)
    assert note.endswith(
        "size of the bed: not measured; time of shaking: not the same in all packings; "
        "insertion: +0.0090 ± 0.0006 (just above the bed instead of at the heights of Rettinger et al.; 600 "
        "grains of all forms)"
    )
    # Ellipsoids have a bias of their own where it was measured, and otherwise that of grains.
    point = {"numerics": {"contact_time": "1 ms", "polyhedron_contact": "point"}, "generation": {"fill": "r22"}}
    note = bias_note([specification(**point)], biases)
    assert "settings: −0.0030 ± 0.0000 (standard at the deepest point and contact time 1 ms instead of r22; 600" in note
    note = bias_note([specification(**point, shapes={"kind": "ellipsoid"})], biases)
    assert (
        "settings: −0.0050 ± 0.0000 (standard at the deepest point and contact time 1 ms instead of a contact" in note
    )
    assert "time of 0.2 ms; 600 ellipsoids of one of 4 forms, inserted at the heights of Rettinger et al.)" in note
    poured_ellipsoids = specification(generation={"fill": "r22"}, shapes={"kind": "ellipsoid"})
    assert "settings: +0.0040 ± 0.0000 (standard instead of r22; 600 grains" in bias_note([poured_ellipsoids], biases)
    # One packing of three has shorter steps, for which no bias was measured.
    shorter = specification(numerics={"steps_per_contact_time": 14})
    note = bias_note([specification(), shorter, specification(seed=2)], biases)
    assert "settings: for 2 of 3 packings +0.0020 ± 0.0006 (standard instead of r22;" in note
    assert "inserted just above the bed); for the rest not measured; size" in note
    strewn = {"placement": "random", "orientation": "random"}
    assert bias_note([specification(generation=strewn)], biases).endswith("insertion: not measured")


def test_the_preset_for_wide_curves_is_compared_with_the_same_beds_and_stiffer_contacts(folder):
    beds = pd.DataFrame({"case": "U5", "width_m": 0.07, "mass_kg": 1.4, "seed": range(3), "n": 0.31})
    beds.assign(n=beds["n"] + [0.001, 0.002, 0.003]).to_csv(folder / "wide_both.csv", index=False)
    beds.assign(seed=range(-1, 2)).to_csv(folder / "wide_quota.csv", index=False)  # two of them have a pair
    biases = measured_biases(folder)
    row = biases[biases["source"] == "wide_both.csv"].squeeze()
    assert (row["setting"], row["beds"], row["difference"]) == ("wide", 2, pytest.approx(0.0015))
    wide = specification(accuracy="wide", generation={"fill": "r22"})
    assert "(wide instead of a contact time of 0.2 ms and 2 s of shaking; 1.4 kg of U5" in bias_note([wide], biases)
    # It is not among the differences from the reference of the other presets.
    reference = bias_note([specification(accuracy="r22", generation={"fill": "r22"})], biases)
    assert "others differ from it by" in reference and "for wide" not in reference

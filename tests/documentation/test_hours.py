"""The CPU hours on the page of findings are those of collected.csv."""

import pandas as pd
import pytest

from simcore.paths import REFERENCE, ROOT

STUDIES = {
    "63 single forms, U1": ("single_form", "synthetic"),
    "twenty-four packings of single forms": ("single_form_wide", "synthetic"),
    "63 scans, U1": ("single_form", "scans"),
    "ellipsoids of the 63 forms": ("equivalent_ellipsoids", "synthetic"),
    "52 mixtures, U1": ("form_mixtures", "synthetic"),
    "the experiment, cylinder": ("validation", "synthetic"),
    "time of shaking, cylinder": ("shaking_cylinder", "synthetic"),
    "beds for size and form": ("size_and_form", "synthetic"),
}


@pytest.mark.parametrize("title", STUDIES)
def test_hours_of_each_study(title):
    collected = pd.read_csv(REFERENCE / "collected.csv").set_index(["study", "source"])
    row = collected.loc[STUDIES[title]]
    page = (ROOT / "docs" / "reference" / "findings.md").read_text(encoding="utf-8")
    (line,) = (line for line in page.splitlines() if line.startswith("|") and title in line.split("|")[1])
    _, packings, measured, estimated, published, _ = (cell.strip() for cell in line.split("|"))
    assert measured == f"{row.cpu_h:.1f}"
    assert estimated == ("" if pd.isna(row.cpu_h_estimated) else f"{row.cpu_h_estimated:.1f}")
    assert published.split(";")[0] == f"{row.r22_cpu_h:.0f}"
    if title.startswith("beds"):
        assert packings.startswith(f"{row.packings} ")


def test_the_longest_time_over_its_estimate():
    collected = pd.read_csv(REFERENCE / "collected.csv").set_index("study")
    ratios = collected.cpu_h / collected.cpu_h_estimated.where(collected.cpu_h_estimated > 0)
    page = " ".join((ROOT / "docs" / "reference" / "findings.md").read_text(encoding="utf-8").split())
    assert f"take {ratios.max():.1f} times as long, as in the study `{ratios.idxmax()}`" in page

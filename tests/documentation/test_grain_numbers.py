"""Numbers of the page of the synthetic grains are those of their tables."""

import pandas as pd

from simcore.paths import REFERENCE, ROOT

PAGE = " ".join((ROOT / "docs" / "appendices" / "grains.md").read_text(encoding="utf-8").split())


def test_principal_components():
    table = pd.read_csv(REFERENCE / "grains" / "components.csv").set_index("component")
    assert len(table) == 13
    explained = 100 * table.loc[["PC1", "PC2"], "explained"].sum()
    assert f"Two principal components explain {explained:.1f} % of the variance of the 13 form factors" in PAGE


def test_normality():
    grains = pd.read_csv(REFERENCE / "grains" / "statistics.csv").iloc[0]
    assert f"p = {grains.shapiro_p_FL:.2f} and p = {grains.shapiro_p_EL:.2f}" in PAGE
    assert min(grains.shapiro_p_FL, grains.shapiro_p_EL) > 0.05

"""The table of impacts in docs/explanation/differences_r22.md is that of the committed rows."""

import pandas as pd

from benchmarks.studies import tilted_impacts
from simcore.paths import REFERENCE, ROOT

PAGE = (ROOT / "docs" / "explanation" / "differences_r22.md").read_text(encoding="utf-8")


def test_the_table_has_the_extremes_over_forms_and_partners():
    rows = pd.read_csv(REFERENCE / "tilted_impacts.csv")
    assert rows["stopped"].sum() == 0 and set(rows["restitution"]) == set(tilted_impacts.RESTITUTIONS)
    for restitution, of_restitution in rows.groupby("restitution"):
        cells = []
        for contact in tilted_impacts.CONTACTS:
            of_contact = of_restitution[of_restitution["polyhedron_contact"] == contact]
            least = f"{of_contact.least_ratio.min():.2f} to " if restitution == 1.0 else "up to "
            cells.append(f"{least}{of_contact.largest_ratio.max():.2f}")
        name = f"{restitution:g}, the default" if restitution == 0.1 else f"{restitution:g}"
        assert f"| {name} | {cells[0]} | {cells[1]} |" in PAGE


def test_some_impacts_are_those_of_the_rows():
    """The first impacts of a row are within its extremes; at the default restitution a cube loses energy."""
    row = tilted_impacts.impacts("cube", "floor", "patch", 0.1, number=10)
    rows = pd.read_csv(REFERENCE / "tilted_impacts.csv")
    of_row = rows.query(
        "form == 'cube' and against == 'floor' and polyhedron_contact == 'patch' and restitution == 0.1"
    )
    assert row["impacts"] == 10 and row["largest_ratio"] <= of_row.largest_ratio.iloc[0] * (1.0 + 1e-6) < 1.0

"""The numbers in docs/reference/cost.md on the growth of the cost, and on threads, are those of scaling.csv."""

import pandas as pd
import pytest

from simcore.paths import REFERENCE, ROOT

PAGE = (ROOT / "docs" / "reference" / "cost.md").read_text(encoding="utf-8")
SHAPES = {"spheres": "sphere", "polyhedra": "polyhedron"}


def row_below(header, first):
    """Return the cells after the first one in the row that begins with `first`, in the table with this header."""
    lines = PAGE[PAGE.index(f"| {header}") :].split("\n\n")[0].splitlines()
    (line,) = (line for line in lines if line.startswith(f"| {first} |"))
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


@pytest.fixture
def rows():
    return pd.read_csv(REFERENCE / "scaling.csv")


@pytest.mark.parametrize("name", SHAPES)
def test_growth_of_the_cost(rows, name):
    alone = rows[(rows["shape"] == SHAPES[name]) & rows["speedup"].isna()].set_index("grains")
    cost = alone["cpu_us_per_grain_step"].loc[[1000, 9000, 100_000]]
    growth = cost.iloc[-1] / cost.iloc[0]
    written = [f"{value:#.3g} µs" for value in cost]
    assert row_below("CPU time of a grain and step", name) == [*written, f"{growth:.2f}"]


@pytest.mark.parametrize("name", SHAPES)
def test_speed_of_two_threads(rows, name):
    both = rows[(rows["shape"] == SHAPES[name]) & (rows["threads"] == 2)].set_index("grains")
    written = [f"{value:.2f}" for value in both["speedup"].loc[[5000, 20_000]]]
    assert row_below("speed of two threads over one", name) == written

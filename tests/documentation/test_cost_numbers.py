"""The numbers in docs/reference/cost.md on steps and threads are those of step_cost.csv and scaling.csv."""

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


STEPS = {
    "spheres": "spheres",
    "ellipsoids": "ellipsoids 1 : 0.75 : 0.5",
    "polyhedra, point contact": "polyhedra of 300 faces, point contact",
    "polyhedra, patch contact": "the same, patch contact",
    "polyhedra, accuracy: wide": "the same, patch contact, 0.5 ms with 14 implicit steps (`accuracy: wide`)",
}
OTHERS = {
    "sphere, per": ("a step of spheres, friction and history", "LAMMPS"),
    "hulls, cold": ("first query of touching polyhedra of 152 vertices", "coal"),
    "hulls, warm": ("the same pair a step later", "coal, with its guess"),
}


def microseconds(value):
    return f"{value:#.3g}".rstrip(".")


def test_cost_of_a_step():
    table = pd.read_csv(REFERENCE / "step_cost.csv").set_index("what")
    for what, name in STEPS.items():
        row = table.loc[what]
        between = f"{microseconds(row.lowest_us)} to {microseconds(row.highest_us)} µs"
        assert row_below("grains | median", name) == [f"{microseconds(row.median_us)} µs", between]
    for part, (name, other) in OTHERS.items():
        ours, theirs = (row for row in table[table.index.str.contains(part)].itertuples())
        cells = [
            f"{microseconds(row.median_us)} µs ({microseconds(row.lowest_us)} to {microseconds(row.highest_us)})"
            for row in (ours, theirs)
        ]
        ratio = f"{ours.median_us / theirs.median_us:.2f}"
        assert row_below("| Scree | other program", name) == [cells[0], f"{other}: {cells[1]}", ratio]
    assert f"measured {table['runs'].max()} times in turns" in PAGE and table["runs"].nunique() == 1


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


def test_examples_of_whole_packings():
    rhine = pd.read_csv(REFERENCE / "mixtures_wide.csv").query("mu_FL_nominal == 0.647")
    hours = rhine["cpu_s"] / 3600.0
    row = row_below("packing | grains", "U7 with the Rhine's distribution of form (`mixtures_wide.csv`)")
    assert row == [f"{rhine['grains'].mean():.0f}"[:2] + "00", f"{hours.min():.1f} to {hours.max():.1f} h"]
    (bed,) = pd.read_csv(REFERENCE / "validation.csv").query("case == 'B70' and run == 1").itertuples()
    row = row_below("packing | grains", "B70 in the cylinder (`validation.csv`)")
    assert row == [f"{round(bed.grains, -2):,}".replace(",", " "), f"{bed.cpu_s / 3600.0:.1f} h"]
    beds = pd.read_csv(REFERENCE / "single_form.csv")
    beds = beds.query("source == 'synthetic' and case == 'U1' and representation == 'polyhedron'")
    seconds = f"{beds['cpu_s'].mean():.0f} s"
    assert row_below("packing | grains", "one form, one sieve class, shaken for 6 s (`single_form.csv`)")[1] == seconds
    assert f"It took {seconds} here" in PAGE

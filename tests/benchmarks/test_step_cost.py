"""The table of the cost of a step: exact for made-up runs, and its beds are accepted."""

from benchmarks.beds import bed_settings, read_overrides
from benchmarks.speed.step_cost import BEDS, COLUMNS, GRAINS, summary
from simcore.reference.columns.benchmarks import STEP_COST
from simcore.scene.specification import resolve


def test_the_median_of_runs_in_turns_is_that_of_one_bed_and_code():
    def run(what, code, cost):
        return {"what": what, "code": code, "cost_us": cost, "contacts_per_grain": 2.0, "digest": "d"}

    runs = [run("a", "x", 1.0), run("a", "y", 5.0), run("a", "x", 3.0), run("b", "x", 7.0), run("a", "x", 1.5)]
    first, second, third = summary(runs, load_average=1.0)
    assert (first["median_us"], first["lowest_us"], first["highest_us"], first["runs"]) == (1.5, 1.0, 3.0, 3)
    assert (second["code"], second["median_us"], third["what"]) == ("y", 5.0, "b")
    assert tuple(first) == COLUMNS == tuple(column.name for column in STEP_COST)


def test_the_beds_are_specifications_that_differ():
    specifications = []
    for shape, assignments in BEDS.values():
        specifications.append(resolve(bed_settings(shape, GRAINS, overrides=read_overrides(assignments))))
    assert all(specifications.count(specification) == 1 for specification in specifications)

"""Random inputs with faults: a few are handled correctly, and the independent checks detect wrong answers."""

import json
import random

import pytest

from benchmarks.correctness import input_specifications, input_tables
from benchmarks.correctness.input_tables import Contradiction, Layout
from benchmarks.correctness.inputs import Ended, Input, judge, run, summarise, try_inputs

TABLE = Layout("ratios", "utf-8", ",", 0, [0, 1], None, None, None)
GRAINS = "FL,EL\n0.5,0.8\n0.7,0.6\n0.6,0.7\n"
SPECIFICATION = """\
domain: {width: 70 mm, height: 1 m}
sizes: {bounds: [4 mm, 8 mm, 11.2 mm], mass_fractions: [0.3, 0.7]}
shapes: {kind: ellipsoid, choice: form, flatness: 0.8, elongation: 0.7}
amount: {grains: 2000}
"""


def test_twenty_inputs_are_answered_rightly_or_refused(tmp_path):
    tried = try_inputs(3, 20, tmp_path)
    assert not [wrong for *_, wrong in tried if wrong]
    assert {ended.status for _, ended, _ in tried} == {0, 2}
    assert summarise(tried)[0].startswith("20 inputs: ")


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "grains.csv"
    path.write_text(GRAINS)
    return path, json.loads(run(["predict", str(path), "--case", "U1", "--json"], 60).output)


@pytest.mark.parametrize("key", ["mu_FL", "sigma_EL", "mu_EQ", "grains"])
def test_the_reader_contradicts_other_statistics(table, key):
    path, answer = table
    input_tables.confirm(path, TABLE, json.dumps(answer))
    answer["samples"][0][key] += 1e-5
    with pytest.raises(Contradiction, match=key):
        input_tables.confirm(path, TABLE, json.dumps(answer))


@pytest.mark.parametrize(("key", "value"), [("n", 1.53), ("n", 0.99), ("lower", -0.1), ("upper", 1.0)])
def test_the_reader_contradicts_porosities_that_are_not_physical(table, key, value):
    path, answer = table
    next(row for row in answer["samples"][0]["predictions"] if row["lower"] is not None)[key] = value
    with pytest.raises(Contradiction, match="porosity"):
        input_tables.confirm(path, TABLE, json.dumps(answer))


MIXED = "sample,FL,EL\none,0.6,0.7\nmany,0.5,0.8\nmany,0.7,0.6\n"


def test_the_reader_accepts_a_sample_without_model_only_in_cases_that_lack_models(tmp_path):
    path = tmp_path / "grains.csv"
    path.write_text(MIXED)
    answer = json.loads(run(["predict", str(path), "--case", "B50", "--json"], 60).output)
    layout = Layout("ratios", "utf-8", ",", 0, [1, 2], None, 0, None)
    input_tables.confirm(path, layout, json.dumps(answer))
    with pytest.raises(Contradiction, match="sample many was answered without a porosity"):
        input_tables.confirm(path, layout, json.dumps(answer | {"case": "U1"}))
    for sample in answer["samples"]:
        sample["predictions"] = answer["samples"][1]["predictions"]
    with pytest.raises(Contradiction, match="all samples"):
        input_tables.confirm(path, layout, json.dumps(answer))


@pytest.mark.parametrize("row", ["1.2,0.5", "0.5,", "nan,0.5", "0.5,0.5,0.5", "0.5,zero"])
def test_the_reader_contradicts_an_answer_to_what_is_no_table_of_grains(table, row):
    path, answer = table
    path.write_text(f"{GRAINS}{row}\n")
    with pytest.raises(Contradiction, match="the reader cannot read it"):
        input_tables.confirm(path, TABLE, json.dumps(answer))


@pytest.mark.parametrize(
    ("asked", "other", "message"),
    [
        ("2000", "2001", "2000 grains"),
        ("0.3, 0.7", "0.78, 0.22", "not 0.78 within"),
        ("flatness: 0.8", "flatness: 0.79", "mean flatness"),
        ("width: 70", "width: 71", "width 70"),
        ("width: 70 mm,", "width: 70 mm, type: cylinder,", "the bed is"),
        ("4 mm", "3 mm", "class"),
    ],
)
def test_the_reader_contradicts_another_specification(tmp_path, asked, other, message):
    path = tmp_path / "packing.yaml"
    path.write_text(SPECIFICATION)
    output = run(["explain", str(path)], 60).output
    input_specifications.confirm(path, output)
    path.write_text(SPECIFICATION.replace(asked, other))
    with pytest.raises(Contradiction, match=message):
        input_specifications.confirm(path, output)


@pytest.mark.parametrize(
    ("verdict", "ended", "wrong"),
    [
        ("either", Ended(2, "", "simcore: no\n"), ""),
        ("either", Ended(0, "right", "a notice\n"), ""),
        ("answer", Ended(2, "", "simcore: no\n"), "without fault"),
        ("refuse", Ended(0, "right", ""), "misread"),
        ("either", Ended(2, "", "one\ntwo\n"), "2 lines"),
        ("either", Ended(2, "", ""), "0 lines"),
        ("either", Ended(2, "0.3", "one\n"), "output"),
        ("either", Ended(1, "", "one\n"), "status 1"),
        ("either", Ended(0, "right", "RuntimeWarning: divide by zero"), "warning"),
        ("either", Ended(None, "", "Traceback\nKeyError: 3"), "KeyError"),
    ],
)
def test_the_judge(tmp_path, verdict, ended, wrong):
    given = Input(["explain"], tmp_path, [], verdict, lambda output: None)
    said = judge(given, ended)
    assert wrong in said and bool(said) == bool(wrong)


def test_a_command_that_takes_too_long_is_ended(tmp_path, monkeypatch):
    def loop(arguments):
        while True:
            pass

    monkeypatch.setattr("simcore.__main__.main", loop)
    ended = run([], 1)
    assert ended.status is None and "longer than 1 s" in ended.errors


def test_a_seed_gives_the_same_inputs(tmp_path):
    def draw(number):
        arguments, path, *others = input_tables.draw_table(random.Random(number), tmp_path, number)
        return arguments, path.suffix == ".xlsx" or path.read_bytes(), others  # a workbook has the time of its making

    assert [draw(number) for number in range(10)] == [draw(number) for number in range(10)]

"""`python -m simcore explain`: what a packing does, without running it."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from simcore.__main__ import main
from simcore.dem.state.features import Features
from simcore.packing.cost import step_cost
from simcore.packing.explanation import PARTS, PARTS_BY_KIND, describe_duration, estimate_cost, parts
from simcore.packing.process import Process
from simcore.scene.shapes import POLYHEDRON, SPHERE
from simcore.scene.specification import express, read_specification, resolve
from tests.helpers.few_spheres import set_up_few_spheres, specify_few_spheres

ROOT = Path(__file__).resolve().parents[2]


def test_every_part_is_there_or_left_out():
    """Each feature of the step except its kind and its clock has a line; switching it off moves this line."""
    _, *others = Features._fields
    rich = Features(POLYHEDRON, *(1 if name == "sliding" else True for name in others))
    bare = Features(SPHERE, *(False for _ in others))
    has, lacks = parts(rich)
    assert len(has) == 1 + len(PARTS) and len(lacks) == len(PARTS_BY_KIND) - 1
    assert [len(lines) for lines in parts(bare)] == [1, len(PARTS_BY_KIND) - 1 + len(PARTS)]
    for name in sorted(set(others) - {"timed"}):
        fewer = parts(rich._replace(**{name: False}))
        assert (len(fewer[0]), len(fewer[1])) == (len(has) - 1, len(PARTS_BY_KIND)), name


@pytest.mark.parametrize("example", sorted(path.stem for path in (ROOT / "examples").glob("*.yaml")))
def test_every_example_is_explained(example, capsys):
    assert main(["explain", str(ROOT / "examples" / f"{example}.yaml")]) == 0
    output = capsys.readouterr().out
    specification = read_specification(ROOT / "examples" / f"{example}.yaml")
    assert output.startswith(f"{example}: ")
    steps = specification["numerics"]["steps_per_contact_time"]
    for word in ("The step has", "It leaves out", "Steps of ", "Time", "Memory", f"Stability   {steps:g} steps"):
        assert word in output, word
    dt = float(re.search(r"Steps of (\S+) s", output)[1])
    contact_time = specification["numerics"]["contact_time"]
    assert specification["material"]["law"] == "hertz" or dt == pytest.approx(contact_time / steps, rel=1e-12)
    grains = int(re.match(rf"{example}: (\d+) grains", output)[1])
    mass = float(re.search(r"grains, (\S+) kg", output)[1])
    if specification["amount"]["grains"] is not None:
        assert grains == specification["amount"]["grains"]
    else:
        assert mass >= specification["amount"]["mass"] * 0.9999
    shaking = round(specification["shaking"]["duration"] / dt)
    assert re.search(rf"shaking +{shaking},", output)
    left_out = output.split("It leaves out")[1].split("Steps of")[0]
    assert ("cylinder" in left_out) == (specification["domain"]["type"] == "periodic")
    assert ("polyhedra" in left_out) == (specification["shapes"]["kind"] != "polyhedron")


def test_the_specification_of_a_workflow_is_explained(tmp_path, capsys):
    """The rule packing_specification writes this file. If its grains are missing, the error is that of pack."""
    specification = resolve(specify_few_spheres())
    (tmp_path / "packing.yaml").write_text(yaml.safe_dump(express(specification), allow_unicode=True))
    assert main(["explain", str(tmp_path / "packing.yaml")]) == 0
    assert capsys.readouterr().out.startswith("few: 40 grains, ")
    grains = {**specification["grains"], "source": "results/grains/none.nc"}
    mesh = {**specification, "grains": grains, "shapes": {**specification["shapes"], "kind": "polyhedron"}}
    (tmp_path / "mesh.yaml").write_text(yaml.safe_dump(express(mesh), allow_unicode=True))
    assert main(["explain", str(tmp_path / "mesh.yaml")]) == 2
    assert "'results/grains/none.nc' does not exist" in capsys.readouterr().err


def test_nothing_is_compiled(tmp_path):
    environment = {**os.environ, "SCREE_CACHE": str(tmp_path)}
    command = [sys.executable, "-m", "simcore", "explain", str(ROOT / "examples" / "ellipsoids.yaml")]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert not list(tmp_path.rglob("*.nb?"))


def test_the_estimate_is_that_of_the_grains_themselves():
    setup = set_up_few_spheres()
    estimated = estimate_cost(setup)
    cost = estimated.packing
    process = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
    last_insertion = process.generate()
    assert cost.grains == 40 and cost.batches == 1 and cost.generating == last_insertion == 0
    assert estimated.mass == pytest.approx(process.bodies.mass.sum(), rel=1e-12)
    assert estimated.bytes_per_grain * 40 == sum(array.nbytes for array in process.bodies)
    # The list has one start more than there are bodies.
    pairs = len(process.contacts.body_a)
    assert estimated.bytes_per_pair * pairs + 8 * 41 == sum(array.nbytes for array in process.contacts)
    assert cost.shaking == 4000
    steps = cost.shaking + cost.damping
    assert cost.cpu_seconds == pytest.approx(40 * steps * step_cost("sphere", "patch", 1e-3, 2.5e-5) * 1e-6)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(1.2e6, "about 330 hours"), (9000, "about 2.5 hours"), (7199, "about 120 minutes"), (3, "about 3 s")],
)
def test_durations_are_written_without_an_exponent(seconds, text):
    assert describe_duration(seconds) == text


def test_amounts_by_mass_and_several_batches():
    setup = set_up_few_spheres(amount={"mass": "100 g", "grains": None})
    estimated = estimate_cost(setup)
    cost = estimated.packing
    process = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
    assert estimated.mass >= 0.1
    mass = setup.scene.material.density * process.insertion.pouring.volumes(setup.draw(np.arange(cost.grains)))
    assert mass.sum() == pytest.approx(estimated.mass) and mass[:-1].sum() < 0.1
    assert cost.batches > 1 and cost.generating > 0


def test_wrong_input_gives_the_same_error_as_pack(tmp_path, capsys):
    bad = tmp_path / "bad.yaml"
    bad.write_text("domain: {width: 25 kg, height: 1 m}\nsizes: {case: U1}\namount: {grains: 5}\n")
    said = []
    for command in (["explain", str(bad)], ["pack", str(bad), str(tmp_path / "out.nc")]):
        assert main(command) == 2
        said.append(capsys.readouterr().err.split(": ", 1)[1])
    assert said[0] == said[1] and "domain.width: '25 kg' is a mass" in said[0]
    assert main(["explain", str(tmp_path / "none.yaml")]) == 2
    assert "there is no such file" in capsys.readouterr().err


def test_a_warning_of_the_run_is_given_before_it():
    from simcore.packing.explanation import explain

    output = explain(set_up_few_spheres(numerics={"contact_time": "1 ms", "steps_per_contact_time": 20}))
    assert "Warning     20 steps per contact time are fewer than the 33.8" in output
    assert "Warning     20 steps" not in explain(set_up_few_spheres())


@pytest.mark.parametrize(
    ("kind", "effect"), [("periodic", "can touch its own periodic image"), ("cylinder", "cannot lie flat")]
)
def test_grains_longer_than_the_width_of_the_domain_are_warned_of(kind, effect):
    from simcore.packing.explanation import explain

    # Ellipsoids of one sieve size d with I = S = d, L = d / 0.3.
    shapes = {"kind": "ellipsoid", "choice": "form", "flatness": 1.0, "elongation": 0.3}
    sizes = {"bounds": ["7.2 mm", "7.5 mm"]}
    output = explain(set_up_few_spheres(domain={"type": kind}, shapes=shapes, sizes=sizes, amount={"grains": 6}))
    assert "longer than the domain" not in output
    output = explain(
        set_up_few_spheres(domain={"type": kind, "width": "24 mm"}, shapes=shapes, sizes=sizes, amount={"grains": 6})
    )
    assert re.search(
        rf"The longest grain, 2[45]\.?\d* mm, is longer than the domain is wide, 24 mm, and {effect}", output
    )

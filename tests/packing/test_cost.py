"""The cost of a packing that a scheduler gets, compared with the estimate from the drawn grains."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simcore.grains.sources import load_grains
from simcore.packing import cost as packing_cost
from simcore.packing.explanation import draw_batches, estimate_cost, explain
from simcore.packing.insertion.batches import Pouring
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve

ROOT = Path(__file__).resolve().parents[2]
LARGE = {
    "domain": {"width": "0.2 m", "height": "1 m"},
    "amount": {"mass": "2 kg"},
    "sizes": {"case": "U1"},
    "shapes": {"kind": "ellipsoid"},
}
LONG = {"flatness": {"mean": 0.8, "std": 0.1}, "elongation": {"mean": 0.4, "std": 0.2}}
# The cylinder of Rettinger et al. is filled in a dozen batches.
CYLINDER = {
    "domain": {"type": "cylinder", "width": "104 mm", "height": "1 m"},
    "amount": {"mass": "3 kg"},
    "sizes": {"case": "U1"},
    "generation": {"fill": "r22"},
}


def example(name):
    return yaml.safe_load((ROOT / "examples" / f"{name}.yaml").read_text())


@pytest.mark.parametrize(
    "raw",
    [
        *map(example, ("spheres", "ellipsoids", "polyhedra", "mixture", "deposit")),
        # Its 0.1 kg may need a batch more by one estimate than by the other.
        {**example("cylinder"), "amount": {"grains": 90}},
        LARGE,
        {**LARGE, "generation": {"fill": "r22"}},
        {**CYLINDER, "shapes": {"kind": "polyhedron", "choice": "random"}},
        {**CYLINDER, "shapes": {"kind": "ellipsoid"}, "sizes": {"case": "U7", "allow_few_top_grains": True}},
        # Long grains, of which a layer of sites contains a third; and grains of a set at random places.
        {
            **{**LARGE, "domain": {"width": "63 mm", "height": "0.8 m"}, "amount": {"grains": 1200}},
            "generation": {"fill": "r22"},
            "shapes": {"kind": "polyhedron", "choice": "form_distribution", **LONG},
        },
        {
            **{**LARGE, "shapes": {"kind": "polyhedron", "choice": "random"}, "amount": {"grains": 1200}},
            "generation": {"placement": "random"},
        },
        # Filled placement has one batch, and several batches in a low domain.
        {**LARGE, "generation": {"placement": "filled"}},
        {**LARGE, "domain": {"width": "0.1 m", "height": "0.3 m"}, "generation": {"placement": "filled"}},
        {**LARGE, "shapes": {"kind": "sphere"}, "sizes": {"case": "B50", "allow_few_top_grains": True}},
    ],
)
def test_near_the_estimate_from_the_grains(raw):
    """The number of grains in a mass depends on their forms and is estimated to 20 % here.

    The times between batches add to the error of the cost.
    """
    specification = resolve(raw)
    near, cost = packing_cost.estimate(specification), estimate_cost(set_up(specification, load_grains))
    exact = cost.packing
    assert near.grains == pytest.approx(exact.grains, rel=0.0 if exact.grains == raw["amount"].get("grains") else 0.2)
    assert near.steps == pytest.approx(exact.steps, rel=0.2)
    assert near.cpu_seconds == pytest.approx(exact.cpu_seconds, rel=0.3)
    # For few grains, the base shapes, which are not counted here, need more memory than the grains; COPIES covers this.
    assert cost.memory < packing_cost.COPIES * near.array_bytes


@pytest.mark.parametrize("accuracy", ["draft", "standard", "r22"])
def test_near_the_measured_cost_of_the_accuracies(accuracy):
    """The cost is right to 30 %.

    Packings of one preset scatter by 15 %, and the lower cost of falling grains is not counted.
    """
    measured = pd.read_csv(ROOT / "results/reference/accuracy.csv").query("accuracy == @accuracy")
    raw = {"domain": {"width": "50 mm", "height": "0.5 m"}, "amount": {"grains": 600}, "sizes": {"case": "U1"}}
    estimated = packing_cost.estimate(resolve({**raw, "accuracy": accuracy}))
    assert estimated.cpu_seconds == pytest.approx(measured.cpu_s.median(), rel=0.3)


def test_a_high_bed_gets_its_last_batches_in_layers():
    """The bed grows by 0.3 mm per grain; from 0.18 m on, batches are limited to the space left below 0.3 m."""
    raw = {
        "domain": {"width": "0.06 m", "height": "0.3 m"},
        "amount": {"grains": 900},
        "sizes": {"bounds": ["5 mm", "6 mm"], "mass_fractions": [1.0]},
        "shapes": {"kind": "sphere"},
        "generation": {"spacing": "12 mm", "velocity_z": "-1 m/s"},
    }
    setup = set_up(resolve(raw), load_grains)
    grain = 3e-4 * packing_cost.SOLID_FRACTION * setup.scene.domain.area
    pour = packing_cost.Pour(900, lambda n: grain * n, 6e-3, np.array([3e-3]))
    inserted, waits = packing_cost.plan_insertion(setup.scene, pour)
    sizes = np.diff([0, *inserted])
    assert inserted[-1] == 900 and len(waits) == len(inserted)
    # A layer of 9.8 mm has 20 sites; batches begin at the floor and at 0.192 m, and end at 0.288 m.
    assert sizes[0] == 20 * 30 and sizes[1] == 20 * 10 and (sizes[2:] <= sizes[1]).all()
    assert min(waits[:-1]) > 0 and waits[-1] == 0


def test_a_stretched_lattice_inserts_fewer_grains_in_a_batch_as_planned_and_as_packed():
    raw = {
        "domain": {"width": "0.06 m", "height": "0.3 m"},
        "amount": {"grains": 900},
        "sizes": {"bounds": ["5 mm", "6 mm"], "mass_fractions": [1.0]},
        "shapes": {"kind": "sphere"},
    }
    planned, packed = [], []
    for stretch in (1, 2):
        setup = set_up(resolve({**raw, "generation": {"spacing": "12 mm", "stretch_z": stretch}}), load_grains)
        pour = packing_cost.Pour(900, lambda n: 1e-7 * n, 6e-3, np.array([3e-3]))
        planned.append(packing_cost.plan_insertion(setup.scene, pour)[0][0])
        packed.append(len(Pouring(setup.scene, setup.bases, setup.draw).batch(0, 0.0, None).places))
    assert planned[1] == pytest.approx(planned[0] / 2, rel=0.1) and packed[1] == pytest.approx(packed[0] / 2, rel=0.1)


@pytest.mark.parametrize("draw", ["random", "quota"])
@pytest.mark.parametrize("kind", ["sphere", "ellipsoid"])
def test_the_last_batch_of_rettinger_et_al_is_whole_as_planned_and_as_packed(kind, draw):
    raw = {
        "domain": {"width": "0.06 m", "height": "1 m"},
        "amount": {"mass": "0.9 kg"},
        "shapes": {"kind": kind} | ({} if kind == "sphere" else {"choice": "form", "flatness": 0.7, "elongation": 0.7}),
        "sizes": {"case": "U1", "draw": draw},
        "generation": {"fill": "r22"},
    }
    setup = set_up(resolve(raw), load_grains)
    sample, cost = draw_batches(setup)
    pouring, inserted, mass = Pouring(setup.scene, setup.bases, setup.draw), 0, 0.0
    while mass < 0.9 and inserted < (setup.scene.amount_grains or np.inf):
        places = pouring.batch(inserted, 0.0, None).places
        mass += setup.scene.material.density * setup.sample(inserted + np.arange(len(places))).volume.sum()
        inserted += len(places)
    # The plan has the layers of the lattice, but not how much of a layer the grains at the lid of the domain leave out.
    assert cost.grains == len(sample.volume) == pytest.approx(inserted, rel=0.05 * (draw == "random"))
    assert estimate_cost(setup).mass == pytest.approx(mass, rel=0.05)
    assert (mass > 0.92) == (estimate_cost(setup).mass > 0.92) == (draw == "random")
    text = explain(setup)
    assert text.startswith(f"packing: {inserted if draw == 'quota' else cost.grains} grains, ")
    assert ("Amount      0.9 kg is specified" in text) == (draw == "random")
    typical = packing_cost.estimate(resolve(raw))
    assert typical.grains == pytest.approx(inserted, rel=0.1)
    if draw == "quota":
        wanted = packing_cost.estimate(resolve({**raw, "generation": {"fill": "bed"}})).grains
        assert typical.grains == wanted


def test_ranks_are_kept_busy():
    cost = packing_cost.estimate(resolve({**LARGE, "amount": {"grains": 2500}}))
    assert [cost.ranks(most, 1000) for most in (1, 2, 3)] == [1, 2, 2]
    assert cost.ranks(4, 5000) == 1
    assert cost.memory_mb(2) > cost.memory_mb(1) and cost.minutes(1) > cost.minutes(8) >= 15


# Standard output is the peak memory [kB] of a process that packs a few pebbles. The peak of getrusage contains that
# of the process that started this one.
PEAK = """
import re, sys
from simcore.__main__ import main
status = main(["pack", "--force", sys.argv[1], sys.argv[2]])
print(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read()).group(1))
sys.exit(status)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="only Linux states the peak memory there")
def test_the_memory_of_a_rank_is_enough_with_and_without_a_compiled_step(tmp_path):
    """The first process compiles the step into an empty cache, the second finds it there."""
    raw = {**LARGE, "amount": {"grains": 20}, "shaking": {"duration": "0 s"}, "faces": 50}
    raw |= {"domain": {"width": "30 mm", "height": "0.2 m"}, "shapes": {"kind": "polyhedron"}}
    (tmp_path / "few.yaml").write_text(yaml.safe_dump({**raw, "name": "few"}))
    environment = {**os.environ, "SCREE_CACHE": str(tmp_path / "cache")}
    command = [sys.executable, "-c", PEAK, tmp_path / "few.yaml", tmp_path / "few.nc"]
    peaks = []
    for _ in range(2):
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        peaks.append(float(done.stdout.split()[-1]) * 1024)
    assert peaks[1] < packing_cost.COMPILED_MEMORY < peaks[0] < packing_cost.COMPILING_MEMORY


COST_ALONE = """
import sys
import yaml
import simcore.scene.setup
from simcore.packing.cost import estimate
from simcore.scene.specification import resolve
for name in ("spheres", "polyhedra", "deposit"):
    estimate(resolve(yaml.safe_load(open(f"examples/{name}.yaml"))))
sys.exit("numba" in sys.modules)
"""


def test_a_cost_needs_no_numba():
    assert subprocess.run([sys.executable, "-c", COST_ALONE], cwd=ROOT).returncode == 0


def test_the_plan_of_a_campaign_needs_no_numba():
    """Snakemake reads its rules for every job that it starts."""
    rules = (ROOT / "workflow" / "rules" / "common.smk").read_text()
    imports = re.findall(r"^from simcore[^\n(]*(?:\([^)]*\))?", rules, re.MULTILINE)
    assert any("campaign.plan" in line for line in imports)
    code = "\n".join(["import sys", *imports, "sys.exit('numba' in sys.modules)"])
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0


def test_a_domain_in_the_wrong_unit_is_refused_before_it_fills_the_memory():
    bed = {"shapes": {"kind": "sphere"}, "sizes": {"case": "U1"}, "amount": {"grains": 300}}
    with pytest.raises(ValueError, match="a width of 60 m and a height of 0.6 m; correct the units of domain.width"):
        packing_cost.estimate(resolve({**bed, "domain": {"width": "60 m", "height": "0.6 m"}}))

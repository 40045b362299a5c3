"""Maps of stability: outcomes of small scenes over two settings each.

    python -m benchmarks.studies.stability > results/reference/stability.csv
    python -m benchmarks.studies.stability --scheme campaigns > results/reference/stability_campaign.csv
    python -m benchmarks.studies.stability --figure results/reference/stability.csv docs/stability.png
    python -m benchmarks.studies.stability --figure results/reference/stability_campaign.csv docs/stability_campaign.png

The maps of spheres with explicit dashpots vary the steps per contact time against contact time, restitution and size
ratio, in a bed that is packed as any other. At 40 steps they vary the contact time against the weight of a grain over
that of the grain below it, and against the speed of an impact. The maps of the scheme that campaigns use (polyhedra of
100 faces, patches, implicit dashpots, a contact time of 0.2 ms) vary the steps per contact time against size ratio,
flatness and elongation.

There is one CSV row per cell: map, x, y, outcome, largest observed overlap over the thickness of the thinner grain, CPU
time [s], and the message of a scene that was refused, stopped or not right. The outcomes are:

    stable     ended and right: a bed stays at rest for 0.02 s of free motion; no overlap is larger than DEEP
    vibrating  the same, but the floor's force alternates from step to step by more than ALTERNATING of the weight
    soft       right, but grains overlap by more than SOFT of the thinner one, so that the springs affect the result
    refused    an error before the first step
    stopped    an error while running
    wrong      ended without an error, but not right
"""

import argparse
import dataclasses
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

SOFT, DEEP = 0.05, 0.5  # of the thinner grain's thickness; deeper than half of it, springs may push to the far side
GRAVITY = 9.81
REST = 5e-3  # [m/s]: the criterion of rest of a packing
ALTERNATING = 0.05  # of the weight: half the mean change of the floor's force from one step to the next
LOOKS = 20  # observations during FREE
FREE = 0.02  # [s] of motion without shaking and damping, in which a bed at rest must stay
BED = {
    "name": "cell",
    "domain": {"width": "18 mm", "height": "0.2 m"},
    "shapes": {"kind": "sphere"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0], "allow_few_top_grains": True},
    "amount": {"grains": 16},
    "material": {"fluid_density": "0 kg/m3"},
    "generation": {"velocity_z": "-0.2 m/s"},
    "shaking": {"duration": "0.02 s"},
    "damping": {"max_time": "0.5 s"},
    "numerics": {"contact_time": "1 ms", "progress_interval": "1000 s"},
}
LONG = {"max_time": "5 s"}
# The scheme that campaigns use
CAMPAIGN_BED = {
    "name": "cell",
    "accuracy": "standard",
    "faces": 100,
    "domain": {"width": "25 mm", "height": "0.4 m"},
    "shapes": {"kind": "polyhedron", "choice": "random"},
    "sizes": {"bounds": ["5.6 mm", "8 mm"], "mass_fractions": [1.0], "allow_few_top_grains": True},
    "amount": {"grains": 60},
    "generation": {"fill": "bed", "velocity_z": "-0.5 m/s"},
    "shaking": {"duration": "0.2 s"},
    "convergence": {"max_speed": f"{REST!r} m/s"},
    "numerics": {"contact_time": "0.2 ms", "polyhedron_contact": "patch", "progress_interval": "1000 s"},
}
CAMPAIGN_STEPS = (4, 6, 8, 10, 12, 14, 20, 40)
STEPS = (5, 6, 8, 12, 16, 20, 30, 40, 80)
CONTACT_TIMES = (2e-6, 2e-5, 2e-4, 1e-3, 2e-3, 1e-2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scheme", choices=MAPS, default="explicit", help="scheme whose maps are made")
    names = [name for maps in MAPS.values() for name in maps]
    parser.add_argument("--map", nargs="+", choices=names, help="only these maps of the scheme")
    parser.add_argument("--figure", nargs=2, metavar=("CSV", "PNG"), help="draw the maps of a file, run nothing")
    options = parser.parse_args()
    if options.figure:
        draw(*options.figure)
        return
    maps = MAPS[options.scheme]
    for name in options.map or maps:
        if name not in maps:
            parser.error(f"the map {name!r} is not one of --scheme {options.scheme}")
    print("map,x,y,outcome,overlap,cpu_s,message")
    for name in options.map or maps:
        cell, xs, ys = maps[name]
        for x in xs:
            for y in ys:
                started = time.process_time()
                outcome, overlap, message = cell(x, y)
                message = " ".join(message.replace('"', "'").split())
                cpu = time.process_time() - started
                print(f'{name},{x:g},{y:g},{outcome},{overlap:.3g},{cpu:.2f},"{message}"', flush=True)


def packed_bed(changes, bed=BED):
    """Pack a bed with `changes` to its settings, leave it free, and return (outcome, overlap, message)."""
    from simcore.campaign.studies import merge
    from simcore.grains.sources import load_grains
    from simcore.packing.packed import SHAKING, PackingError
    from simcore.packing.process import Process
    from simcore.scene.setup import set_up
    from simcore.scene.specification import resolve

    try:
        setup = set_up(resolve(merge(bed, changes)), load_grains)
        process = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
    except ValueError as error:
        return "refused", np.nan, str(error)
    try:
        process.run()
        deepest = deepest_overlap(process)
        lay = process.bodies.position.copy()
        still = dataclasses.replace(setup.scene.shaking, amplitude=0.0)
        # The compiled step still contains the shaking, now with an amplitude of 0.
        process.stepper.scene = dataclasses.replace(setup.scene, shaking=still)
        carried = np.zeros((LOOKS, 2))
        for look in range(LOOKS):
            # A mode at its limit of stability alternates from step to step, so two consecutive steps are observed.
            for phase, steps in enumerate((round(FREE / LOOKS / process.dt) - 1, 1)):
                process.advance(steps, SHAKING)
                process.evaluate()
                carried[look, phase] = process.walls.force[process.walls.touching > 0, 2].sum()
    except PackingError as error:
        return "stopped", np.nan, str(error)
    smallest = 2.0 * process.bodies.radius.min()
    sunk = abs((process.bodies.position - lay)[:, 2].mean())
    weight = setup.scene.material.effective_gravity * process.bodies.mass.sum()
    carried = carried / weight
    alternating = 0.5 * np.abs(carried[:, 0] - carried[:, 1]).mean()
    carried = carried.mean()  # over time, because a grain that rolls into another one presses for a moment
    reasons = []
    speed = np.sqrt((process.bodies.velocity**2).sum(axis=1).mean())  # of all grains: one that rolls is no fault
    if speed > REST:
        reasons.append(f"it moves at {speed:.2g} m/s when left free, root mean square")
    if sunk > 0.01 * smallest:
        reasons.append(f"the bed's height changes by {sunk:.2g} m when left free")
    if abs(carried - 1.0) > 0.05:
        reasons.append(f"the floor carries {carried:.2f} of the weight")
    judged = judge(max(deepest, deepest_overlap(process)), reasons)
    if judged[0] in ("stable", "soft") and alternating > ALTERNATING:
        return "vibrating", judged[1], f"the force of the floor alternates by {alternating:.2f} of the weight"
    return judged


def judge(overlap, reasons):
    """Return (outcome, overlap, message) of a scene without an error; overlap: over the thinner grain's thickness."""
    if overlap > DEEP:
        reasons = [*reasons, f"grains overlap by {overlap:.2g} of the thinner one's thickness"]
    if reasons:
        return "wrong", overlap, "; ".join(reasons)
    return ("soft" if overlap > SOFT else "stable"), overlap, ""


def deepest_overlap(process):
    """Return the largest overlap of a pair, or of a grain and the floor, over the thickness of the thinner grain."""
    from simcore.packing.run_checks import half_thickness

    half, contacts, walls = half_thickness(process.bodies), process.contacts, process.walls
    thinner = np.minimum(half[contacts.body_a], half[contacts.body_b])
    pairs = np.where(contacts.touching > 0, contacts.overlap, 0.0) / (2.0 * thinner)
    floors = np.where(walls.touching > 0, walls.overlap, 0.0) / (2.0 * half[walls.body])
    return float(max(pairs.max(initial=0.0), floors.max(initial=0.0)))


def steps_and_contact_time(contact_time, steps):
    return packed_bed({"numerics": {"contact_time": f"{contact_time!r} s", "steps_per_contact_time": steps}})


def steps_and_restitution(restitution, steps):
    """Pack a bed with the default of 5 s to come to rest, which elastic beds need."""
    changes = {"material": {"restitution": restitution}, "numerics": {"steps_per_contact_time": steps}}
    return packed_bed({**changes, "damping": LONG})


def steps_and_size_ratio(ratio, steps):
    """Pack a bed with four small grains per large one, at the contact time of Rettinger et al.

    It has the default of 5 s to come to rest, since small grains roll on.
    """
    large, few = 8e-3, 1.001
    small = large / ratio
    bounds = [small, few * small, large, few * large]
    fractions = [4.0 / (4.0 + ratio**3), 0.0, ratio**3 / (4.0 + ratio**3)]
    if ratio == 1.0:
        bounds, fractions = bounds[2:], [1.0]
    return packed_bed(
        {
            "sizes": {"bounds": [f"{bound!r} m" for bound in bounds], "mass_fractions": fractions},
            "amount": {"grains": 40},
            "numerics": {"contact_time": "0.2 ms", "steps_per_contact_time": steps},
            "damping": LONG,
        }
    )


def steps_and_size_ratio_of_pebbles(ratio, steps):
    """Pack pebbles in the scheme that campaigns use, with four small ones per large one."""
    large, few = 8e-3, 1.001
    small = large / ratio
    fractions = [4.0 / (4.0 + ratio**3), 0.0, ratio**3 / (4.0 + ratio**3)]
    bounds = [f"{bound!r} m" for bound in (small, few * small, large, few * large)]
    if ratio == 1.0:
        bounds, fractions = bounds[2:], [1.0]
    changes = {"sizes": {"bounds": bounds, "mass_fractions": fractions}, "amount": {"grains": 100}}
    return packed_bed({**changes, "numerics": {"steps_per_contact_time": steps}}, CAMPAIGN_BED)


def steps_and_flatness(flatness, steps):
    """Pack pebbles of one flatness S/I and of elongation 0.8, in the scheme that campaigns use."""
    return _bed_of_form(flatness, 0.8, steps)


def steps_and_elongation(elongation, steps):
    """Pack pebbles of one elongation I/L and of flatness 0.6, in the scheme that campaigns use."""
    return _bed_of_form(0.6, elongation, steps)


def _bed_of_form(flatness, elongation, steps):
    form = {"flatness": {"mean": flatness, "std": 0.0}, "elongation": {"mean": elongation, "std": 0.0}}
    changes = {"shapes": {"choice": "form_distribution", **form}, "numerics": {"steps_per_contact_time": steps}}
    return packed_bed(changes, CAMPAIGN_BED)


def placed(contact_time, radius, position, velocity=0.0):
    """Return a Process of spheres of radius (n,) [m] above each other; the top one falls at `velocity` [m/s]."""
    from simcore.campaign.studies import merge
    from simcore.dem.shapes.polyhedra import unit_sphere
    from simcore.dem.state.bodies import make_bodies
    from simcore.packing.process import Process
    from simcore.scene.setup import set_up
    from simcore.scene.specification import resolve

    height = max(velocity**2 / (2.0 * GRAVITY), 0.2)  # a fall to this speed
    changes = {"domain": {"width": f"{8.0 * float(radius.max())!r} m", "height": f"{float(height)!r} m"}}
    changes["numerics"] = {"contact_time": f"{contact_time!r} s"}
    setup = set_up(resolve(merge(BED, changes)), lambda group: [])
    process = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
    n = len(radius)
    speed, still = np.zeros((n, 3)), np.zeros((n, 3))
    speed[-1, 2] = -velocity
    place = np.column_stack([np.zeros(n), np.zeros(n), position])
    scale = np.outer(radius, np.ones(3))
    density = setup.scene.material.density
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    process.place(
        make_bodies(
            [unit_sphere()],
            np.zeros(n, int),
            scale,
            place,
            upright,
            speed,
            still,
            density,
            features=process.stepper.features,
        ),
        2.0 * float(radius.mean()),
    )
    return process


def run_and_look(make, duration, end=lambda process: []):
    """Run a Process made by `make` for `duration` [s] and return (outcome, overlap, message).

    It runs as a packing does, and is checked at every convergence interval. A second one is observed about 200 times,
    which gives the largest overlap in between. end(process): returns a list of what is wrong at the end, as texts.
    """
    from simcore.packing.packed import DAMPING, PackingError

    try:
        process, close = make(), make()
    except (ValueError, PackingError) as error:
        return "refused", np.nan, str(error)
    try:
        for _ in range(-(-round(duration / process.dt) // process.interval_steps)):
            process.advance(process.interval_steps, DAMPING)
    except PackingError as error:
        return "stopped", np.nan, str(error)
    deepest, reasons = 0.0, end(process)
    try:
        for _ in range(200):
            close.advance(max(round(duration / process.dt / 200), 1), DAMPING)
            deepest = max(deepest, deepest_overlap(close))
    except PackingError as error:
        return "wrong", deepest, f"not seen at the packing's own interval: {error}"
    return judge(deepest, reasons)


def weight_and_contact_time(ratio, contact_time):
    """Place a grain of 1 mm under one that is heavier by the factor `ratio`, for four periods."""
    light = 5e-4
    radius = light * np.array([1.0, ratio ** (1.0 / 3.0)])
    return run_and_look(
        lambda: placed(contact_time, radius, [light, 2.0 * light + radius[1]]), 8.0 * contact_time * np.sqrt(ratio)
    )


def impact_and_contact_time(speed, contact_time):
    """Let a sphere of 6 mm hit another one, which is on the floor, at `speed` [m/s].

    The overlap is 0.129 v T_c for the speed v and the contact time T_c, and more because of the floor.
    """

    def end(process):
        through = process.bodies.position[1, 2] < process.bodies.position[0, 2]
        return ["the upper sphere fell through the lower one"] if through else []

    return run_and_look(lambda: placed(contact_time, np.full(2, 3e-3), [3e-3, 9e-3], speed), 4.0 * contact_time, end)


MAPS = {
    "explicit": {
        "steps and contact time": (steps_and_contact_time, CONTACT_TIMES[1:], STEPS),
        "steps and restitution": (steps_and_restitution, (0.01, 0.03, 0.1, 0.3, 0.6, 0.9, 1.0), STEPS),
        "steps and size ratio": (steps_and_size_ratio, (1.0, 2.0, 4.0, 8.0, 16.0), STEPS),
        "weight and contact time": (weight_and_contact_time, (1, 10, 100, 1e3, 1e4, 1e5, 1e6), CONTACT_TIMES),
        "impact and contact time": (impact_and_contact_time, (0.1, 0.3, 1.0, 3.0, 10.0, 14.0, 30.0), CONTACT_TIMES),
    },
    "campaigns": {
        "steps and size ratio of pebbles": (steps_and_size_ratio_of_pebbles, (1.0, 2.0, 4.0, 8.0), CAMPAIGN_STEPS),
        "steps and flatness": (steps_and_flatness, (0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0), CAMPAIGN_STEPS),
        "steps and elongation": (steps_and_elongation, (0.2, 0.3, 0.4, 0.6, 0.8, 1.0), CAMPAIGN_STEPS),
    },
}


def draw(table, path):
    """Draw the figure of a table of cells and write it to `path`."""
    import pandas as pd

    from simcore.report.figures.saving import save_figure
    from simcore.report.figures.stability import stability_figure

    save_figure(stability_figure(pd.read_csv(table)), Path(path))


if __name__ == "__main__":
    sys.exit(main())

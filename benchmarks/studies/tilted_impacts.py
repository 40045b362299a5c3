"""How much impacts of nearly parallel flat faces change the energy of polyhedra, and whether they come to rest.

    python -m benchmarks.studies.tilted_impacts > results/reference/tilted_impacts.csv
    python -m benchmarks.studies.tilted_impacts --rest

Without gravity and friction, a cube, a flat block and a leaning prism fall on a floor or on their like, tilted by 1e-5
to 0.1 rad, at 1 mm/s to 0.3 m/s, both drawn uniformly in their logarithm. There is one row per form, partner, contact
and restitution. With --rest, prisms stand on the floor with their centre of mass over a part of their base, and cubes
on a cube that they overhang by a share of their edge, at the default restitution; there is one row for each. It takes 4
minutes of CPU time, or 5 s for --rest.
"""

import argparse
import sys
import zlib

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

import simcore
from benchmarks.tables import significant
from simcore.compilation import source_digest

EDGE = 0.02  # [m]
TILTS, SPEEDS = (1e-5, 0.1), (1e-3, 0.3)  # [rad], [m/s]
CONTACTS, RESTITUTIONS = ("patch", "point"), (1.0, 0.9, 0.7, 0.5, 0.3, 0.1)
NUMBER = 300  # impacts of each row
AFTER = 12  # intervals of ten steps without contact, after which an impact has ended
PARTS = (0.5, 0.7, 0.8, 0.9)  # of the base: where the centre of mass of a standing prism is above it
OVERHANGS = (0.2, 0.3, 0.4)  # of the edge
SETTLING = 2.0  # [s]


def prism(part, height=1.0):
    """Return a prism with a square base whose centre of mass is above this part of it; height in edges."""
    lean = 2.0 * (part - 0.5) * EDGE
    corners = [(x + lean * z, y, z * height * EDGE) for x in (0.0, EDGE) for y in (0.0, EDGE) for z in (0.0, 1.0)]
    return simcore.convex(corners)


FORMS = {"cube": prism(0.5), "flat block": prism(0.5, 0.3), "leaning prism": prism(0.8)}


def scene(shape, against, contact, restitution, rng):
    """Return a Simulation of a body just above the floor, or above its like, with random tilt and speed."""
    tilt, speed = (np.exp(rng.uniform(*np.log(limits))) for limits in (TILTS, SPEEDS))
    angle, heading = rng.uniform(0.0, 2.0 * np.pi, 2)
    turn = Rotation.from_rotvec(tilt * np.array([np.cos(angle), np.sin(angle), 0.0])) * Rotation.from_euler(
        "z", heading
    )
    corners = turn.apply(shape.base.vertices + shape.center)
    settings = {"gravity": 0.0, "friction": 0.0, "restitution": restitution, "polyhedron_contact": contact}
    quaternion = turn.as_quat(scalar_first=True)
    if against == "floor":
        start = (0.0, 0.0, 1e-6 - corners[:, 2].min())
        return simcore.Simulation(
            [shape], [0], [start], orientation=quaternion, velocity=(0.0, 0.0, -speed), **settings
        )
    aside = EDGE * rng.uniform(-0.4, 0.4, 2)
    top = (shape.base.vertices + shape.center)[:, 2].max()
    middle = (shape.base.vertices + shape.center).mean(axis=0) - corners.mean(axis=0)
    start = (*(middle[:2] + aside), top + 1e-6 - corners[:, 2].min())
    return simcore.Simulation(
        [shape], [0, 0], [(0.0, 0.0, 0.0), start], orientation=[(1.0, 0.0, 0.0, 0.0), quaternion],
        velocity=[(0.0, 0.0, 0.0), (0.0, 0.0, -speed)], floor=False, **settings,
    )  # fmt: skip


def energy_ratio(simulation):
    """Return the energy after an impact over that before; nan if there was none within 3000 steps."""
    before, touched, free = simulation.energy.total, False, 0
    for _ in range(300):
        simulation.advance(steps=10)
        touching = len(simulation.contacts.overlap) > 0
        touched |= touching
        free = free + 1 if touched and not touching else 0
        if free > AFTER:
            return simulation.energy.total / before
    return np.nan


def impacts(form, against, contact, restitution, number=NUMBER):
    """Return a row for impacts of one form: how many ended or were stopped, and their ratios of energy."""
    rng = np.random.default_rng(zlib.crc32(f"{form},{against},{contact},{restitution}".encode()))
    ratios, stopped = [], 0
    for _ in range(number):
        try:
            ratios.append(energy_ratio(scene(FORMS[form], against, contact, restitution, rng)))
        except FloatingPointError:
            stopped += 1
    ratios = np.array(ratios)
    ratios = ratios[~np.isnan(ratios)]
    return {
        "form": form,
        "against": against,
        "polyhedron_contact": contact,
        "restitution": restitution,
        "impacts": len(ratios),
        "stopped": stopped,
        "least_ratio": ratios.min(),
        "largest_ratio": ratios.max(),
        "share_off_by_tenth": (np.abs(ratios - 1.0) > 0.1).mean(),
        "share_gaining": (ratios > 1.001).mean(),
    }


def standing(part):
    """Return a row for a prism that stands on the floor with its centre of mass above this part of its base."""
    simulation = simcore.Simulation([prism(part)], [0], [(0.0, 0.0, 0.0)])
    return {"body": "prism on the floor", "part": part} | at_rest(simulation)


def overhanging(share):
    """Return a row for a cube that overhangs its like by this share of its edge."""
    simulation = simcore.Simulation([prism(0.5)], [0, 0], [(0.0, 0.0, 0.0), (share * EDGE, 0.0, EDGE)])
    return {"body": "cube on a cube", "part": share} | at_rest(simulation)


def at_rest(simulation):
    """Return force on the floor over the weight, and the largest speed [m/s], after SETTLING, as a dict."""
    simulation.advance(SETTLING)
    forces, speeds = [], []
    for _ in range(400):
        simulation.advance(steps=3)
        contacts = simulation.contacts
        forces.append(-contacts.force[contacts.body[:, 1] == -1, 2].sum() / (9.81 * simulation.mass.sum()))
        speeds.append(np.linalg.norm(simulation.velocity, axis=1).max())
    return {"least_force": min(forces), "largest_force": max(forces), "largest_speed": max(speeds)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rest", action="store_true")
    if parser.parse_args().rest:
        rows = [*map(standing, PARTS), *map(overhanging, OVERHANGS)]
    else:
        rows = [
            impacts(form, against, contact, restitution)
            for form in FORMS
            for against in ("floor", "its like")
            for contact in CONTACTS
            for restitution in RESTITUTIONS
        ]
        rows = [row | {"digest": source_digest()} for row in rows]
    significant(pd.DataFrame(rows)).to_csv(sys.stdout, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()

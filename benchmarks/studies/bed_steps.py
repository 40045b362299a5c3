"""Minimum steps per contact time of whole beds with implicit dashpots, over those of their stiffest grain.

    python -m benchmarks.studies.bed_steps

The beds are those of the maps of stability (benchmarks/studies/stability.py, scheme campaigns): 60 pebbles of one form,
at rest, with 14 steps per contact time. Both numbers follow from the contacts of that moment: for the bed from the
largest eigenvalue of the matrix of all bodies, for the grain from its matrix among fixed neighbours. The resistance of
patches to rocking and twisting is left out of both. It prints one row per bed and takes a minute of CPU time.
"""

import os

os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np

from benchmarks.studies.stability import CAMPAIGN_BED

FORMS = ((0.6, 0.8), (0.3, 0.8), (0.6, 0.4), (1.0, 0.99))  # flatness S/I and elongation I/L
SEEDS = (1, 2)
STEPS = 14


def main():
    print("flatness,elongation,seed,steps_of_bed,steps_of_stiffest_grain,ratio")
    for flatness, elongation in FORMS:
        for seed in SEEDS:
            of_bed, of_grain = steps_at_rest(flatness, elongation, seed)
            print(f"{flatness:g},{elongation:g},{seed},{of_bed:.2f},{of_grain:.2f},{of_bed / of_grain:.2f}", flush=True)


def steps_at_rest(flatness, elongation, seed):
    """Pack a bed and return its minimum steps per contact time and those of its stiffest grain."""
    from simcore.campaign.studies import merge
    from simcore.dem.stability import body_steps
    from simcore.grains.sources import load_grains
    from simcore.packing.process import Process
    from simcore.scene.setup import set_up
    from simcore.scene.specification import resolve

    form = {"flatness": {"mean": flatness, "std": 0.0}, "elongation": {"mean": elongation, "std": 0.0}}
    changes = {"seed": seed, "shapes": {"choice": "form_distribution", **form}}
    setup = set_up(
        resolve(merge(CAMPAIGN_BED, {**changes, "numerics": {"steps_per_contact_time": STEPS}})), load_grains
    )
    process = Process(setup.scene, setup.bases, setup.draw, lambda line: None)
    process.run()
    process.evaluate()
    bodies, candidates, width = process.bodies, process.candidates, process.stepper.box.width
    for contacts in candidates:
        contacts.spread[:] = 0.0
    law = process.watch.composition.continuous_law
    of_grains = [body_steps(bodies, candidates, width, law, True, int(body), implicit=True) for body in bodies.id]
    return whole_steps(bodies, candidates, width, law), max(of_grains)


def whole_steps(bodies, candidates, width, law):
    """Return the minimum steps per contact time at which the whole bed is stable."""
    from simcore.dem.stability import contact_time, steps_needed

    normal, tangential, effective = contact_matrices(bodies, candidates, width)

    def load_at(load):
        whole = np.einsum("k,kij->ij", load.normal, normal) + np.einsum("k,kij->ij", load.tangential, tangential)
        return np.linalg.eigvalsh(whole)[-1]

    return steps_needed(law, True, load_at, effective, contact_time(law))


def contact_matrices(bodies, candidates, width):
    """Return the matrices of all contacts per unit of normal and tangential load, and their effective contacts.

    Matrices (k, 6 n, 6 n) in units of the masses, for k contacts, with walls, of n bodies; effective contacts (k,).
    """
    contacts, walls = candidates
    number, matrices, effective = bodies.effective_contacts, [], []
    for p in np.flatnonzero(contacts.touching):
        a, b = contacts.body_a[p], contacts.body_b[p]
        offset = bodies.position[b] - bodies.position[a]
        offset[:2] += width * contacts.image[p]
        motion = _motion(bodies, b, contacts.point[p] - offset) - _motion(bodies, a, contacts.point[p])
        mass = bodies.mass[a] * bodies.mass[b] / (bodies.mass[a] + bodies.mass[b])
        matrices.append(_parts(mass, motion, contacts.direction[p]))
        effective.append(max(number[a], number[b]))
    for w in np.flatnonzero(walls.touching):
        body = walls.body[w]
        matrices.append(_parts(bodies.mass[body], _motion(bodies, body, walls.point[w]), walls.normal[w]))
        effective.append(number[body])
    return *np.swapaxes(matrices, 0, 1), np.array(effective)


def _motion(bodies, body, arm):
    """Return the motion (3, 6 n) of the point at `arm` of a body by those of all bodies, in units of the masses."""
    rows = np.zeros((3, 6 * len(bodies.mass)))
    rows[:, 6 * body : 6 * body + 3] = np.eye(3) / np.sqrt(bodies.mass[body])
    turn = np.cross(arm, np.eye(3)) @ bodies.rotation[body]
    rows[:, 6 * body + 3 : 6 * body + 6] = turn / np.sqrt(bodies.inertia[body])
    return rows


def _parts(mass, motion, normal):
    along = np.outer(normal, normal)
    return mass * motion.T @ along @ motion, mass * motion.T @ (np.eye(3) - along) @ motion


if __name__ == "__main__":
    main()

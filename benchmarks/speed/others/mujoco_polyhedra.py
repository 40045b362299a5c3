"""CPU time of the same polyhedra in MuJoCo.

    python mujoco_polyhedra.py BED.npz

It runs in an environment with `mujoco`. Grains are convex meshes with our stiffness and damping per mass (negative
solref), friction, time step, gravity and shaking. MuJoCo has no periodic box; therefore the images of the grains
surround the bed, fixed at their initial positions, and only few steps are measured. The fastest of its solvers counts.
"""

import argparse
import json
import time

import mujoco
import numpy as np
from scipy.spatial import cKDTree

FIRST_STEPS, TRIAL_STEPS, STEPS = 80, 40, 400  # STEPS: at most 2 ms, in which a grain moves by 0.1 mm
IMPEDANCE = 0.95  # of a constraint, the same at any depth; its stiffness and damping are divided by it
SOLVERS = {
    "Newton": mujoco.mjtSolver.mjSOL_NEWTON,
    "CG": mujoco.mjtSolver.mjSOL_CG,
    "PGS": mujoco.mjtSolver.mjSOL_PGS,
}
NOT_COMPARABLE = [
    "contact law: soft constraints solved together at each step, not springs and dashpots; friction without history",
    "up to several contact points for a pair, where we have one",
    "its soft constraints push grains apart within the first steps, so that fewer touch than in our bed",
    "fixed images of grains for the periodic sides, each contact with one counted",
    "the usual time step of MuJoCo is a hundred times longer, with contacts as much softer",
]


def build(bed):
    """Return the model and the data with the bed in it."""
    spec = mujoco.MjSpec()
    option = spec.option
    option.timestep = float(bed["time_step"])
    option.gravity = [0.0, 0.0, -float(bed["gravity"])]
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.memory = 2**30
    surface = {
        "friction": [float(bed["friction"]), 0.0, 0.0],
        "condim": 3,
        "solref": [-float(bed["stiffness"]), -float(bed["damping"])],
        "solimp": [IMPEDANCE, IMPEDANCE, 1.0, 0.5, 2.0],
    }
    hulls, radius = [], []
    for k, (shape, scale) in enumerate(zip(bed["shape"], bed["scale"], strict=True)):
        vertices = bed["vertices"][bed["vertex_start"][shape] : bed["vertex_start"][shape + 1]] * scale
        faces = bed["faces"][bed["face_start"][shape] : bed["face_start"][shape + 1]]
        spec.add_mesh(name=f"mesh{k}", uservert=vertices.ravel(), userface=faces.ravel())
        hull = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": f"mesh{k}", "density": float(bed["density"])}
        body = spec.worldbody.add_body(name=f"grain{k}", pos=bed["position"][k], quat=bed["orientation"][k])
        body.add_freejoint()
        body.add_geom(**hull, **surface)
        hulls.append(hull)
        radius.append(np.linalg.norm(vertices, axis=1).max())
    for k, position in images(bed["position"], np.array(radius), float(bed["width"])):
        spec.worldbody.add_geom(pos=position, quat=bed["orientation"][k], **hulls[k], **surface)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 1], **surface)
    model = spec.compile()
    data = mujoco.MjData(model)
    velocity = data.qvel.reshape(-1, 6)
    velocity[:, :3] = bed["velocity"]
    for k, quaternion in enumerate(bed["orientation"]):  # angular velocity is in the body's axes
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, quaternion)
        velocity[k, 3:] = rotation.reshape(3, 3).T @ bed["angular_velocity"][k]
    return model, data


def images(position, radius, width):
    """Yield grain and position of each periodic image whose bounding sphere is within half its radius of a grain's."""
    tree = cKDTree(position)
    for shift in [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]:
        places = position + width * np.array([*shift, 0.0])
        for k, place in enumerate(places):
            near = tree.query_ball_point(place, 1.5 * radius[k] + radius.max())
            if any(np.linalg.norm(position[i] - place) < 1.5 * radius[k] + radius[i] for i in near):
                yield k, place


def run(model, data, steps, push, rate):
    """Return the CPU time [s] of the steps, and the mean numbers of touching grain pairs and of contact points."""
    dt, pairs, points = model.opt.timestep, [], []
    began = time.process_time()
    spent = 0.0
    for step in range(steps):
        model.opt.gravity[0] = push * np.sin(rate * round(data.time / dt) * dt)
        mujoco.mj_step(model, data)
        if step % 40 == 39:
            spent += time.process_time() - began
            both = np.sort(data.contact.geom, axis=1)[(data.contact.dist < 0.0) & no_floor(model, data)]
            pairs.append(len(np.unique(both, axis=0)))
            points.append(len(both))
            began = time.process_time()
    return spent + time.process_time() - began, float(np.mean(pairs)), float(np.mean(points))


def no_floor(model, data):
    return (model.geom_type[data.contact.geom] != mujoco.mjtGeom.mjGEOM_PLANE).all(axis=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bed")
    with np.load(parser.parse_args().bed) as file:
        bed = dict(file)
    n, drive = len(bed["shape"]), (float(bed["shaking"]), float(bed["shaking_rate"]))
    model, data = build(bed)
    run(model, data, FIRST_STEPS, *drive)
    trials = {}
    for name, solver in SOLVERS.items():
        model.opt.solver = solver
        run(model, data, TRIAL_STEPS, *drive)
        trials[name] = run(model, data, TRIAL_STEPS, *drive)[0] / TRIAL_STEPS / n * 1e6
    best = min(trials, key=trials.get)
    model.opt.solver = SOLVERS[best]
    steps = min(int(bed["steps"]), STEPS)
    cpu, pairs, points = run(model, data, steps, *drive)
    print(
        json.dumps(
            {
                "code": "MuJoCo",
                "version": mujoco.__version__,
                "cpu_us_per_grain_step": cpu / steps / n * 1e6,
                "contacts_per_grain": pairs / n,
                "contact_points_per_grain": points / n,
                "steps": steps,
                "settings": f"solver {best}, elliptic cone",
                "trials": {name: round(value, 2) for name, value in trials.items()},
                "not_comparable": NOT_COMPARABLE,
            }
        )
    )


if __name__ == "__main__":
    main()

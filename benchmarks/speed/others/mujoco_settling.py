"""Drop polyhedra into a cylinder in MuJoCo until they rest.

    python mujoco_settling.py GRAINS.npz POSES.npz

It runs in an environment with `mujoco`, with the settings that a user would choose: large implicit steps, the CG
solver, and soft constraints of MuJoCo's default stiffness. The wall is a prism of planes around the cylinder. There is
no shaking.
"""

import argparse
import json
import time

import mujoco
import numpy as np

PLANES = 64  # the area of the prism is (n/π) tan(π/n) = 1.0008 times that of the cylinder


def build(grains, step):
    """Return the model and the data with the grains where they are inserted. step: time step [s]."""
    spec = mujoco.MjSpec()
    option = spec.option
    option.timestep = step
    option.gravity = [0.0, 0.0, -float(grains["gravity"])]
    option.solver = mujoco.mjtSolver.mjSOL_CG
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.memory = 2**30
    surface = {"friction": [float(grains["friction"]), 0.0, 0.0], "condim": 3}
    for k, (shape, scale) in enumerate(zip(grains["shape"], grains["scale"], strict=True)):
        vertices = grains["vertices"][grains["vertex_start"][shape] : grains["vertex_start"][shape + 1]] * scale
        faces = grains["faces"][grains["face_start"][shape] : grains["face_start"][shape + 1]]
        spec.add_mesh(name=f"mesh{k}", uservert=vertices.ravel(), userface=faces.ravel())
        body = spec.worldbody.add_body(name=f"grain{k}", pos=grains["position"][k], quat=grains["orientation"][k])
        body.add_freejoint()
        hull = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": f"mesh{k}", "density": float(grains["density"])}
        body.add_geom(**hull, **surface)
    plane = {"type": mujoco.mjtGeom.mjGEOM_PLANE, "size": [1, 1, 1], **surface}
    spec.worldbody.add_geom(**plane)
    radius = 0.5 * float(grains["width"])
    for angle in 2.0 * np.pi * np.arange(PLANES) / PLANES:
        outward = np.array([np.cos(angle), np.sin(angle), 0.0])
        quaternion = np.zeros(4)
        mujoco.mju_quatZ2Vec(quaternion, -outward)  # a plane's normal is its z axis
        spec.worldbody.add_geom(pos=radius * outward, quat=quaternion, **plane)
    model = spec.compile()
    data = mujoco.MjData(model)
    velocity = data.qvel.reshape(-1, 6)
    velocity[:, :3] = grains["velocity"]
    return model, data


def settle(model, data, speed, patience):
    """Step until all are slower than `speed` [m/s] or `patience` [s] is over; return CPU time [s], steps, top speed."""
    began = time.process_time()
    steps, fastest = 0, np.inf
    while data.time < patience:
        mujoco.mj_step(model, data)
        steps += 1
        if steps % 5 == 0 and data.time > 0.1:
            fastest = float(np.linalg.norm(data.qvel.reshape(-1, 6)[:, :3], axis=1).max())
            if fastest < speed:
                break
    return time.process_time() - began, steps, fastest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("grains")
    parser.add_argument("poses")
    parser.add_argument("--step", type=float, default=2e-3, help="time step [s]")
    parser.add_argument("--speed", type=float, default=5e-3, help="largest speed of a grain at rest [m/s]")
    parser.add_argument("--patience", type=float, default=4.0, help="maximum simulated time [s]")
    options = parser.parse_args()
    with np.load(options.grains) as file:
        grains = dict(file)
    began = time.process_time()
    model, data = build(grains, options.step)
    built = time.process_time() - began
    cpu, steps, fastest = settle(model, data, options.speed, options.patience)
    poses = data.qpos.reshape(-1, 7)
    # MuJoCo moves the frame of a mesh to its centre of mass and principal axes, but the frame of the body is ours.
    np.savez(options.poses, position=poses[:, :3], orientation=poses[:, 3:])
    print(
        json.dumps(
            {
                "code": "MuJoCo",
                "version": mujoco.__version__,
                "settings": f"CG, implicitfast, {options.step * 1e3:g} ms, default solref",
                "cpu_s": cpu,
                "build_cpu_s": built,
                "steps": steps,
                "simulated_s": data.time,
                "max_speed": fastest,
            }
        )
    )


if __name__ == "__main__":
    main()

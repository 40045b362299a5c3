"""CPU time of the same polyhedra in YADE.

    yade -n -x -j1 -f1 yade_polyhedra.py BED.npz

Grains, friction, time step, gravity and shaking are the same. The force between YADE's polyhedra is proportional to the
volume of their intersection (CGAL), so the stiffness is ours only for a contact area of 1 mm². Fixed images of the
grains surround the bed, as in mujoco_polyhedra.py. Units are mm, g, s, because YADE's tolerances are absolute. Only few
steps are measured, because they are slow. The 2023.02a of Debian 12 ends in malloc() at 300 faces.
"""

import json
import os
import sys
import time

import numpy as np
from yade import (
    Bo1_Polyhedra_Aabb,
    Bo1_Wall_Aabb,
    ForceResetter,
    Ig2_Polyhedra_Polyhedra_PolyhedraGeom,
    Ig2_Wall_Polyhedra_PolyhedraGeom,
    InsertionSortCollider,
    InteractionLoop,
    Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys,
    Law2_PolyhedraGeom_PolyhedraPhys_Volumetric,
    NewtonIntegrator,
    PolyhedraMat,
    polyhedra_utils,
    utils,
)
from yade.wrapper import Omega

FIRST_STEPS, STEPS, CPU_LIMIT = 2, 200, 20.0  # CPU_LIMIT in s
MM = 1e3  # in a metre
IMAGE = 2  # mask bit of bodies that have no contacts with one another
CONTACT_AREA = 1e-6  # [m²]
NOT_COMPARABLE = [
    "contact law: force by volume of the intersection, without viscous damping (a global damping of 0.3 instead)",
    "fixed images of grains for the periodic sides, each contact with one counted: compare the cost per contact too",
]


def rotate(quaternion, vectors):
    w, axis = quaternion[0], np.asarray(quaternion[1:])
    return vectors + 2.0 * np.cross(axis, np.cross(axis, vectors) + w * vectors)


def hulls(bed):
    """Return the vertices of each grain in world axes, relative to its centre."""
    start = bed["vertex_start"]
    return [
        rotate(quaternion, bed["vertices"][start[shape] : start[shape + 1]] * scale)
        for shape, scale, quaternion in zip(bed["shape"], bed["scale"], bed["orientation"])  # noqa: B905  old Python
    ]


def images(position, radius, width):
    """Yield grain and position of each periodic image whose bounding sphere is within half its radius of a grain's."""
    for shift in [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]:
        for k, place in enumerate(position + width * np.array([*shift, 0.0])):
            if (np.linalg.norm(position - place, axis=1) < 1.5 * radius[k] + radius).any():
                yield k, place


def build(scene, bed):
    corners = hulls(bed)
    radius = np.array([np.linalg.norm(hull, axis=1).max() for hull in corners])
    stiffness = 0.5 * float(bed["density"]) * 1.5e-7 * float(bed["stiffness"])
    material = PolyhedraMat(
        density=1e3 * float(bed["density"]) / MM**3,
        young=1e3 * stiffness / (CONTACT_AREA * MM**2),
        poisson=0.22,
        frictionAngle=float(np.arctan(bed["friction"])),
        IsSplitable=False,
    )

    def add(hull, place):
        body = polyhedra_utils.polyhedra(material, v=[tuple(vertex) for vertex in MM * (hull + place)])
        scene.bodies.append(body)
        return body

    for hull, place, velocity, spin in zip(corners, bed["position"], bed["velocity"], bed["angular_velocity"]):  # noqa: B905
        body = add(hull, place)
        body.state.vel, body.state.angVel = tuple(MM * velocity), tuple(spin)
    for k, place in images(bed["position"], radius, float(bed["width"])):
        image = add(corners[k], place)
        image.dynamic, image.mask = False, IMAGE
    scene.bodies.append(utils.wall(0.0, axis=2, material=material))
    push = float(bed["shaking"]) * 0.5  # the acceleration is constant, because there are few steps
    collider = InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb()], avoidSelfInteractionMask=IMAGE)
    collider.verletDist = 0.1 * MM * float(radius.mean())
    scene.engines = [
        ForceResetter(),
        collider,
        InteractionLoop(
            [Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
            [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
            [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
        ),
        NewtonIntegrator(damping=0.3, gravity=(MM * push, 0, -MM * float(bed["gravity"])), exactAsphericalRot=True),
    ]
    scene.dt = float(bed["time_step"])


def main():
    with np.load(sys.argv[-1]) as file:
        bed = dict(file)
    scene, n = Omega(), len(bed["shape"])
    build(scene, bed)
    scene.run(FIRST_STEPS, True)
    cpu, steps, contacts = 0.0, 0, []
    while steps < STEPS and cpu < CPU_LIMIT:
        began = time.process_time()
        scene.run(1, True)
        cpu += time.process_time() - began
        steps += 1
        real = [i for i in scene.interactions if i.isReal and max(i.id1, i.id2) < len(scene.bodies) - 1]
        contacts.append(len(real) / n)
    result = {
        "code": "YADE",
        "version": "2023.02a or as installed",
        "cpu_us_per_grain_step": cpu / steps / n * 1e6,
        "contacts_per_grain": float(np.mean(contacts)),
        "steps": steps,
        "not_comparable": NOT_COMPARABLE,
    }
    print("\n" + json.dumps(result), flush=True)
    os._exit(0)  # YADE would wait for its prompt at the end


main()

"""CPU time of the same spheres in LIGGGHTS.

    python liggghts_spheres.py BED.npz

The program `liggghts` must be on the PATH. The model is hooke/stiffness with tangential history, with the bed's
stiffness, damping, friction, time step, gravity and shaking; the box is periodic in x and y, with a primitive wall as
floor. The CPU time is that of a run of all steps minus that of a run without steps. Several skins are tried, and the
fastest one is measured.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import tempfile
from pathlib import Path

import numpy as np

SKINS = (0.03, 0.06, 0.12, 0.25)  # in diameters
TRIAL_STEPS, REMEMBERING_STEPS = 2000, 1000
NOT_COMPARABLE = [
    "LIGGGHTS carries more per grain and contact (temperature, wear, cohesion may be switched on) at run time",
    "Debian's program is compiled for any x86-64 and its last version is of 2022, numba for this processor",
]


def write_bed(path, bed, diameter, height):
    n, width = len(bed["position"]), float(bed["width"])
    with open(path, "w", encoding="utf-8") as file:
        print(f"bed\n\n{n} atoms\n2 atom types\n", file=file)
        print(f"0 {width!r} xlo xhi\n0 {width!r} ylo yhi\n{-diameter!r} {height!r} zlo zhi\n\nAtoms\n", file=file)
        for k, place in enumerate(bed["position"]):
            print(k + 1, 1, repr(diameter), float(bed["density"]), *map(repr, map(float, place)), file=file)
        print("\nVelocities\n", file=file)
        for k, motion in enumerate(np.hstack([bed["velocity"], bed["angular_velocity"]])):
            print(k + 1, *map(repr, map(float, motion)), file=file)


def script(bed, diameter, skin, steps, folder):
    mass = float(bed["density"]) * np.pi / 6 * diameter**3
    stiffness, damping = 0.5 * mass * float(bed["stiffness"]), float(bed["damping"])
    kt, gt = float(bed["tangential"]), float(bed["root_tangential"])
    friction = float(bed["friction"])

    def pairs(grains, wall):
        return f"{grains!r} {wall!r} {wall!r} {grains!r}"  # types: grain, wall

    return f"""
        units si
        atom_style granular
        atom_modify map array
        boundary p p f
        newton off
        communicate single vel yes
        read_data {folder}/bed.data
        neighbor {skin!r} bin
        neigh_modify every 1 delay 0 check yes
        fix kn all property/global kn peratomtypepair 2 {pairs(stiffness, 2 * stiffness)}
        fix kt all property/global kt peratomtypepair 2 {pairs(kt * stiffness, 2 * kt * stiffness)}
        fix gn all property/global gamman peratomtypepair 2 {pairs(damping, damping)}
        fix gt all property/global gammat peratomtypepair 2 {pairs(gt * damping, gt * damping)}
        fix xmu all property/global coefficientFriction peratomtypepair 2 {pairs(friction, friction)}
        pair_style gran model hooke/stiffness tangential history
        pair_coeff * *
        timestep {float(bed["time_step"])!r}
        variable push equal {float(bed["shaking"])!r}*sin({float(bed["shaking_rate"])!r}*step*dt)
        fix down all gravity {float(bed["gravity"])!r} vector 0 0 -1
        fix shake all gravity v_push vector 1 0 0
        fix floor all wall/gran model hooke/stiffness tangential history primitive type 2 zplane 0
        fix move all nve/sphere
        compute touching all contact/atom
        compute all_touching all reduce sum c_touching
        compute rotation all erotate/sphere
        variable touching equal c_all_touching
        variable energy equal ke+c_rotation
        thermo_style custom step ke c_all_touching c_rotation
        thermo {max(steps // 10, 1)}
        run {REMEMBERING_STEPS}
        run {steps}
    """


def run(program, bed, diameter, skin, steps):
    """Return CPU time [s] of a call of the program; rows of step, energy, contacts and rotational energy; version."""
    height = float(bed["position"][:, 2].max()) + 10 * diameter
    with tempfile.TemporaryDirectory() as folder:
        write_bed(f"{folder}/bed.data", bed, diameter, height)
        Path(folder, "in.bed").write_text(script(bed, diameter, skin, steps, folder), encoding="utf-8")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [program, "-in", "in.bed", "-log", "none"]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"}
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode or "ERROR" in done.stdout:
        raise RuntimeError(done.stdout[-2000:] + done.stderr[-2000:])
    version = re.search(r"Version ([^,)]*)", done.stdout)[1]
    rows = [line.split() for line in done.stdout.splitlines() if re.fullmatch(r"\s*\d+(\s+[-+.e\d]+){3}\s*", line)]
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, np.array(rows, float), version


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bed")
    parser.add_argument("--program", default="liggghts")
    options = parser.parse_args()
    with np.load(options.bed) as file:
        bed = dict(file)
    radius = bed["scale"][:, 0]
    diameter, n, steps = 2.0 * float(radius.mean()), len(radius), int(bed["steps"])
    if np.ptp(radius) > 1e-6 * diameter:
        raise ValueError("hooke/stiffness has one stiffness for all pairs: give a bed of equal spheres")
    trials = {}
    for skin in SKINS:
        base = run(options.program, bed, diameter, skin * diameter, 0)[0]
        spent = run(options.program, bed, diameter, skin * diameter, TRIAL_STEPS)[0] - base
        trials[skin] = spent / TRIAL_STEPS / n * 1e6
    skin = min(trials, key=trials.get)
    base = run(options.program, bed, diameter, skin * diameter, 0)[0]
    cpu, rows, version = run(options.program, bed, diameter, skin * diameter, steps)
    rows = rows[rows[:, 0] > REMEMBERING_STEPS]
    print(
        json.dumps(
            {
                "code": "LIGGGHTS",
                "version": version,
                "cpu_us_per_grain_step": (cpu - base) / steps / n * 1e6,
                "contacts_per_grain": float(rows[:, 2].mean()) / 2 / n,
                "kinetic_energy_per_grain": float((rows[:, 1] + rows[:, 3]).mean()) / n,
                "steps": steps,
                "settings": f"skin {skin:g} of the diameter",
                "trials": {str(skin): round(value, 4) for skin, value in trials.items()},
                "not_comparable": NOT_COMPARABLE,
            }
        )
    )


if __name__ == "__main__":
    main()

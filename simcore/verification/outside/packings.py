"""Specifications and seeds of the verification packings. A specification has the keys that a user would write."""

from typing import NamedTuple

from simcore.verification.outside.solids import SOLIDS


class Seeds(NamedTuple):
    """A specification without name and seed, and the seeds with which it is simulated."""

    specification: dict
    seeds: tuple[int, ...]


def _laid_over(base, *changes):
    """Return the groups of `base`, where the keys in `changes` override those in `base`."""
    merged = {name: dict(group) if isinstance(group, dict) else group for name, group in base.items()}
    for change in changes:
        for name, group in change.items():
            merged[name] = {**merged.get(name, {}), **group} if isinstance(group, dict) else group
    return merged


def _equal(diameter):
    """Return the sizes of equal grains: one sieve class of relative width 1e-6. diameter [mm]."""
    return {"bounds": [f"{diameter:g} mm", f"{diameter * (1.0 + 1e-6):.8g} mm"], "mass_fractions": [1.0]}


# At a contact time of 0.5 ms, spheres of 7 mm in a bed 10 diameters high overlap by less than 1e-3 of their diameter.
# The criteria of rest are stricter than by default, because smooth beds continue to settle under very small forces.
SPHERES = {
    "domain": {"width": "49 mm", "height": "0.4 m"},
    "shapes": {"kind": "sphere"},
    "sizes": _equal(7.0),
    "amount": {"grains": 900},
    "shaking": {"duration": "1 s"},
    "convergence": {"max_speed": "1 mm/s", "max_unbalanced_force": 0.01},
    "numerics": {"contact_time": "0.5 ms"},
}
SMOOTH, ROUGH, BEADS = ({"material": {"friction": friction}} for friction in (0.0, 0.5, 0.2))
# In a periodic box the shaking force moves a smooth bed as a whole and does not shake it; a cylinder prevents this.
POURED = {"shaking": {"amplitude": "0 m", "duration": "0 s"}}


def _cylinder(ratio, grains):
    domain = {"type": "cylinder", "width": f"{7.0 * ratio:g} mm"}
    return {"domain": domain, "amount": {"grains": grains}}


# Grains are inserted one at a time, at random places in the tube. Contacts are stiff, so that the weight of 30 spheres
# shortens the column by less than a thousandth of a diameter per sphere.
COLUMN = {
    "amount": {"grains": 30},
    "generation": {"placement": "random", "batch_grains": 1},
    "convergence": {"max_speed": "0.1 mm/s", "max_unbalanced_force": 1e-3, "height_change": "1e-7 m"},
    "numerics": {"contact_time": "0.1 ms"},
}


def _bidisperse(coarse_share, grains):
    """Return changes for spheres of 8 and 4 mm in a box four coarse diameters wide; coarse_share: of the volume."""
    return {
        "domain": {"width": "32 mm"},
        "sizes": {
            "bounds": ["4 mm", "4.000004 mm", "8 mm", "8.000008 mm"],
            "mass_fractions": [round(1.0 - coarse_share, 2), 0.0, coarse_share],
        },
        "amount": {"grains": grains},
    }


# The edge length of the meshes has no effect, because sizes come from the sieve. Tetrahedra need shorter steps, because
# their contacts are far from the centre and their corners are light; therefore there are fewer of them.
DICE = {
    "domain": {"width": "60 mm", "height": "0.5 m"},
    "shapes": {"kind": "polyhedron", "choice": "random"},
    "faces": "original",
    "sizes": _equal(10.0),
    "amount": {"grains": 300},
    "generation": {"orientation": "random"},
    "shaking": {"duration": "1 s"},
    "convergence": {"max_speed": "5 cm/s", "max_unbalanced_force": 0.2},
    "numerics": {"contact_time": "1 ms", "steps_per_contact_time": 14, "dashpot": "implicit"},
}
TETRAHEDRA = {
    "domain": {"width": "50 mm"},
    "amount": {"grains": 200},
    "numerics": {"steps_per_contact_time": 70},
}

# Energy is conserved: no friction, full restitution, no shaking. The grains never come to rest and are only stepped.
ELASTIC = {
    "domain": {"width": "35 mm", "height": "1 m"},
    "amount": {"grains": 64},
    "material": {"restitution": 1.0},
    "generation": {"velocity_z": "0 m/s"},
    "numerics": {"contact_time": "1 ms"},
}

PACKINGS = {
    "smooth_spheres_shaken": Seeds(_laid_over(SPHERES, SMOOTH, _cylinder(12, 1430)), (1, 2)),
    "smooth_spheres_poured": Seeds(_laid_over(SPHERES, SMOOTH, POURED), (1, 2, 3)),
    "frictional_spheres_poured": Seeds(_laid_over(SPHERES, ROUGH, POURED), (1, 2, 3)),
    "frictional_spheres_shaken": Seeds(_laid_over(SPHERES, ROUGH), (1, 2, 3)),
    "column_1.3": Seeds(_laid_over(SPHERES, SMOOTH, _cylinder(1.3, 30), COLUMN), (1, 2)),
    "column_1.5": Seeds(_laid_over(SPHERES, SMOOTH, _cylinder(1.5, 30), COLUMN), (1, 2)),
    "column_1.7": Seeds(_laid_over(SPHERES, SMOOTH, _cylinder(1.7, 30), COLUMN), (1, 2)),
    "cylinder_3": Seeds(_laid_over(SPHERES, BEADS, _cylinder(3, 110)), (1, 2, 3)),
    "cylinder_5": Seeds(_laid_over(SPHERES, BEADS, _cylinder(5, 260)), (1, 2, 3)),
    "cylinder_8": Seeds(_laid_over(SPHERES, BEADS, _cylinder(8, 690)), (1, 2)),
    **{
        f"bidisperse_{share:.2f}": Seeds(_laid_over(SPHERES, SMOOTH, POURED, _bidisperse(share, grains)), (1, 2, 3))
        for share, grains in ((0.30, 1220), (0.50, 930), (0.70, 640), (0.85, 430))
    },
    "elastic_spheres": Seeds(_laid_over(SPHERES, SMOOTH, POURED, ELASTIC), (1, 2, 3)),
    **{
        f"dice_{solid}": Seeds(_laid_over(DICE, TETRAHEDRA if solid == "tetrahedron" else {}), (1, 2))
        for solid in SOLIDS
    },
}
_RUNS = {f"{name}_seed{seed}": name for name, packing in PACKINGS.items() for seed in packing.seeds}
ELASTIC_RUNS = [run for run, name in _RUNS.items() if name == "elastic_spheres"]
PACKED = [run for run in _RUNS if run not in ELASTIC_RUNS]


def specification(run: str, dice: str) -> dict:
    """Return the specification of a run, such as "column_1.5_seed2", as it would be read from YAML.

    dice: folder with the meshes of the solids, such as cube.obj in mm. KeyError for an unknown run.
    """
    name = _RUNS[run]
    seed = int(run.rpartition("_seed")[2])
    raw = {"name": run, "seed": seed, **_laid_over(PACKINGS[name].specification)}
    if name.startswith("dice_"):
        raw["grains"] = {"source": f"{dice}/{name.removeprefix('dice_')}.obj", "unit": "mm"}
    return raw

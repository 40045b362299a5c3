"""Whether the long axes of a deposit prefer an azimuth by chance, because neighbours align, or because of the box.

    python -m benchmarks.studies.azimuths FOLDER [--seeds 12]

Rayleigh's test in simcore.evaluation.fabric assumes independent azimuths φ. For n of them with the resultant
R = |<exp(2iφ)>|, the mean of n R² is 1 and p = exp(-n R²). If azimuths are correlated, the mean of n R² is the variance
factor c = 1 + Σ cos 2(φ_i - φ_j) / n over all ordered pairs of grains, and p^(1/c) is the correct p-value. The command
prints four tables:

deposits    small deposits of each of FORMS. n_R2: c of all pairs, over the deposits. near_<radius>: c of the pairs with
            centres nearer than each of RADII. pull: number of standard errors by which the sum over the pairs nearer
            than NEAREST exceeds that of permuted azimuths. thirds: correlation of the resultants of the lowest and the
            highest third of the bulk, in the unit of c; it is 0 unless the whole bed has a common direction.
directions  Rayleigh's test of the preferred azimuths of these deposits: p-values against one fixed direction, and
            against the walls or the diagonals of the box
inserted    the mean of cos 2φ of the short axes and its standard error, over deposits of flat grains (FLAT), which have
            the settings of deposit_bridge in config/deposits.yaml. Upright grains start with their short axes along x,
            where cos 2φ = 1.
committed   c of the rows of results/reference/deposits.csv, which is the mean of -ln p: of all rows, and of the halves
            with smaller and larger a/c; the number of rows with p < 0.05; and the number with p^(1/c) < 0.05, for c of
            the long axes of the small deposits within PREDICTED diameters

FOLDER stores the deposits. Those that it lacks are packed, in 5 to 18 s of CPU time each. The small deposits have the
settings of deposit_map in the same file, except 600 grains in a box of 40 mm and a Young's modulus of 5 MPa.
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
import yaml
from scipy.spatial import cKDTree

from simcore.campaign.deposits import read_deposits
from simcore.evaluation.axis_statistics import grain_axes, rayleigh_test
from simcore.evaluation.bulk_region import bulk
from simcore.grains.form import equal_volume_diameter
from simcore.packing.file import read_packing, write_packing
from simcore.packing.single import pack
from simcore.paths import CONFIG, REFERENCE

FORMS = ((1.4, 1.0), (1.6, 1.6))  # eta and zeta: the rounder one is a prolate spheroid
FIRST_SEED = 101  # the committed deposits have seeds up to 10
FLAT, FLAT_SEEDS = (1.0, 2.5), range(11, 19)
RADII = (1.5, 2.0, 2.5, 3.0)  # in diameters of the sphere of a grain's volume
NEAREST, PREDICTED = 1.5, 2.5  # both are in RADII
LEVEL = 0.05
KINDS = ("long_axis", "contact_normal")
FOLDS = (2, 4)


def bed(folder, study, seed, name, changes):
    """Return the deposit of a study with a seed and changes of its settings, read from the folder or packed into it."""
    path = Path(folder) / f"{study}_{name}_seed_{seed}.nc"
    if not path.exists():
        fixes = yaml.safe_load((CONFIG / "deposits.yaml").read_text(encoding="utf-8"))["studies"][study]["fixes"]
        # Hertzian contacts have no contact time of their own, which a single packing refuses.
        fixes.get("numerics", {}).pop("contact_time", None)
        own = {key: fixes.get(key, {}) | values for key, values in changes.items()}
        write_packing(path, pack(fixes | own | {"name": path.stem, "seed": seed}))
    return read_packing(path)


def small_bed(folder, eta, zeta, seed):
    """Return a small deposit of this form, inserted in random directions."""
    changes = {
        "domain": {"type": "periodic", "width": "40 mm"},
        "amount": {"grains": 600},
        "shapes": {"eta": eta, "zeta": zeta},
        "material": {"youngs_modulus": "5 MPa"},
    }
    return bed(folder, "deposit_map", seed, f"{eta}_{zeta}", changes)


def flat_bed(folder, orientation, seed):
    """Return a deposit of FLAT grains by the process of Rettinger et al., inserted with this orientation."""
    changes = {
        "domain": {"type": "periodic"},
        "shapes": {"eta": FLAT[0], "zeta": FLAT[1]},
        "shaking": {"amplitude": "0 mm", "duration": "0 s"},
        "generation": {"orientation": orientation},
    }
    return bed(folder, "deposit_bridge", seed, orientation, changes)


def axes_of(packing, kind):
    """Return the places (n, 3), in diameters, and exp(2iφ) (n,) of the grains in the bulk, and the box's width."""
    axes, grains = grain_axes(packing)[kind]
    inner = bulk(packing).grains[grains]
    axes, grains = axes[inner], grains[inner]
    diameter = equal_volume_diameter(float(packing["volume"].mean()))
    doubled = np.exp(2j * np.arctan2(axes[:, 1], axes[:, 0]))
    return packing["position"].values[grains] / diameter, doubled, packing.attrs["domain_width"] / diameter


def alignment(places, doubled, width):
    """Return statistics of one bed in a periodic box, dict.

    places (n, 3) and width in diameters; doubled (n,): exp(2iφ). azimuth: the preferred one [rad]. The others are
    described in the module; thirds is n Re(R_low R_high*), with n the geometric mean of the numbers of grains.
    """
    n, mean = len(doubled), doubled.mean()
    values = {"grains": n, "n_R2": n * np.abs(mean) ** 2, "azimuth": 0.5 * np.angle(mean) % np.pi}
    places = places - [0.0, 0.0, places[:, 2].min()]
    places[:, :2] %= width
    high = 2.0 * places[:, 2].max() + 2.0 * max(RADII)  # a period that no pair crosses
    tree = cKDTree(places, boxsize=[width, width, high])
    for radius in RADII:
        i, j = tree.query_pairs(radius, output_type="ndarray").T
        total = (doubled[i] * doubled[j].conj()).real.sum()
        values[f"near_{radius:g}"] = 1.0 + 2.0 * total / n
        if radius == NEAREST:
            permuted = len(i) * (values["n_R2"] - 1.0) / (n - 1)  # mean over all orders of the azimuths
            values["pull"] = (total - permuted) / np.sqrt(0.5 * len(i))
    below, above = np.quantile(places[:, 2], [1 / 3, 2 / 3])
    low, top = doubled[places[:, 2] <= below], doubled[places[:, 2] > above]
    values["thirds"] = np.sqrt(len(low) * len(top)) * (low.mean() * top.mean().conj()).real
    return values


def form_row(eta, zeta, beds):
    """Return the row of a form. beds: DataFrame of `alignment`, one row per deposit."""
    k = len(beds)
    row = {"eta": eta, "zeta": zeta, "beds": k, "grains": beds["grains"].sum()}
    for name in ("n_R2", *(f"near_{radius:g}" for radius in RADII), "thirds"):
        row[name], row[f"{name}_error"] = beds[name].mean(), beds[name].std(ddof=1) / np.sqrt(k)
    return row | {"pull": beds["pull"].sum() / np.sqrt(k)}


def directions(azimuths):
    """Return the p-values of the preferred azimuths (k,) for one fixed direction, and for walls or diagonals."""
    return [rayleigh_test(np.abs(np.exp(1j * fold * azimuths).mean()), len(azimuths)) for fold in FOLDS]


def inserted(folder):
    """Return the mean of cos 2φ of the short axes over the flat deposits, DataFrame: one row per orientation."""
    table = []
    for orientation in ("upright", "random"):
        beds = [axes_of(flat_bed(folder, orientation, seed), "short_axis")[1].mean().real for seed in FLAT_SEEDS]
        error = np.std(beds, ddof=1) / np.sqrt(len(beds))
        table.append({"inserted": orientation, "beds": len(beds), "cos_2phi": np.mean(beds), "cos_2phi_error": error})
    return pd.DataFrame(table)


def committed(factor):
    """Return c of the committed p-values, DataFrame with one row per direction and fold; factor: see the module."""
    rows = read_deposits(REFERENCE / "deposits.csv")
    rows = rows[rows["eta"] * rows["zeta"] > 1.0]  # without spheres
    table = []
    for kind in KINDS:
        for fold in FOLDS:
            ours = rows.dropna(subset=[f"azimuth_p{fold}_{kind}"])
            n_R2, ratio = -np.log(ours[f"azimuth_p{fold}_{kind}"]), ours["eta"] * ours["zeta"]
            row = {"direction": kind, "fold": fold, "rows": len(ours), "c": n_R2.mean()}
            row["c_error"] = n_R2.std(ddof=1) / np.sqrt(len(ours))
            row["c_rounder"] = n_R2[ratio < ratio.median()].mean()
            row["c_longer"] = n_R2[ratio >= ratio.median()].mean()
            row["below"] = int((n_R2 > -np.log(LEVEL)).sum())
            row["below_corrected"] = int((n_R2 / factor > -np.log(LEVEL)).sum())
            table.append(row)
    return pd.DataFrame(table)


def main() -> None:
    """Print the four tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="folder of the deposits")
    parser.add_argument("--seeds", type=int, default=12, help="number of deposits of each form")
    args = parser.parse_args()
    Path(args.folder).mkdir(parents=True, exist_ok=True)
    parts = []
    for eta, zeta in FORMS:
        seeds = range(FIRST_SEED, FIRST_SEED + args.seeds)
        rows = [alignment(*axes_of(small_bed(args.folder, eta, zeta, seed), "long_axis")) for seed in seeds]
        parts.append(pd.DataFrame(rows).assign(eta=eta, zeta=zeta))
    beds = pd.concat(parts, ignore_index=True)
    table = pd.DataFrame([form_row(*form, group) for form, group in beds.groupby(["eta", "zeta"])])
    print(table.T.to_string(header=False, float_format="%.3f"))
    print("directions: one p = {:.3f}, walls or diagonals p = {:.3f}".format(*directions(beds["azimuth"].to_numpy())))
    print(inserted(args.folder).to_string(index=False, float_format="%.3f"))
    print(committed(table[f"near_{PREDICTED:g}"].mean()).to_string(index=False, float_format="%.2f"))


if __name__ == "__main__":
    main()

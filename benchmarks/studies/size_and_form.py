"""The beds of the study size_and_form before they are packed: what each represents and what it costs.

    python -m benchmarks.studies.size_and_form [--study size_and_form]

It reads config/size_and_form.yaml and prints a line for each bed, in the order of the pieces: its sieve curve, family
and form; grains; expected number of grains in the coarsest class and the share of the mass there; width and depth of
the bed in largest grains; effective number of grains of the evaluated part, V / <v> with the solid volume V and the
mean volume <v> of a grain by volume; expected sampling error of the porosity; CPU hours as `snakemake -n` estimates
them, of the bed and of all beds up to it.
"""

import argparse

import numpy as np
import pandas as pd
import yaml

from simcore.campaign.estimates import number_pieces
from simcore.campaign.studies import expand, merge
from simcore.packing.cost import estimate
from simcore.packing.forecast import forecast, typical_grains
from simcore.paths import CONFIG
from simcore.scene.domain import Domain
from simcore.scene.sizes import all_cases, size_curve
from simcore.scene.specification import resolve

STUDY = "size_and_form"


def planned(study=STUDY):
    """Return the resolved specifications of the study's beds, dict by name of the packing, in the order of the file."""
    files = [yaml.safe_load((CONFIG / name).read_text(encoding="utf-8")) for name in ("config.yaml", f"{STUDY}.yaml")]
    plan = expand(resolve(merge(*files), "config"))
    plan = plan[plan["study"] == study]
    return dict(zip(plan["packing"], plan["specification"], strict=True))


def describe(specification):
    """Return one row of the table as a dict."""
    case, shapes = specification["sizes"]["case"], specification["shapes"]
    curve, cost = size_curve(specification["sizes"]), estimate(specification)
    domain, grains = Domain(**specification["domain"]), typical_grains(specification)
    bed = forecast(domain, grains)
    evaluated = bed.solid_fraction * domain.area * bed.evaluated
    return {
        "curve": case,
        "family": all_cases()[case].family,
        "form": "sphere" if shapes["kind"] == "sphere" else shapes["grain"] or "all",
        "seed": specification["seed"],
        "grains": cost.grains,
        "top_grains": round(cost.grains * float(curve.number_fractions()[curve.mass_fractions > 0][-1])),
        "top_share": float(curve.mass_fractions[curve.mass_fractions > 0][-1]),
        "width": domain.width / curve.largest,
        "depth": bed.height / curve.largest,
        "effective": round(evaluated / grains.mean_volume),
        "error": bed.sampling_error,
        "cpu_h": cost.cpu_seconds / 3600.0,
    }


def beds_table(study=STUDY):
    """Return one row per bed, in the order of the pieces."""
    table = pd.DataFrame([describe(specification) for specification in planned(study).values()])
    order = np.argsort(number_pieces(table["cpu_h"].to_numpy(), table["seed"].to_numpy(), 1e-9))
    table = table.iloc[order].reset_index(drop=True)
    return table.assign(cpu_h_sum=table["cpu_h"].cumsum())


def main(arguments=None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--study", default=STUDY)
    table = beds_table(parser.parse_args(arguments).study)
    print(table.to_string(float_format=lambda value: f"{value:.3g}"))


if __name__ == "__main__":
    main()

"""The pictures of the documentation: which rows or scripts each shows, and whether it is older than these.

    python -m docs.generate.pictures                 # lists the pictures that are older than what they show
    python -m docs.generate.pictures NAME.png ...    # draws pictures again
    python -m docs.generate.pictures --keep NAME.png # keeps a picture whose sources changed without effect on it

pictures.yaml lists all pictures in docs/ with their sources and the digest that these had when the picture was drawn. A
test fails if a source has changed since.
"""

import argparse
import functools
import hashlib
import operator
import subprocess
import sys
from pathlib import Path

import pandas as pd
import yaml

from simcore.paths import CONFIG, REFERENCE, ROOT

DOCS = ROOT / "docs"
MANIFEST = Path(__file__).with_name("pictures.yaml")
_HEAD = """# The pictures in docs/: what each shows, and the digest of that when it was drawn.
# `python -m docs.generate.pictures NAME.png` draws one and updates its digest; see docs/generate/pictures.py.
"""


def manifest():
    """Return the entries of all pictures: dict from the path below docs/ to dict with sources, digest and command."""
    return yaml.safe_load(MANIFEST.read_text(encoding="utf-8"))


def source_digest(entry):
    """Return the digest of the contents of an entry's sources, which are paths in the clone.

    The code that a script imports does not count: nearly every commit changes some of it, and hardly any a picture.
    """
    total = hashlib.sha256()
    for name in entry["sources"]:
        total.update(f"{name}\n".encode() + (ROOT / name).read_bytes())
    return total.hexdigest()[:16]


def outdated():
    """Return the names of the pictures whose sources have changed since they were drawn."""
    return [name for name, entry in manifest().items() if source_digest(entry) != entry["digest"]]


def draw(name):
    """Draw a picture again from its sources, by its command or by the function in DRAWN."""
    entry = manifest()[name]
    if "command" in entry:
        subprocess.run([sys.executable, *entry["command"].split()[1:]], cwd=ROOT, check=True)
    elif name not in drawn():
        raise SystemExit(f"{name} is drawn by hand: {entry['by_hand']} Then run this command with --keep.")
    else:
        from simcore.report.figures.saving import save_figure

        save_figure(drawn()[name](), DOCS / name)


def keep(name):
    """Store the digest that the sources of a picture have now."""
    entries = manifest()
    entries[name]["digest"] = source_digest(entries[name])
    text = yaml.safe_dump(entries, sort_keys=False, allow_unicode=True, width=120)
    MANIFEST.write_text(_HEAD + text, encoding="utf-8")


def _deposits():
    from simcore.campaign.deposit_findings import findings
    from simcore.campaign.deposits import read_deposits
    from simcore.report.figures.deposits import forms_figure

    rows = read_deposits(REFERENCE / "deposits.csv")
    return forms_figure(rows, findings(rows)["maxima"])


def _model():
    from simcore.report.committed import findings

    return findings(REFERENCE)[1]["single_form_features_synthetic"]


def _packing():
    from simcore.packing.single import pack
    from simcore.report.figures.packings import packing_figure

    return packing_figure(pack(ROOT / "examples" / "polyhedra.yaml", force=True))


def _verification():
    from simcore.report.figures.outside import outside_figure

    return outside_figure(pd.read_csv(REFERENCE / "verification_packings.csv"))


def _work_precision():
    from simcore.campaign.plan import Plan
    from simcore.report.figures.work_precision import work_precision_figure
    from simcore.scene.specification import resolve
    from simcore.verification.packings import work_precision_of_studies

    errors = pd.read_csv(REFERENCE / "work_precision" / "packings.csv")
    texts = [(CONFIG / name).read_text(encoding="utf-8") for name in ("config.yaml", "work_precision.yaml")]
    campaign, overlay = map(yaml.safe_load, texts)
    campaign = resolve({**campaign, "studies": overlay["studies"]}, "config")
    names = list(dict.fromkeys(errors["study"]))
    plan = Plan(campaign)
    rows = [list(plan.of(name).row) for name in names]
    titles = {name: campaign["studies"][name]["title"] for name in names}
    runs = work_precision_of_studies(errors, names, titles, rows)
    labels = {"porosity": "error of the\nporosity [-]"}
    note = errors["machine"].iloc[0]
    return work_precision_figure(
        runs, "CPU time of a packing", labels, "setting", micro=False, note=note, name_all=True
    )


# Pictures that are drawn from committed rows, or from a small packing.
DRAWN = {
    "deposits.png": _deposits,
    "model.png": _model,
    "packing.png": _packing,
    "verification.png": _verification,
    "work_precision.png": _work_precision,
}


def drawn():
    """Return the functions that draw a picture: dict from its path below docs/ to a function that returns a Figure."""
    from docs.generate import (
        curve_pictures,
        deposit_pictures,
        grain_pictures,
        porosity_pictures,
        time_step,
        wide_pictures,
    )

    modules = (curve_pictures, deposit_pictures, grain_pictures, porosity_pictures, time_step, wide_pictures)
    return functools.reduce(operator.or_, (module.FIGURES for module in modules), DRAWN)


def main(arguments=None):
    """Draw the pictures that are named, or list those that are older than their sources; 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME.png", help="pictures to draw, by their path below docs/")
    parser.add_argument("--keep", action="store_true", help="store the digest of the sources without drawing")
    options = parser.parse_args(arguments)
    if unknown := sorted(set(options.names) - set(manifest())):
        parser.error(f"{', '.join(unknown)}: there is no such picture in {MANIFEST.name}; add an entry for it")
    for name in options.names:
        if not options.keep:
            draw(name)
        keep(name)
    if not options.names:
        for name in outdated():
            print(f"{name} is older than what it shows; draw it with: python -m docs.generate.pictures {name}")
    return int(not options.names and bool(outdated()))


if __name__ == "__main__":
    sys.exit(main())

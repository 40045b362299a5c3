"""A configuration still lists the packing of every committed row, with the settings that it was packed with."""

import functools
import os
from pathlib import Path

import pandas as pd
import pytest
import yaml

from benchmarks.studies import bed_size
from docs.generate import results
from simcore.campaign.studies import expand, merge
from simcore.grains.spherical_harmonics import read_coefficients
from simcore.paths import CONFIG, REFERENCE, ROOT
from simcore.scene.identity import result_digest
from simcore.scene.specification import resolve

# Grains that are not part of the clone: their rows need a folder of this name, which need not contain them.
ELSEWHERE = {"scans", "rhine"}
ABOVE = REFERENCE / "born_above_bed"
SCANS = Path(os.environ.get("SCREE_SHARED", "/work/shared")) / "grains" / "scans"


@functools.cache
def packings(overlays, studies, source=None):
    """Return the packings of some studies, with the files merged over each other in Snakemake's order."""
    names = (*overlays, "config.yaml", "work_precision.yaml", *overlays)
    raw = [yaml.safe_load((CONFIG / name).read_text(encoding="utf-8")) for name in names]
    grains = {"grains": {"source": str(source), "unit": "mm"}} if source else {}
    config = resolve(merge(*raw, grains), "config")
    config["studies"] = {name: config["studies"].get(name) for name in studies}
    return expand(config)


def digests(*arguments):
    """Return the digests of their settings as a dict by study and packing."""
    return {(row.study, row.packing): result_digest(row.specification) for row in packings(*arguments).itertuples()}


def compare(rows, overlays, source=None):
    """Return the rows of a ledger that a configuration lists with other settings, or does not list."""
    listed = digests(overlays, tuple(sorted(set(rows.study))), source)
    return [
        (row.study, row.packing) for row in rows.itertuples() if listed.get((row.study, row.packing)) != row.settings
    ]


def gathered():
    """Return the rows of gathered.csv by the overlays of their command and their source of grains."""
    commands = pd.read_csv(REFERENCE / "collected.csv").dropna(subset="command")[["study", "source", "command"]]
    ledger = pd.read_csv(REFERENCE / "gathered.csv", dtype={"settings": str}).merge(commands, on=["study", "source"])
    groups = []
    for (command, source), rows in ledger.groupby(["command", "source"]):
        files = command.split("; ")[0].removeprefix("snakemake --configfile ").split()
        groups.append(pytest.param(rows, tuple(Path(file).name for file in files), source, id=f"{files[-1]}-{source}"))
    return groups


PUBLISHED = {"beard_weyl_1973.csv"}  # read in publications of others than Rettinger et al., with the source of each row


def test_every_table_that_is_not_published_has_a_command():
    of_campaigns = results.commands()
    for path in results.committed_tables():
        if not path.startswith("r22/") and path not in PUBLISHED:
            assert results.sentences()[path].get("command") or of_campaigns.get(path), path


def test_every_row_of_the_ledger_has_a_command():
    ledger, summary = (pd.read_csv(REFERENCE / f"{name}.csv") for name in ("gathered", "collected"))
    assert len(ledger) > 800
    counted = ledger.groupby(["study", "source"]).size()
    summary = summary.dropna(subset="command").set_index(["study", "source"])
    assert summary.packings[counted.index].to_dict() == counted.to_dict()


@pytest.mark.parametrize(("rows", "overlays", "source"), gathered())
def test_a_configuration_lists_each_gathered_row_with_its_settings(rows, overlays, source, tmp_path):
    folder = tmp_path / source
    folder.mkdir()
    assert compare(rows, overlays, folder if source in ELSEWHERE else None) == []


OVERLAYS = [
    ("deposits.yaml",), ("deposits.yaml", "deposits_large.yaml"), ("differences.yaml",), ("insertion_rate.yaml",),
    ("size_and_form.yaml",), ("wide.yaml",), ("workstation.yaml",), ("r22.yaml",), ("bed_size.yaml",),
]  # fmt: skip


@pytest.mark.parametrize("overlays", OVERLAYS, ids=lambda overlays: overlays[-1])
def test_no_campaign_replaces_a_committed_row_by_one_of_other_settings(overlays):
    """A row is replaced by one of the same study and packing, so these must not mean another bed in another file."""
    folder = merge(*(yaml.safe_load((CONFIG / name).read_text(encoding="utf-8")) for name in overlays)).get("reference")
    ledger = Path(folder or "none") / "gathered.csv"
    rows = pd.read_csv(ROOT / ledger, dtype={"settings": str}) if (ROOT / ledger).exists() else None
    if rows is None:
        assert folder != "results/reference"
        return
    named = rows.set_index(["study", "packing"]).settings.groupby(level=[0, 1]).agg(set)
    listed = digests(overlays, tuple(sorted(set(rows.study))))
    assert [key for key, digest in listed.items() if key in named.index and digest not in named[key]] == []


def test_beds_inserted_above_the_bed_are_those_of_their_configuration(tmp_path):
    ledger = pd.read_csv(ABOVE / "gathered.csv", dtype={"settings": str})
    own = ledger[ledger.source == "synthetic"]
    overlays = ("inserted_above_bed.yaml",)
    assert compare(own, overlays) == []
    listed = packings(overlays, tuple(sorted(set(own.study))))
    assert listed.groupby("study").size().to_dict() == own.groupby("study").size().to_dict()
    (tmp_path / "scans").mkdir()
    assert compare(ledger[ledger.source == "scans"], overlays, tmp_path / "scans") == []
    tables = {"single_form": 134, "form_mixture": 52, "application": 8, "near_spheres": 22, "validation": 5}
    assert {name: len(pd.read_csv(ABOVE / f"{name}.csv")) for name in tables} == tables
    assert len(ledger) == sum(tables.values())
    named = {
        path: entry["command"] for path, entry in results.sentences().items() if path.startswith("born_above_bed/")
    }
    assert len(named) == 6 and all("config/inserted_above_bed.yaml" in command for command in named.values())


def test_the_rows_of_accuracy_are_settings_of_its_studies():
    listed = packings((), ("accuracy", "accuracy_changed"))
    varied = pd.DataFrame([row["varied"] for row in listed.row]).assign(study=listed.study)
    rows = pd.read_csv(REFERENCE / "accuracy.csv")
    presets = varied[varied.study == "accuracy"]
    assert set(zip(rows.accuracy, rows.seed, strict=True)) == set(zip(presets.accuracy, presets.seed, strict=True))
    keys = ["accuracy", "contact_time_s", "polyhedron_contact", "max_unbalanced_force", "faces", "seed"]
    rows = pd.read_csv(REFERENCE / "accuracy_changed.csv")
    merged = rows.merge(varied[varied.study == "accuracy_changed"], on=keys)
    assert len(merged) == len(rows) == 34 and not rows[keys].duplicated().any()


def test_the_rows_behind_the_effects_of_settings_are_the_packings_of_their_studies():
    rows = pd.read_csv(REFERENCE / "work_precision" / "rows.csv")
    listed = packings((), tuple(sorted(set(rows.study))))
    assert set(zip(rows.study, rows.packing, strict=True)) == set(zip(listed.study, listed.packing, strict=True))
    config = yaml.safe_load((CONFIG / "work_precision.yaml").read_text(encoding="utf-8"))
    assert set(rows.study) == {study for study in config["studies"] if study.startswith("precision_")}


def test_beds_of_long_grains_of_other_sources_are_a_study(tmp_path):
    rows = pd.read_csv(REFERENCE / "difference_long_sources.csv")
    for source, of_source in rows.groupby("source"):
        (tmp_path / source).mkdir()
        listed = packings(("differences.yaml",), ("difference_long_sources",), tmp_path / source)
        specifications = list(listed.specification)
        assert [spec["seed"] for spec in specifications] == sorted(of_source.seed)
        assert {row["varied"]["faces"] for row in listed.row} == set(of_source.faces)
        assert {spec["sizes"]["case"] for spec in specifications} == set(of_source.case)
        assert {spec["amount"]["grains"] for spec in specifications} == set(of_source.grains)
        assert all(source in spec["grains"]["source"] for spec in specifications)


def test_the_beds_of_several_sizes_are_the_packings_of_their_configuration():
    """The table has no height of the domain and no contacts; its command refuses beds that differ in other settings."""
    rows = pd.read_csv(REFERENCE / "bed_size.csv")
    studies = [name for name in results.sentences()["bed_size.csv"]["command"].split() if name.startswith("bed_size_")]
    studies = tuple(sorted(name.rstrip(";") for name in studies))
    listed = packings(("bed_size.yaml",), studies)
    beds = [
        (
            spec["sizes"]["case"],
            spec["shapes"]["grain"],
            round(1e3 * spec["domain"]["width"], 3),
            spec["amount"]["grains"],
            spec["seed"],
        )
        for spec in listed.specification
    ]
    assert sorted(beds) == sorted(
        rows[["case", "grain", "width_mm", "grains", "seed"]].itertuples(index=False, name=None)
    )
    shared = [
        {key: value for key, value in spec.items() if key not in bed_size.FREE | {"shapes"}}
        for spec in listed.specification
    ]
    assert all(settings == shared[0] for settings in shared)


def test_the_beds_of_1200_grains_are_rows_of_single_forms_inserted_above_the_bed():
    rows = pd.read_csv(REFERENCE / "bed_size.csv")
    of_1200 = rows[(rows.width_mm == 63.0) & (rows.grains == 1200)]
    former = pd.read_csv(ABOVE / "single_form.csv")
    former = former[former.representation == "polyhedron"]
    merged = of_1200.merge(former, on=["case", "grain", "seed"], suffixes=("", "_former"))
    assert len(merged) == len(of_1200) == 18
    assert merged.n.tolist() == merged.n_former.tolist() and merged.cpu_s.tolist() == merged.cpu_s_former.tolist()
    ledger = pd.read_csv(ABOVE / "gathered.csv", dtype={"settings": str})
    single_forms = set(ledger[(ledger.study == "single_form") & (ledger.source == "synthetic")].settings)
    assert set(digests(("bed_size.yaml",), ("bed_size_1200",)).values()) == single_forms


def test_the_beds_behind_the_ends_of_a_bed_are_single_forms_inserted_above_the_bed():
    """The table has means over beds, so only their number can be compared; not all were packed when it was made."""
    rows = pd.read_csv(REFERENCE / "height.csv")
    beds = rows.groupby("study").beds.agg(["min", "max"])
    assert (beds["min"] == beds["max"]).all()
    command = results.sentences()["height.csv"]["command"]
    assert "config/inserted_above_bed.yaml" in command
    listed = packings(("inserted_above_bed.yaml",), tuple(beds.index)).groupby("study").size()
    assert all(f"results/inserted_above_bed/porosity/{study}" in command for study in beds.index)
    assert (listed[beds.index] == 63).all() and (beds["max"] < 63).all() and (beds["max"] > 40).all()


def committed_name(name):
    """Return the name in the committed rows of the grain of a file of the public repository."""
    prefix, number = name.split("-anm-")
    return f"AZcoarse_{number}" if prefix == "AZ0.5" else f"FDOT57_{prefix}{int(number)}"


def test_the_scans_of_the_committed_rows_are_those_of_their_configuration():
    names = yaml.safe_load((CONFIG / "scans.yaml").read_text(encoding="utf-8"))["grains"]["names"]
    rows = pd.read_csv(REFERENCE / "single_form.csv")
    assert [committed_name(name) for name in names] == sorted(rows[rows.source == "scans"].grain.unique())


@pytest.mark.skipif(not SCANS.is_dir(), reason="the copies of the scans are not part of the clone")
def test_the_copies_of_the_scans_are_the_named_files_cut_at_the_degree():
    grains = yaml.safe_load((CONFIG / "scans.yaml").read_text(encoding="utf-8"))["grains"]
    copies = sorted(SCANS.glob("*.sh.txt"))
    assert [path.name.removesuffix(".sh.txt") for path in copies] == [*map(committed_name, grains["names"])]
    for path, name in zip(copies, grains["names"], strict=True):
        assert f"/{name}.dat " in path.read_text(encoding="utf-8").splitlines()[0]
        assert read_coefficients(path)[0].max() == grains["degree"]

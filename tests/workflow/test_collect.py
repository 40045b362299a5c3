"""Rows of finished packings in committed tables, while others are missing, and the cost that a dry run prints."""

import json
import re
import shutil
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml

from simcore.campaign.evaluations import SETTINGS, settings_text
from simcore.campaign.studies import expand, merge
from simcore.evaluation.evaluate import evaluate
from simcore.paths import REFERENCE, ROOT
from simcore.scene.specification import resolve
from tests.helpers.packings import make_packing
from tests.helpers.workplace import NULL_STUDIES

pytestmark = pytest.mark.workflow

CAMPAIGN = f"""
reference: kept
pathvars: {{results: results/mine}}
packing: {{domain: {{width: 45 mm, height: 0.3 m}}, amount: {{grains: 300}}, shapes: {{kind: ellipsoid}}}}
studies:
  spheroids:
    fixes: {{shapes: {{choice: form, elongation: 0.8}}}}
    varies: {{sizes.case: [U1], shapes.flatness: [0.5, 0.6], seed: [1, 2]}}
  heights:
    fixes: {{sizes: {{case: U1}}, shapes: {{choice: form, flatness: 0.6, elongation: 0.8}}}}
    varies: {{generation.drop_height: [1 cm, 2 cm]}}
{NULL_STUDIES}
"""


@pytest.fixture
def campaign(workplace):
    """Return a campaign with some made-up beds: its folder, run(), and add(), which adds beds."""
    (workplace.folder / "mine.yaml").write_text(CAMPAIGN)
    raw = [yaml.safe_load((ROOT / "config" / "config.yaml").read_text()), yaml.safe_load(CAMPAIGN)]
    plan = expand(resolve(merge(*raw), "config"))

    def add(study, number, **changed):
        rows = plan[plan.study == study].iloc[:number]
        for row in rows.itertuples():
            bed = make_packing(
                np.random.default_rng(4).uniform(0.005, 0.06, (300, 3)),
                np.tile([0.0055, 0.0045, 0.0035], (300, 1)),
                width=0.05,
                scene=json.dumps({**row.specification, **changed}),
                seed=row.specification["seed"],
                cpu_seconds=72.0,
                steps=100,
                code_version="0.1.0+test",
                largest=0.011,
            )
            path = workplace.folder / "results" / "mine" / "porosity" / study / f"{row.packing}.nc"
            path.parent.mkdir(parents=True, exist_ok=True)
            evaluate(bed).to_netcdf(path)

    return SimpleNamespace(
        add=add,
        folder=workplace.folder,
        run=lambda target="collect", *more: workplace.run("--configfile", "mine.yaml", *more, "--", target),
    )


def test_half_of_a_campaign_is_gathered_and_the_rest_later(campaign):
    campaign.add("heights", 1)
    status, said = campaign.run()
    assert status == 0, said
    assert "heights: 1 of 2 packings" in said and "spheroids: 0 of 4 packings" in said
    kept = campaign.folder / "kept"
    assert sorted(path.name for path in kept.iterdir()) == [
        "collected.csv",
        "gathered.csv",
        "heights.csv",
        "trends.csv",
    ]
    first = pd.read_csv(kept / "heights.csv")
    (first_bed,) = pd.read_csv(kept / "gathered.csv").packing + ".nc"
    assert list(first) == ["case", "drop_height", "seed", "n", "n_error", "grains", "cpu_s"] and len(first) == 1
    # On another machine, where there are no files, packings that have a row are not packed again.
    beds = campaign.folder / "results" / "mine" / "porosity" / "heights"
    for bed in beds.iterdir():
        bed.rename(bed.with_suffix(".gone"))
    status, said = campaign.run("heights_left", "--dry-run")
    assert status == 0 and re.search(r"^packing +1$", said, re.MULTILINE), said
    status, said = campaign.run("spheroids_left", "--dry-run")
    assert status == 0 and re.search(r"^packing +4$", said, re.MULTILINE), said
    campaign.add("heights", 2)
    (beds / first_bed).unlink()
    status, said = campaign.run()
    assert status == 0, said
    table = pd.read_csv(kept / "heights.csv")
    assert len(table) == 2 and table.iloc[0].equals(first.iloc[0])
    behind = pd.read_csv(kept / "collected.csv").set_index("study").loc["heights"]
    assert (behind.packings, behind.planned, behind.cpu_h, behind.cpu_h_left_estimated) == (2, 2, 0.04, 0.0)
    assert behind.command == "snakemake --configfile mine.yaml" and behind.code == "0.1.0+test"


def test_committed_rows_give_tables_and_figures_without_a_packing(campaign):
    shutil.copytree(REFERENCE, campaign.folder / "kept", ignore=shutil.ignore_patterns("[!n]*"))
    status, said = campaign.run("committed_studies")
    assert status == 0 and said.count("rule committed_studies:") == 1 and "rule packing:" not in said, said
    made = campaign.folder / "results" / "mine" / "committed"
    assert sorted(path.name for path in made.glob("n*")) == [f"near_spheres.{kind}" for kind in ("csv", "pdf", "png")]
    # There are no rows of this campaign's own studies, and no models.
    headings = re.findall("<h2[^>]*>([^<]+)", (made / "report.html").read_text())
    assert headings == []


def test_beds_of_other_settings_and_other_campaigns_are_left_out(campaign, workplace):
    campaign.add("heights", 2, faces=30)
    status, said = campaign.run()
    assert status == 0 and "heights: 0 of 2 packings" in said
    assert not (campaign.folder / "kept" / "heights.csv").exists()
    (workplace.folder / "tests.yaml").write_text(f"test_only: true\n{CAMPAIGN}")
    for arguments, message in (
        (["--configfile", "tests.yaml"], "are not gathered, since `test_only` is set"),
        ([], "cannot be gathered: give a folder for them"),
    ):
        status, said = workplace.run(*arguments, "--", "collect")
        assert status != 0 and message in said
    status, said = workplace.run("--dry-run", "--", "near_spheres_left")
    assert status != 0 and "near_spheres_left needs the rows that `collect` writes: give a folder for them" in said


def test_evaluations_of_former_settings_are_no_rows_of_a_table(campaign):
    """If only the times of files decide, Snakemake keeps packings whose settings have changed."""
    for changed, text in (({"faces": 30}, "was packed with another value of faces"), ({}, "")):
        campaign.add("heights", 2, **changed)
        status, said = campaign.run("heights", "--rerun-triggers", "mtime")
        log = (campaign.folder / "results/mine/logs/study_table/heights.log").read_text()
        assert (status != 0, text in said + log) == (bool(text), True)
    assert (campaign.folder / "results/mine/tables/heights.csv").exists()


def test_evaluations_with_another_cut_are_not_gathered(campaign):
    campaign.add("heights", 2)
    for path in (campaign.folder / "results/mine/porosity/heights").iterdir():
        bed = xr.load_dataset(path).assign_attrs({SETTINGS: settings_text({"slice_height": None, "cut": 0.005})})
        bed.to_netcdf(path)
    status, said = campaign.run()
    assert status == 0 and "heights: 0 of 2 packings" in said
    log = (campaign.folder / "results/mine/logs/collect.log").read_text()
    assert "is left out: it was evaluated with another value of porosity.cut than the campaign has" in log
    (campaign.folder / "cut.yaml").write_text("porosity: {cut: 5 mm}")
    status, said = campaign.run("collect", "--configfile", "mine.yaml", "cut.yaml")
    assert status == 0 and "heights: 2 of 2 packings" in said, said


def test_a_dry_run_prints_packings_hours_and_pieces(workplace):
    """With the sizes of Rettinger et al. the packings take many hours, and long packings are single pieces."""
    status, said = workplace.run("--dry-run", "--configfile", "config/r22.yaml", "--", "validation_piece_1")
    assert status == 0, said
    line = re.search(r"^validation +(\d+) +\d+ +([0-9.]+) +([0-9.]+) +(\d+)$", said, re.MULTILINE)
    packings, hours, longest, pieces = map(float, line.groups())
    assert packings == 21 and longest > 2 and 21 * longest > hours > 10
    assert 1 < pieces <= 21
    assert re.search(r"^all +624 ", said, re.MULTILINE)
    # Each of the other pieces has at least one packing.
    assert 1 <= said.count("rule packing:") <= packings - (pieces - 1)

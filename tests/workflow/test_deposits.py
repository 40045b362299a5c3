"""The deposits: a target outside `all`, and a tiny campaign of them run through."""

import json
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr

from simcore.campaign.deposit_findings import findings
from simcore.campaign.deposits import read_deposits
from simcore.report.figures.deposits import figures_of_rows
from simcore.report.findings import Findings
from tests.helpers.column_names import undescribed_columns
from tests.helpers.workplace import Workplace

pytestmark = pytest.mark.workflow
REFERENCE = Path(__file__).parents[2] / "results" / "reference"

TINY = """
reference: kept
pathvars: {results: results/tiny}
studies:
  deposit_diagonal:
    in_all: false
    fixes: &deposit
      accuracy: null
      domain: {width: 24 mm, height: 0.3 m}
      amount: {grains: 90}
      sizes: {beta: {radius: 3 mm, spread: 0}}
      shapes: {kind: ellipsoid, choice: ratios, eta: 1.0, zeta: 1.0}
      material:
        {law: hertz, youngs_modulus: 5 MPa, end_of_contact: clamped, restitution: 0.3, friction_law: dynamic}
      generation: {placement: random, orientation: random, drop_height: 5 mm, velocity_z: -2 m/s, batch_grains: 30}
      shaking: {amplitude: 0 mm, duration: 0 s}
      damping: {factor: 1}
      convergence: {rule: settled, kinetic_energy: 1.0e-3, compaction: 5.0e-3}
      numerics: {contact_time: 0.2 ms, steps_per_contact_time: 10, dashpot: explicit}
    varies: {seed: [1, 2]}
  deposit_map:
    in_all: false
    fixes: *deposit
    varies: {shapes.zeta: [1.0, 1.2], seed: [3]}
  deposit_sizes:
    in_all: false
    fixes: *deposit
    varies: {sizes.beta.spread: [0.2], seed: [4]}
"""


def test_deposits_are_a_target_of_their_own(workplace):
    everything = workplace.plan("--configfile", "config/deposits.yaml")
    assert not {study for _, study in everything if (study or "").startswith("deposit_")}
    jobs = workplace.plan("--configfile", "config/deposits.yaml", "--", "deposits")
    packed = [study for rule, study in jobs if rule == "packing"]
    assert len(packed) == [rule for rule, _ in jobs].count("deposit") > 150
    assert packed.count("deposit_map") + packed.count("deposit_map_long") == 36
    assert packed.count("deposit_diagonal") + packed.count("deposit_diagonal_long") == 5 * 12
    assert {rule for rule, _ in jobs} == {
        "packing_specification", "packing", "deposit", "deposit_tables", "deposit_figures", "deposits",
    }  # fmt: skip


def test_committed_rows_become_tables_and_figures_without_a_packing(workplace):
    (workplace.folder / "rows.yaml").write_text(f"pathvars: {{results: results/rows}}\nreference: {REFERENCE}\n")
    config = ("--configfile", "config/deposits.yaml", "rows.yaml")
    assert workplace.plan(*config, "--", "committed_deposits") == [("committed_deposits", None)]
    status, said = workplace.run(*config, "--", "committed_deposits")
    assert status == 0, said
    results = workplace.folder / "results" / "rows" / "committed_deposits"
    maxima = pd.read_csv(results / "maxima.csv").set_index(["of", "family"])
    assert 1.2 < maxima.loc[("solid_fraction", "diagonal"), "ratio"] < 1.7
    assert (results / "bridge.png").stat().st_size > 1000


def test_what_has_no_rows_is_left_out_of_tables_and_figures(workplace, tmp_path):
    """Rows of the diagonal alone give the files that the rule of all rows promises, without Snakemake."""
    rows = read_deposits(REFERENCE / "deposits.csv")
    rows = rows[rows["study"] == "deposit_diagonal"]
    tables = findings(rows)
    Findings(tables, figures_of_rows(rows, tables["maxima"])).write_into(tmp_path / "part")
    (workplace.folder / "rows.yaml").write_text(f"reference: {REFERENCE}\n")
    (job,) = workplace.jobs("--configfile", "config/deposits.yaml", "rows.yaml", "--", "committed_deposits")
    assert {path.rsplit("/", 1)[1] for path in job.output} == {path.name for path in (tmp_path / "part").iterdir()}
    assert set(tables["maxima"]["family"]) == {"diagonal"} and tables["changes"].empty


@pytest.fixture(scope="session")
def deposited(tmp_path_factory):
    """Return a workplace in which a tiny campaign of deposits has run."""
    workplace = Workplace(tmp_path_factory.mktemp("deposits"))
    (workplace.folder / "tiny.yaml").write_text(TINY)
    status, said = workplace.run("--configfile", "tiny.yaml", "--", "deposits")
    assert status == 0, said
    return workplace


def test_a_tiny_campaign_gives_tables_and_figures(deposited):
    results = deposited.folder / "results" / "tiny"
    table = pd.read_csv(results / "deposits" / "packings.csv")
    assert undescribed_columns(results) == {}
    assert table.family.tolist() == ["diagonal"] * 2 + ["map"] * 2 + ["sizes"]
    assert table.solid_fraction.between(0.4, 0.75).all() and (table.steps > 100).all()
    assert pd.read_csv(results / "deposits" / "means.csv").packings.sum() == 5
    for name in (
        *("map", "forms", "directions", "histograms", "sizes", "bridge"),
        *("size_distributions", "histograms_over_sizes", "picture"),
    ):
        for suffix in ("png", "pdf"):
            assert (results / "figures" / "deposits" / f"{name}.{suffix}").stat().st_size > 1000
    with xr.open_dataset(results / "fabric" / "deposit_map" / "zeta_1.0-seed_3.nc") as fabric:
        assert json.loads(fabric.attrs["scene"])["seed"] == 3
    status, said = deposited.run("--configfile", "tiny.yaml", "--", "deposits")
    assert status == 0 and "Nothing to be done" in said


def test_half_of_it_is_gathered(deposited):
    fabric = deposited.folder / "results" / "tiny" / "fabric" / "deposit_map" / "zeta_1.2-seed_3.nc"
    aside = fabric.with_suffix(".aside")
    fabric.rename(aside)
    try:
        status, said = deposited.run("--configfile", "tiny.yaml", "--", "collect_deposits")
    finally:
        aside.rename(fabric)
    assert status == 0, said
    assert "deposit_map: 1 of 2 packings" in said and "deposit_diagonal: 2 of 2 packings" in said
    kept = deposited.folder / "kept"
    first = pd.read_csv(kept / "deposits.csv")
    assert len(first) == 4 and {"P2_contact_normal", "azimuth_p4_long_axis", "cpu_s"} <= set(first)
    assert list(pd.read_csv(kept / "deposit_crossings.csv").direction) == ["contact_normal", "long_axis"]
    status, said = deposited.run("--configfile", "tiny.yaml", "--", "collect_deposits")
    assert status == 0, said
    assert len(pd.read_csv(kept / "deposits.csv")) == 5
    behind = pd.read_csv(kept / "collected.csv").set_index("study")
    assert behind.loc["deposit_map", "planned"] == 2 and behind.loc["deposit_map", "cpu_h_left_estimated"] == 0


def test_deposits_of_former_settings_do_not_share_a_table_with_new_ones(deposited):
    """With --rerun-triggers mtime the deposits of former settings would stay. The last test: it removes the tables."""
    changed = TINY.replace("restitution: 0.3", "restitution: 0.4")
    (deposited.folder / "changed.yaml").write_text(changed)
    (deposited.folder / "results" / "tiny" / "deposits" / "means.csv").unlink()
    status, said = deposited.run("--configfile", "changed.yaml", "--rerun-triggers", "mtime", "--", "deposits")
    assert status != 0
    assert "fabric/deposit_diagonal/seed_1.nc was packed with another value of material.restitution" in said

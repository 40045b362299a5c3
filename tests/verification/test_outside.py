"""Packings with known outcomes: the cases are consistent, and measures are right where the answer is known."""

import inspect

import numpy as np
import pandas as pd
import pytest
import trimesh
import xarray as xr
import yaml

from simcore.__main__ import main
from simcore.grains.readers import read_grain
from simcore.grains.sources import load_grains
from simcore.packing.file import read_packing
from simcore.paths import REFERENCE, ROOT
from simcore.report.figures.outside import outside_figure
from simcore.scene.setup import set_up
from simcore.scene.specification import resolve
from simcore.verification.outside import measures, packings
from simcore.verification.outside.cases import CASES, Case
from simcore.verification.outside.elastic import jump
from simcore.verification.outside.formulas import rod_porosity, wall_porosity, zigzag_porosity
from simcore.verification.outside.solids import SOLIDS, solid_mesh, write_solid
from simcore.verification.outside.table import case_table
from tests.helpers.packings import make_packing, sphere_lattice, touching_pairs

FCC = 1.0 - np.pi / np.sqrt(18.0)
VOLUMES = {  # of edge 1
    "tetrahedron": 1.0 / (6.0 * np.sqrt(2.0)),
    "cube": 1.0,
    "octahedron": np.sqrt(2.0) / 3.0,
    "dodecahedron": (15.0 + 7.0 * np.sqrt(5.0)) / 4.0,
    "icosahedron": 5.0 * (3.0 + np.sqrt(5.0)) / 12.0,
}


# -- the cases ----------------------------------------------------------------------------------------------------


def test_each_case_has_a_band_a_source_a_reason_and_a_measure_that_takes_its_options():
    for case in CASES:
        assert case.low < case.high, case.name
        assert case.source and case.reason and case.quantity, case.name
        assert 1 <= len(case.packings) <= 2 and set(case.packings) <= set(packings.PACKINGS), case.name
        inspect.signature(measures.MEASURES[case.measure]).bind(None, **case.options)


def test_names_are_unique_and_each_packing_serves_a_case():
    assert len({case.name for case in CASES}) == len(CASES)
    assert {name for case in CASES for name in case.packings} == set(packings.PACKINGS)
    assert all(len(set(packing.seeds)) >= 2 for packing in packings.PACKINGS.values())  # a standard error needs two


@pytest.mark.parametrize("run", packings.PACKED + packings.ELASTIC_RUNS)
def test_each_specification_is_one_that_a_user_could_write(run, tmp_path):
    for solid in SOLIDS:
        write_solid(tmp_path / f"{solid}.obj", solid, 10.0)
    raw = yaml.safe_load(yaml.safe_dump(packings.specification(run, str(tmp_path))))
    setup = set_up(resolve(raw), load_grains)
    assert setup.scene.name == run and setup.scene.amount_grains == raw["amount"]["grains"]


def test_a_run_that_is_none_is_refused():
    with pytest.raises(KeyError):
        packings.specification("column_1.5_seed99", "dice")


def test_the_middle_of_each_band_is_the_formula_s():
    """The bands agree with the formulas to the digits with which they are written down."""
    band = {case.name: 0.5 * (case.low + case.high) for case in CASES}
    for ratio in (1.3, 1.5, 1.7):
        assert band[f"column_{ratio}"] == pytest.approx(zigzag_porosity(ratio), abs=1e-5)
    for ratio in (3, 5, 8):
        assert band[f"cylinder_{ratio}"] == pytest.approx(wall_porosity(ratio), abs=6e-5)
    for share in (0.30, 0.50, 0.70, 0.85):
        rods = rod_porosity([8.0, 4.0], [share, 1.0 - share])
        assert band[f"bidisperse_{share:.2f}"] == pytest.approx(rods, abs=6e-5)
    gain = rod_porosity([1.0], [1.0]) - rod_porosity([8.0, 4.0], [0.7, 0.3])
    assert band["bidisperse_gain"] == pytest.approx(gain, abs=1e-4)


def test_the_committed_table_has_these_cases_bands_and_sources():
    """A band cannot be changed after its packing unless the table is made again."""
    committed = pd.read_csv(REFERENCE / "verification_packings.csv")
    assert list(committed.name) == [case.name for case in CASES]
    assert list(committed.source) == [case.source for case in CASES]
    np.testing.assert_allclose(committed[["low", "high"]], [[case.low, case.high] for case in CASES], rtol=1e-12)
    np.testing.assert_array_equal(committed.inside, committed.measured.between(committed.low, committed.high))


def test_the_page_lists_each_case_with_its_measured_value():
    committed = pd.read_csv(REFERENCE / "verification_packings.csv")
    page = (ROOT / "docs" / "reference" / "verification.md").read_text(encoding="utf-8")
    for row in committed.itertuples():
        (line,) = [line for line in page.splitlines() if line.startswith(f"| `{row.name}` ")]
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        assert float(cells[3].split(" ± ")[0]) == pytest.approx(row.measured, abs=6e-5), row.name
        assert (cells[4] == "inside") == row.inside, row.name


# -- formulas -----------------------------------------------------------------------------------------------------


def test_equal_rods_fill_what_farr_and_groot_give():
    assert 1.0 - rod_porosity([3.0], [1.0]) == pytest.approx(0.6435, abs=1e-4)


def test_rods_do_not_depend_on_how_sizes_are_split_ordered_or_scaled():
    whole = rod_porosity([8.0, 4.0], [0.7, 0.3])
    assert rod_porosity([8.0, 4.0, 8.0], [0.2, 0.3, 0.5]) == pytest.approx(whole, abs=1e-9)
    assert rod_porosity([4e-3, 8e-3], [0.3, 0.7]) == pytest.approx(whole, abs=1e-9)
    assert rod_porosity([8.0, 4.0, 1.0], [0.7, 0.3, 0.0]) == pytest.approx(whole, abs=1e-9)


def test_rods_of_very_different_sizes_fill_each_other_s_pores():
    """As in Furnas, few fine spheres fit into the pores of coarse ones, and few coarse ones into a fine bed."""
    solid = 1.0 - rod_porosity([1.0], [1.0])
    coarse_bed = 1.0 - solid / 0.9
    fine_bed = 1.0 - 1.0 / (0.5 + 0.5 / solid)
    assert rod_porosity([1000.0, 1.0], [0.9, 0.1], rods=200_000) == pytest.approx(coarse_bed, abs=5e-4)
    assert rod_porosity([1000.0, 1.0], [0.5, 0.5], rods=200_000) == pytest.approx(fine_bed, abs=5e-4)


@pytest.mark.parametrize("ratio", [1.0, 1.87])
def test_no_zigzag_where_there_is_none(ratio):
    with pytest.raises(ValueError, match="zigzag"):
        zigzag_porosity(ratio)


# -- measures -----------------------------------------------------------------------------------------------------


def zigzag(ratio, count, diameter=7e-3):
    """Return a column of touching spheres in a tube, placed by hand."""
    aside = 0.5 * (ratio - 1.0) * diameter
    rise = np.sqrt(diameter**2 - (2.0 * aside) ** 2)
    k = np.arange(count)
    position = np.column_stack([aside * (-1.0) ** k, np.zeros(count), 0.5 * diameter + rise * k])
    return make_packing(position, 0.5 * diameter, width=ratio * diameter, domain="cylinder")


@pytest.mark.parametrize("ratio", [1.05, 1.3, 1.5, 1.7, 1.86])
@pytest.mark.parametrize("count", [3, 30])
def test_a_column_built_by_hand_has_the_porosity_of_the_closed_form(ratio, count):
    column = zigzag(ratio, count)
    assert measures.column_porosity(column) == pytest.approx(zigzag_porosity(ratio), abs=1e-12)


def test_a_column_that_is_no_zigzag_is_looser():
    column = zigzag(1.5, 10)
    column["position"][5:, 2] += 1e-3
    assert measures.column_porosity(column) > zigzag_porosity(1.5) + 0.001


@pytest.fixture(scope="module")
def fcc():
    """Return an FCC lattice of touching spheres of 7 mm about the vertical axis, 8 by 8 by 12 cells, with contacts."""
    centres, width = sphere_lattice("fcc", 8, 12)
    pairs, images = touching_pairs(centres, width)
    packing = make_packing(7e-3 * centres, 3.5e-3, width=7e-3 * width, contacts=pairs, images=images)
    packing["position"][:, :2] -= 3.5e-3 * width
    return packing


def test_a_close_packed_lattice_has_its_porosity(fcc):
    """The ends of the interval cut layers; the error is up to half a layer of 0.7 diameters in 14 diameters."""
    assert measures.porosity(fcc, floor=0.014, surface=0.014) == pytest.approx(FCC, abs=0.005)


def test_the_core_of_a_lattice_has_the_lattice_s_porosity(fcc):
    """Within three diameters, the number of points and the spheres that the cylinder cuts leave an error of 0.006."""
    assert measures.core_porosity(fcc, 0.021, floor=0.014, surface=0.014) == pytest.approx(FCC, abs=0.006)


def test_the_core_is_for_equal_spheres():
    packing = make_packing([[0, 0, 0.005], [0, 0, 0.015], [0, 0, 0.025]], [0.005, 0.005, 0.004], width=0.0095)
    with pytest.raises(ValueError, match="not equal"):
        measures.core_porosity(packing, 0.002, floor=0.0, surface=0.0)


def test_each_sphere_of_a_close_packed_lattice_has_twelve_contacts(fcc):
    assert measures.coordination(fcc, 0.014, 0.014, bearing_contacts=4) == 12.0


def test_the_energy_that_counts_is_the_one_farthest_from_the_first():
    record = xr.Dataset({"energy": ("time", [2.0, 2.002, 1.99, 2.0])})
    assert measures.energy_ratio(record) == pytest.approx(0.995)


# -- solids -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SOLIDS)
def test_a_solid_is_closed_and_has_its_volume_and_equal_axes(name, tmp_path):
    vertices, faces = solid_mesh(name, 2.0)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight and mesh.volume == pytest.approx(8.0 * VOLUMES[name])
    write_solid(tmp_path / f"{name}.obj", name, 10.0)
    grain = read_grain(tmp_path / f"{name}.obj", "mm")
    assert grain.volume == pytest.approx(1e-6 * VOLUMES[name])
    assert grain.S == pytest.approx(grain.L, rel=1e-6)


def test_an_unknown_solid_is_refused():
    with pytest.raises(ValueError, match="not a Platonic solid"):
        solid_mesh("prism", 1.0)


# -- the table ----------------------------------------------------------------------------------------------------


def test_the_table_has_means_standard_errors_and_marks_misses(monkeypatch):
    for name in ("first", "second"):
        monkeypatch.setitem(packings.PACKINGS, name, packings.Seeds({}, (1, 2, 3)))
    monkeypatch.setitem(measures.MEASURES, "number", lambda record: float(record["number"]))
    numbers = {"first_seed": (1.0, 2.0, 3.0), "second_seed": (0.5, 0.5, 0.5)}

    def read(run):
        return xr.Dataset({"number": numbers[run[:-1]][int(run[-1]) - 1]}, attrs={"cpu_seconds": 2.0})

    cases = [
        Case("mean", ("first",), "number", "number", {}, 1.5, 2.5, "someone", "because"),
        Case("missed", ("first",), "number", "number", {}, 2.1, 2.5, "someone", "because"),
        Case("difference", ("first", "second"), "number", "number", {}, 1.0, 2.0, "someone", "because"),
    ]
    table = case_table(read, cases)
    assert list(table.columns) == [
        "name", "quantity", "seeds", "measured", "std_error", "low", "high", "inside", "cpu_s", "source"
    ]  # fmt: skip
    np.testing.assert_allclose(table.measured, [2.0, 2.0, 1.5])
    np.testing.assert_allclose(table.std_error, 1.0 / np.sqrt(3.0))
    assert list(table.inside) == [True, False, True]
    assert list(table.cpu_s) == [6.0, 6.0, 12.0]
    figure = outside_figure(table)
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert labels == ["mean: 2", "missed: 2", "difference: 1.5"]
    markers = {line.get_marker(): line for line in figure.axes[0].lines}
    assert list(markers["o"].get_ydata()) == [2, 0] and list(markers["D"].get_ydata()) == [1]
    assert markers["o"].get_color() != markers["D"].get_color(), "values outside have a colour of their own"


def test_deviations_of_energy_of_either_sign_do_not_cancel(monkeypatch):
    monkeypatch.setitem(packings.PACKINGS, "jump", packings.Seeds({}, (1, 2)))
    case = Case("energy", ("jump",), "energy", "energy_ratio", {}, 0.995, 1.005, "theory", "conserved")

    def read(run, deviation):
        sign = 1 if run.endswith("seed1") else -1
        return xr.Dataset({"energy": ("t", [2.0, 2.0 * (1.0 + sign * deviation)])}, attrs={"cpu_seconds": 1.0})

    for deviation, inside in ((0.006, False), (0.004, True)):
        table = case_table(lambda run, deviation=deviation: read(run, deviation), [case])
        assert table.measured[0] == pytest.approx(1.0) and bool(table.inside[0]) is inside


# -- the real way -------------------------------------------------------------------------------------------------


def test_eight_spheres_poured_into_a_tube_form_a_zigzag(tmp_path):
    """The case's own specification is packed and measured, as the workflow does it."""
    raw = packings.specification("column_1.5_seed1", "dice")
    raw["amount"], raw["shaking"] = {"grains": 8}, {"duration": "0.1 s"}
    (tmp_path / "column.yaml").write_text(yaml.safe_dump(raw))
    assert main(["pack", str(tmp_path / "column.yaml"), str(tmp_path / "column.nc")]) == 0
    column = read_packing(tmp_path / "column.nc")
    (case,) = [case for case in CASES if case.name == "column_1.5"]
    assert case.low < measures.column_porosity(column) < case.high
    assert float(column.attrs["cpu_seconds"]) > 0.0


def test_elastic_spheres_keep_their_energy_and_damped_ones_do_not():
    raw = packings.specification("elastic_spheres_seed1", "dice")
    raw["amount"] = {"grains": 12}
    elastic = jump(raw, duration=0.2, measurements=10)
    assert measures.energy_ratio(elastic) == pytest.approx(1.0, abs=0.005)
    raw["material"]["restitution"] = 0.9
    assert measures.energy_ratio(jump(raw, duration=0.2, measurements=10)) < 0.95

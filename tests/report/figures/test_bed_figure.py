"""The figure of one packing shows what the packing contains; `scree plot` writes it."""

import numpy as np
import pytest

from simcore.__main__ import main
from simcore.evaluation.axis_statistics import density_per_solid_angle, grain_axes
from simcore.evaluation.porosity import bulk_porosity, porosity_profile
from simcore.evaluation.rounding import rounded
from simcore.packing.file import write_packing
from simcore.report.figures.bed import INCLINATIONS, SECTORS, bed_figure
from tests.helpers.packings import make_packing, sphere_lattice
from tests.helpers.rotations import random_orientations


def ellipsoids(n=400):
    """Return densely strewn ellipsoids; their overlaps do not matter to the figure."""
    rng = np.random.default_rng(0)
    position = rng.uniform([0, 0, 0.003], [0.03, 0.03, 0.05], (n, 3))
    scale = rng.uniform(0.8, 1.2, (n, 1)) * [1.6e-3, 2.2e-3, 3e-3]
    bed = make_packing(position, scale, random_orientations(n, 1), width=0.03, largest=6e-3, title="Packing strewn")
    bounds, share = [[1e-3, 3e-3], [3e-3, 4e-3], [4e-3, 5e-3], [5e-3, 9e-3]], [0.0, 0.25, 0.75, 0.0]  # ends are empty
    return bed.assign(sieve_bounds=(("sieve_class", "bound"), bounds), mass_fraction_specified=("sieve_class", share))


def panels(figure):
    """Return the axes of the figure by their title or label."""
    return {axes.get_title() or axes.get_xlabel(): axes for axes in figure.axes}


def lines(axes):
    return {line.get_label(): line for line in axes.get_lines()}


def test_every_panel_shows_its_numbers(tmp_path):
    bed = ellipsoids()
    bulk = bulk_porosity(bed, "exact")
    figure = bed_figure(bed, bulk, "Title", pixels=150)
    figure.savefig(tmp_path / "bed.png", dpi=40)
    shown = panels(figure)
    profile = lines(shown["porosity n [-]"])
    expected = porosity_profile(bed, 1e-3, "exact")
    np.testing.assert_allclose(profile["n(z)"].get_xdata(), expected["porosity"])
    assert f"bulk n = {rounded(float(bulk['n']), float(bulk['n_std_error']))}" in profile
    sizes = lines(shown["sizes of the grains"])
    x, y = sizes["grains of the packing"].get_data()
    np.testing.assert_allclose(x, 1e3 * np.sort(bed["D"].values))
    heavier = bed["volume"].values[bed["D"].values <= np.median(bed["D"].values)].sum() / bed["volume"].values.sum()
    assert np.interp(1e3 * np.median(bed["D"].values), x, y) == pytest.approx(100 * heavier, abs=0.5)
    np.testing.assert_allclose(sizes["specified sieve curve"].get_xydata(), [[3, 0], [4, 25], [5, 100]])
    rose = shown["azimuths of long axes"]
    heights = np.array([bar.get_height() for bar in rose.patches])
    assert len(heights) == 2 * SECTORS and heights[:SECTORS].sum() == pytest.approx(SECTORS)
    np.testing.assert_array_equal(heights[:SECTORS], heights[SECTORS:])
    directions, _ = grain_axes(bed)["long_axis"]
    first = np.mean(np.arctan2(directions[:, 1], directions[:, 0]) % np.pi < np.pi / SECTORS)
    assert heights[0] == pytest.approx(first * SECTORS)
    dip = lines(shown["dip of the axes"])
    edges = np.linspace(0.0, 0.5 * np.pi, INCLINATIONS + 1)
    for label, name in (("long axes", "long_axis"), ("short axes", "short_axis")):
        directions, _ = grain_axes(bed)[name]
        density, _ = density_per_solid_angle(directions, np.ones(len(directions)), edges)
        angle, radius = dip[label].get_data()
        assert angle[0] == pytest.approx(0.5 * np.pi) and radius[0] == pytest.approx(density[0])  # the upright ones
        assert angle[-1] == pytest.approx(0.0) and radius[-1] == pytest.approx(density[-1])


def test_round_grains_have_no_rose():
    centres, width = sphere_lattice("bcc", 3, 6)
    bed = make_packing(1e-2 * centres, 5e-3, width=1e-2 * width)
    shown = panels(bed_figure(bed, pixels=100))
    for title, text in (("azimuths of long axes", "L = I"), ("dip of the axes", "round")):
        assert not shown[title].axison and text in shown[title].texts[0].get_text()
    assert "evaluated interval" not in lines(shown["porosity n [-]"])


def test_the_command_writes_the_figure_beside_the_packing_or_where_told(tmp_path, capsys):
    write_packing(tmp_path / "bed.nc", ellipsoids())
    assert main(["plot", str(tmp_path / "bed.nc")]) == 0
    assert capsys.readouterr().out == f"wrote {tmp_path / 'bed.png'}\n"
    assert (tmp_path / "bed.png").read_bytes().startswith(b"\x89PNG")
    assert main(["plot", str(tmp_path / "bed.nc"), str(tmp_path / "new" / "bed.svg"), "--cut", "8 mm"]) == 0
    text = (tmp_path / "new" / "bed.svg").read_text()
    bulk = bulk_porosity(ellipsoids(), "exact", 8e-3)
    assert "Packing strewn" in text and f"bulk n = {rounded(float(bulk['n']), float(bulk['n_std_error']))}" in text


def test_a_bed_too_low_to_evaluate_is_drawn_with_a_note(tmp_path, capsys):
    write_packing(tmp_path / "bed.nc", ellipsoids())
    assert main(["plot", str(tmp_path / "bed.nc"), "--cut", "40 mm"]) == 0
    printed = capsys.readouterr()
    assert printed.err.startswith(f"scree plot: {tmp_path / 'bed.nc'}: without bulk porosity: ")
    assert printed.err.count("\n") == 1
    assert (tmp_path / "bed.png").exists()


def test_wrong_input_is_one_line(tmp_path, capsys):
    write_packing(tmp_path / "bed.nc", ellipsoids(3))
    write_packing(tmp_path / "empty.nc", make_packing(np.zeros((0, 3)), np.zeros((0, 3))))
    for arguments, message in (
        (["bed.nc", "bed.jpeg"], "bed.jpeg must end in .png, .pdf or .svg"),
        (["none.nc"], "there is no such file"),
        (["empty.nc"], "contains no grain"),
        (["bed.nc", "--cut", "1 kg"], "--cut: '1 kg' is a mass"),
    ):
        paths = [
            argument if argument.startswith("-") or " " in argument else str(tmp_path / argument)
            for argument in arguments
        ]
        assert main(["plot", *paths]) == 2
        printed = capsys.readouterr().err
        assert message in printed and printed.count("\n") == 1

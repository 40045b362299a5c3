"""Spherical-harmonic radii in both file formats, compared with closed forms."""

import numpy as np
import pytest

from simcore.grains.mesh import make_grain
from simcore.grains.readers import read_grain, read_grains_of
from simcore.grains.spherical_harmonics import cut_at, radius, read_coefficients, sampled_directions
from simcore.grains.spiral import spiral_directions

# r = 10 + 2 z + 1.5 x - 0.8 y + 0.7 (x² - y²) on the unit sphere, written in orthonormal Y_nm by hand:
# Y_00 = 1/sqrt(4 pi), Y_10 = sqrt(3/4pi) z, Y_11 = -sqrt(3/8pi) (x + iy), Y_22 = sqrt(15/32pi) (x + iy)²
HALF = [
    (0, 0, 10 * np.sqrt(4 * np.pi), 0.0),
    (1, 1, -1.5 / 2 / np.sqrt(3 / (8 * np.pi)), -0.8 / 2 / np.sqrt(3 / (8 * np.pi))),
    (1, 0, 2 / np.sqrt(3 / (4 * np.pi)), 0.0),
    (2, 2, 0.7 / 2 / np.sqrt(15 / (32 * np.pi)), 0.0),
]
FULL = HALF + [(n, -m, (-1) ** m * re, -((-1) ** m) * im) for n, m, re, im in HALF if m > 0]


def expected(u):
    x, y, z = u.T
    return 10 + 2 * z + 1.5 * x - 0.8 * y + 0.7 * (x**2 - y**2)


def write(path, rows, comments=""):
    path.write_text(comments + "".join(f"{n:4d}{m:4d} {re:20.10f} {im:20.10f}\n" for n, m, re, im in rows))
    return path


def surface_points(coefficients):
    directions = sampled_directions(coefficients)
    return radius(coefficients, directions)[:, None] * directions


@pytest.mark.parametrize("rows, comments", [(HALF, "# one\n# two\n# three\n"), (FULL, "")])
def test_radius_is_the_closed_form_in_both_formats(tmp_path, rows, comments):
    u = spiral_directions(500)
    coefficients = read_coefficients(write(tmp_path / "a.dat", rows, comments))
    # The file has ten decimals.
    np.testing.assert_allclose(radius(coefficients, u), expected(u), atol=1e-9)


def test_only_the_mean_radius_gives_a_sphere(tmp_path):
    points = surface_points(read_coefficients(write(tmp_path / "a.dat", HALF[:1])))
    grain = make_grain("sphere", points)
    # The inscribed hull of 4000 points has 7996 faces; it loses 10.9 / faces of the volume, a third of that in length.
    assert 1 - grain.volume / (4 / 3 * np.pi * 1000) == pytest.approx(10.9 / 7996, rel=0.15)
    assert grain.L == pytest.approx(20, rel=10.9 / 7996 / 2)


def test_points_are_dense_enough_for_high_degrees(tmp_path):
    rng = np.random.default_rng(3)
    rows = [(0, 0, 30.0, 0.0)] + [(25, m, *rng.normal(0, 0.05, 2)) for m in range(1, 26)]
    coefficients = read_coefficients(write(tmp_path / "a.dat", rows))
    points = surface_points(coefficients)
    finer = spiral_directions(8 * len(points))
    volume = make_grain("f", radius(coefficients, finer)[:, None] * finer).volume
    assert 0 < 1 - make_grain("g", points).volume / volume < 0.003


@pytest.mark.parametrize(
    "text, reason",
    [
        ("", "the file is empty"),
        ("# a\n\n0 0 1 0\n0 0 1\n", "line 4: '0 0 1' is no row of four numbers `n m re im`; points are read from .xyz"),
        ("n m re im\n0 0 one 0\n", "line 2: '0 0 one 0' is no row"),
        ("x,y,z\n1,2,3\n", "line 1: 'x,y,z' is no row .*; points are read from .xyz or .csv: rename"),
        ("0 0 nan 0\n", "NaN"),
        ("1 2 1 0\n", r"\|m\| <= n"),
        ("0 0 1 0\n0 0 1 0\n", "twice"),
    ],
)
def test_broken_files_are_refused(tmp_path, text, reason):
    (tmp_path / "a.dat").write_text(text)
    with pytest.raises(ValueError, match=rf"a\.dat.*{reason}"):
        read_coefficients(tmp_path / "a.dat")


def test_impossible_surfaces_are_refused():
    u = spiral_directions(500)
    n, m = np.array([0, 1, 1]), np.array([0, 1, -1])
    with pytest.raises(ValueError, match="not positive"):
        radius((n[:2], m[:2], np.array([1.0, 5.0])), u)
    with pytest.raises(ValueError, match="real"):
        radius((n, m, np.array([10.0, 1.0, 1.0])), u)


def coefficients_up_to(degree, seed=5):
    """Return rows of a pebble of about 10 mm with all m up to this degree, as public files have them."""
    rng = np.random.default_rng(seed)
    rows = [(0, 0, 5 * np.sqrt(4 * np.pi), 0.0)]
    for n in range(1, degree + 1):
        rows.append((n, 0, rng.normal(0, 0.3 / n**2), 0.0))
        for m in range(1, n + 1):
            re, im = rng.normal(0, 0.3 / n**2, 2)
            rows += [(n, m, re, im), (n, -m, (-1) ** m * re, -((-1) ** m) * im)]
    return rows


def test_a_file_cut_at_a_degree_is_the_file_without_the_degrees_above(tmp_path):
    rows = coefficients_up_to(25)
    whole = write(tmp_path / "whole.sh.txt", rows)
    cut = write(tmp_path / "cut.sh.txt", [row for row in rows if row[0] <= 10])
    (grain,), (same,) = read_grains_of(whole, "mm", degree=10), read_grains_of(cut, "mm")
    np.testing.assert_array_equal(grain.vertices, same.vertices)
    np.testing.assert_array_equal(grain.faces, same.faces)
    assert (grain.L, grain.volume, grain.hull_ratio) == (same.L, same.volume, same.hull_ratio)
    assert read_grain(whole, "mm").volume != same.volume
    (all_degrees,) = read_grains_of(whole, "mm", degree=25)
    np.testing.assert_array_equal(all_degrees.vertices, read_grain(whole, "mm").vertices)
    # A published copy has only m >= 0 and fewer decimals; its surface is the same within these decimals.
    half = write(tmp_path / "half.sh.txt", [(n, m, round(re, 6), round(im, 6)) for n, m, re, im in rows if 0 <= m])
    u = spiral_directions(500)
    radii = [radius(cut_at(read_coefficients(path), 10), u) for path in (whole, half)]
    np.testing.assert_allclose(*radii, atol=121 * 1e-6)


def test_a_degree_above_those_of_the_file_is_refused(tmp_path):
    path = write(tmp_path / "a.sh.txt", coefficients_up_to(10))
    with pytest.raises(
        ValueError, match=r"a\.sh\.txt: grains\.degree is 12, but the highest degree .* is 10; lower it"
    ):
        read_grains_of(path, "mm", degree=12)
    assert read_grains_of(path, "mm", degree=10)[0].volume == read_grain(path, "mm").volume

"""Tortuosity by diffusion, compared with closed forms of channels and with a lattice of spheres."""

import numpy as np
import pytest

from simcore.pores.diffusion import effective_diffusion, extrapolated, tortuosity
from simcore.pores.image import PoreImage, pore_image
from tests.helpers.packings import make_packing, sphere_lattice


def image(pores, periodic=True, spacing=(1.0, 1.0, 1.0)):
    pores = np.asarray(pores, bool)
    spacing = np.array(spacing)
    area = pores.shape[0] * pores.shape[1] * spacing[0] * spacing[1]
    return PoreImage(pores, spacing, periodic, float(area), 0, pores.shape[2])


def staircase():
    """Return a path that climbs one layer for each step along x and passes the sides of the box twice."""
    pores = np.zeros((4, 1, 8), bool)
    for z in range(8):
        pores[[z % 4, (z + 1) % 4], 0, z] = True
    return pores


def test_straight_pores_have_the_tortuosity_one():
    pores = np.zeros((5, 4, 9), bool)
    pores[1, 2], pores[3] = True, True
    assert tortuosity(image(pores)) == pytest.approx(1.0, abs=1e-6)
    assert effective_diffusion(image(pores, spacing=(0.9, 1.1, 2.0))) == pytest.approx(0.25, abs=1e-6)


def test_a_path_through_the_sides_of_the_box_has_its_resistance():
    """Two ends of 3/8, seven steps up and six sideways are in series; without the periodic sides there is no path."""
    expected = (8.0 / 4.0) / (2.0 * 3.0 / 8.0 + 7.0 + 6.0)
    assert effective_diffusion(image(staircase())) == pytest.approx(expected, rel=1e-6)
    assert tortuosity(image(staircase(), periodic=False)) == np.inf


def test_pores_without_a_path_do_not_count():
    pores = np.zeros((4, 4, 6), bool)
    pores[0, 0] = True
    expected = effective_diffusion(image(pores))
    pores[2, 2, 2], pores[2, 2, 4:], pores[0, 2, :3] = True, True, True
    assert effective_diffusion(image(pores)) == pytest.approx(expected, rel=1e-6)


def test_closed_pores_are_infinitely_tortuous():
    pores = np.ones((3, 3, 6), bool)
    pores[:, :, 3] = False
    assert tortuosity(image(pores)) == np.inf


@pytest.mark.parametrize("solid", [0.2, 0.3])
def test_a_lattice_of_spheres_conducts_as_rayleigh_computed(solid):
    """For insulating spheres, simple cubic, D_eff/D = 1 − 3 c / (2 + c − 0.979 c^(10/3)); the next term is c^(14/3).

    The formula is Rayleigh's (1892), with the coefficient as corrected by Runge, 1.305 · 3/4 here. The extrapolated
    value is within a quarter of the error that the command prints, the difference between the two sizes of voxels.
    """
    edge = 0.01
    radius = edge * (3.0 * solid / (4.0 * np.pi)) ** (1.0 / 3.0)
    centres, _ = sphere_lattice("sc", 1, 3)
    bed = make_packing(edge * centres, radius, width=edge)
    coarse, fine = (effective_diffusion(pore_image(bed, edge, 2.0 * edge, edge / count)) for count in (20, 40))
    exact = 1.0 - 3.0 * solid / (2.0 + solid - 0.75 * 1.305 * solid ** (10.0 / 3.0))
    assert extrapolated(coarse, fine) == pytest.approx(exact, abs=0.25 * abs(fine - coarse))


def test_touching_spheres_converge_with_the_first_order():
    """The difference between successive sizes of voxels halves, to 15 %."""
    centres, _ = sphere_lattice("sc", 1, 3)
    bed = make_packing(0.01 * centres, 0.005, width=0.01)
    a, b, c = (effective_diffusion(pore_image(bed, 0.01, 0.02, 0.01 / count)) for count in (20, 40, 80))
    assert (b - a) / (c - b) == pytest.approx(2.0, rel=0.15)

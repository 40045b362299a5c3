"""Permeability of the pore network, compared with published lattices and Kozeny–Carman, and local thickness.

The bands are what PoreSpy 3.2 and OpenPNM 3.6 reach, as docs/how_to/pores.md states; nothing is fitted.
"""

import numpy as np
import pytest

pytest.importorskip("porespy")
pytest.importorskip("openpnm")

import simcore  # noqa: E402
from simcore.pores.image import PoreImage  # noqa: E402
from simcore.pores.network import network_permeability  # noqa: E402
from simcore.pores.pore_sizes import percentile, pore_sizes  # noqa: E402
from simcore.pores.pores import bulk_pores, voxel_pores  # noqa: E402
from tests.helpers.lattice_permeability import lattice_image, lattice_permeability  # noqa: E402

D = 0.01  # [m]


@pytest.mark.parametrize("kind, low, high", [("sc", 1.2, 1.45), ("bcc", 1.05, 1.2), ("fcc", 0.9, 1.05)])
def test_lattices_are_missed_by_what_the_page_says(kind, low, high):
    """The values are those of Zick and Homsy (1982), at 20 voxels per diameter."""
    ratio = network_permeability(lattice_image(kind, 20, D), D) / lattice_permeability(kind, D)
    assert low < ratio < high


def test_permeability_grows_with_the_square_of_the_size():
    small, large = (network_permeability(lattice_image("sc", 20, d), d) for d in (D, 3.0 * D))
    assert large == pytest.approx(9.0 * small, rel=1e-9)


def test_where_a_periodic_box_begins_does_not_matter():
    """A box that is shifted by a quarter of a diameter has the same permeability, to 10 %."""
    here, shifted = (network_permeability(lattice_image("sc", 20, D, s), D) for s in (0.0, 0.25))
    assert shifted == pytest.approx(here, rel=0.1)


def test_a_closed_bed_has_no_permeability_and_solid_voxels_are_refused():
    image = lattice_image("sc", 20, D)
    closed = image.pores.copy()
    closed[:, :, closed.shape[2] // 2 - 2 : closed.shape[2] // 2 + 2] = False
    assert network_permeability(image._replace(pores=closed), D) < 1e-9 * network_permeability(image, D)
    with pytest.raises(ValueError, match="choose a smaller --voxel"):
        network_permeability(image._replace(pores=np.zeros_like(closed)), D)


def test_the_thickness_of_a_slit_is_its_width():
    pores = np.zeros((24, 12, 20), bool)
    pores[5:15] = True  # 10 voxels of 2 mm
    image = PoreImage(pores, np.full(3, 2e-3), True, 24 * 12 * 4e-6, 4, 16)
    diameters, shares = pore_sizes(image, 0.01)
    assert percentile(diameters, shares, 50) == pytest.approx(0.02, abs=2e-3)
    assert shares.sum() == pytest.approx(1.0) and (np.diff(diameters) > 0.0).all()


def test_the_largest_pores_are_those_of_the_lattices():
    """A sphere of (√3 − 1) d fits between the spheres of a simple cubic lattice, one of (√2 − 1) d in fcc.

    Four voxels are allowed: the nearest is up to √3/2 of its edge away from the centre, and radii are rounded down.
    """
    for kind, exact in (("sc", np.sqrt(3.0) - 1.0), ("fcc", np.sqrt(2.0) - 1.0)):
        diameters, _ = pore_sizes(lattice_image(kind, 40, D), D)
        assert diameters[-1] == pytest.approx(exact * D, abs=4.0 * D / 40)


@pytest.fixture(scope="module")
def bed():
    """Return a random packing of 110 spheres, about four diameters wide and five high."""
    specification = {
        "domain": {"width": "32 mm", "height": "0.3 m"},
        "shapes": {"kind": "sphere"},
        "sizes": {"bounds": ["7.9 mm", "8.1 mm"], "mass_fractions": [1]},
        "amount": {"grains": 110},
        "shaking": {"duration": "0.2 s"},
        "numerics": {"contact_time": "1 ms"},
    }
    return simcore.pack(specification, force=True)


def test_a_random_packing_is_within_the_spread_of_kozeny_and_carman(bed):
    """The constant is 180 for spheres, with a spread of 50 %, on the same surface and porosity; voxels are d/20."""
    results = bulk_pores(bed)
    n = results["porosity"]
    assert results["specific_surface"] == pytest.approx(6.0 / 8e-3, rel=0.05)
    constant_180 = n**3 * (6.0 / results["specific_surface"]) ** 2 / (180.0 * (1.0 - n) ** 2)
    assert results["kozeny_carman_permeability"] == pytest.approx(constant_180, rel=1e-12)
    found, sizes = voxel_pores(bed, results["z_lower"], results["z_upper"], 0.4e-3)
    assert abs(found["network_permeability"] / constant_180 - 1.0) < results["kozeny_carman_spread"]
    assert found["voxel_porosity"] == pytest.approx(n, abs=0.01)
    # The bounds are that of Hashin and Shtrikman and the straight path that grazes half spheres.
    assert 1.0 + 0.5 * (1.0 - n) < found["tortuosity"] < 0.5 * np.pi
    assert 0.1 * 8e-3 < found["pore_diameter_d50"] < 0.5 * 8e-3
    assert sizes[1].sum() == pytest.approx(1.0)

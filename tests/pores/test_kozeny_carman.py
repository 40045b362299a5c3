"""Kozeny–Carman, compared with published permeabilities, and the limit of Darcy's law."""

import numpy as np
import pytest

from simcore.pores import kozeny_carman
from tests.helpers.lattice_permeability import POROSITY, lattice_permeability


@pytest.mark.parametrize("kind, published_over_formula", [("sc", 1.15), ("fcc", 0.97)])
def test_lattices_of_touching_spheres_are_within_the_spread(kind, published_over_formula):
    """The ratio of Zick and Homsy's value to the formula, to its second decimal, is far within ±50 %."""
    formula = kozeny_carman.permeability(POROSITY[kind], 6.0)
    ratio = lattice_permeability(kind, 1.0) / formula
    assert ratio == pytest.approx(published_over_formula, abs=0.005)
    assert abs(ratio - 1.0) < kozeny_carman.SPREAD


def test_the_constant_of_spheres_is_180():
    n, d = 0.4, 3e-3
    assert kozeny_carman.permeability(n, 6.0 / d) == pytest.approx(n**3 * d**2 / (180.0 * (1.0 - n) ** 2), rel=1e-14)


def test_conductivity_of_water_at_ten_degrees():
    """One darcy, 9.869e-13 m², conducts 7.4e-6 m/s."""
    assert kozeny_carman.conductivity(9.869e-13) == pytest.approx(7.41e-6, rel=1e-3)


def test_at_the_limit_of_darcys_law_inertia_is_a_tenth_of_friction():
    """Both terms are those of Macdonald et al. (1979), with the flow at the limit."""
    n, d = 0.38, 8e-3
    rho, mu, g = kozeny_carman.DENSITY, kozeny_carman.VISCOSITY, kozeny_carman.GRAVITY
    gradient = kozeny_carman.darcy_limit(n, 6.0 / d)
    friction, inertia = 180.0 * mu * (1.0 - n) ** 2 / (n**3 * d**2), 1.8 * rho * (1.0 - n) / (n**3 * d)
    q = (-friction + np.sqrt(friction**2 + 4.0 * inertia * rho * g * gradient)) / (2.0 * inertia)
    assert inertia * q**2 == pytest.approx(0.1 * friction * q, rel=1e-12)


@pytest.mark.parametrize("n, surface", [(0.0, 100.0), (1.0, 100.0), (0.4, 0.0)])
def test_what_is_no_bed_is_refused(n, surface):
    with pytest.raises(ValueError, match="are no bed"):
        kozeny_carman.permeability(n, surface)

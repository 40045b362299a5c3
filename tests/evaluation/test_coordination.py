"""Coordination number with and without rattlers."""

import numpy as np
import pytest

from simcore.evaluation.coordination import coordination_number
from tests.helpers.packings import make_packing, sphere_lattice


def test_contacts_and_rattlers_are_counted():
    # Grains 0, 1 and 2 form a triangle on the floor, 3 and 4 a chain that ends free, and 5 touches only the floor.
    contacts = [[0, 1], [1, 2], [0, 2], [2, 3], [3, 4], [0, -1], [5, -1]]
    bed = make_packing([[0, 0, z] for z in (1, 2, 3, 4, 5, 6)], 0.5, contacts=contacts)
    result = coordination_number(bed)
    assert result["contacts"].values.tolist() == [2, 2, 3, 2, 1, 0]
    assert float(result["coordination_number"]) == pytest.approx(10 / 6)
    # Grains 4 and 5 are removed first; then 3 has only one contact and is removed, and the triangle remains.
    assert float(result["rattler_fraction"]) == pytest.approx(3 / 6)
    assert float(result["coordination_number_without_rattlers"]) == pytest.approx(2.0)
    upper = coordination_number(bed, grains=[False, False, True, True, False, False])
    assert float(upper["coordination_number"]) == pytest.approx(2.5)
    # Grain 4 is not evaluated, so it remains and supports grain 3.
    assert float(upper["coordination_number_without_rattlers"]) == pytest.approx(2.5)
    assert float(upper["rattler_fraction"]) == 0.0
    tail = coordination_number(bed, grains=[False, False, True, True, True, False])
    assert float(tail["coordination_number_without_rattlers"]) == pytest.approx(2.0)
    assert float(tail["rattler_fraction"]) == pytest.approx(2 / 3)
    # For two grains with 3 and 2 contacts the error of the mean is half the difference.
    assert float(upper["coordination_number_std_error"]) == pytest.approx(0.5)


def test_rattlers_are_found_along_a_chain_and_by_the_given_number():
    # A tetrahedron 0-1-2-3 has a chain 3-4-5-6 with a free end, so 6, 5 and 4 are removed one after the other.
    contacts = [[a, b] for a in range(4) for b in range(a + 1, 4)] + [[3, 4], [4, 5], [5, 6]]
    bed = make_packing([[0, 0, z] for z in range(1, 8)], 0.5, contacts=contacts)
    result = coordination_number(bed)
    assert float(result["rattler_fraction"]) == pytest.approx(3 / 7)
    assert float(result["coordination_number_without_rattlers"]) == pytest.approx(3.0)
    # Without the chain, each grain of the tetrahedron has three contacts, too few if four are required.
    none = coordination_number(bed, bearing_contacts=4)
    assert float(none["rattler_fraction"]) == 1.0 and np.isnan(none["coordination_number_without_rattlers"])
    # A ring that is closed by the floor has no rattlers.
    ring = make_packing([[0, 0, z] for z in (1, 2, 3)], 0.5, contacts=[[0, -1], [0, 1], [1, 2], [2, -1]])
    assert float(coordination_number(ring)["rattler_fraction"]) == 0.0


def test_a_contact_that_does_not_push_bears_nothing():
    bed = make_packing([[0, 0, z] for z in (1, 2, 3)], 0.5, contacts=[[0, 1], [1, 2], [0, 2]])
    assert float(coordination_number(bed)["rattler_fraction"]) == 0.0
    bed["contact_force"][2] *= -1.0  # pulls
    pulled = coordination_number(bed)
    assert float(pulled["rattler_fraction"]) == 1.0
    assert float(pulled["coordination_number"]) == 2.0


def test_two_images_are_two_contacts_and_an_own_image_counts_at_both_ends():
    bed = make_packing([[0, 0, 1], [0, 0, 1]], 0.5, contacts=[[0, 1], [0, 1], [1, 1]])
    assert coordination_number(bed)["contacts"].values.tolist() == [2, 4]


def test_memory_without_overlap_is_no_contact():
    bed = make_packing([[0, 0, 1], [0, 0, 2]], 0.5, contacts=[[0, 1]])
    bed["contact_overlap"][:] = -1e-9
    assert float(coordination_number(bed)["coordination_number"]) == 0.0


def test_a_lattice_has_six_neighbours():
    centres, width = sphere_lattice("sc", 4, 5)
    index = {tuple(c.round().astype(int)): i for i, c in enumerate(centres - [0, 0, 0.5])}
    contacts = []
    for (x, y, z), i in index.items():
        contacts += [[i, index[(x + 1) % 4, y, z]], [i, index[x, (y + 1) % 4, z]]]
        contacts += [[i, index[x, y, z + 1]]] if z < 4 else []
    bed = make_packing(centres, 0.5, width=width, contacts=contacts)
    inner = coordination_number(bed, grains=(centres[:, 2] > 1.0) & (centres[:, 2] < 4.0))
    assert float(inner["coordination_number"]) == 6.0
    assert float(inner["rattler_fraction"]) == 0.0


def test_no_grain_is_refused():
    with pytest.raises(ValueError, match="no grain to average over"):
        coordination_number(make_packing([[0, 0, 1]], 0.5), grains=[False])

"""The network of contacts, read back with networkx."""

import re

import networkx
import numpy as np
import pandas as pd
import pytest

from simcore.evaluation.coordination import coordination_number
from simcore.export.export import export
from tests.export.test_paraview import lattice
from tests.helpers.random_beds import strew


def grain_edges(network, node):
    """Return the number of contacts of a node with grains."""
    return sum(network.nodes[end]["kind"] == "grain" for _, end in network.edges(node))


def test_degrees_are_the_coordination_numbers(tmp_path):
    packing = lattice()
    packing["contact_overlap"][0] = 0.0
    export(packing, tmp_path / "bed.graphml")
    network = networkx.read_graphml(tmp_path / "bed.graphml")
    expected = coordination_number(packing)["contacts"].values
    assert set(network) == {*map(str, range(packing.sizes["grain"])), "floor"}
    degrees = [grain_edges(network, str(grain)) for grain in range(packing.sizes["grain"])]
    np.testing.assert_array_equal(degrees, expected)
    assert [network.nodes[str(grain)]["coordination"] for grain in range(len(expected))] == list(expected)
    assert network.degree("floor") == (packing["contact_body"].values == -1).sum()


def test_two_contacts_of_two_grains_are_two_edges(tmp_path):
    packing = strew("sphere", contacts=[(0, 1), (0, 1)], images=[(0, 0), (1, 0)])
    export(packing, tmp_path / "bed.graphml")
    network = networkx.read_graphml(tmp_path / "bed.graphml", force_multigraph=True)
    ids = re.findall(r'<edge [^>]*id="([^"]*)"', (tmp_path / "bed.graphml").read_text(encoding="utf-8"))
    assert len(set(ids)) == 2, "Gephi is reported to ignore an edge whose id it has"
    assert sorted(edge["image_x"] for edge in network.get_edge_data("0", "1").values()) == [0, 1]


def test_nodes_and_edges_have_the_numbers_of_the_packing(tmp_path):
    packing = strew("ellipsoid", contacts=[(0, 1), (1, 2), (2, -1)], images=[(0, 1), (0, 0), (0, 0)])
    export(packing, tmp_path / "bed.graphml")
    network = networkx.read_graphml(tmp_path / "bed.graphml", force_multigraph=True)
    for grain in range(3):
        node = network.nodes[str(grain)]
        assert [node[name] for name in "DLIS"] == [float(packing[name][grain]) for name in "DLIS"]
        assert [node[axis] for axis in "xyz"] == packing["position"].values[grain].tolist()
        assert node["FL"] == pytest.approx(float(packing["S"][grain] / packing["I"][grain]), rel=1e-15)
    (edge,) = network.get_edge_data("0", "1").values()
    assert (edge["image_x"], edge["image_y"], edge["overlap"], edge["wall"]) == (0, 1, 1e-8, "")
    assert [edge[f"force_{axis}"] for axis in "xyz"] == packing["contact_force"].values[0].tolist()


def test_the_table_of_edges_makes_the_same_network(tmp_path):
    packing = lattice()
    export(packing, tmp_path / "bed.csv")
    table = pd.read_csv(tmp_path / "bed.csv", keep_default_na=False)
    assert len(table) == packing.sizes["contact"]
    np.testing.assert_array_equal(table[["first", "second"]], packing["contact_body"])
    np.testing.assert_array_equal(table["overlap"], packing["contact_overlap"])
    np.testing.assert_array_equal(table[["x", "y", "z"]], packing["contact_point"])
    network = networkx.from_pandas_edgelist(table, "first", "second", "force", create_using=networkx.MultiGraph)
    degrees = [sum(end >= 0 for _, end in network.edges(grain)) for grain in range(packing.sizes["grain"])]
    np.testing.assert_array_equal(degrees, coordination_number(packing)["contacts"])
    assert set(table["wall"]) == {"", "floor"}

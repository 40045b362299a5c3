"""The network of contacts: grains are nodes, contacts are edges (.graphml by networkx, .csv as a table of edges)."""

from simcore.export.libraries import library
from simcore.export.table import contact_table, grain_table


def contact_network(packing):
    """Return the contacts as a networkx.MultiGraph: a node per grain and touched wall, an edge per contact.

    Nodes are the numbers of the grains, or "floor" and "cylinder". Those of grains have the columns of
    simcore.export.table.grain_table, edges those of contact_table; the number of edges between grains at a node is its
    coordination. Two grains that touch through two periodic images have two edges. ValueError without networkx.
    """
    networkx = library("networkx", ".graphml")
    network = networkx.MultiGraph(title=str(packing.attrs.get("title", "")), units="SI")
    for row in grain_table(packing).to_dict("records"):
        network.add_node(row["grain"], kind="grain", **{name: value for name, value in row.items() if name != "grain"})
    for row in contact_table(packing).to_dict("records"):
        first, second, wall = row.pop("first"), row.pop("second"), row["wall"]
        if wall:
            network.add_node(wall, kind="wall")
        network.add_edge(first, wall or second, **row)
    return network


def write_graphml(path, packing):
    """Write the network of contacts as GraphML, for Gephi, igraph and networkx."""
    networkx = library("networkx", ".graphml")
    networkx.write_graphml(contact_network(packing), path)


def write_edges(path, packing):
    """Write the table of contacts, one row each, in SI units; see simcore.export.table.contact_table."""
    contact_table(packing).to_csv(path, index=False)

"""The network of contacts: grains are nodes, contacts are edges (.graphml by networkx, .csv as a table of edges)."""

from simcore.export.libraries import library
from simcore.export.table import contact_table, grain_table
from simcore.writing import whole_file


def contact_network(packing):
    """Return the contacts as a networkx.MultiGraph: a node per grain and touched wall, an edge per contact.

    Nodes are the numbers of the grains, or "floor" and "cylinder". Those of grains have the columns of
    simcore.export.table.grain_table, edges those of contact_table; the number of edges between grains at a node is its
    coordination. Two grains that touch through two periodic images have two edges. Keys number the edges, so that each
    has an id of its own in a file. ValueError without networkx.
    """
    networkx = library("networkx", ".graphml")
    network = networkx.MultiGraph(title=str(packing.attrs.get("title", "")), units="SI")
    for row in grain_table(packing).to_dict("records"):
        network.add_node(row["grain"], kind="grain", **{name: value for name, value in row.items() if name != "grain"})
    for number, row in enumerate(contact_table(packing).to_dict("records")):
        first, second, wall = row.pop("first"), row.pop("second"), row["wall"]
        if wall:
            network.add_node(wall, kind="wall")
        network.add_edge(first, wall or second, key=number, **row)
    return network


def write_graphml(path, packing):
    """Write the network of contacts as GraphML, for Gephi, igraph and networkx."""
    networkx = library("networkx", ".graphml")
    with whole_file(path) as part:
        networkx.write_graphml(contact_network(packing), part)


def write_edges(path, packing):
    """Write the table of contacts, one row each, in SI units; see simcore.export.table.contact_table."""
    with whole_file(path) as part:
        contact_table(packing).to_csv(part, index=False)

"""Orders the grains of a set so that the first of them, for any number, are spread over the Zingg diagram."""

import csv

import numpy as np
import pandas as pd


def spread_order(flatness, elongation):
    """Return the indices (n,) of all grains in an order whose first k, for any k, are spread over the Zingg diagram.

    The first grain is the nearest to the mean; each next one is the farthest from all before it. Ties go to the lower
    index. flatness, elongation: (n,).
    """
    points = np.column_stack([flatness, elongation])
    order = [int(np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    distance = np.full(len(points), np.inf)
    while len(order) < len(points):
        distance = np.minimum(distance, np.linalg.norm(points - points[order[-1]], axis=1))
        distance[order[-1]] = -1.0
        order.append(int(np.argmax(distance)))
    return np.array(order)


def spread_table(grains):
    """Return a DataFrame with the columns grain (name), FL and EL of all grains, in the order of `spread_order`."""
    rows = [(grain.name, grain.flatness, grain.elongation) for grain in grains]
    table = pd.DataFrame(rows, columns=["grain", "FL", "EL"])
    return table.iloc[spread_order(table.FL, table.EL)]


def read_spread(path):
    """Read the names of the grains, in their order, from a CSV file of `spread_table`."""
    with open(path, newline="", encoding="utf-8") as file:
        return [line["grain"] for line in csv.DictReader(file)]

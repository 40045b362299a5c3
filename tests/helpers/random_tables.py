"""Random tables of grains as text, in the spellings that people use, some of them with a fault."""

import numpy as np

KINDS = ("axes", "ratios", "means", "one form", "two axes")
# These texts replace a cell of a table to make it faulty.
FAULTS = ("", "abc", "1.234,5", "1.234", "1,234", "0", "-3", "65 %", "nan", "1e9", "1,2,3")


def random_table(rng, faulty=False):
    """Return the text of a table; with `faulty`, one of its cells is replaced or removed."""
    kind = KINDS[rng.integers(len(KINDS))]
    header, rows = _cells(rng, kind, int(rng.integers(1, 40)))
    if faulty:
        row = rows[rng.integers(len(rows))]
        row[rng.integers(len(row))] = FAULTS[rng.integers(len(FAULTS))]
    separator, mark = ((";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", "."), ("|", "."))[rng.integers(6)]
    end = ("\n", "\r\n")[rng.integers(2)]
    title = "Gravel of the Rhine" if separator == "," else "Gravel, Rhine km 640"
    above = [[title], ["date:", "12.03.2025"]][: rng.integers(1, 3)] if rng.random() < 0.2 else []
    units = {"L": "mm", "I": "mm", "S": "mm", "FL": "-", "EL": "-"}
    below = [[units.get(name, "") for name in header]] if header[0] == "L" and rng.random() < 0.3 else []
    lines = [
        *above,
        header,
        *below,
        *([cell if isinstance(cell, str) else _write(rng, cell, mark) for cell in row] for row in rows),
    ]
    return end.join(separator.join(line) for line in lines) + (end if rng.random() < 0.8 else "")


def _cells(rng, kind, number):
    """Return the names of the columns, and rows of numbers and texts."""
    if kind == "means":
        names = [["mean_FL", "std_FL", "mean_EL", "std_EL"], ["mu FL", "sd FL", "mu EL", "sd EL"]][rng.integers(2)]
        rows = [
            [rng.uniform(0.25, 0.95), rng.choice([0.0, 0.02, rng.uniform(0.0, 0.3)]), rng.uniform(0.3, 0.95)]
            + [rng.choice([0.0, 0.02, rng.uniform(0.0, 0.3)])]
            for _ in range(1 + number // 8)
        ]
        if rng.random() < 0.5:
            numbers = rng.integers(rng.integers(2), 80, len(rows))  # 0 is no number of grains
            names = [*names, ["grains", "n"][rng.integers(2)]]
            rows = [[*row, str(count)] for row, count in zip(rows, numbers, strict=True)]
        return names, rows
    if kind == "one form":
        form = [float(f"{value:.3f}") for value in rng.uniform(0.15, 1.0, 2)]
        return ["FL", "EL"], [list(form) for _ in range(1 + number // 10)]
    mean, width = rng.uniform(0.35, 0.9, 2), rng.choice([0.01, 0.05, 0.12, 0.2], 2)
    FL, EL = np.clip(rng.normal(mean, width, (number, 2)), 0.15, 1.0).T
    if kind == "ratios":
        return ["FL", "EL"] if rng.random() < 0.5 else ["S/I", "I/L"], np.transpose([FL, EL]).tolist()
    L = rng.uniform(8.0, 200.0, number)
    columns = [L, L * EL] if kind == "two axes" else [L, L * EL, L * EL * FL]
    names = [["L", "I", "S"], ["a [mm]", "b [mm]", "c [mm]"], ["long", "medium", "short"]][rng.integers(3)]
    rows = [list(row) for row in np.transpose(columns)]
    names = names[: len(columns)]
    extra = rng.random()
    if extra < 0.25:
        names, rows = [*names, "count"], [[*row, str(rng.integers(1, 9))] for row in rows]
    elif extra < 0.5:
        names, rows = ["sample", *names], [["AB"[rng.integers(2)], *row] for row in rows]
    elif extra < 0.6:
        names, rows = ["stone", *names], [[f"no {i}", *row] for i, row in enumerate(rows)]
        rows.append(["Mean", *np.mean([row[1:] for row in rows], axis=0)])
    return names, rows


def _write(rng, value, mark):
    return f"{value:.{rng.integers(4, 7)}f}".replace(".", mark)

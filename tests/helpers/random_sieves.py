"""Random tables of sieve curves as text, in the spellings that people use, some of them with a fault."""

import numpy as np

SIEVES = [0.5, 1, 2, 2.8, 4, 5.6, 8, 11.2, 16, 22.4, 31.5, 45, 63, 90]  # mm
OPENINGS = {"opening [mm]": 1.0, "Siebweite (mm)": 1.0, "size [cm]": 0.1, "mesh [µm]": 1e3, "phi": None, "D": "mm"}
FAULTS = ("", "abc", "-3", "1.234,5", "1.234", "1,234", "1e4", "2 m", "500", "no 8")


def random_sieves(rng, faulty=False):
    """Return the text of a table; with `faulty`, one of its cells or names is replaced."""
    number = int(rng.integers(2, 10))
    first = int(rng.integers(0, len(SIEVES) - number + 1))
    openings = SIEVES[first : first + number]
    retained = rng.dirichlet(np.full(number, 0.8)) * rng.choice([0.0, 1.0], number, p=[0.15, 0.85])
    retained[-1] *= rng.random() < 0.2
    retained[0] += 0.05
    in_pan = rng.choice([0.0, 0.004, 0.05]) * retained.sum()
    title = list(OPENINGS)[rng.integers(len(OPENINGS))]
    rows = [[_opening(size, OPENINGS[title]), amount] for size, amount in zip(openings, retained, strict=True)]
    kind = ("mass [g]", "Retained (%)", "passing [%]", "cumulative retained [%]", "finer", "mass")[rng.integers(6)]
    names = [title, kind]
    _as_kind(rows, kind, in_pan)
    if rng.random() < 0.2 and OPENINGS[title] is not None and kind[0] in "mR":
        names[0], rows = _as_classes(rng, title, rows)
    if rng.random() < 0.5:
        rows.reverse()
    if kind.startswith(("mass", "Ret", "cum")):
        rows.append(["pan", {"m": 1e3 * in_pan, "R": 100 * in_pan / (retained.sum() + in_pan), "c": 100.0}[kind[0]]])
    if faulty:
        spot = rng.integers(4)
        if spot == 0:
            names[rng.integers(2)] = ("weight [stone]", "passing [%]", "mass [mm]", "cum %", "note")[rng.integers(5)]
        else:
            rows[rng.integers(len(rows))][rng.integers(2)] = FAULTS[rng.integers(len(FAULTS))]
    if rng.random() < 0.2:
        names, rows = [*names, "remark"], [[*row, "dry"] for row in rows]
    separator, mark = ((";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", "."), ("|", "."))[rng.integers(6)]
    lines = [names, *([_write(cell, mark) for cell in row] for row in rows)]
    return "\n".join(separator.join(line) for line in lines) + "\n"


def _opening(size, factor):
    if factor is None:
        return float(-np.log2(size))
    return f"{size} {factor}" if isinstance(factor, str) else size * factor


def _as_kind(rows, kind, in_pan):
    """Replace the masses on the sieves, from fine to coarse, by the amounts of a kind."""
    masses = np.array([row[1] for row in rows])
    total = masses.sum() + in_pan
    below = in_pan + np.r_[0.0, np.cumsum(masses)[:-1]]
    amounts = {"m": 1e3 * masses, "R": 100 * masses / total, "p": 100 * below / total}
    amounts |= {"c": 100 - 100 * below / total, "f": below / total}
    for row, amount in zip(rows, amounts[kind[0]], strict=True):
        row[1] = float(amount)


def _as_classes(rng, title, rows):
    """Return the name of a column of classes, and the rows with a class instead of its lower sieve."""
    sizes = [float(row[0].split()[0]) if isinstance(row[0], str) else row[0] for row in rows]
    unit = " mm" if isinstance(rows[0][0], str) else ""
    mark = ("-", " – ", "/", " bis ", " to ")[rng.integers(5)]
    classes = [[f"{low:g}{mark}{high:g}{unit}", row[1]] for low, high, row in zip(sizes, sizes[1:], rows, strict=False)]
    if rows[-1][1] > 0.0:
        classes.append([f"> {sizes[-1]:g}{unit}", rows[-1][1]])
    return ("class" if unit else title), classes


def _write(cell, mark):
    return cell if isinstance(cell, str) else f"{cell:.6g}".replace(".", mark)

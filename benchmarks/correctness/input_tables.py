"""Random tables of measured grains for `predict`, with faults, and an independent reader of them.

The reader shares no code with simcore. It gets the file and its Layout (the positions of the columns, and how the file
was saved), and computes the statistics of each sample by plain arithmetic.
"""

import codecs
import csv
import io
import json
import math
from typing import NamedTuple

import openpyxl

SUMMARIES = ("Mean", "Max", "Total")
HEADERS = {
    "axes": (("L", "I", "S"), ("a", "b", "c"), ("Long axis", "Intermediate axis", "Short axis"), ("l", "i", "s")),
    "ratios": (("FL", "EL"), ("S/I", "I/L"), ("fl", "el"), ("FL [-]", "EL [-]")),
    "means": (("mean_FL", "std_FL", "mean_EL", "std_EL"), ("mu_FL", "sigma_FL", "mu_EL", "sigma_EL")),
}
UNITS = ("", " [mm]", " (cm)", "_mm", "/mm", ", mm")
CASES = ("U1", "one-class", "U7", "B50")
HALF_FITTED = ("U7", "B50")  # cases that have a model of one form, and none of a distribution, or of ours
ENCODINGS = ("utf-8", "utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1", "cp1252", "xlsx")


class Layout(NamedTuple):
    """How a table was written: the indices of its columns, from 0, and its encoding, or "xlsx"."""

    kind: str
    encoding: str
    separator: str
    skipped: int  # lines above the header
    forms: list
    label: int | None
    sample: int | None
    counts: int | None


class Contradiction(Exception):
    """An answer that the independent reader does not confirm; its text gives the reason."""


def read_independently(path, layout):
    """Return the samples of a file as {name: [(numbers of the form, grains)]}; an error if it is no table of grains."""
    if layout.encoding == "xlsx":
        lines = [["" if c is None else str(c) for c in row] for row in openpyxl.load_workbook(path).active.values]
    else:
        text = path.read_bytes().decode(layout.encoding)
        lines = list(csv.reader(io.StringIO(text), delimiter=layout.separator, strict=True, skipinitialspace=True))
    lines, samples = [line for line in lines[layout.skipped :] if any(map(str.strip, line))], {}
    for line in lines[1:]:
        if layout.label is not None and line[layout.label].strip() in SUMMARIES:
            continue
        numbers = [float(line[i].replace(",", ".")) for i in layout.forms]
        name = "" if layout.sample is None else line[layout.sample].strip()
        name = f"{len(samples)}" if layout.sample is None and layout.kind == "means" else name
        count = 1.0 if layout.counts is None else float(line[layout.counts])
        assert len(line) <= len(lines[0]) or not any(line[len(lines[0]) :]), "a row is longer than the header"
        samples.setdefault(name, []).append((numbers, count))
    return samples


def statistics(kind, rows):
    """Return number of grains, means and standard deviations of form factors of a sample; ValueError for no grains."""
    if kind == "means":
        ((numbers, _),) = rows
        if not (0 < numbers[0] <= 1 and 0 < numbers[2] <= 1 and 0 <= min(numbers[1], numbers[3]) < 0.5 + 1e-9):
            raise ValueError("no mean or deviation of a ratio")
        return {"grains": 0, **dict(zip(("mu_FL", "sigma_FL", "mu_EL", "sigma_EL"), numbers, strict=True))}
    if min(min(numbers) for numbers, _ in rows) <= 0:
        raise ValueError("a number of a grain is not positive")
    forms = [(n[2] / n[1], n[1] / n[0]) if kind == "axes" else tuple(n) for n, _ in rows]
    counts = [count for _, count in rows]
    if not all(0 < x <= 1 + 1e-12 for form in forms for x in form) or min(counts) < 0 or sum(counts) <= 0:
        raise ValueError("no form of a grain, or no number of grains")
    whole = all(count.is_integer() for count in counts)
    result = {"grains": sum(counts) if whole else sum(count > 0 for count in counts)}
    for key, values in (
        ("FL", [f[0] for f in forms]),
        ("EL", [f[1] for f in forms]),
        ("EQ", [f[0] * f[1] for f in forms]),
    ):
        mean = math.fsum(c * v for c, v in zip(counts, values, strict=True)) / sum(counts)
        square = math.fsum(c * (v - mean) ** 2 for c, v in zip(counts, values, strict=True)) / sum(counts)
        result |= {f"mu_{key}": mean, f"sigma_{key}": math.sqrt(square)}
    return result


def confirm(path, layout, output):
    """Raise Contradiction unless the JSON in `output` agrees with the file at `path` and has physical porosities."""
    answer = json.loads(output)
    try:
        samples = [(name, statistics(layout.kind, rows)) for name, rows in read_independently(path, layout).items()]
        assert samples, "there are no grains"
    except Exception as error:
        raise Contradiction(f"it was answered, but the reader cannot read it: {error!r}") from None
    if len(answer["samples"]) != len(samples):
        raise Contradiction(f"{len(answer['samples'])} samples were answered, the reader has {len(samples)}")
    predicted = 0
    for printed, (name, truth) in zip(answer["samples"], samples, strict=True):
        if layout.sample is not None and printed["name"] != name:
            raise Contradiction(f"sample {printed['name']}, the reader has {name}")
        for key, value in truth.items():
            if abs(printed[key] - value) > 1e-6:
                raise Contradiction(f"sample {printed['name']}: {key} is {printed[key]}, the reader has {value}")
        predicted += confirm_porosities(printed, answer["case"])
    if not predicted:
        raise Contradiction("all samples were answered without a porosity")


def confirm_porosities(printed, case):
    """Raise Contradiction unless the porosities of one sample are in (0, 1) and within their intervals.

    Returns whether the sample has a porosity; it may lack one if the case is one of HALF_FITTED, with a reason.
    """
    evaluated = [row for row in printed["predictions"] if row["n"] is not None]
    without_model = [row["model"] for row in printed["predictions"]] == [""] and case in HALF_FITTED
    if not evaluated and not without_model:
        raise Contradiction(f"sample {printed['name']} was answered without a porosity")
    for row in printed["predictions"]:
        if row["n"] is None and (not row["refused"] or row["lower"] is not None or row["upper"] is not None):
            raise Contradiction(
                f"sample {printed['name']}: no porosity of {row['model']}, and no reason or an interval"
            )
    for row in evaluated:
        lower, upper = (row["n"] if row[key] is None else row[key] for key in ("lower", "upper"))
        if not (0 < lower <= row["n"] <= upper < 1) or row["refused"] or (row["by"] == "ours" and row["lower"] is None):
            raise Contradiction(f"sample {printed['name']}: porosity {row['n']} in {row['lower']} to {row['upper']}")
    return bool(evaluated)


def draw_table(rng, folder, number):
    """Write a random table; return (arguments, path, Layout, faults, verdict).

    verdict: "answer", "refuse" or "either".
    """
    kind = rng.choice(["axes", "axes", "ratios", "means"])
    grid, layout = _draw_grid(rng, kind)
    case = rng.choice(CASES)
    faults, verdict, options = [], "either" if case in HALF_FITTED else "answer", ["--case", case]
    for fault in rng.sample(sorted(FAULTS), rng.choice([0, 0, 0, 1, 1, 1, 2, 3])):
        faults.append(fault)
        wanted = FAULTS[fault](rng, grid, layout, options)
        verdict = "refuse" if "refuse" in (wanted, verdict) else "either"
    path = folder / f"{number:03d}{'.xlsx' if layout.encoding == 'xlsx' else rng.choice(['.csv', '.txt'])}"
    if "last bytes cut off" in faults:
        verdict = "refuse" if layout.encoding == "xlsx" else verdict
    layout = _write(rng, path, grid, layout, "last bytes cut off" in faults)
    if layout.sample is not None and grid[0][layout.sample].lower() != "sample":
        options += ["--sample", grid[0][layout.sample]]
    return ["predict", str(path), "--json", *options], path, layout, faults, verdict


def _draw_grid(rng, kind):
    """Return the cells of a table without faults, a list of lists of text, and its Layout."""
    number, mean_FL, mean_EL = rng.randint(3, 30), rng.uniform(0.5, 0.7), rng.uniform(0.55, 0.75)
    rows = [_draw_row(rng, kind, mean_FL, mean_EL) for _ in range(number if kind != "means" else rng.randint(1, 5))]
    unit = rng.choice(UNITS) if kind == "axes" else ""
    columns = [(name + unit, "form", [row[i] for row in rows]) for i, name in enumerate(rng.choice(HEADERS[kind]))]
    if rng.random() < 0.3:
        columns.append(("weight (g)", "", [f"{rng.uniform(1, 90):.1f}" for _ in rows]))
    if rng.random() < 0.3:
        columns.append(("Bemerkung", "", [rng.choice(["Köln", "gerundet", "", "rot"]) for _ in rows]))
    if rng.random() < 0.25 and kind != "means":
        columns.append(
            (rng.choice(["count", "Number of grains", "n"]), "counts", [str(rng.randrange(1, 90)) for _ in rows])
        )
        columns[-1][2][:2] = ["9", "4"]  # 1, 2, 3, ... in a column n would be numbers of rows
    if rng.random() < 0.3 or kind == "means":
        names = [f"S{i}" for i in range(len(rows))] if kind == "means" else ["Rhine", "Kall"] * len(rows)
        columns.append((rng.choice(["sample", "Sample", "site"]), "sample", names[: len(rows)]))
    if rng.random() < 0.3:
        columns.append((rng.choice(["nr", "grain"]), "label", [str(i + 1) for i in range(len(rows))]))
    order = rng.sample(range(len(columns)), len(columns))
    places = {role: order.index(i) for i, (_, role, _) in enumerate(columns) if role not in ("", "form")}
    forms = [order.index(i) for i, (_, role, _) in enumerate(columns) if role == "form"]
    grid = [[columns[i][0] for i in order], *([columns[i][2][row] for i in order] for row in range(len(rows)))]
    if "label" in places and rng.random() < 0.5:
        for label in rng.sample(SUMMARIES, rng.randint(1, 2)):
            row = list(grid[1])
            row[places["label"]] = label
            grid.append(row)
    places = {role: places.get(role) for role in ("label", "sample", "counts")}
    return grid, Layout(kind, rng.choice(ENCODINGS), rng.choice([",", ";", "\t", "|"]), 0, forms, **places)


def _draw_row(rng, kind, mean_FL, mean_EL):
    FL, EL = (min(max(rng.gauss(mean, 0.12), 0.3), 0.97) for mean in (mean_FL, mean_EL))
    if kind == "means":
        return [f"{FL:.3f}", f"{rng.uniform(0.1, 0.2):.3f}", f"{EL:.3f}", f"{rng.uniform(0.1, 0.2):.3f}"]
    L = rng.uniform(20, 60)
    return [f"{x:.2f}" for x in (L, L * EL, L * EL * FL)] if kind == "axes" else [f"{FL:.4f}", f"{EL:.4f}"]


def _write(rng, path, grid, layout, cut):
    """Write the cells to `path` and return the Layout as written. cut: leave out the last bytes."""
    if layout.encoding == "xlsx":
        book = openpyxl.Workbook()
        for row in grid:
            book.active.append([_as_cell(text, rng.random() < 0.8) for text in row])
        book.save(path)
        if cut:
            path.write_bytes(path.read_bytes()[:-200])
        return layout
    separator, end = layout.separator, rng.choice(["\n", "\r\n"])
    comma, quoted, trailing = separator != "," and rng.random() < 0.4, rng.random() < 0.2, rng.random() < 0.2
    lines = []
    for number, row in enumerate(grid):
        cells = [text.replace(".", ",") if comma and number and text[:1].isdigit() else text for text in row]
        # A cell that contains the separator, such as "L, mm", is quoted, as every program writes it.
        cells = [f'"{text}"' if separator in text or (quoted and '"' not in text) else text for text in cells]
        lines.append(separator.join(cells) + (separator if trailing else ""))
        lines += [""] * (rng.random() < 0.05)
    if rng.random() < 0.1:
        lines, layout = [f"sep={separator}", *lines], layout._replace(skipped=1)
    text = end.join(lines) + end * rng.randint(0, 2)
    mark = codecs.BOM_UTF16_LE if layout.encoding == "utf-16-le" and rng.random() < 0.5 else b""
    data = mark + text.encode(layout.encoding)
    path.write_bytes(data[: -rng.randint(1, 20)] if cut else data)
    return layout


def _as_cell(text, as_number):
    try:
        return float(text) if as_number and text else text or None
    except ValueError:
        return text


def _cell_fault(texts):
    """Return a fault that puts one of these texts into a cell of the form; the reader finds out what follows."""

    def fault(rng, grid, layout, options):
        rows = [row for row in grid[1:] if layout.label is None or row[layout.label] not in SUMMARIES]
        if rows:
            rng.choice(rows)[rng.choice(layout.forms)] = rng.choice(texts)
        return "either"

    return fault


def _swap(rng, grid, layout, options):
    """Exchange the long and the short axis of a row; in a table of ratios, put a ratio above 1 into a cell."""
    if layout.kind != "axes" or len(grid) < 2:
        return _cell_fault(["1.32", "65"])(rng, grid, layout, options) if layout.kind != "means" else "either"
    row, (long, _, short) = grid[1], layout.forms
    row[long], row[short] = row[short], row[long]
    return "either"


def _far_out(rng, grid, layout, options):
    """Multiply the short axes, or the ratios, of all rows by a factor of 0.5 to 0.01."""
    factor, places = rng.choice([0.5, 0.2, 0.05, 0.01]), {"axes": [2], "ratios": [0, 1], "means": [0, 2]}
    for row in grid[1:]:
        for place in places[layout.kind]:
            try:
                row[layout.forms[place]] = f"{float(row[layout.forms[place]]) * factor:.4f}"
            except ValueError:
                pass
    return "either"


def _alike(rng, grid, layout, options):
    """Give all grains the same form."""
    for row in grid[2:]:
        for place in layout.forms:
            row[place] = grid[1][place]
    return "either"


def _column_twice(rng, grid, layout, options):
    place = rng.choice(layout.forms)
    for row in grid:
        row.append(row[place])
    return "refuse"


def _rename(texts):
    """Return a fault that renames the first column of the form."""

    def fault(rng, grid, layout, options):
        grid[0][layout.forms[0]] = rng.choice(texts)
        return "refuse"

    return fault


def _mixed_units(rng, grid, layout, options):
    if layout.kind != "axes":
        return "either"
    for place, text in zip(layout.forms, ("L [mm]", "I [cm]", "S [mm]"), strict=True):
        grid[0][place] = text
    return "refuse"


def _add_cell(rng, grid, layout, options):
    rng.choice(grid[1:] or grid).append("3.1")
    return "either"


def _no_rows(rng, grid, layout, options):
    del grid[1:]
    return "refuse"


def _one_character(rng, grid, layout, options):
    """Replace a random character of a cell; the reader finds out what the file means then."""
    row = rng.choice(grid[1:] or [[""]])
    place = rng.randrange(len(row))
    at, character = rng.randrange(len(row[place]) + 1), rng.choice("x#%-*0e .'_")
    row[place] = row[place][:at] + character + row[place][at + 1 :]
    return "either"


def _bad_counts(rng, grid, layout, options):
    if layout.counts is None or len(grid) < 2:
        return "either"
    grid[1][layout.counts] = rng.choice(["-3", "many", "", "1e20", "nan"])
    return "either"


def _other_option(rng, grid, layout, options):
    words, verdict = rng.choice(
        [
            (["--level", "1.5"], "refuse"),
            (["--level", "0.5"], "either"),
            (["--level", "0.9999999"], "either"),
            (["--case", "U3"], "either"),
            (["--case", "B70"], "either"),
            (["--case", "U99"], "refuse"),
            (["--sample", "nowhere"], "refuse" if layout.sample is None else "either"),
        ]
    )
    options += words
    return verdict


FAULTS = {
    "text in a cell": _cell_fault(["n/a", "broken", "-", "27.3 mm", "65%", "12.5.3"]),
    "not a number": _cell_fault(["NaN", "inf", "-Infinity"]),
    "empty cell": _cell_fault([""]),
    "zero or negative": _cell_fault(["0", "-3.1", "-0.2", "0.000"]),
    "huge or tiny number": _cell_fault(["1e300", "1e-300", "1e999"]),
    "wrong order": _swap,
    "far-out forms": _far_out,
    "all alike": _alike,
    "a column twice": _column_twice,
    "percent": _rename(["FL [%]", "mean_FL (%)"]),
    "a column is missing": _rename(["roundness", "", "12.5"]),
    "mixed units": _mixed_units,
    "a cell too many": _add_cell,
    "no rows": _no_rows,
    "a quotation mark": _cell_fault(['"27.3']),
    "one character": _one_character,
    "bad counts": _bad_counts,
    "another option": _other_option,
    "last bytes cut off": lambda *_: "either",
}

"""Random specifications for `explain`, with faults, and an independent reader of them.

The reader shares no code with simcore. It reads the YAML file itself and compares the output of `explain` with the
specified values by plain arithmetic: number and mass of the grains, shares of the sieve classes, form, and height of
the bed.
"""

import copy
import math
import re

import yaml

from benchmarks.correctness.input_tables import Contradiction

UNITS = {"m": 1, "cm": 1e-2, "mm": 1e-3, "kg": 1, "g": 1e-3, "t": 1e3, "kg/m3": 1, "g/cm3": 1e3, "": 1}
SIGMAS = 6.0


def quantity(text):
    """Return the value of a quantity in SI units."""
    number, unit = re.fullmatch(r"\s*([-+.\deE]*\d\.?)\s*([^\d\s]\S*)?\s*", str(text)).groups()
    return float(number) * UNITS[unit or ""]


def printed(pattern, output, what):
    """Return the numbers that the groups of a pattern match in the output; Contradiction if there is no match."""
    match = re.search(pattern, output)
    if match is None:
        raise Contradiction(f"{what} is not printed")
    return [float(text) for text in match.groups()]


def volume_shares(bounds, fractions):
    """Return, for each class, the share by number and the means of D³ and D⁶, for sizes that are uniform in log D."""
    pairs = list(zip(bounds, bounds[1:], strict=False))
    cubes, squares = ([(b**p - a**p) / (p * math.log(b / a)) for a, b in pairs] for p in (3, 6))
    numbers = [share / cube for share, cube in zip(fractions, cubes, strict=True)]
    return [number / sum(numbers) for number in numbers], cubes, squares


def normal_within(mean, std, low, high):
    """Return the mean of a normal distribution that is redrawn until it is within bounds."""
    if std == 0:
        return mean
    a, b = (low - mean) / std, (high - mean) / std
    density = [math.exp(-x * x / 2) / math.sqrt(2 * math.pi) for x in (a, b)]
    inside = (math.erf(b / math.sqrt(2)) - math.erf(a / math.sqrt(2))) / 2
    return mean + std * (density[0] - density[1]) / inside


def confirm(path, output):
    """Raise Contradiction unless the output of `explain` agrees with the file at `path` and is physical."""
    if bad := re.search(r"\b(nan|inf)\b", output):
        raise Contradiction(f"{bad[0]} is printed")
    specification = yaml.safe_load(path.read_bytes())
    domain, amount, shapes, sizes = (specification.get(key) or {} for key in ("domain", "amount", "shapes", "sizes"))
    number, mass, width, height = printed(
        r": (\d+) grains, (\S+) kg, .*(?:width|diameter) (\S+) mm, height (\S+) mm", output, "the packing"
    )
    for key, value in (("width", width), ("height", height)):
        if abs(value - quantity(domain[key]) * 1e3) > 1e-5 * value:
            raise Contradiction(f"{key} {value} mm, specified {domain[key]}")
    density = quantity((specification.get("material") or {}).get("density", "2650 kg/m3"))
    if amount.get("grains") is not None and number != amount["grains"]:
        raise Contradiction(f"{number:g} grains, specified {amount['grains']}")
    if amount.get("mass") is not None and mass < quantity(amount["mass"]) * 0.999:
        raise Contradiction(f"{mass:g} kg, specified {amount['mass']}")
    confirm_forms(shapes, number, output)
    if sizes.get("bounds") is not None:
        confirm_sizes(sizes, shapes, number, mass, density, amount, output)
    confirm_bed(domain, mass / density, output)


def confirm_forms(shapes, number, output):
    """Raise Contradiction unless the mean FL and EL are the specified ones."""
    means = printed(r"FL = S/I is (\S+) and the mean elongation EL = I/L is (\S+);", output, "the form")
    if not all(0 < mean <= 1 for mean in means):
        raise Contradiction(f"the mean FL and EL are {means}")
    keys = ("flatness", "elongation")
    choice = "sphere" if shapes.get("kind") == "sphere" else shapes.get("choice", "random")
    for mean, key, ratio in zip(means, keys, ("zeta", "eta"), strict=True):
        value, slack = 1.0, 5.1e-4
        if choice == "form":
            value = shapes[key]
        elif choice == "ratios" and not isinstance(shapes[ratio], dict):
            value = 1 / shapes[ratio]
        elif choice == "form_distribution":
            value = normal_within(shapes[key]["mean"], shapes[key]["std"], 0.1, 1.0)
            slack += SIGMAS * min(shapes[key]["std"], 0.26) / math.sqrt(number)
        elif choice != "sphere":
            continue
        if abs(mean - value) > slack:
            raise Contradiction(f"mean {key} {mean}, specified {value:.4f} with an error of {slack:.4f}")


def confirm_sizes(sizes, shapes, number, mass, density, amount, output):
    """Raise Contradiction unless the shares of the classes, as specified and as drawn, and the mass are right."""
    bounds, fractions = [quantity(text) for text in sizes["bounds"]], sizes["mass_fractions"]
    by_number, cubes, squares = volume_shares(bounds, fractions)
    rows = re.findall(r"(\S+) to (\S+) mm\s+(\S+)%\s+(\S+)%", output)
    rows = [[float(text) for text in row] for row in rows]
    spread = 1.0 if shapes.get("kind") == "sphere" or shapes.get("choice") in ("form", "ratios") else 1.5
    enough = all(number * share > 30 for share in by_number if share > 0)
    mean = sum(p * cube for p, cube in zip(by_number, cubes, strict=True))
    for i, share in enumerate(fractions):
        ends = bounds[i] * 1e3, bounds[i + 1] * 1e3  # they are printed with six digits
        row = [
            r[2:]
            for r in rows
            if math.isclose(r[0], ends[0], rel_tol=6e-6) and math.isclose(r[1], ends[1], rel_tol=6e-6)
        ]
        if not row:
            if share > 0:
                raise Contradiction(f"the class from {bounds[i]:g} m is not printed")
            continue
        shown, drawn = (percent / 100 for percent in row[0])
        others = sum(p * s for k, (p, s) in enumerate(zip(by_number, squares, strict=True)) if k != i)
        variance = ((1 - share) ** 2 * by_number[i] * squares[i] + share**2 * others) / (number * mean**2)
        error = 6e-4 + SIGMAS * spread * math.sqrt(variance)
        if abs(shown - share) > 6e-4 or (enough and abs(drawn - share) > error):
            raise Contradiction(
                f"the class from {bounds[i]:g} m has {drawn} (specified: {shown}), not {share} within {error:.4f}"
            )
    if shapes.get("kind") == "sphere":
        one = density * math.pi / 6 * bounds[-1] ** 3
        if amount.get("mass") is not None and mass > quantity(amount["mass"]) * 1.001 + one:
            raise Contradiction(f"{mass:g} kg, specified {amount['mass']}, and a grain has at most {one:g} kg")
        square = sum(p * s for p, s in zip(by_number, squares, strict=True))
        expected = number * density * math.pi / 6 * mean
        error = 1e-3 + SIGMAS * math.sqrt((square / mean**2 - 1) / number)
        if enough and abs(mass / expected - 1) > error:
            raise Contradiction(f"{number:g} spheres have {mass:g} kg, expected {expected:g} within {error:.1%}")


def confirm_bed(domain, solid, output):
    """Raise Contradiction unless height and solid fraction of the bed fit the volume of the grains, `solid` [m³]."""
    height, fraction = printed(r"It will be about (\S+) mm high, at a solid fraction of (\d\.\d+)", output, "the bed")
    if not 0 < fraction < 1:
        raise Contradiction(f"the solid fraction is {fraction}")
    area = quantity(domain["width"]) ** 2 * (math.pi / 4 if domain.get("type") == "cylinder" else 1)
    expected = solid / area / fraction
    if abs(height * 1e-3 - expected) > 0.6e-3 + 0.01 * expected:
        raise Contradiction(f"the bed is {height} mm high, expected {expected * 1e3:.1f}")
    evaluated = re.search(r"evaluated over a height of about (\d+) mm", output)
    if evaluated and not 0 <= float(evaluated[1]) <= height:
        raise Contradiction(f"{evaluated[1]} mm of {height} are evaluated")
    if re.search(r"sampling error of about -|about -", output):
        raise Contradiction("something negative is printed")


def draw_specification(rng, folder, number):
    """Write a random specification; return (arguments, path, faults, verdict).

    verdict: "answer", "refuse" or "either".
    """
    settings, faults, verdict = _draw_base(rng), [], "answer"
    fault_names = rng.sample(sorted(FAULTS), rng.choice([0, 0, 0, 1, 1, 1, 2, 3]))
    for fault in fault_names:
        faults.append(fault)
        # A later fault can undo an earlier one, so only the verdict of the last one counts.
        verdict = FAULTS[fault](rng, settings)
    text = yaml.safe_dump(settings, sort_keys=False, default_flow_style=rng.choice([None, False]), allow_unicode=True)
    if len(faults) == 1 and rng.random() < 0.15:
        fault = rng.choice(sorted(TEXT_FAULTS))
        faults, verdict = [*faults, fault], "refuse"
        text = TEXT_FAULTS[fault](text)
    path = folder / f"{number:03d}.yaml"
    path.write_text(text, encoding=rng.choice(["utf-8", "utf-8", "utf-8-sig", "utf-16"]))
    return ["explain", str(path)], path, faults, verdict


def _draw_base(rng):
    """Return a specification without faults."""
    bounds, fractions, settings = _draw_curve(rng), None, {"name": "drawn", "seed": rng.randrange(1000)}
    shares = [rng.uniform(0.2, 1.0) for _ in bounds[1:]]
    fractions = [round(share / sum(shares), 3) for share in shares]
    fractions[-1] = round(1 - sum(fractions[:-1]), 3)
    by_number, cubes, _ = volume_shares(bounds, fractions)
    grains = math.ceil(max(rng.uniform(100, 1000), rng.uniform(8, 40) / by_number[-1]))
    solid = grains * math.pi / 6 * sum(p * cube for p, cube in zip(by_number, cubes, strict=True))
    width = bounds[-1] * rng.uniform(5, 9)
    unit = rng.choice(["mm", "cm", "m"])
    settings["domain"] = {"width": _text(width, unit), "height": _text(max(6 * solid / width**2, 10 * width), "m")}
    if rng.random() < 0.3:
        settings["domain"]["type"] = "cylinder"
    settings["sizes"] = {"bounds": [_text(bound, unit) for bound in bounds], "mass_fractions": fractions}
    settings["amount"] = (
        {"grains": grains} if rng.random() < 0.5 else {"mass": _text(solid * 2650, rng.choice(["kg", "g"]))}
    )
    settings["shapes"] = rng.choice(
        [
            {"kind": "sphere"},
            {"kind": "sphere"},
            {"kind": "ellipsoid", "choice": "form", "flatness": _share(rng), "elongation": _share(rng)},
            {"kind": "ellipsoid", "choice": "form_distribution", "flatness": _normal(rng), "elongation": _normal(rng)},
            {"kind": "ellipsoid", "choice": "ratios", "eta": round(rng.uniform(1, 2), 2), "zeta": 1.3},
            {"kind": "ellipsoid"},
            {"kind": "polyhedron", "choice": "form_distribution", "flatness": _normal(rng), "elongation": _normal(rng)},
            {},
        ]
    )
    if settings["shapes"].get("kind", "polyhedron") == "polyhedron":
        settings |= {"grains": {"number": 21}, "faces": rng.choice([50, 100])}
    if rng.random() < 0.3:
        settings["material"] = {"density": rng.choice(["2650 kg/m3", "2.4 g/cm3", "3100 kg/m3"])}
    if rng.random() < 0.3:
        settings["accuracy"] = rng.choice(["draft", "standard"])
    return settings


def _draw_curve(rng):
    """Return the bounds [m] of one to four classes; the largest is at most thirty times the smallest."""
    bounds = [10 ** rng.uniform(-3, -1.7)]
    for _ in range(rng.randint(1, 4)):
        ratio = rng.choice([1.05, 1.4, 2.0, rng.uniform(1.1, 6)])
        if bounds[-1] * ratio < 30 * bounds[0]:
            bounds.append(bounds[-1] * ratio)
    return bounds


def _text(metres, unit):
    return f"{metres / UNITS[unit]:.7g} {unit}"


def _share(rng):
    return round(rng.uniform(0.4, 0.95), 2)


def _normal(rng):
    return {"mean": round(rng.uniform(0.5, 0.8), 2), "std": round(rng.uniform(0.0, 0.2), 2)}


def _set(path, values, verdict):
    """Return a fault that sets the key at a dotted path to one of these values."""

    def fault(rng, settings):
        *groups, key = path.split(".")
        for group in groups:
            settings[group] = settings = settings[group] if isinstance(settings.get(group), dict) else {}
        settings[key] = copy.deepcopy(rng.choice(values))
        return verdict

    return fault


def _fractions(change):
    """Return a fault that changes the mass fractions; the verdict depends on their sum and number."""

    def fault(rng, settings):
        fractions = settings["sizes"].get("mass_fractions") if isinstance(settings.get("sizes"), dict) else None
        if not isinstance(fractions, list):
            return "either"
        new = change([float(share) for share in fractions])
        settings["sizes"]["mass_fractions"] = new
        return (
            "refuse"
            if abs(sum(new) - 1) > 1e-3 or len(new) != len(settings["sizes"].get("bounds") or []) - 1
            else "either"
        )

    return fault


def _bounds(change):
    """Return a fault that changes the sieve openings."""

    def fault(rng, settings):
        bounds = settings["sizes"].get("bounds") if isinstance(settings.get("sizes"), dict) else None
        if isinstance(bounds, list):
            settings["sizes"]["bounds"] = change(bounds)
        return "either"

    return fault


def _unused(rng, settings):
    shapes = settings.get("shapes") if isinstance(settings.get("shapes"), dict) else {}
    if shapes.get("choice", "random") != "random":
        return "either"
    settings["shapes"] = {**shapes, "flatness": 0.3}
    return "refuse"


LENGTHS = [
    "40 kg",
    "40 parsec",
    "-3 mm",
    "0 mm",
    ".nan",
    "5,6 mm",
    "forty mm",
    40,
    "1e999 mm",
    True,
    None,
    [1],
    {"a": 1},
]
FAULTS = {
    "width": _set("domain.width", LENGTHS, "refuse"),
    "height": _set("domain.height", LENGTHS, "refuse"),
    "odd box": _set("domain.width", ["1 mm", "3 cm", "99 m", "1e-9 m"], "either"),
    "low box": _set("domain.height", ["1 mm", "3 cm", "99 m", "1e-9 m"], "either"),
    "unknown key": _set("domain.depth", ["3 mm"], "refuse"),
    "typing error": _set("amonut", [{"grains": 3}], "refuse"),
    "unused key": _unused,
    "wrong type": _set("seed", [1.5, -1, "one", True, "1", [1]], "refuse"),
    "no group": _set("shapes", [3, "sphere", ["sphere"], True], "refuse"),
    "kind": _set("shapes.kind", ["cube", "Mesh", 3, ["sphere"]], "refuse"),
    "other kind": _set("shapes.kind", ["sphere", "mixed", "ellipsoid"], "either"),
    "choice": _set("shapes.choice", ["one", "form", "form_distribution", "ratios"], "either"),
    "flatness": _set(
        "shapes.flatness", [1e-9, 0.02, 1.0, 1.2, {"mean": 0.1, "std": 1.0}, {"mean": 65, "std": 3}], "either"
    ),
    "amount": _set(
        "amount", [{"grains": 0}, {"grains": "many"}, {"grains": 1e3}, {"mass": "3"}, {}, None, 3], "refuse"
    ),
    "tiny amount": _set("amount", [{"grains": 1}, {"mass": "1e-9 g"}, {"mass": "1e-300 kg"}, {"grains": 6}], "either"),
    "huge amount": _set(
        "amount", [{"grains": 200000}, {"grains": 10**8}, {"mass": "1e6 kg"}, {"mass": "9e99 kg"}], "either"
    ),
    "huge everything": lambda rng, settings: (
        settings.update(domain={"width": "100 m", "height": "1000 m"}, amount={"mass": "1e9 kg"}) or "either"
    ),
    "both amounts": _set("amount", [{"grains": 100, "mass": "1 kg"}], "refuse"),
    "few top grains": _set("sizes.allow_few_top_grains", [True], "either"),
    "case": _set("sizes", [{"case": "U1"}, {"case": "B50"}], "either"),
    "no case": _set("sizes", [{"case": "U99"}, {"case": 1}, {}, None, {"case": "U1", "own": True}], "refuse"),
    "beta": _set("sizes", [{"beta": {"radius": "3 mm", "spread": s}} for s in (0, 0.5, 0.95)], "either"),
    "cumulative": _fractions(lambda shares: [sum(shares[: i + 1]) for i in range(len(shares))]),
    "percent": _fractions(lambda shares: [100 * share for share in shares]),
    "one fraction more": _fractions(lambda shares: [*shares, 0.0]),
    "scaled fractions": _fractions(lambda shares: [0.9 * share for share in shares]),
    "reversed bounds": _bounds(lambda bounds: bounds[::-1]),
    "a bound twice": _bounds(lambda bounds: [bounds[0], *bounds]),
    "narrow class": _bounds(lambda bounds: ["7 mm", "7.0000001 mm"]),
    "bound without unit": _bounds(lambda bounds: [1e-5, *bounds[1:]]),
    "missing file": _set("grains", [{"source": "/nowhere/g.stl", "unit": "mm"}, {"source": "/nowhere/a.nc"}], "refuse"),
    "density": _set("material.density", ["0 kg/m3", "-1 kg/m3", "2650", "2650 kg"], "refuse"),
    "light grains": _set("material.density", ["900 kg/m3", "1000 kg/m3", "1e-9 kg/m3", "30000 kg/m3"], "either"),
    "steps": _set("numerics.steps_per_contact_time", [2, 3, 10000, 40.5], "either"),
    "contact time": _set("numerics.contact_time", ["1 s", "1e-9 s", "1 ns", "0.1 ms"], "either"),
    "law": _set("material.law", ["hertz", "hook"], "either"),
    "gravity": _set("material.gravity", ["1e-9 m/s2", "1000 m/s2", "0 m/s2", "9.81 m/s"], "either"),
}
TEXT_FAULTS = {
    "a key twice": lambda text: text + "\nseed: 77\nseed: 78\n",
    "a group twice": lambda text: text + "\ndomain: {width: 90 mm, height: 3 m}\n",
    "no YAML": lambda text: text + "\n}{",
    "a tab": lambda text: text + "\nsizes:\n\tcase: U1\n",
    "a list": lambda text: "- 1\n- 2\n",
    "a word": lambda text: "gravel\n",
    "nothing": lambda text: "",
    "a control character": lambda text: text + "\x07",
    "an alias of nothing": lambda text: text + "\nfaces: *few\n",
    "nested deeply": lambda text: text + "\nfaces: " + 3000 * "[",
    "an object": lambda text: text + "\nfaces: !!python/object:os.system {}\n",
}

"""Recognises the columns of a table of measured grains by their names."""

import re
from dataclasses import dataclass

AXES, RATIOS = ("L", "I", "S"), ("FL", "EL")
TWO_AXES = ("L", "I")  # of grains seen from above, such as in a photo
MEANS = ("mean_FL", "std_FL", "mean_EL", "std_EL")
SAMPLE = "sample"
SAMPLE_NAMES = (SAMPLE, "probe", "bed", "bett")  # of the column of samples, in any case; the first one counts
NEEDED = (
    "give the columns L, I, S (axes of each grain), or FL, EL (of each grain), or mean_FL, std_FL, mean_EL, std_EL (of "
    "each sample)"
)

NO_DEVIATIONS = (
    "if they were not measured, give those of similar grains, such as 0.175 and 0.139 of the Rhine's gravel; 0 means "
    "that all grains have one form"
)

_UNIT = (
    "(?:[µμumcdk]?m|inch(?:es)?|in|ft|feet|px|pixels?|vox(?:el)?s?|microns?|(?:micro|milli|centi|deci)?met(?:er|re)s?)"
)
# "L", "L_mm", "L mm", "L/mm", "L, mm", "L in mm", "L [mm]", "L (mm)" and R's "L..mm." are one column.
_WITH_UNIT = rf"(?:\s*\[\s*({_UNIT})\s*\]|\s*\(\s*({_UNIT})\s*\)|\s*[/,]\s*({_UNIT})|(?:\s+in)?[\s_.-]+({_UNIT})\.?)?"
_AXIS_WORD = r"(?:[\s_-]*(?:axis|axes|achse|diameter|durchmesser|dimension|length|side))?"
# Dmax, Dmed and Dmin are the axes in exports of G3Point (Steer et al. 2022).
_AXIS_NAMES = {
    "L": r"L|a|longest|long|length|major|Dmax|d_?L|l(?:ä|ae)nge|lange?|l(?:ä|ae)ngste|achse[\s_-]+a",
    "I": r"I|b|intermediate|medium|middle|width|breadth|Dmed|d_?I|breite|mittel|mittlere|achse[\s_-]+b",
    "S": r"S|c|shortest|short|thickness|height|minor|Dmin|d_?S|h(?:(?:ö|oe)he)?|dicke|kurze?|k(?:ü|ue)rzeste"
    r"|achse[\s_-]+c",
}
_NO_UNIT = r"(?:\s*[\[(]\s*[-–1]?\s*[\])])?"
_RATIO_NAMES = {
    "FL": r"FL(?:\s*[=(\[]\s*S\s*/\s*I\s*[)\]]?)?|S\s*/\s*I|c\s*/\s*b",
    "EL": r"EL(?:\s*[=(\[]\s*I\s*/\s*L\s*[)\]]?)?|I\s*/\s*L|b\s*/\s*a",
}
_STATISTICS = {
    "mean": r"mean|mu|µ|μ|average|avg",
    "std": r"std|sigma|σ|sd|st\.?\s?dev|std\.?\s?dev|standard deviation",
}
_PERCENT = r"[\s_]*[\[(]?\s*(?:%|percent)\s*[\])]?"
_OF_GRAINS = r"[\s_]+(?:of[\s_]+)?(?:the[\s_]+)?(?:grains|particles|clasts|pebbles|stones|körner)"
_RUNNING = r"n|number|anzahl"  # a column of this name may also number the rows
_COUNTS = (
    rf"(?:counts?|{_RUNNING}|grains|frequency|freq\.?|häufigkeit|(?:count|number|no\.?|n|anzahl){_OF_GRAINS})"
    rf"(?:{_NO_UNIT}|{_PERCENT})"
)
_MINOR = rf"minor{_AXIS_WORD}{_WITH_UNIT}"


@dataclass(frozen=True)
class FormColumns:
    """The columns of a table that are read, as positions from 0.

    kind: AXES, RATIOS, MEANS or TWO_AXES. forms: position of each name of the kind. counts: position of the column
    with the number of grains in each row, or None. sample: position of the column with the name of the sample, or None.
    """

    kind: tuple
    forms: dict
    counts: int | None
    sample: int | None

    @property
    def used(self):
        """Set of all positions that are read."""
        return {*self.forms.values(), self.counts, self.sample} - {None}


def recognise_columns(path, header, sample=None, two_axes=False):
    """Return the FormColumns of a table.

    header: list of the names of the columns. sample: name of the column of samples; with None it is the first of
    SAMPLE_NAMES that the table has, if any. two_axes: whether the longest and the middle axis suffice. ValueError,
    which names the file `path`, if the columns of a form are missing, if two columns have the same meaning, if a form
    is in percent, or if the units of the axes differ.
    """
    names = _recognise_forms(path, header)
    kind = _kind(names, two_axes)
    if kind is None:
        raise ValueError(f"{path}: {_what_is_missing(header, names)}; {NEEDED}")
    forms = {name: _only(path, header, names[name], name) for name in kind}
    if kind in (AXES, TWO_AXES):
        _check_units(path, {axis: _unit(header[position]) for axis, position in forms.items()})
    by = sample_position(path, header, sample)
    if by in forms.values():
        raise ValueError(f"{path}: {header[by]} is a form, not the name of a sample; name another column")
    counts = [i for i, name in enumerate(header) if i != by and i not in forms.values() and _matches(_COUNTS, name)]
    if kind == MEANS and len(counts) > 1:
        counts = [i for i in counts if not may_number_rows(header[i])]  # `n` beside them may be a porosity
    return FormColumns(kind, forms, _only(path, header, counts, "the number of grains") if counts else None, by)


def has_two_axes(path, header):
    """Return whether a table with these names of columns has the longest and the middle axis, but no form.

    ValueError as in recognise_columns if a form is in percent.
    """
    return _kind(_recognise_forms(path, header), two_axes=True) == TWO_AXES


def _kind(names, two_axes):
    """Return the kind of a table whose recognised columns are `names`, or None."""
    kinds = (AXES, RATIOS, MEANS, TWO_AXES) if two_axes else (AXES, RATIOS, MEANS)
    return next((kind for kind in kinds if set(kind) <= set(names)), None)


def may_number_rows(name):
    """Return whether a column of this name may number the rows instead of counting grains."""
    return _matches(_RUNNING, name)


def form_patterns():
    """Return the regular expression of the names of each meaning of AXES, RATIOS and MEANS, dict of str."""
    patterns = {axis: rf"(?:{names}){_AXIS_WORD}{_WITH_UNIT}" for axis, names in _AXIS_NAMES.items()}
    patterns |= {ratio: f"(?:{names}){_NO_UNIT}" for ratio, names in _RATIO_NAMES.items()}
    for statistic, words in _STATISTICS.items():
        for ratio in RATIOS:
            gap = r"[\s_.-]*"
            patterns[f"{statistic}_{ratio}"] = f"(?:(?:{words}){gap}{ratio}|{ratio}{gap}(?:{words})){_NO_UNIT}"
    return patterns


def all_patterns():
    """Return the regular expressions of the names of columns, for a reader in another language, as plain data.

    forms: of each meaning; axes: of those of AXES, without a unit; percent: of those of RATIOS and MEANS in percent,
    which are refused; minor, counts, running: of a minor axis, a number of grains, and a number that may also count the
    rows. Case does not matter, and a whole name must match. The groups of an axis are its units.
    """
    forms = form_patterns()
    percent = {meaning: _in_percent(pattern) for meaning, pattern in forms.items() if meaning not in AXES}
    return {
        "forms": forms,
        "axes": _AXIS_NAMES,
        "percent": percent,
        "minor": _MINOR,
        "counts": _COUNTS,
        "running": _RUNNING,
    }


def _in_percent(pattern):
    return pattern.removesuffix(_NO_UNIT) + _PERCENT


def _recognise_forms(path, header):
    """Return the positions of the columns that match each name of AXES, RATIOS and MEANS, dict of lists."""
    patterns = form_patterns()
    names = {}
    for position, name in enumerate(header):
        for meaning, pattern in patterns.items():
            if _matches(pattern, name):
                names.setdefault(meaning, []).append(position)
            elif meaning not in AXES and _matches(_in_percent(pattern), name):
                raise ValueError(f"{path}: the column {name} is in percent; give {meaning} as a fraction, 0.65 not 65")
    if "S" in names and "I" not in names and all(_matches(_MINOR, header[i]) for i in names["S"]):
        names["I"] = names.pop("S")  # without a middle axis, major and minor are those of an ellipse in a photo
    # Programs for photos give each axis in pixels and in a length.
    for axis in set(AXES) & set(names):
        of_length = [i for i in names[axis] if (_unit(header[i]) or "px")[:2] not in ("px", "pi")]
        if len(of_length) == 1 and all(_unit(header[i]) for i in names[axis]):
            names[axis] = of_length
    return names


def _what_is_missing(header, names):
    """Describe why the table is none of the three kinds, without a full stop."""
    columns = ", ".join(name or "(no name)" for name in header)
    for kind in (MEANS, RATIOS, AXES):
        missing = [name for name in kind if name not in names]
        if len(missing) < len(kind):
            verb = "column {} is" if len(missing) == 1 else "columns {} are"
            text = f"the {verb.format(', '.join(missing))} missing beside {columns}"
            return f"{text} ({NO_DEVIATIONS})" if set(missing) == {"std_FL", "std_EL"} else text
    if named := [name for name in header if re.match("flatness|elongation", name, re.IGNORECASE)]:
        return (
            f"{' and '.join(named)} may be defined in several ways; if FL = S/I and EL = I/L are meant, name the "
            "columns FL and EL"
        )
    for name in header:
        unit = re.fullmatch(r"(.*?)\s*[\[(]\s*(.*?)\s*[\])]", name)
        if unit and any(_matches(axis, unit[1]) for axis in _AXIS_NAMES.values()):
            return f"the column {name} has the unknown unit '{unit[2]}'; axes are in m, cm, mm, µm, in, ft or pixels"
    if any(re.match(r"[-+.]?\d", name) for name in header):
        return f"the first row ({columns}) contains numbers where the names of the columns are needed"
    return f"none of its columns ({columns}) is an axis or a form"


def _only(path, header, positions, meaning):
    """Return the single position of the columns with one meaning; ValueError if there are several."""
    if len(positions) == 1:
        return positions[0]
    name, other = (header[position] for position in positions[:2])
    if name == other:
        raise ValueError(f"{path}: two columns are named {name}; remove or rename one")
    raise ValueError(f"{path}: the columns {name} and {other} are both {meaning}; remove one")


def sample_position(path, header, sample=None):
    """Return the position of the column with the names of the samples, None without one.

    Arguments and errors are those of recognise_columns.
    """
    for wanted in SAMPLE_NAMES if sample is None else (" ".join(sample.split()),):
        for normalise in (str, str.lower):
            positions = [position for position, name in enumerate(header) if normalise(name) == normalise(wanted)]
            if positions:
                return _only(path, header, positions, "the sample")
    if sample is None:
        return None
    raise ValueError(
        f"{path}: there is no column {sample} to distinguish the samples; the columns are {', '.join(header)}"
    )


def _check_units(path, units):
    if len(set(units.values())) > 1:
        mixed = ", ".join(f"{axis} in {units[axis] or 'no unit'}" for axis in units)
        axes = "all three axes" if len(units) == len(AXES) else "both axes"
        raise ValueError(f"{path}: the header mixes units ({mixed}); give {axes} in one unit")


def _unit(name):
    """Return the unit in the name of a column of axes, in one spelling, or None if there is no unit."""
    for names in _AXIS_NAMES.values():
        match = re.fullmatch(f"(?:{names}){_AXIS_WORD}{_WITH_UNIT}", name, re.IGNORECASE)
        if match:
            unit = next(filter(None, match.groups()), None)
            return unit and re.sub("^(?:[uμ]m|microns?)$", "µm", unit.lower())
    return None


def _matches(pattern, name):
    return re.fullmatch(pattern, name, re.IGNORECASE) is not None

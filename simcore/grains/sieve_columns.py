"""Recognises the columns of a table of a sieve curve by their names: the openings, and the amounts on the sieves."""

import re
from dataclasses import dataclass

from simcore.grains.cell_numbers import NUMBER
from simcore.grains.form_columns import SAMPLE_NAMES
from simcore.grains.form_notices import SHOWN
from simcore.grains.table_file import plain_words
from simcore.grains.text_lists import join_first

NEEDED = (
    "give a column of sieve openings, such as `opening [mm]` or `phi`, or of classes, such as `class [mm]` with "
    "8-11.2, or the two columns `from [mm]` and `to [mm]`, and one of amounts, such as `mass [g]`, "
    "`retained [%]` or `passing [%]`"
)
# Lengths in metres; phi is -log2 of the opening in mm, and psi is -phi.
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "in": 0.0254}
PHI, PSI = "phi", "psi"
LOGARITHMS = (PHI, PSI)
PERCENT, FRACTION = "%", "1"
MASSES = {"mg": 1e-6, "g": 1e-3, "kg": 1.0, "t": 1000.0, "lb": 0.45359237}
RETAINED, PASSING, CUMULATIVE = "retained", "passing", "cumulative retained"
OPENING = "opening"
# Cells of the column of openings that mean what passes the finest sieve.
PAN = re.compile(
    r"pan|receiver|bottom|base|tray|fines|(?:sieb)?boden|(?:boden|auffang)?schale|auffangboden|pfanne|feinanteil|fond"
    r"|plateau|r(?:é|e)sidu|rest(?:korn)?|< ?\S.*",
    re.IGNORECASE,
)

_SPELLINGS = {
    "um": "µm", "μm": "µm", "micron": "µm", "microns": "µm", "micrometer": "µm", "micrometre": "µm",
    "millimeter": "mm", "millimetre": "mm", "inch": "in", "inches": "in", "φ": PHI, "Φ": PHI, "ϕ": PHI, "phi": PHI,
    "ψ": PSI, "Ψ": PSI, '"': "in", "″": "in", "”": "in",
    "percent": PERCENT, "pct": PERCENT, "wt%": PERCENT, "wt.%": PERCENT, "wt-%": PERCENT, "mass%": PERCENT,
    "mass-%": PERCENT, "masse-%": PERCENT, "m-%": PERCENT, "m.-%": PERCENT, "ma.-%": PERCENT, "gew%": PERCENT,
    "gew.%": PERCENT, "gew-%": PERCENT, "gew.-%": PERCENT, "gram": "g", "grams": "g", "lbs": "lb",
    "-": FRACTION,
}  # fmt: skip
_OPENING_WORDS = {
    "opening", "openings", "aperture", "mesh", "size", "sieve", "sieves", "diameter", "d", "grainsize", "maschenweite",
    "siebweite", "sieb", "siebe", "prüfsieb", "prüfsiebe", "siebgröße", "sieböffnung", "maschenöffnung", "öffnung",
    "korngröße", "korndurchmesser", "tamis", "ouverture", "diamètre", "ø", PHI, PSI,
}  # fmt: skip
# Words of a column with the upper, or the mean sizes of classes.
_UPPER_WORDS = {
    "upper", "max", "maximum", "smaller", "less", "up", "bis", "kleiner", "obere", "oberer", "oberes",
    "oberen", "sup", "supérieur", "supérieure",
}  # fmt: skip
_MEAN_WORDS = {
    "mean", "average", "middle", "mid", "centre", "center", "median", "mittel", "mittlere", "mittlerer", "mittleres",
    "moyen", "moyenne",
}  # fmt: skip
_PASSING_WORDS = {
    "passing", "passes", "finer", "undersize", "durchgang", "siebdurchgang", "durchgangssumme", "durchgänge",
    "unterkorn", "passant", "passants", "tamisat", "tamisats",
}  # fmt: skip
_COARSER_WORDS = {"coarser", "oversize", "rückstandssumme", "summenrückstand"}
_SUMMED_WORDS = {
    "cumulative",
    "cumulated",
    "cum",
    "cumul",
    "cumulé",
    "cumulée",
    "cumulés",
    "cumulées",
    "accumulated",
    "running",
    "kumuliert",
    "kumulativ",
    "kum",
    "aufsummiert",
    "aufaddiert",
    "summe",
    "σ",
}
_RETAINED_WORDS = {
    "retained", "mass", "masses", "weight", "weights", "fraction", "fractions", "rückstand", "masse", "gewicht",
    "refus", "percent", "wt", "siebrückstand", "auswaage", "anteil", "anteile", "massenanteil", "gew",
}  # fmt: skip
# Words of a column with the masses of the sieves, with or without grains on them. Those of _SIEVE_WORDS mean it only if
# they are joined with some of _GRAIN_WORDS, as in "sieve + sample", or stand alone, as in "mass of sieve".
_GROSS_WORDS = {
    "gross", "brutto", "bruttomasse", "brut", "tare", "tara", "leer", "leermasse", "leergewicht", "empty", "vide",
    "full", "voll", "plein",
}  # fmt: skip
_SIEVE_WORDS = {"sieve", "sieb", "siebs", "siebes", "tamis"}
_GRAIN_WORDS = {"sample", "soil", "material", "grains", "probe", "rückstand", "échantillon", "sol"}
_JOINING_WORDS = {"and", "with", "incl", "und", "mit", "inkl", "et", "avec"}
_MASS_WORDS = {"mass", "weight", "masse", "gewicht"}
_OF_WORDS = {"of", "the", "des", "du", *_MASS_WORDS}
_COUNT_WORDS = {"count", "counts", "number", "numbers", "anzahl", "n"}
_BRACKETS = re.compile(r"\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
# A unit without brackets: "opening_mm", "mass g", "size, mm".
_TRAILING = re.compile(
    r"[\s_,/.-]+(?:in\s+)?(mm|cm|m|µm|um|μm|microns?|inch(?:es)?|phi|φ|psi|ψ|g|kg|mg|lbs?|%)\.?$", re.IGNORECASE
)


@dataclass(frozen=True)
class AmountColumn:
    """A column of amounts: its position, its meaning (RETAINED, PASSING or CUMULATIVE) and its unit, or None."""

    position: int
    meaning: str
    unit: str | None


@dataclass(frozen=True)
class SieveColumns:
    """The columns that are read: position and unit (None if the cells have it) of the openings; the amounts."""

    opening: int
    unit: str | None
    amounts: list


def recognise_sieve_columns(path, table, classes=None):
    """Return the SieveColumns of a TextTable.

    classes: position of a column of classes whose cells have been replaced by openings, with their unit, or None.
    ValueError, which names the file `path`, if a needed column is missing, if two have the same meaning, or if a unit
    is unknown or of the wrong kind.
    """
    header, openings, amounts = table.header, [], []
    gross = [name for name in header if has_mass_of_sieve(name)]
    for position, name in enumerate(header):
        if gross and _may_be_mass_of_sieve(name):
            continue
        meaning, unit = (OPENING, None) if position == classes else column_meaning(path, name)
        if meaning == OPENING:
            openings.append((position, unit))
        elif meaning is not None:
            amounts.append(AmountColumn(position, meaning, unit))
    names = [name or "(no name)" for name in header]
    if not openings:
        raise ValueError(f"{path}: none of the columns ({', '.join(names)}) has sieve openings; {NEEDED}")
    if not amounts and gross:
        raise ValueError(
            f"{path}: the column {gross[0]} has the mass of the sieve in it; give the mass of the grains, which is the "
            "difference, in a column `mass [g]`"
        )
    if not amounts:
        raise ValueError(f"{path}: {_without_amounts(names, table.cells, openings[0][0])}")
    if len(openings) > 1:
        names = " and ".join(header[position] for position, _ in openings[:2])
        raise ValueError(f"{path}: the columns {names} are both sieve openings; remove one")
    if openings[0][0] != classes:
        _check_lower_size(path, header[openings[0][0]], amounts)
    kinds = [(column.meaning, column.unit in MASSES) for column in amounts]
    for i, kind in enumerate(kinds):
        if kind in kinds[:i]:
            names = f"{header[amounts[kinds.index(kind)].position]} and {header[amounts[i].position]}"
            raise ValueError(f"{path}: the columns {names} are both the amount {amounts[i].meaning}; remove one")
    return SieveColumns(*openings[0], amounts)


def _check_lower_size(path, name, amounts):
    """Raise ValueError if a column has the upper or mean sizes of classes, but an amount is of the sieve below them."""
    text = split_unit(name)[0]
    words = plain_words(text)
    kind = "upper" if words & _UPPER_WORDS or "<" in text else "mean" if words & _MEAN_WORDS else None
    if kind and all(column.meaning != PASSING for column in amounts):
        raise ValueError(
            f"{path}: the column {name} seems to have the {kind} sizes of classes, but the sieve is needed that "
            "retains a class; give that sieve, such as `opening [mm]`, or both bounds as `from [mm]` and `to [mm]`; "
            "if the table has them, remove this column"
        )


def check_one_sample(path, table, used):
    """Raise ValueError if a column of a TextTable names several samples; used: positions of those that are read."""
    for position, name in enumerate(table.header):
        names = list(dict.fromkeys(text for text in table.cells[position] if text))
        if position not in used and name.lower() in SAMPLE_NAMES and len(names) > 1:
            raise ValueError(
                f"{path}: the column {name} has several samples ({join_first(names, SHOWN)}); a table has one sieve "
                "curve, so that each sample needs its own file"
            )


def notices_of_counts(name, unused, amounts):
    """Return a notice if counts of grains stand beside shares in percent, which may then be by number.

    name: of the column with the shares. unused: names of the columns that are not read. amounts: AmountColumns.
    """
    counts = next(filter(counts_grains, unused), None)
    if counts is None or any(column.unit not in (PERCENT, FRACTION) for column in amounts):
        return []
    return [
        f"the column {counts} has counts of grains; {name} must be shares of the mass, or of counts on a grid (Wolman)"
        ", not of the number of all grains"
    ]


def _without_amounts(names, cells, opening):
    """Return what is wrong with a table without amounts: a column for each of several samples, counts, or neither.

    names: of the columns of `cells`. opening: position of the column of openings.
    """
    counts = list(filter(counts_grains, names))
    numeric = []
    for name, (position, texts) in zip(names, cells.items(), strict=True):
        filled = [text for text in texts if text]
        if position != opening and name not in counts and filled and all(map(NUMBER.fullmatch, filled)):
            numeric.append(name)
    if len(numeric) > 1:
        return (
            f"the columns {', '.join(numeric)} are not named as amounts; a table has one sieve curve, so that each "
            "sample needs its own file with a column such as `mass [g]`"
        )
    if counts:
        return (
            f"the column {counts[0]} has counts of grains; a sieve curve needs masses, such as `mass [g]`. Counts on a "
            "grid on the surface (Wolman) may be named `retained`"
        )
    return f"none of the columns ({', '.join(names)}) has amounts; {NEEDED}"


def column_meaning(path, name):
    """Return (OPENING, RETAINED, PASSING, CUMULATIVE or None, unit or None) of a column with this name."""
    words, unit = _split(path, name)
    return None if has_mass_of_sieve(name) else _meaning(path, name, words, unit), unit


def has_mass_of_sieve(name):
    """Return whether a column of this name has masses of sieves, with or without the grains on them."""
    text = split_unit(name)[0]
    words = plain_words(text)
    joined = "+" in text or bool(words & _JOINING_WORDS)
    both = joined and bool(words & _SIEVE_WORDS) and bool(words & _GRAIN_WORDS)
    alone = words <= _SIEVE_WORDS | _OF_WORDS and bool(words & _SIEVE_WORDS) and bool(words & {"of", "des", "du"})
    return bool(words & _GROSS_WORDS) or both or alone


def _may_be_mass_of_sieve(name):
    """Return whether a name, such as "sieve mass [g]", means the mass of the sieves beside one with grains on them."""
    text, unit = split_unit(name)
    words = plain_words(text)
    of_mass = bool(words & _MASS_WORDS) or known_unit(unit or "") in MASSES
    return of_mass and words <= _SIEVE_WORDS | _MASS_WORDS and bool(words & _SIEVE_WORDS)


def counts_grains(name):
    """Return whether a column of this name has counts of grains."""
    return bool(plain_words(name) & _COUNT_WORDS)


def unit_in_name(name):
    """Return the text of the unit in the name of a column, or None."""
    return split_unit(name)[1]


def split_unit(name):
    """Return the name of a column without its unit, and the text of the unit or None."""
    match = _BRACKETS.search(name) or _TRAILING.search(name)
    return (name[: match.start()], match[1]) if match else (name, None)


def known_unit(text):
    """Return a unit in the spelling of this module, or None if it is unknown."""
    unit = _SPELLINGS.get(text, _SPELLINGS.get(text.lower(), text.lower()))
    return unit if unit in {*LENGTHS, *MASSES, *LOGARITHMS, PERCENT, FRACTION} else None


def reading_rules():
    """Return the words, units and patterns by which columns are recognised, as plain values for another language."""
    words = {
        "opening": _OPENING_WORDS, "passing": _PASSING_WORDS, "coarser": _COARSER_WORDS, "summed": _SUMMED_WORDS,
        "retained": _RETAINED_WORDS, "count": _COUNT_WORDS, "gross": _GROSS_WORDS, "sieve": _SIEVE_WORDS,
        "grains": _GRAIN_WORDS, "joining": _JOINING_WORDS, "of": _OF_WORDS, "mass": _MASS_WORDS,
        "upper": _UPPER_WORDS, "mean_size": _MEAN_WORDS,
    }  # fmt: skip
    return {
        "words": {key: sorted(values) for key, values in words.items()},
        "spellings": _SPELLINGS,
        "lengths": LENGTHS,
        "masses": MASSES,
        "patterns": {"brackets": _BRACKETS.pattern, "trailing": _TRAILING.pattern, "pan": PAN.pattern},
        "needed": NEEDED,
    }


def _split(path, name):
    """Return the words of a column's name without its unit, and the unit or None."""
    text = name.lower()
    bare = known_unit(text)
    if bare in LOGARITHMS:
        return {bare}, bare
    if bare in LENGTHS:
        return {OPENING}, bare
    if bare in MASSES or bare == PERCENT:
        return {"retained"}, bare
    match = _BRACKETS.search(name) or _TRAILING.search(name)
    unit = known_unit(match[1]) if match else None
    words = plain_words(text[: match.start()] if match else text)
    if match and unit is None and match[1] and words & {*_OPENING_WORDS, *_RETAINED_WORDS, *_PASSING_WORDS}:
        raise ValueError(
            f"{path}: the column {name} has the unknown unit '{match[1]}'; sieve openings are in "
            f"{', '.join([*LENGTHS, *LOGARITHMS])}, amounts in {', '.join(MASSES)} or %"
        )
    if unit is None and (words & {"percent", "pct"} or "%" in text):
        unit = PERCENT
    if unit is None and words & {"fraction", "fractions"}:
        unit = FRACTION
    return words, unit


def _meaning(path, name, words, unit):
    """Return OPENING, the meaning of an amount, or None for a column that is not needed."""
    if words & _PASSING_WORDS:
        meaning = PASSING
    elif words & _COARSER_WORDS or words & _SUMMED_WORDS and words & _RETAINED_WORDS - {"percent"}:
        meaning = CUMULATIVE
    elif words & _SUMMED_WORDS:
        raise ValueError(f"{path}: the column {name} may be passing or retained; name it `passing [%]` or "
                         "`cumulative retained [%]`")  # fmt: skip
    elif words & _RETAINED_WORDS:
        meaning = RETAINED
    elif words & _OPENING_WORDS:
        meaning = OPENING
    else:
        return None
    of_length = unit in LENGTHS or unit in LOGARITHMS
    if meaning == OPENING and unit is not None and not of_length:
        raise ValueError(f"{path}: the column {name} is in {unit}, but sieve openings are a length; correct its name")
    if meaning != OPENING and of_length:
        raise ValueError(f"{path}: the column {name} is in {unit}, but amounts are masses or percent; correct its name")
    return meaning

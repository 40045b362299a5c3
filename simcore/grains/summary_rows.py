"""Finds the rows of a table that summarise others, such as Mean, Max or Total, or have a loss, by their labels."""

import re

_STRONG = (
    r"means?|averages?|avg|mittelwert|mittel|mw|moyenne|medians?|medianwert|médiane|zentralwert|modus|max|maximum|maxima"
    r"|maximalwert|min|minimum|minima|minimalwert|std|stdev|stddev|st\.?\s?dev|std\.?\s?dev|std\.?\s?deviation"
    r"|standard[\s-]?deviation|standard[\s-]?error|std\.?\s?err(?:or)?|standardabweichung|stabw|écart[\s-]type|variance"
    r"|varianz|coefficient of variation|skewness|kurtosis|sums?|summe|somme|totals?|gesamt|insgesamt|subtotal"
    r"|zwischensumme|percentile|quartile|quantile|loss(?:es)?|siebverluste?|verluste?|pertes?|einwaage"
    r"|(?:dry[\s_]+)?(?:mass|weight|total)[\s_]+before[\s_]+sieving"
)
# These may also be names of grains or places, so they count only next to another label.
_WEAK = r"sd|se|sem|cv|var|n|count|counts|number|anzahl|range|mode|q[1-4]|[dp]\d{1,2}|\d{1,2}(?:[.,]\d+)?\s?%"
_BEFORE = r"(?:(?:grand|overall|arithmetic|geometric|harmonic|weighted|sample|population|arithm\.?)[\s_]+)?"
_AFTER = (
    r"(?:\s*[.:=])?(?:[\s_]*[(\[].*[)\]])?(?:[\s_]+(?:values?|wert|of\b.*|all|all grains|grains|dev\.?))?(?:\s*[.:=])?"
)

_ALL = (
    r"(?:grand[\s_]+)?(?:sums?|summe|somme|totals?|gesamt|insgesamt|einwaage|(?:dry[\s_]+)?(?:mass|weight|total)[\s_]+before"
    r"[\s_]+sieving)(?:\s*[.:=])?(?:\s*[(\[].*[)\]])?"
)


def find_summary_rows(cells):
    """Return the labels of the rows that summarise others, dict from index to the text of the label.

    cells: DataFrame of str, the columns that may contain labels. A row counts if the whole text of a cell is a label,
    in English, German or French. There are two exceptions for grains whose names look like labels: a label that a
    neighbouring row also has is a name (grains that Max measured), and short labels (SD, n, 25 %) count only next to
    another label.
    """
    labels = {}
    for _, texts in cells.items():
        words = texts.str.lower().tolist()
        places = {i for i, word in enumerate(words) if _is_label(_STRONG, word) and word not in _beside(words, i)}
        weak = {i for i, word in enumerate(words) if _is_label(_WEAK, word)} if places else set()
        while joined := {i for i in weak - places if {i - 1, i + 1} & places}:
            places |= joined
        labels |= {texts.index[i]: texts.iloc[i] for i in places if texts.index[i] not in labels}
    return dict(sorted(labels.items()))


def is_total(label):
    """Return whether the label of a row that summarises others is that of the sum of all of them."""
    return re.fullmatch(_ALL, label, re.IGNORECASE) is not None


def label_patterns():
    """Return the regular expressions of labels, dict; a whole text must match, in any case.

    strong: labels. weak: labels only next to another one. total: those of the sum of the other rows.
    """
    return {"strong": _pattern(_STRONG), "weak": _pattern(_WEAK), "total": _ALL}


def _beside(words, i):
    """Return the texts of the rows before and after row i."""
    return words[max(i - 1, 0) : i] + words[i + 1 : i + 2]


def _is_label(words, text):
    return re.fullmatch(_pattern(words), text, re.IGNORECASE) is not None


def _pattern(words):
    return f"{_BEFORE}(?:{words}){_AFTER}"

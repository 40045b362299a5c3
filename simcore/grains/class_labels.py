"""Recognises a column of sieve classes by its name and by its cells, such as "8-11.2 mm"."""

import re

CLASS_NAME = re.compile(
    r"(?:(?:(?:size|sieve)[ _-]*)?class|(?:sieb|korn)?klasse)(?:\s*[\[(]([a-zµμ]+)[\])])?", re.IGNORECASE
)
CLASS_LABEL = re.compile(r"([\d.,]+)\s*([a-zµ]*)\s*(?:-|–|to|\.\.)\s*([\d.,]+)\s*([a-zµ]*)", re.IGNORECASE)


def class_patterns():
    """Return the regular expressions of the name of the column and of its cells; whole texts match, in any case."""
    return CLASS_NAME.pattern, CLASS_LABEL.pattern


def look_like_classes(texts):
    """Return whether there are texts, and each of them is a range of sizes, the smaller one first."""
    matches = [CLASS_LABEL.fullmatch(text) for text in texts]
    try:
        return bool(matches) and all(match and _number(match[1]) < _number(match[3]) for match in matches)
    except ValueError:
        return False


def _number(text):
    return float(text.replace(",", "."))

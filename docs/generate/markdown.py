"""Parts of a page in Markdown."""


def table(header, rows):
    """Return a table in Markdown. header: names of the columns; rows: lists of cells, text or numbers.

    Line breaks and vertical bars in cells are replaced, because they would end a cell.
    """
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines)


def code(text):
    """Return text as code, or an empty text as such."""
    return f"`{text}`" if str(text) else ""


def sentence(text):
    """Return text that begins with a capital letter, unless with a name or symbol, and ends with a full stop."""
    text = " ".join(str(text).split())
    first = text.partition(" ")[0]
    is_word = first == "a" or (first.rstrip(",;:.").isalpha() and first[1:].islower())  # neither netCDF nor a symbol
    start = text[:1].upper() if is_word else text[:1]
    return start + text[1:] + ("" if text.endswith((".", "!", "?", "…")) else ".") if text else ""


def _cell(value):
    return " ".join(str(value).split()).replace("|", "\\|")

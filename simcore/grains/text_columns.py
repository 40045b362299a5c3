"""Tables for the terminal: cells in columns of equal width."""

from tabulate import tabulate

_ALIGNMENTS = {"l": "left", "r": "right"}


def text_columns(rows, align="l") -> list[str]:
    """Return the lines of a table of text cells, two spaces between its columns.

    rows: lists of str of one length, the header first. align: "l" or "r" for all columns, or one letter per column.
    """
    letters = align * len(rows[0]) if len(align) == 1 else align
    alignments = [_ALIGNMENTS[letter] for letter in letters]
    text = tabulate(rows, tablefmt="plain", disable_numparse=True, colalign=alignments)
    return [line.rstrip() for line in text.split("\n")]

"""A static HTML page of tables and pictures that needs no other file."""

import base64
from html import escape
from pathlib import Path

import pandas as pd

# A picture of several panels gets the whole width of the page: panels in one row are recognised by width over height,
# panels in several rows by the number of pixels.
WIDE, WIDE_PIXELS = 1.6, 1200
# Longer text is broken into lines.
LONG_TEXT = 28
# Longer tables are folded, so that the page stays short.
ROWS_SHOWN = 24

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #1c2526; }
h1, h2 { line-height: 1.2; } h2 { margin-top: 2.5rem; border-top: 1px solid #cdd4d5; padding-top: 1rem; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.85rem; margin: 0.5rem 0; }
th, td { padding: 0.2rem 0.7rem; text-align: right; border-bottom: 1px solid #e3e8e8; white-space: nowrap; }
th { background: #f1f4f4; white-space: normal; vertical-align: bottom; } td.text, th.text { text-align: left; }
td.long { white-space: normal; min-width: 11rem; max-width: 22rem; } summary { cursor: pointer; font-size: 0.9rem; }
figure { display: inline-block; margin: 1rem; vertical-align: top; max-width: 32rem; }
figure.wide { display: block; max-width: none; }
img { width: 100%; }
figcaption, .note { color: #53605f; font-size: 0.9rem; }
.file { color: #8a9695; font-size: 0.75rem; }
.banner { background: #ffe9b8; padding: 0.6rem 1rem; font-weight: bold; }
nav a { margin-right: 1rem; }
"""


def page(title, lead, sections, banner=""):
    """Return the page as HTML text.

    lead: paragraph under the title; sections: list of (heading, list of HTML fragments from `paragraph`, `table`
    and `picture`); banner: warning at the top of the page, none if empty.
    """
    links = " ".join(f'<a href="#{_anchor(heading)}">{escape(heading)}</a>' for heading, _ in sections)
    parts = [
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>',
        f"<style>{_STYLE}</style></head><body>",
        f'<p class="banner">{escape(banner)}</p>' if banner else "",
        f"<h1>{escape(title)}</h1>\n<p>{escape(lead)}</p>\n<nav>{links}</nav>",
    ]
    for heading, fragments in sections:
        parts += [f'<h2 id="{_anchor(heading)}">{escape(heading)}</h2>', *fragments]
    return "\n".join(filter(None, parts)) + "\n</body></html>\n"


def paragraph(text):
    """Return a paragraph of plain text."""
    return f'<p class="note">{escape(text)}</p>'


def bullets(texts):
    """Return a list of plain texts."""
    items = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f'<ul class="note">{items}</ul>'


def table(path, caption="", behind=()):
    """Return the CSV file at `path` as a table under a caption, in the format of `rows_table`.

    A column `note` is left out, because the banner of the page has the same text. behind: columns that are moved to the
    right end, so that the important columns are visible without scrolling.
    """
    rows = pd.read_csv(path).drop(columns="note", errors="ignore")
    rows = rows[[*rows.columns.difference(behind, sort=False), *(name for name in behind if name in rows)]]
    return f'<p class="note">{_caption(caption, path)}</p>\n{rows_table(rows)}'


def rows_table(rows):
    """Return a DataFrame as a table: numbers with four significant digits, missing values empty.

    Columns without any value are left out. A table of more than ROWS_SHOWN rows is folded.
    """
    rows = rows.dropna(axis="columns", how="all") if len(rows) else rows
    texts = [not pd.api.types.is_numeric_dtype(rows[name]) for name in rows]
    # Column names may be broken after an underscore.
    head = "".join(_element("th", name, text).replace("_", "_<wbr>") for name, text in zip(rows, texts, strict=True))
    body = "\n".join(
        "<tr>" + "".join(_element("td", value, text) for value, text in zip(row, texts, strict=True)) + "</tr>"
        for row in rows.itertuples(index=False)
    )
    shown = f'<div class="scroll"><table><tr>{head}</tr>\n{body}</table></div>'
    return shown if len(rows) <= ROWS_SHOWN else f"<details><summary>{len(rows)} rows</summary>\n{shown}</details>"


def picture(path, caption=""):
    """Return the PNG file at `path`, embedded in the page, over a caption; a wide one has the width of the page."""
    content = Path(path).read_bytes()
    data, name = base64.b64encode(content).decode(), escape(caption or str(path))
    # The first chunk of a PNG file contains width and height.
    width, height = (int.from_bytes(content[start : start + 4], "big") for start in (16, 20))
    wide = ' class="wide"' if width > min(WIDE * height, WIDE_PIXELS) else ""
    return (
        f'<figure{wide}><img alt="{name}" src="data:image/png;base64,{data}">'
        f"<figcaption>{_caption(caption, path)}</figcaption></figure>"
    )


def is_picture(fragment):
    """Return whether a fragment comes from `picture`."""
    return fragment.startswith("<figure")


def _caption(text, path):
    """Return the caption with the name of the file."""
    return " ".join(filter(None, [escape(text), f'<span class="file">{escape(str(path))}</span>']))


def _element(tag, value, text):
    """Return a cell of a table; text: whether its column contains text instead of numbers."""
    shown = _cell(value)
    kinds = " ".join(["text"] * text + ["long"] * (text and len(shown) > LONG_TEXT))
    return f'<{tag} class="{kinds}">{shown}</{tag}>' if kinds else f"<{tag}>{shown}</{tag}>"


def _cell(value):
    if pd.isna(value):
        return ""
    if not isinstance(value, float):
        return escape(str(value))
    return f"{value:.0f}" if 1000 <= abs(value) < 1e9 else f"{value:.4g}"


def _anchor(heading):
    return "".join(letter if letter.isalnum() else "-" for letter in heading.lower())

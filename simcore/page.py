"""One static HTML page of tables and pictures that needs no other file."""

import base64
from html import escape
from pathlib import Path

import pandas as pd

# A picture of two panels and more needs the whole width: by width over height, or, where they stand in rows, by pixels.
WIDE, WIDE_PIXELS = 1.6, 1200

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #1c2526; }
h1, h2 { line-height: 1.2; } h2 { margin-top: 2.5rem; border-top: 1px solid #cdd4d5; padding-top: 1rem; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.85rem; margin: 0.5rem 0; }
th, td { padding: 0.2rem 0.7rem; text-align: right; border-bottom: 1px solid #e3e8e8; white-space: nowrap; }
th { background: #f1f4f4; } td.text, th.text { text-align: left; }
figure { display: inline-block; margin: 1rem; vertical-align: top; max-width: 32rem; }
figure.wide { display: block; max-width: none; }
img { width: 100%; }
figcaption, .note { color: #53605f; font-size: 0.9rem; }
.file { color: #8a9695; font-size: 0.75rem; }
.banner { background: #ffe9b8; padding: 0.6rem 1rem; font-weight: bold; }
nav a { margin-right: 1rem; }
"""


def page(title, lead, sections, banner=""):
    """The whole page as text.

    lead: a paragraph under the title; sections: list of (heading, list of HTML fragments from `paragraph`, `table`
    and `picture`); banner: a warning on top of the page, none if empty.
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
    """A paragraph of plain text."""
    return f'<p class="note">{escape(text)}</p>'


def table(path, caption=""):
    """The CSV file at `path` as a table under a caption; numbers to four significant digits, nothing where there is no
    value. A column `note` is left out: the page's banner says it once."""
    rows = pd.read_csv(path).drop(columns="note", errors="ignore")
    kinds = ["" if pd.api.types.is_numeric_dtype(rows[name]) else ' class="text"' for name in rows]
    head = "".join(f"<th{kind}>{escape(str(name))}</th>" for name, kind in zip(rows, kinds, strict=True))
    body = "\n".join(
        "<tr>" + "".join(f"<td{kind}>{_cell(value)}</td>" for value, kind in zip(row, kinds, strict=True)) + "</tr>"
        for row in rows.itertuples(index=False)
    )
    said = f'<p class="note">{_caption(caption, path)}</p>'
    return f'{said}\n<div class="scroll"><table><tr>{head}</tr>\n{body}</table></div>'


def picture(path, caption=""):
    """The PNG file at `path`, put into the page itself, over a caption; a wide one has the width of the page."""
    content = Path(path).read_bytes()
    data, name = base64.b64encode(content).decode(), escape(caption or str(path))
    # Width and height stand in the first chunk of a PNG file.
    width, height = (int.from_bytes(content[start : start + 4], "big") for start in (16, 20))
    wide = ' class="wide"' if width > min(WIDE * height, WIDE_PIXELS) else ""
    return (
        f'<figure{wide}><img alt="{name}" src="data:image/png;base64,{data}">'
        f"<figcaption>{_caption(caption, path)}</figcaption></figure>"
    )


def is_picture(fragment):
    """Whether a fragment comes from `picture`."""
    return fragment.startswith("<figure")


def _caption(text, path):
    """What is shown, in words, and the file it comes from."""
    return " ".join(filter(None, [escape(text), f'<span class="file">{escape(str(path))}</span>']))


def _cell(value):
    if pd.isna(value):
        return ""
    return f"{value:.4g}" if isinstance(value, float) else escape(str(value))


def _anchor(heading):
    return "".join(letter if letter.isalnum() else "-" for letter in heading.lower())

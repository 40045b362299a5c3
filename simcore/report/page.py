"""One HTML page of text, tables and pictures that needs no other file: its parts, and its template.

The template, the style and the scripts are in the folder static/; static/vendor/ has the library that sorts tables.
"""

import base64
import io
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from jinja2 import Environment, StrictUndefined
from PIL import Image  # which matplotlib needs

from simcore.report.figures.saving import RESOLUTION
from simcore.report.tables import DETAILS, LONG_TEXT, read_table, show_table, table_name

# Longer tables are folded, so that the page stays short.
ROWS_SHOWN = 24
# Pixels of the style sheet per inch of a figure; letters then have the same size in all figures.
PIXELS_PER_INCH = 96
SMALL_FILE = 20_000  # bytes
LIBRARY = "sortable-tablesort 4.1.7"  # in static/vendor
_SCRIPTS = ("vendor/sortable.js", "vendor/sortable.a11y.js", "page.js")


class Section(NamedTuple):
    """A heading with its parts; level 2, or 3 for a section of the one before."""

    heading: str
    parts: list
    level: int = 2


def paragraph(text, kind="note"):
    """Return a paragraph of plain text, or of Markup; kind: note, answer, asked, outcome or text."""
    return {"part": "paragraph", "text": text, "kind": kind}


def bullets(texts):
    """Return a list of plain texts."""
    return {"part": "bullets", "texts": list(texts)}


def folded(title, parts):
    """Return parts that a reader opens by their title."""
    return {"part": "folded", "title": title, "parts": list(parts)}


def table(path, caption="", details=DETAILS, name=None):
    """Return the CSV file at `path` as a table under a caption, in the format of `rows_table`.

    name: of the table, which selects the meanings of its columns; by default its folder and stem.
    """
    return rows_table(read_table(path), caption, name or table_name(path), details, str(path))


def rows_table(rows, caption="", name="", details=DETAILS, path=""):
    """Return a DataFrame as a table with the text of `simcore.report.tables.show_table`.

    A table of more than ROWS_SHOWN rows is folded. path: file with all digits, printed below the table.
    """
    shown = show_table(rows, name, details)
    return {"part": "table", "caption": caption, "path": path, "folded": len(rows) > ROWS_SHOWN, "table": shown}


def picture(path, caption=""):
    """Return the PNG file at `path`, embedded in the page, over a caption; the page shows it in its own size."""
    content = Path(path).read_bytes()
    # The first chunk of a PNG file contains its width.
    width = int.from_bytes(content[16:20], "big") * PIXELS_PER_INCH // RESOLUTION
    data = base64.b64encode(_smaller(content)).decode()
    return {"part": "picture", "caption": caption, "path": str(path), "data": data, "width": width}


def _smaller(content):
    """Return a PNG file with 256 colours instead of all, a third as large; a small file as it is."""
    if len(content) < SMALL_FILE:
        return content
    written = io.BytesIO()
    colours = Image.open(io.BytesIO(content)).convert("RGB").quantize(256, dither=Image.Dither.NONE)
    colours.save(written, "PNG", optimize=True)
    return min(written.getvalue(), content, key=len)


def is_picture(part):
    """Return whether a part comes from `picture`."""
    return part["part"] == "picture"


def page(title, lead, sections, banner="", made=""):
    """Return the page as HTML text.

    lead: paragraph under the title; sections: list of Section, or of (heading, parts); banner: warning at the top of
    the page, none if empty; made: when and by which code the page was made, at its end.
    """
    sections = [Section(*section) for section in sections]
    environment = Environment(undefined=StrictUndefined, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(_read("page.html")).render(
        title=title,
        lead=lead,
        banner=banner,
        made=made,
        contents=_contents(sections),
        style=_read("page.css"),
        scripts="\n".join(_read(name) for name in _SCRIPTS),
        library=LIBRARY,
        long_text=LONG_TEXT,
    )


def _contents(sections):
    """Return the sections with their anchors, their parts numbered, each of level 2 with those of level 3 below it."""
    counts, anchors, contents = {"table": 0, "picture": 0}, set(), []
    for heading, parts, level in sections:
        anchor = _anchor(heading)
        while anchor in anchors:
            anchor += "-"
        anchors.add(anchor)
        entry = {"heading": heading, "anchor": anchor, "parts": _numbered(parts, counts), "below": []}
        if level == 2 or not contents:
            contents.append(entry)
        else:
            contents[-1]["below"].append(entry)
    return contents


def _numbered(parts, counts):
    """Return the parts with the numbers of tables and figures; counts: the last numbers, which are increased."""
    numbered = []
    for part in parts:
        if part["part"] in counts:
            counts[part["part"]] += 1
            part = part | {"number": counts[part["part"]]}
        elif part["part"] == "folded":
            part = part | {"parts": _numbered(part["parts"], counts)}
        numbered.append(part)
    return numbered


def _anchor(heading):
    return "".join(letter if letter.isalnum() else "-" for letter in heading.lower())


def _read(name):
    return (files("simcore.report") / "static" / name).read_text(encoding="utf-8")

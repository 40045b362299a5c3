"""Writes the page: a template, a style, scripts and the data of the models in one file."""

import json
import re
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, StrictUndefined

from simcore.page.data import page_data
from simcore.writing import whole_file

# In the order in which they are loaded; each one uses only those before it.
SCRIPTS = (
    "elements", "numbers", "rows", "table_head", "table", "summaries", "columns", "sieve_columns", "sieve_openings",
    "sieve_classes", "grains", "sieve_table", "prediction", "packing", "skeletons", "bed", "bed_specification",
    "outputs", "drawings", "curve_chart", "curve_input", "bed_output", "page",
)  # fmt: skip


def write_page(path, fitted):
    """Write the page of these FittedModels to `path`, as UTF-8; its folder is made if it does not exist."""
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path}: this is a folder; give the name of the page to write, such as porosity.html")
    path.parent.mkdir(parents=True, exist_ok=True)
    text = page_text(page_data(fitted))
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")


def page_text(data):
    """Return the page as HTML; data: result of page_data."""
    # Not autoescaped: scripts and style are this package's own, and the data are escaped by _json.
    environment = Environment(undefined=StrictUndefined, autoescape=False, keep_trailing_newline=True)
    return environment.from_string(_read("page.html")).render(
        style=_read("page.css"),
        scripts=[_compact(_read(f"{name}.js")) for name in SCRIPTS],
        data=_json(data),
        version=data["version"],
    )


def _json(data):
    """Return JSON that can be inside <script>: without the characters that could end it."""
    text = json.dumps(data, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _compact(script):
    """Return a script without lines of comment, empty lines and indentation, so that the page is smaller.

    Lines that begin inside a text in backquotes stay as they are. A backquote that begins no text is written \\x60.
    """
    lines, in_text = [], False
    for line in script.splitlines():
        if in_text or not re.match(r"\s*(?://|$)", line):
            lines.append(line if in_text else line.strip())
            in_text ^= line.count("`") % 2 == 1
    return "\n".join(lines)


def _read(name):
    return (files("simcore.page") / "static" / name).read_text(encoding="utf-8")

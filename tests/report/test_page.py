"""The page of tables and pictures."""

import base64
import io
import re

import matplotlib
import numpy as np
import pandas as pd

matplotlib.use("Agg")
from importlib.resources import files

import pytest
from matplotlib.figure import Figure
from PIL import Image

from simcore.provenance.digest import ROOT
from simcore.report.page import LIBRARY, ROWS_SHOWN, folded, is_picture, page, paragraph, picture, rows_table, table


def html_of(*parts):
    return page("Title", "Lead", [("Heading", list(parts))])


def test_a_picture_is_in_the_page_in_its_own_size_with_its_caption(tmp_path):
    path = tmp_path / "beds.png"
    Figure(figsize=(5, 4)).savefig(path, dpi=150)
    part = picture(path, "Beds & their porosity.")
    html = html_of(part)
    assert base64.b64encode(path.read_bytes()).decode() in html
    assert "<b>Figure 1.</b> Beds &amp; their porosity. <span" in html and str(path) in html
    # Five inches are 480 pixels, so that letters have one size in all figures.
    assert 'style="width: 480px"' in html
    assert '<button type="button" class="enlarge" aria-label="Enlarge figure 1">' in html
    assert is_picture(part) and not is_picture(paragraph("text"))


def test_a_large_picture_has_fewer_colours_and_the_same_size(tmp_path):
    figure = Figure(figsize=(4, 4))
    figure.subplots().imshow(np.random.default_rng(1).uniform(size=(200, 200)))
    figure.savefig(tmp_path / "noise.png", dpi=150)
    content = base64.b64decode(picture(tmp_path / "noise.png")["data"])
    assert len(content) < 0.7 * (tmp_path / "noise.png").stat().st_size
    assert Image.open(io.BytesIO(content)).size == (600, 600)


def test_a_table_shows_rounded_numbers_and_no_note(tmp_path):
    path = tmp_path / "tables" / "n.csv"
    path.parent.mkdir()
    path.write_text("note,case,n,n_std_error,grains\ntest only,U1,0.3761234,0.0031,300\ntest only,<b>,,,12\n")
    html = html_of(table(path, "Porosity."))
    assert "<b>Table 1.</b> Porosity." in html and "test only" not in html
    assert ">0.376 ± 0.003</td>" in html and ">300</td>" in html and str(path) in html
    assert "&lt;b&gt;" in html and "<b></" not in html


def test_each_heading_has_its_meaning_on_hover_and_below_the_table():
    html = html_of(rows_table(pd.DataFrame({"case": ["U1", "U7"], "n": [0.36, 0.3]}), name="tables/s"))
    headings = re.findall(r'<th scope="col" class="[^"]*" title="([^"]+)" aria-describedby="([^"]+)">([^<]+)', html)
    assert [words for *_, words in headings] == ["sieve curve", "porosity"]
    for meaning, identifier, words in headings:
        assert f'<dt>{words}</dt><dd id="{identifier}">{meaning}</dd>' in html
    assert headings[1][0] == "bulk porosity by volume-equivalent spheres"


def test_tables_can_be_sorted_by_all_digits_and_scroll_in_their_box():
    html = html_of(rows_table(pd.DataFrame({"n": [0.36124, 0.36119]}), name="tables/s"))
    assert 'data-sort="0.36119"' in html and html.count('<table class="sortable asc n-last">') == 1
    assert '<div class="scroll" tabindex="0" role="region" aria-label="Table 1">' in html
    for name in ("sortable.js", "sortable.a11y.js"):
        assert (files("simcore.report") / "static" / "vendor" / name).read_text(encoding="utf-8") in html


def test_columns_on_request_are_hidden_at_first():
    shown = rows_table(pd.DataFrame({"n": [0.3, 0.4], "n_exact": [0.31, 0.41]}), name="tables/s")
    assert '<input type="checkbox" class="all" id="all-1">' in html_of(shown)
    assert 'class="number detail"' in html_of(shown)
    assert 'type="checkbox"' not in html_of(rows_table(pd.DataFrame({"n": [0.3, 0.4]}), name="tables/s"))


def test_a_long_table_is_folded():
    rows = pd.DataFrame({"n": [0.3 + 1e-3 * k for k in range(ROWS_SHOWN + 1)]})
    assert f'<details class="rows"><summary>{ROWS_SHOWN + 1} rows</summary>' in html_of(rows_table(rows))
    assert '<details class="rows">' not in html_of(rows_table(rows[1:]))


def test_the_page_lists_its_sections_and_those_below_them():
    sections = [("A, b", [paragraph("text")]), ("C", [], 3), ("A, b", [])]
    html = page("Title", "Lead", sections, "Banner", "Made today.")
    assert '<a href="#a--b">' in html and '<h2 id="a--b">' in html and "Banner" in html and "Made today." in html
    assert '<h3 id="c">' in html and '<h2 id="a--b-">' in html, "each anchor is there once"
    assert html.count('<a href="#top">Back to the top</a>') == 2


def test_tables_are_numbered_also_where_they_are_folded():
    rows = pd.DataFrame({"n": [0.3, 0.4]})
    html = html_of(rows_table(rows), folded("More", [rows_table(rows)]), rows_table(rows))
    assert re.findall(r"<b>Table (\d)\.</b>", html) == ["1", "2", "3"]


def test_the_page_needs_no_other_file_and_no_network():
    html = html_of(rows_table(pd.DataFrame({"n": [0.3, 0.4]})))
    assert not re.search(r"https?://|<link|@import|url\(|\bfetch\(|XMLHttpRequest|\bimport\(", html)
    assert re.findall(r'src="(?!data:)', html) == []


def test_the_template_and_the_library_with_its_licence_are_package_data():
    static = files("simcore.report") / "static"
    assert {"page.html", "page.css", "page.js"} <= {path.name for path in static.iterdir()}
    notes = (static / "vendor" / "README.md").read_text(encoding="utf-8")
    name, version = LIBRARY.split()
    assert name in notes and f"version {version}" in notes
    assert "public domain" in (static / "vendor" / "LICENSE").read_text(encoding="utf-8")
    assert "simcore/report/static" in (ROOT / "MANIFEST.in").read_text()
    assert '"simcore.report" = ["static/*", "static/vendor/*"]' in (ROOT / "pyproject.toml").read_text()


def test_captions_are_sentences():
    """Snakemake's report reads them as reStructuredText and the page as plain text, so they contain no markup."""
    texts = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "workflow/report").glob("*.rst")}
    assert len(texts) > 20
    for name, text in texts.items():
        assert text.strip()[0].isupper() and text.strip()[-1] in ".?", name
        assert not any(mark in text for mark in ("`", "{{", "<", "::", "_ ")), name


@pytest.mark.parametrize("text", ["<script>", "</style>"])
def test_text_is_escaped(text):
    assert html_of(paragraph(text)).count(text) == html_of().count(text)

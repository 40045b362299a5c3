"""The page of tables and pictures."""

import base64
import re

import matplotlib
import pandas as pd

matplotlib.use("Agg")
import pytest
from matplotlib.figure import Figure

from simcore.provenance.digest import ROOT
from simcore.report.page import LONG_TEXT, ROWS_SHOWN, is_picture, page, paragraph, picture, rows_table, table


@pytest.mark.parametrize(("size", "wide"), [((4, 4), False), ((6, 4), False), ((8, 4), True), ((13, 12), True)])
def test_a_picture_is_in_the_page_with_its_caption_in_words(tmp_path, size, wide):
    path = tmp_path / "beds.png"
    Figure(figsize=size).savefig(path)
    html = picture(path, "Beds & their porosity.")
    assert base64.b64encode(path.read_bytes()).decode() in html
    assert "<figcaption>Beds &amp; their porosity. <span" in html and str(path) in html
    assert ('<figure class="wide">' in html) == wide
    assert is_picture(html) and not is_picture(paragraph("text"))


def test_a_table_shows_numbers_shortly_and_no_note(tmp_path):
    path = tmp_path / "n.csv"
    path.write_text("note,case,n,grains\ntest only,U1,0.3761234,300\ntest only,<b>,,12\n")
    html = table(path, "Porosity.")
    assert "Porosity." in html and "test only" not in html and "note<" not in html
    assert "<td>0.3761</td>" in html and "<td>300</td>" in html and "<td></td>" in html
    assert "&lt;b&gt;" in html and "<b>" not in html


def test_columns_behind_come_last_and_columns_without_values_are_left_out(tmp_path):
    path = tmp_path / "n.csv"
    path.write_text("study,n,grains,n_exact,r22_n\nvalidation,0.38,11805.5,,0.37\n")
    html = table(path, behind=("grains", "study", "absent"))
    assert re.findall("<th[^>]*>(.+?)</th>", html) == ["n", "r22_<wbr>n", "grains", "study"]
    assert re.findall("<td[^>]*>([^<]+)", html) == ["0.38", "0.37", "11806", "validation"]


def test_long_text_is_broken_into_lines_and_numbers_are_not():
    html = rows_table(pd.DataFrame({"bed": ["x" * LONG_TEXT, "x" * (LONG_TEXT + 1)], "n": [0.3612345, 0.38]}))
    assert re.findall("<td([^>]*)>", html) == [' class="text"', "", ' class="text long"', ""]


def test_a_long_table_is_folded():
    rows = pd.DataFrame({"n": range(ROWS_SHOWN + 1)})
    assert f"<summary>{ROWS_SHOWN + 1} rows</summary>" in rows_table(rows)
    assert "<details>" not in rows_table(rows[1:])


def test_the_page_links_its_sections():
    html = page("Title", "Lead", [("A, b", [paragraph("text")])], "Banner")
    assert '<a href="#a--b">' in html and '<h2 id="a--b">' in html and "Banner" in html


def test_captions_are_sentences():
    """Snakemake's report takes them for reStructuredText, the page as they are: so they hold no markup of either."""
    texts = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "workflow/report").glob("*.rst")}
    assert len(texts) > 20
    for name, text in texts.items():
        assert text.strip()[0].isupper() and text.strip()[-1] in ".?", name
        assert not any(mark in text for mark in ("`", "{{", "<", "::", "_ ")), name

"""The report page as a person uses it: mouse, keyboard, phone."""

import pandas as pd
import pytest
from matplotlib.figure import Figure

from simcore.report.page import page, paragraph, picture, rows_table
from tests.helpers.browser import chromium


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """Yield a function that opens a page with a table and a figure, offline, in a window of some width."""
    folder = tmp_path_factory.mktemp("report")
    Figure(figsize=(9, 3)).savefig(folder / "wide.png", dpi=150)
    rows = pd.DataFrame(
        {"case": ["U7", "U1", "B50"], "n": [0.29, 0.384, 0.2851], "n_std_error": [0.002, 0.0013, 0.006]}
    )
    rows = rows.assign(n_exact=rows["n"], **{f"r22_column_{k}": 0.123 + rows["n"] for k in range(12)})
    parts = [paragraph("Text"), rows_table(rows, "Porosities.", "tables/s"), picture(folder / "wide.png", "Wide.")]
    (folder / "report.html").write_text(page("Title", "Lead", [("One", parts), ("Two", parts)]), encoding="utf-8")
    errors, requests = [], []
    with chromium() as browser:

        def open_at(width):
            view = browser.new_page(viewport={"width": width, "height": 800}, offline=True)
            view.on("pageerror", lambda error: errors.append(str(error)))
            view.on("request", lambda request: requests.append(request.url))
            view.goto((folder / "report.html").as_uri())
            return view

        yield open_at
    assert errors == [] and {url.split(":")[0] for url in requests} <= {"file", "data"}


def column(view, place):
    return view.locator(f"#table-1 tbody tr td:nth-child({place})").all_inner_texts()


def test_a_click_or_the_enter_key_sorts_by_the_numbers(shown):
    view = shown(1400)
    view.locator("#table-1 th").nth(1).click()
    view.wait_for_function("document.querySelector('#table-1 td').innerText === 'B50'")
    assert column(view, 2) == ["0.285 ± 0.006", "0.290 ± 0.002", "0.3840 ± 0.0013"]
    view.locator("#table-1 th").nth(1).press("Enter")
    view.wait_for_function("document.querySelector('#table-1 td').innerText === 'U1'")
    assert view.locator("#table-1 th").nth(1).get_attribute("aria-sort") == "descending"


def test_the_meaning_of_a_column_appears_on_hover_and_on_focus(shown):
    view, tip = (view := shown(1400)), view.locator("#tip")
    assert tip.is_hidden()
    view.locator("#table-1 th").nth(1).hover()
    assert "bulk porosity by volume-equivalent spheres; after ±" in tip.inner_text()
    view.mouse.move(0, 0)
    assert tip.is_hidden()
    view.locator("#table-1 th").nth(0).focus()
    assert tip.inner_text() == "sieve curve"
    view.keyboard.press("Escape")
    assert tip.is_hidden()


def test_a_figure_opens_large_and_closes_again(shown):
    view = shown(1400)
    view.locator(".enlarge").first.press("Enter")
    assert view.locator("dialog img").bounding_box()["width"] > view.locator("figure img").first.bounding_box()["width"]
    assert "Figure 1. Wide." in view.locator("dialog p").inner_text()
    view.keyboard.press("Escape")
    assert view.locator("dialog").is_hidden()


@pytest.mark.parametrize("width", [400, 1400])
def test_the_page_is_as_wide_as_the_window_and_tables_scroll_in_their_box(shown, width):
    view = shown(width)
    assert view.evaluate("document.documentElement.scrollWidth") <= width
    assert view.evaluate("(b => b.scrollWidth > b.clientWidth)(document.querySelector('.scroll'))")
    # On a phone the contents are closed, so that they do not fill the screen.
    assert view.locator("nav a").first.is_visible() == (width == 1400)


def test_all_columns_are_shown_on_request(shown):
    view = shown(1400)
    assert view.locator("#table-1 th.detail").is_hidden()
    view.locator("#all-1").check()
    assert view.locator("#table-1 th.detail").is_visible()

"""The page, written once, and a headless Chromium that shows it."""

import pytest

from simcore.models.fitting import fit_reference_models
from simcore.page.writing import write_page
from tests.helpers.browser import chromium


@pytest.fixture(scope="package")
def fitted():
    return fit_reference_models()


@pytest.fixture(scope="package")
def page_file(fitted, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "deep" / "porosity.html"
    write_page(path, fitted)
    return path


@pytest.fixture(scope="module")  # playwright allows one at a time in a process
def browser():
    """Yield Chromium without a network; skip with a warning where it is not installed."""
    with chromium() as browser:
        yield browser


@pytest.fixture
def open_page(browser, page_file):
    """Yield a function that opens the page offline, at an address fragment; a failed script fails the test."""
    contexts, errors = [], []

    def open_at(fragment="", width=1400):
        context = browser.new_context(viewport={"width": width, "height": 900}, locale="en-GB", offline=True)
        context.set_default_timeout(120_000)  # a machine with other work takes long to draw
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(page_file.as_uri() + fragment)
        return page

    yield open_at
    for context in contexts:
        context.close()
    assert errors == []

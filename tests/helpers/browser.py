"""A headless Chromium that shows pages."""

import shutil
import warnings
from contextlib import contextmanager

import pytest


@contextmanager
def chromium():
    """Open Chromium without a sandbox; where it is not installed, the test is skipped with a warning."""
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        program = None
    if program is None:
        reason = "the page is not tested in a browser: install chromium (apt-get install chromium) and playwright (pip)"
        warnings.warn(reason, stacklevel=1)
        pytest.skip(reason)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield browser
        browser.close()

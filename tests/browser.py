"""Headless Chromium for tests and measurements of the page; skipped by name where there is none."""

import contextlib
import os
import shutil
from collections.abc import Iterator

import pytest

#: Where a browser of the system may be, by what packagers call it.
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def executable() -> str | None:
    """The browser: that of the environment variable CHROMIUM, or the system's."""
    found = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    return found


@contextlib.contextmanager
def chromium() -> Iterator:
    """A browser, driven by playwright."""
    playwright = pytest.importorskip("playwright.sync_api", reason="the page is driven by playwright")
    path = executable()
    if path is None:
        pytest.skip(f"no browser of {', '.join(NAMES)} is installed: the page is not driven")
    with playwright.sync_playwright() as driver:
        # a container has no room for sandboxes of its own; pages are ours
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        try:
            yield browser
        finally:
            browser.close()

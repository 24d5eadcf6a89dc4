"""A headless Chromium, for what is measured and tested of the page that explores maps.

playwright drives the browser that the system has (Debian's `chromium`, or what CHROMIUM names): of the
drivers it alone emulates touch, colour schemes and sharp screens, and needs no second program that fits the
browser.
"""

import contextlib
import os
import shutil
from collections.abc import Iterator
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


class NoBrowser(Exception):
    """There is none, or nothing that drives it."""


@contextlib.contextmanager
def chromium() -> Iterator[Any]:
    """A browser; NoBrowser says what is missing."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        raise NoBrowser("playwright is not installed: pip install playwright") from None
    path = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        raise NoBrowser(f"none of {', '.join(NAMES)} is installed, and CHROMIUM names no browser")
    with sync_playwright() as driver:
        # a container has no room for sandboxes of its own; pages are ours
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        try:
            yield browser
        finally:
            browser.close()

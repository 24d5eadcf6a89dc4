"""Headless Chromium for measurements and tests of the interactive page.

playwright drives a browser of the system: the one that CHROMIUM names, or the first of `NAMES` that is there.
Debian's `chromium-headless-shell` can open no window; tests of the page take two thirds of the time in it.
playwright is the only driver that emulates touch, colour schemes and high-resolution screens, and it needs no
second program that matches the browser.
"""

import contextlib
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..report.record import save

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


class NoBrowser(Exception):
    """No browser, or no driver for it, is available."""


def skipped(name: str, missing: NoBrowser, results: Path) -> dict:
    """Say and save that a benchmark needs a browser; return what is saved."""
    content: dict = {"no browser": str(missing)}
    print(f"skipped: {missing}")
    save(name, content, results)
    return content


@contextlib.contextmanager
def chromium() -> Iterator[Any]:
    """Start a browser; NoBrowser names the missing part."""
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

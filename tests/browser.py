"""Headless Chromium for tests of the page; skipped by name where there is none."""

import contextlib
from collections.abc import Iterator

import pytest

from benchmarks.measures import browser


@contextlib.contextmanager
def chromium() -> Iterator:
    """A browser, or the reason why the page is not driven."""
    with contextlib.ExitStack() as stack:
        try:
            driven = stack.enter_context(browser.chromium())
        except browser.NoBrowser as missing:
            pytest.skip(str(missing))
        yield driven

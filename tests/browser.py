"""Headless Chromium for tests of the page: pages, and what they have painted; skipped where there is none."""

import base64
import contextlib
import urllib.parse
from collections.abc import Iterator

import numpy as np
import pytest
from pages import HANG, solver

import frictionmap as fm
from benchmarks.measures import browser
from frictionmap.pictures.classes import classes
from frictionmap.pictures.palette import CLASSES

WAIT = 1000.0 * HANG

#: Waits until the page has painted the finest picture of its view.
DONE = "#stage[data-state=done]"

#: Scripts of the page: pixels of the cells; move a slider.
PIXELS = """(box) => {
  const { data } = document.querySelector('#cells').getContext('2d').getImageData(...box);
  let text = '';
  for (let at = 0; at < data.length; at += 8192) text += String.fromCharCode(...data.subarray(at, at + 8192));
  return btoa(text);
}"""
MOVE = """([name, value]) => {
  const range = document.querySelector(`input[type=range][name='${name}']`);
  range.value = value;
  range.dispatchEvent(new Event('input'));
}"""


@contextlib.contextmanager
def chromium() -> Iterator:
    """A browser, or the reason why the page is not driven."""
    with contextlib.ExitStack() as stack:
        try:
            driven = stack.enter_context(browser.chromium())
        except browser.NoBrowser as missing:
            pytest.skip(str(missing))
        yield driven


@contextlib.contextmanager
def page_of(browser, url, wait=DONE, **options):
    """A page; in the end nothing was wrong on its console, and nobody else was asked for anything."""
    context = browser.new_context(**{"viewport": {"width": 480, "height": 400}, **options})
    context.set_default_timeout(WAIT)
    page = context.new_page()
    page.wrong, page.asked = [], set()
    page.on("console", lambda said: page.wrong.append(said.text) if said.type == "error" else None)
    page.on("pageerror", lambda error: page.wrong.append(str(error)))
    page.on("request", lambda request: page.asked.add(urllib.parse.urlsplit(request.url)[:2]))
    try:
        page.goto(url)
        if wait:
            page.wait_for_selector(wait)
        yield page
        assert page.wrong == [], page.wrong
        assert {pair for pair in page.asked if pair[0] not in ("data", "blob")} == {
            urllib.parse.urlsplit(url)[:2]
        }
    finally:
        context.close()


def area(page):
    """Where the cells lie on the page: left, top, width, height."""
    box = page.locator("#stage").bounding_box()
    return box["x"] + 64, box["y"] + 18, box["width"] - 80, box["height"] - 68


def point(page, across, up):
    left, top, width, height = area(page)
    return left + across * width, top + (1.0 - up) * height


def colours(page):
    """Colours of the cells as they are on the screen, shape (columns, rows from below, 3)."""
    ratio = page.evaluate("devicePixelRatio")
    columns, rows = map(int, page.get_attribute("#stage", "data-cells").split())
    if columns < 100:  # cells that are larger than pixels
        columns, rows = (int(ratio * size) for size in area(page)[2:])
    box = [64 * ratio, 18 * ratio, columns, rows]
    pixels = np.frombuffer(base64.b64decode(page.evaluate(PIXELS, box)), np.uint8).reshape(rows, columns, 4)
    return pixels[::-1, :, :3].swapaxes(0, 1)


def wanted(system, r, beta, mu, shape, **settings):
    """Colours of a map of columns x rows cells over ranges of r and beta."""
    middles = [
        np.linspace(low + half, high - half, count)
        for (low, high), count in zip((r, beta), shape, strict=True)
        for half in [0.5 * (high - low) / count]
    ]
    found = classes(fm.sweep(system, *middles, mu, solver=solver(**settings)).isel(mu=0))
    table = np.array(
        [[int(look.colour[k : k + 2], 16) for k in (1, 3, 5)] for look in CLASSES], dtype=np.uint8
    )
    return table[found]


def repainted(page, act):
    """Do something, and wait for the finest picture of what the view has become."""
    act()
    page.wait_for_function("() => document.querySelector('#stage').dataset.state === 'done'")

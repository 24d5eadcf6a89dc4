"""The page while answers are late: what is saved, and what stands beside cells, is of those cells."""

import contextlib
import re
import threading

import matplotlib.image
import numpy as np
import pytest
from browser import DONE, MOVE, WAIT, colours, page_of, point, repainted, wanted
from pages import TWO_MASSES, scene_from, served

import frictionmap as fm
from frictionmap.explorer import pieces, stored
from frictionmap.pictures.classes import classes
from frictionmap.pictures.palette import CLASSES

ONE = """\
title = "One mass"
[system]
contact = "fixed-wall"
[grid]
r = [0.0, 2.0]
beta = [0.0, 1.2]
"""
SMALL, LARGE = {"width": 400, "height": 420}, {"width": 1280, "height": 800}
RANGES = (0.0, 2.0), (0.0, 1.2)

#: Writes down the text of canvases that are on no page: of a picture that is saved.
WRITTEN = """() => {
  window.written = [];
  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
    if (!this.canvas.isConnected) window.written.push(text);
    return fillText.call(this, text, ...rest);
  };
}"""
FADED = "(name) => document.querySelector(name).classList.contains('outdated')"


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as server:
        yield server


@contextlib.contextmanager
def held(page, *kinds):
    """Requests of these kinds have no answer until the end."""
    waiting, ended = [], False

    def hold(route):
        if ended:
            route.continue_()
        else:
            waiting.append(route)

    for kind in kinds:
        page.route(f"**/{kind}?**", hold)
    yield
    ended = True
    for route in waiting:
        route.continue_()
    for kind in kinds:
        page.unroute(f"**/{kind}?**", hold)


def saved(page):
    """The picture that is saved: its pixels (rows, columns, 3), and the text in it."""
    page.evaluate("window.written = []")
    page.click("#save summary")
    with page.expect_download() as expected:
        page.click("[data-save=picture]")
    pixels = np.rint(255.0 * matplotlib.image.imread(expected.value.path(), format="png")[..., :3])
    return pixels, " | ".join(page.evaluate("window.written"))


def likeness(pixels, right):
    """Share of the cells of a saved picture that have the right colours, (columns, rows from below, 3).

    Lines are drawn over some cells; how many lines of text stand above them is found by trying.
    """
    columns, rows = right.shape[:2]
    tops = [18 + 26 + 16 * lines for lines in range(1, 8)]
    seen = [pixels[top : top + rows, 64 : 64 + columns][::-1].swapaxes(0, 1) for top in tops]
    return max((one == right).all(axis=-1).mean() for one in seen if one.shape == right.shape)


def check_counts(text, found):
    """The shares in the legend of a saved picture are those of a map."""
    labels = [look.label for look in CLASSES]
    counts = np.bincount(classes(found.isel(mu=0)).ravel(), minlength=len(labels))
    listed = {name.strip(): float(share) for name, share in re.findall(r"\| ([^|]*?), ([0-9.]+) %", text)}
    known = {name: share for name, share in listed.items() if name in labels}  # others have their stops
    assert sum(known.values()) > 50.0
    for name, share in known.items():
        assert share == pytest.approx(100.0 * counts[labels.index(name)] / counts.sum(), abs=0.5)


def middles(low, high, count):
    half = 0.5 * (high - low) / count
    return np.linspace(low + half, high - half, count)


def test_a_picture_saved_while_another_is_computed_is_the_one_before(browser, one):
    with page_of(browser, one.url, viewport=SMALL) as page:
        page.evaluate(f"({WRITTEN})()")
        size = colours(page).shape[:2]
        right = wanted(fm.System(), *RANGES, 1.0, size)
        with held(page, "map"):
            page.select_option("#quantity", "contact_amplitude")
            page.evaluate(MOVE, ["mu", 500])
            page.evaluate(MOVE, ["damping_ratios", 300])
            page.wait_for_timeout(300)
            pixels, text = saved(page)
            assert likeness(pixels, right) > 0.9
            assert "μ = 1;" in text
            assert "no viscous damping;" in re.sub(r" \| ", " ", text)
            assert "regime and stops" in text
            assert "amplitude" not in text
            r, beta = (middles(*ends, count) for ends, count in zip(RANGES, size, strict=True))
            check_counts(text, fm.sweep(fm.System(), r, beta))
            assert "still being computed" in page.inner_text("#toast")
            assert page.inner_text("#system").endswith("no viscous damping")
            assert all(page.evaluate(FADED, name) for name in ("#cells", "#legend", "#system"))
        page.wait_for_selector(DONE)
        assert not any(page.evaluate(FADED, name) for name in ("#cells", "#legend", "#system"))
        assert page.inner_text("#system").endswith("damping ratio 0.09")
        assert "amplitude in the contact" in page.inner_text("#legend")
        pixels, text = saved(page)
        assert likeness(pixels, right) < 0.5
        assert "μ = 2;" in text
        assert "damping ratio 0.09;" in text.replace(" |", "")
        assert "amplitude in the contact" in text


class Gate:
    """Pieces of maps with a delay, of which a limited number gets through."""

    def __init__(self, work, seconds):
        self.work, self.seconds = work, seconds
        self.passes = threading.Semaphore(10**6)
        self.waits = threading.Event()

    def __call__(self, view, quantity, piece, *rest):
        header, arrays = self.work(view, quantity, piece, *rest)
        if not self.passes.acquire(blocking=False):
            self.waits.set()
            self.passes.acquire()
        share = (piece.last - piece.first) / piece.columns
        return {**header, "seconds": share * self.seconds}, arrays


def test_a_half_filled_map_is_not_counted(browser, one, monkeypatch):
    """A picture is saved when a coarse map is there, and the first piece of a finer one."""
    gate = Gate(pieces.piece_of_map, seconds=2.0)
    monkeypatch.setattr(pieces, "piece_of_map", gate)
    with page_of(browser, f"{one.url}#mu=1.5", viewport=SMALL) as page:
        page.evaluate(f"({WRITTEN})()")
        size = colours(page).shape[:2]
        gate.passes = threading.Semaphore(2)
        page.evaluate(MOVE, ["mu", 500])
        assert gate.waits.wait(WAIT / 1000.0)
        page.wait_for_timeout(300)
        _, text = saved(page)
        words = text.replace(" |", "")  # some lines are broken
        columns, rows = map(int, re.search(r"([0-9]+) × ([0-9]+) cells", words).groups())
        mu = float(re.search(r"μ = ([0-9.]+);", words)[1])
        r, beta = (middles(*ends, count) for ends, count in zip(RANGES, (columns, rows), strict=True))
        check_counts(text, fm.sweep(fm.System(), r, beta, mu))
        assert mu == 2.0
        assert columns < size[0] / 2
        assert f"has {columns} × {rows} cells. A finer one" in page.inner_text("#toast")
        gate.passes.release(10**6)
        page.wait_for_selector(DONE)


def test_a_motion_shown_with_a_newer_map_is_computed_anew(browser, one):
    with page_of(browser, f"{one.url}#cell=0.4,0.3&cut=beta", viewport=LARGE) as page:
        page.wait_for_selector("#cut:not([hidden])")
        page.wait_for_selector("#motion tbody tr")
        page.focus("#stage")
        page.keyboard.press("Escape")
        page.mouse.move(*point(page, 0.15, 0.4))  # r = 0.3, beta = 0.48: beta_stick is 1/mu
        page.wait_for_selector("#motion .others:not([hidden])")
        page.mouse.move(5, 5)
        with held(page, "motion", "map"):
            page.evaluate(MOVE, ["mu", 1000])
            assert page.evaluate(FADED, "#motion")
        page.wait_for_function(f"() => !({FADED})('#motion')")
        assert page.inner_text("#motion .regime") == "Permanent sticking"
        page.mouse.click(*point(page, 0.4, 0.1))
        page.wait_for_function(f"() => !({FADED})('#motion')")
        page.click("[data-cut=r]")
        page.wait_for_function("() => document.querySelector('#cut').innerText.includes('along r')")
        with held(page, "cut", "motion"):
            page.mouse.click(*point(page, 0.6, 0.2))
            assert page.evaluate(FADED, "#cut")
            assert page.evaluate(FADED, "#motion")
        page.wait_for_function(f"() => !({FADED})('#cut') && !({FADED})('#motion')")


def test_units_come_with_what_they_are_of(browser, one):
    """Another contact has others; what else is known of its system comes late."""
    with page_of(browser, f"{one.url}#cell=0.4,0.3") as page, held(page, "scene"):
        page.wait_for_selector("#motion tbody tr")
        assert "P/k₁" in page.inner_text("#motion")
        repainted(page, lambda: page.select_option("#contact", "joined-base-wall:1"))
        page.wait_for_function(f"() => !({FADED})('#motion')")
        assert re.search(r"amplitude of the mass\s+\S+ Y", page.inner_text("#motion"))
        assert "harmonic base motion" in page.inner_text("#system")


def test_a_late_answer_about_compiling_changes_nothing(browser, one):
    with page_of(browser, one.url) as page:
        with held(page, "state"):
            with page.expect_request("**/state?**"), held(page, "map"):
                page.click("[data-zoom=in]")
                page.wait_for_timeout(1500)  # until the page would say that it waits
            page.wait_for_selector(DONE)
        page.wait_for_timeout(1000)
        assert page.is_hidden("#message")


def test_a_view_that_is_refused_is_not_saved(browser, one):
    with page_of(browser, one.url) as page:
        page.fill("input.number[name=mu]", "0.5")
        page.keyboard.press("Enter")
        page.wait_for_selector("#message.wrong")
        page.click("#save summary")
        page.click("[data-save=csv]")
        page.wait_for_selector("#toast:not([hidden])")
        assert page.inner_text("#toast") == "mu must be >= 1; got 0.5"
        assert page.evaluate(FADED, "#cells")
        page.wrong = [text for text in page.wrong if "400 (Bad Request)" not in text]


@pytest.mark.slow
def test_a_page_as_a_file_shows_the_map_of_its_sliders(browser, tmp_path):
    """Sliders that were not moved together when it was written go back, in words."""
    scene = scene_from(tmp_path, TWO_MASSES)
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {"_CELLS": {True: (24, 20)}, "_PLACES": 3}.items():
            patch.setattr(stored, name, value)
        (tmp_path / "page.html").write_bytes(stored.write_page(scene, lambda *_: None))
    with page_of(browser, (tmp_path / "page.html").as_uri(), offline=True) as page:
        page.evaluate(f"({WRITTEN})()")
        numbers = {}

        def check(mu, ratio):
            for name in ("mu", "mass_ratios[2]"):
                numbers[name] = float(page.input_value(f"input.number[name='{name}']"))
            assert (numbers["mu"], numbers["mass_ratios[2]"]) == (mu, ratio)
            system = fm.System(
                "between-masses", [1, 2], mass_ratios=[1.0, ratio], stiffness_ratios=[1.0, 2.0]
            )
            assert page.inner_text("#system") == system.describe()
            ds = fm.sweep(system, middles(0.1, 2.5, 24), middles(0.0, 2.0, 20), mu)
            _, text = saved(page)
            check_counts(text, ds)
            assert f"{system.describe()}; μ = {mu:g};" in text.replace(" | ", " ")

        repainted(page, lambda: page.evaluate(MOVE, ["mu", 2]))
        check(3.0, 0.5)
        repainted(page, lambda: page.evaluate(MOVE, ["mass_ratios[2]", 2]))
        check(1.0, 5.0)
        assert page.inner_text("#notice") == ("μ is reset to 1: this file has no map with all these values.")
        repainted(page, lambda: page.click("[data-zoom=in]"))
        assert page.is_hidden("#notice")

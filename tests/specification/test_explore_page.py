"""The page that explores maps in headless Chromium: what it paints, states, asks for, keeps in addresses."""

import contextlib
import json
import re
import urllib.parse

import numpy as np
import pytest
from browser import DONE, MOVE, area, colours, page_of, point, repainted, wanted
from pages import ONE, TWO_MASSES, packet, scene_from, served

import frictionmap as fm
from frictionmap.explorer import stored
from frictionmap.files.config import config_of
from frictionmap.pictures.classes import classes
from frictionmap.pictures.palette import CLASSES

SMALL = {"width": 400, "height": 400}


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as server:
        yield server


def of_address(page):
    """The view in the address of a page, once it is there."""
    page.wait_for_timeout(400)
    return dict(urllib.parse.parse_qsl(urllib.parse.urlsplit(page.url).fragment))


def ends(text):
    return [float(part) for part in text.split(",")]


#: Scripts of the page: how many values the pixels of a chart have; what the page makes of a packet.
DRAWN = """(name) => {
  const { width, height } = document.querySelector(`#motion .${name}`);
  const pen = document.querySelector(`#motion .${name}`).getContext('2d');
  return new Set(pen.getImageData(0, 0, width, height).data).size;
}"""
UNPACK = """async () => {
  const { unpack } = await import('/packet.js');
  const answer = await fetch('/motion?at=0.3,0.5');
  const found = unpack(await answer.arrayBuffer());
  return JSON.stringify([found.regime, [...found.z], [...found.numbers]]);
}"""

FORESEEN = """async ([ofCell, ofColumn]) => {
  const { Refiner } = await import('/refine.js');
  const spent = (columns, rows, first, last) => { // the left is the dearest, as it is of maps
    const share = (at) => 1 - (1 - at / columns) ** 4;
    return (share(last) - share(first)) * (columns * rows * ofCell + columns * ofColumn);
  };
  const source = { fixed: null, live: false, map: async (view, scene, { columns, rows, first, last }) => ({
    about: { lines: [] },
    classes: new Uint8Array((last - first) * rows), beta_lim: new Float64Array(last - first),
    beta_stick: new Float64Array(last - first), seconds: spent(columns, rows, first, last) }) };
  const view = { r: [0, 1], beta: [0, 1], mu: 1.5, quantity: 'regime', start: 'rest', contact: '' };
  return new Promise((told) => {
    let size = null;
    const onState = ({ held, done }) => {
      if (held) told([size.columns, size.rows, held / 1000]);
      else if (done !== undefined) told([size.columns, size.rows, 0]);
    };
    const asked = { view, scene: { masses: 5 }, columns: 640, rows: 480, kind: 'classes', scale: null };
    new Refiner(source, (picture) => (size = picture), onState).ask({ ...asked, table: new Uint32Array(10) });
  });
}"""
FOCUS = """() => {
  const { id, tagName, dataset } = document.activeElement;
  const { outlineStyle, outlineWidth } = getComputedStyle(document.activeElement);
  return [id || dataset.zoom || tagName, outlineStyle === "solid" ? parseFloat(outlineWidth) : 0];
}"""

# The map


@pytest.mark.parametrize("ratio", [1, 2])
def test_a_map_is_painted_cell_by_cell(browser, one, ratio):
    with page_of(browser, one.url, device_scale_factor=ratio, viewport=SMALL) as page:
        seen = colours(page)
        right = wanted(fm.System(), (0.0, 2.0), (0.0, 1.2), 1.0, seen.shape[:2])
        assert seen.shape[0] > 300 * ratio
        np.testing.assert_array_equal(seen, right)
        assert page.title() == "One mass – frictionmap"
        legend = page.inner_text("#legend")
        for words in ("permanent sticking", "continuous", "2 stops", "natural frequency"):
            assert words in legend


def test_zoom_and_pan_recompute_at_the_resolution_of_the_screen(browser, one):
    with page_of(browser, one.url) as page:
        page.mouse.move(*point(page, 0.25, 0.5))
        repainted(page, lambda: page.mouse.wheel(0, -900))
        view = of_address(page)
        r, beta = ends(view["r"]), ends(view["beta"])
        factor = 1.0015**-900
        assert r[1] - r[0] == pytest.approx(2.0 * factor, rel=1e-3)
        _, _, width, height = area(page)  # what is pointed at stays there, within two pixels
        assert (0.5 - r[0]) / (r[1] - r[0]) == pytest.approx(0.25, abs=2.0 / width)
        assert (0.6 - beta[0]) / (beta[1] - beta[0]) == pytest.approx(0.5, abs=2.0 / height)
        seen = colours(page)
        np.testing.assert_array_equal(seen, wanted(fm.System(), r, beta, 1.0, seen.shape[:2]))
        start, end = point(page, 0.5, 0.5), point(page, 0.25, 0.5)
        page.mouse.move(*start)
        page.mouse.down()
        page.mouse.move(*end, steps=5)
        repainted(page, page.mouse.up)
        moved = ends(of_address(page)["r"])
        assert moved[0] == pytest.approx(r[0] + 0.25 * (r[1] - r[0]), abs=4e-3)
        assert moved[1] - moved[0] == pytest.approx(r[1] - r[0], rel=1e-3)


def test_keys_and_buttons(browser, one):
    with page_of(browser, one.url) as page:
        page.focus("#stage")
        repainted(page, lambda: page.keyboard.press("+"))
        first = ends(of_address(page)["r"])
        assert first == pytest.approx([1 - 1 / 1.6, 1 + 1 / 1.6], abs=1e-3)
        repainted(page, lambda: page.keyboard.press("ArrowRight"))
        assert ends(of_address(page)["r"])[0] == pytest.approx(first[0] + 0.12 * 1.25, abs=1e-3)
        repainted(page, lambda: page.keyboard.press("ArrowUp"))
        assert ends(of_address(page)["beta"])[0] > 0.225
        repainted(page, lambda: page.click("[data-zoom=out]"))
        repainted(page, lambda: page.click("[data-zoom=home]"))
        assert ends(of_address(page)["r"]) == [0.0, 2.0]
        page.focus("#stage")
        page.keyboard.press("Shift+ArrowRight")
        page.wait_for_function("() => location.hash.includes('cell=')")
        assert ends(of_address(page)["cell"])[0] == pytest.approx(1.0, abs=0.05)
        page.click("#save summary")
        page.keyboard.press("Escape")  # closes the menu only
        assert page.is_hidden("[data-save=link]")
        assert "cell" in of_address(page)
        page.keyboard.press("Escape")
        assert "cell" not in of_address(page)
        repainted(page, lambda: page.keyboard.press("q"))  # though a button has the focus
        assert of_address(page)["quantity"] == "contact_amplitude"
        page.keyboard.press("?")
        assert page.is_visible("#keys")


def test_the_keyboard_comes_to_the_map_before_what_changes_it(browser, one):
    with page_of(browser, one.url) as page:
        names = []
        for _ in range(6):
            page.keyboard.press("Tab")
            names.append(page.evaluate(FOCUS))
        assert [name for name, _ in names] == ["SUMMARY", "help", "stage", "in", "out", "home"]
        assert all(width >= 2 for _, width in names)  # and is seen there


def test_a_pinch_zooms(browser, one):
    with page_of(
        browser, one.url, has_touch=True, is_mobile=True, viewport={"width": 420, "height": 800}
    ) as page:
        devices = page.context.new_cdp_session(page)
        (x0, y0), (x1, y1) = point(page, 0.4, 0.5), point(page, 0.6, 0.5)

        def touch(kind, *places):
            points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(places)]
            devices.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

        touch("touchStart", (x0, y0), (x1, y1))
        for k in range(1, 6):
            away = 0.2 * k * (x1 - x0) / 2
            touch("touchMove", (x0 - away, y0), (x1 + away, y1))
        repainted(page, lambda: touch("touchEnd"))
        r = ends(of_address(page)["r"])
        assert r[1] - r[0] == pytest.approx(1.0, rel=0.05)
        assert sum(r) / 2 == pytest.approx(1.0, abs=0.05)
        devices.send("Input.synthesizeTapGesture", {"x": round(x0), "y": round(y0)})
        page.wait_for_function("() => document.querySelector('#motion h2')?.innerText.includes('selected')")


# Numbers


def test_a_slider_changes_the_map(browser, one):
    with page_of(browser, one.url) as page:
        repainted(page, lambda: page.evaluate(MOVE, ["mu", 250]))
        assert of_address(page)["mu"] == "1.5"
        repainted(page, lambda: page.evaluate(MOVE, ["damping_ratios", 200]))
        assert of_address(page)["damping_ratios"] == "0.04"
        seen = colours(page)
        right = wanted(fm.System(damping_ratios=0.04), (0.0, 2.0), (0.0, 1.2), 1.5, seen.shape[:2])
        np.testing.assert_array_equal(seen, right)
        assert page.inner_text("#system").endswith("damping ratio 0.04")
        repainted(page, lambda: page.select_option("#contact", "joined-base-wall:1"))
        repainted(page, lambda: page.click("[data-start=moving]"))
        seen = colours(page)
        system = fm.System("joined-base-wall", damping_ratios=0.04)
        right = wanted(system, (0.0, 2.0), (0.0, 1.2), 1.5, seen.shape[:2], start="moving")
        np.testing.assert_array_equal(seen, right)


def test_many_inputs_in_a_row_end_with_the_last(browser, one):
    with page_of(browser, one.url, viewport=SMALL) as page:
        for k in range(40):
            page.evaluate(MOVE, ["mu", 7 * k])
            page.evaluate(MOVE, ["damping_ratios", 300 - 5 * k])
        repainted(page, lambda: page.click("[data-zoom=in]"))
        view = of_address(page)
        seen = colours(page)
        system = fm.System(damping_ratios=float(view["damping_ratios"]))
        right = wanted(system, ends(view["r"]), ends(view["beta"]), float(view["mu"]), seen.shape[:2])
        np.testing.assert_array_equal(seen, right)
        assert (view["mu"], view["damping_ratios"]) == ("1.55", "0.011")


def test_ratios_of_a_chain_have_sliders(browser, tmp_path):
    with served(scene_from(tmp_path, TWO_MASSES)) as server, page_of(browser, server.url) as page:
        page.fill("input.number[name='mass_ratios[2]']", "0.8")
        repainted(page, lambda: page.keyboard.press("Enter"))
        assert of_address(page)["mass_ratios[2]"] == "0.8"
        repainted(page, lambda: page.select_option("#contact", "fixed-wall:2"))
        seen = colours(page)
        system = fm.System("fixed-wall", [2], mass_ratios=[1, 0.8], stiffness_ratios=[1, 2])
        np.testing.assert_array_equal(seen, wanted(system, (0.1, 2.5), (0.0, 2.0), 1.0, seen.shape[:2]))


def test_quantities_have_a_ramp(browser, one):
    with page_of(browser, one.url) as page:
        before = colours(page)
        repainted(page, lambda: page.select_option("#quantity", "contact_amplitude"))
        assert "logarithmic" in page.inner_text("#legend")
        after = colours(page)
        stuck = (before == [196, 196, 196]).all(axis=-1)
        np.testing.assert_array_equal(after[stuck], before[stuck])
        assert np.unique(after[~stuck], axis=0).shape[0] > 100
        assert of_address(page)["quantity"] == "contact_amplitude"


# The motion in a cell


def test_pointing_at_a_cell_shows_its_motion(browser, one):
    with page_of(browser, one.url) as page:
        page.mouse.move(*point(page, 0.15, 0.4))
        page.wait_for_selector("#motion .others:not([hidden])")
        assert page.inner_text("#motion .regime") == "Stick-slip"
        words = page.inner_text("#motion .words")
        assert "2 stops per cycle" in words
        assert "lies between βlim" in re.sub(r"\s", " ", words).replace("β lim", "βlim")
        assert "the same motion results" in page.inner_text("#motion .others")
        where = page.inner_text("#motion .where")
        r, beta = (float(value) for value in re.findall(r"= ([0-9.]+)", where))
        ds = fm.response(fm.System(), r, beta)
        rows = dict(row.split("\t") for row in page.inner_text("#motion tbody").splitlines())
        assert float(rows["share of time stuck"].split()[0]) == pytest.approx(
            100 * ds["stuck_fraction"].item(), rel=2e-2
        )
        assert rows["phase lag of the mass"].startswith("none: held at its maximum from")
        for canvas in ("displacement", "force", "portrait", "loop", "spectrum"):
            assert page.evaluate(DRAWN, canvas) > 10, canvas


def test_a_motion_that_takes_long_is_waited_for(browser, one):
    with page_of(browser, one.url) as page:
        page.mouse.move(*point(page, 0.15, 0.4))
        page.wait_for_selector("#motion .others:not([hidden])")
        page.route("**/motion?**", lambda route: None)
        page.mouse.move(*point(page, 0.5, 0.1))
        page.wait_for_selector("#motion .hint")  # and no numbers of the cell before
        r, beta = re.findall(r"[0-9.]+[0-9]", page.inner_text("#motion"))
        assert page.inner_text("#motion") == f"Computing the motion at r = {r}, β = {beta}."
        assert (float(r), float(beta)) == pytest.approx((1.0, 0.12), abs=0.02)
        page.unroute("**/motion?**")  # what was kept waiting goes on
        page.wait_for_selector("#motion tbody tr")
        assert page.inner_text("#motion .where") == f"r = {r}, β = {beta}"


def test_a_cell_is_kept_in_the_address(browser, one):
    with page_of(browser, f"{one.url}#mu=1.5&r=0.2,0.5&beta=0.5,1") as page:
        r, beta = 0.303, 0.76
        repainted(page, lambda: page.mouse.click(*point(page, (r - 0.2) / 0.3, (beta - 0.5) / 0.5)))
        page.wait_for_selector("#motion .others:not([hidden])")
        assert page.inner_text("#motion .regime") == "Permanent sticking"
        assert "another motion results" in page.inner_text("#motion .others")
        assert "2 stops per cycle" in page.inner_text("#motion .others")
        cell = ends(of_address(page)["cell"])
        assert cell == pytest.approx([r, beta], abs=2e-3)
        link = page.url
    with page_of(browser, link) as page:
        page.wait_for_selector("#motion .others:not([hidden])")
        assert page.inner_text("#motion .regime") == "Permanent sticking"
        assert of_address(page) == dict(urllib.parse.parse_qsl(urllib.parse.urlsplit(link).fragment))
        page.focus("#stage")
        page.keyboard.press("Escape")
        assert "cell" not in of_address(page)


def test_a_cut_is_drawn(browser, one):
    with page_of(browser, f"{one.url}#cell=0.4,0.3&cut=r") as page:
        page.wait_for_selector("#cut:not([hidden])")
        assert "along r at β = 0.3" in page.inner_text("#cut")
        repainted(page, lambda: page.click("[data-cut=beta]"))
        page.wait_for_function(
            "() => document.querySelector('#cut').innerText.includes('along β at r = 0.4')"
        )
        page.select_option("#contact", "joined-base-wall:1")
        page.wait_for_function(
            "() => /amplitude of the mass\\s+\\S+ Y/.test(document.querySelector('#motion').innerText)"
        )
        page.route("**/cut?**", lambda route: None)
        with page.expect_request("**/cut?**along=r**"):
            page.click("[data-cut=r]")
        with page.expect_event("requestfailed", lambda request: "along=r" in request.url):  # it is given up
            page.click("[data-cut=beta]")
        page.unroute("**/cut?**")
        repainted(page, lambda: page.click("#cut button"))
        assert not page.is_visible("#cut")


# What is outdated, what is wrong


def test_what_is_outdated_is_given_up(browser, tmp_path):
    with served(scene_from(tmp_path, TWO_MASSES)) as server:
        slow = f"{server.url}#mu=1.9&r=0.02,0.2&beta=0.01,0.9"
        with page_of(browser, slow, wait="#stage[data-state=refining]") as page:
            page.wait_for_function(
                "() => document.querySelector('#legend').children.length > 0"
            )  # a coarse picture
            assert page.get_attribute("#stage", "data-state") == "refining"
            address = "#mu=1&r=0.1,2.5&beta=0,2"
            repainted(page, lambda: page.evaluate(f"location.hash = '{address}'"))
            seen = colours(page)
            system = fm.System("between-masses", [1, 2], mass_ratios=[1, 0.5], stiffness_ratios=[1, 2])
            np.testing.assert_array_equal(seen, wanted(system, (0.1, 2.5), (0.0, 2.0), 1.0, seen.shape[:2]))
            page.wait_for_timeout(300)
            assert not server.page.jobs._running


def test_what_finer_pictures_take_is_foreseen(browser, one):
    """Of seconds that are known: every cell costs some, or every column, most of them on the left."""
    held = 0
    with page_of(browser, one.url, viewport=SMALL) as page:
        for of_cell, of_column in ((0.02, 0.0), (0.0, 2.0), (1e-3, 0.2), (1e-6, 1e-4)):
            columns, rows, told = page.evaluate(FORESEEN, [of_cell, of_column])
            finer = 4 if columns <= 640 / 8 else 2
            takes = finer * columns * (finer * rows * of_cell + of_column)
            held += told > 0
            assert told / 3.0 < takes < 3.0 * told if told else columns == 640
    assert held == 3


def test_the_whole_legend_is_seen_on_a_laptop(browser, one):
    with page_of(browser, f"{one.url}#mu=1.5", viewport={"width": 1280, "height": 800}) as page:
        assert page.locator("#legend > span").count() > 8
        low, high = page.evaluate(
            """() => ["#legend", "#legend > span:last-child"]
                 .map((name) => document.querySelector(name).getBoundingClientRect().bottom).reverse()"""
        )
        assert low <= high <= 800


def test_errors_of_the_address_are_reported_in_a_line_each(browser, one):
    address = "#mu=abc&r=3,1&damping_ratios=-1&zeta=0.1&beta=0,0.9&cell=1&quantity=stuck_fraction"
    with page_of(browser, one.url + address) as page:
        keys = "r, beta, quantity, cell, start, contact, cut, lecture, mu, damping_ratios"
        assert page.inner_text("#notice") == (
            "mu must be a number >= 1; got abc; used: 1\n"
            "r must be two increasing numbers >= 0 separated by a comma; got 3,1; used: 0,2\n"
            "damping_ratios must be a number >= 0; got -1; used: 0\n"
            f"unknown key 'zeta', ignored; valid: {keys}\n"
            "cell must be r > 0 and beta >= 0 separated by a comma; got 1; used: none"
        )
        right = {"r": "0,2", "beta": "0,0.9", "mu": "1", "quantity": "stuck_fraction"}
        assert of_address(page) == right
        page.fill("input.number[name=mu]", "0.5")
        page.keyboard.press("Enter")
        page.wait_for_selector("#message.wrong")
        assert page.inner_text("#message") == "mu must be >= 1; got 0.5"
        page.fill("input.number[name=mu]", "")
        page.keyboard.press("Enter")
        assert page.input_value("input.number[name=mu]") == "0.5"
        assert page.is_hidden("#notice")  # the view is another one now
        page.fill("input.number[name=mu]", "1.2")
        repainted(page, lambda: page.keyboard.press("Enter"))
        assert page.is_hidden("#message")
        page.wrong = [
            text for text in page.wrong if "400 (Bad Request)" not in text
        ]  # the browser's own note


def test_a_server_that_has_ended_is_reported(browser, tmp_path):
    with contextlib.ExitStack() as stack:
        server = stack.enter_context(served(scene_from(tmp_path, ONE)))
        with page_of(browser, server.url) as page:
            stack.close()
            page.context.set_offline(True)
            page.click("[data-zoom=in]")
            page.wait_for_selector("#message.wrong")
            assert "it does not respond. Start it again" in page.inner_text("#message")
            page.wrong = [text for text in page.wrong if "net::ERR" not in text]


def test_compiling_is_said(browser, one):
    with page_of(browser, one.url) as page:
        waiting = []
        page.route("**/map?**", lambda route: waiting.append(route))
        page.route(
            "**/state?**",
            lambda route: route.fulfill(json={"compiling": {"seconds": 12.4, "kernels": 3, "left": 27.8}}),
        )
        page.click("[data-zoom=in]")
        page.wait_for_function("() => document.querySelector('#message').innerText.includes('compiling')")
        assert page.inner_text("#message") == (
            "First use: compiling, about 28 s left. This happens once per machine. "
            "Until then the map before is shown."
        )
        page.unroute("**/state?**")
        page.unroute("**/map?**")
        page.wait_for_selector(DONE)  # what was kept waiting goes on
        page.wait_for_selector("#message", state="hidden")


# What is taken along


#: The words of the menu about the files of a view, once both have their size.
SIZES = """() => {
  const words = ['csv', 'nc'].map((what) => document.querySelector(`[data-save=${what}]`).innerText.trim());
  return words.every((one) => one.includes('about')) && words;
}"""


def test_a_view_can_be_taken_along(browser, one, tmp_path):
    allowed = {
        "permissions": ["clipboard-read", "clipboard-write"],
        "viewport": {"width": 320, "height": 400},
    }
    with page_of(browser, f"{one.url}#r=0.2,1.4&beta=0.1,1&mu=1.3", **allowed) as page:

        def copied(what):
            page.click("#save summary")
            page.click(f"[data-save={what}]")
            page.wait_for_selector("#toast:not([hidden])")
            return page.evaluate("navigator.clipboard.readText()")

        config = config_of(copied("configuration"), {})
        ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
        table = np.array([[int(look.colour[k : k + 2], 16) for k in (1, 3, 5)] for look in CLASSES], np.uint8)
        np.testing.assert_array_equal(colours(page), table[classes(ds.isel(mu=0))])
        assert copied("link") == page.url
        page.click("#save summary")
        sizes = page.wait_for_function(SIZES).json_value()  # read at once: opening the menu clears them first
        page.click("#save summary")
        for what, name in (("picture", "map.png"), ("csv", "map.csv"), ("nc", "map.nc")):
            with page.expect_download() as expected:
                page.click("#save summary")
                page.click(f"[data-save={what}]")
            assert expected.value.suggested_filename == name
            expected.value.save_as(tmp_path / name)
        assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
        assert (tmp_path / "map.csv").read_text().startswith("mu,r,beta,regime")
        for line, ending in zip(sizes, ("csv", "nc"), strict=True):
            told = re.fullmatch(
                r"Cells of this view \((?:CSV|NetCDF), about ([0-9.]+) MB(?:, [0-9]+ (?:s|min))?\)", line
            )
            assert told, line
            assert float(told[1]) == pytest.approx((tmp_path / f"map.{ending}").stat().st_size / 1e6, rel=0.5)


def test_a_page_as_a_file_needs_no_server(browser, tmp_path):
    scene = scene_from(tmp_path, ONE)
    with pytest.MonkeyPatch.context() as patch:
        settings = {"_CELLS": {False: (40, 30)}, "_PLACES": 3, "_PER_MOTION": {False: (10, 10)}}
        for name, value in settings.items():
            patch.setattr(stored, name, value)
        (tmp_path / "page.html").write_bytes(stored.write_page(scene, lambda *_: None))
    url = f"{(tmp_path / 'page.html').as_uri()}#mu=1.7"
    with page_of(browser, url, offline=True) as page:
        assert page.inner_text("#notice") == "mu must be one of 1, 2, 3; got 1.7; used: 1"
        maps = lambda mu, zeta: wanted(fm.System(damping_ratios=zeta), (0.0, 2.0), (0.0, 1.2), mu, (40, 30))  # noqa: E731

        def middles():
            """Colours in the middles of the cells, which are larger than pixels."""
            seen = colours(page)
            places = [
                ((np.arange(count) + 0.5) / count * size).astype(int)
                for count, size in zip((40, 30), seen.shape[:2], strict=True)
            ]
            return seen[np.ix_(*places)]

        np.testing.assert_array_equal(middles(), maps(1.0, 0.0))
        page.mouse.click(*point(page, 0.14, 0.52))  # the file has 4 x 3 motions; beta_stick is 1/mu
        shown = "() => document.querySelector('#motion h2')?.textContent"
        place = "selected, nearest in this file: r = 0.275, β = 0.62"
        page.wait_for_function(f"{shown} === 'Stick-slip {place}'")
        repainted(page, lambda: page.evaluate(MOVE, ["mu", 1]))
        page.wait_for_function(f"{shown} === 'Permanent sticking {place}'")
        page.keyboard.press("Escape")
        repainted(page, lambda: page.evaluate(MOVE, ["damping_ratios", 1]))
        mu, zeta = (
            float(page.input_value(f"input.number[name={name}]")) for name in ("mu", "damping_ratios")
        )
        assert (mu, zeta) == (2.0, 0.125)
        np.testing.assert_array_equal(middles(), maps(mu, zeta))
        repainted(page, lambda: page.select_option("#quantity", "stuck_fraction"))
        repainted(page, lambda: page.click("[data-zoom=in]"))


# How it looks


def test_it_follows_the_colours_of_the_desktop(browser, one):
    backs = set()
    for scheme in ("light", "dark"):
        with page_of(browser, one.url, color_scheme=scheme, viewport=SMALL) as page:
            backs.add(page.evaluate("getComputedStyle(document.body).backgroundColor"))
            cells = colours(page)
    assert len(backs) == 2
    assert {tuple(colour) for colour in np.unique(cells.reshape(-1, 3), axis=0)} <= {
        tuple(int(look.colour[k : k + 2], 16) for k in (1, 3, 5)) for look in CLASSES
    }


@pytest.mark.parametrize("width", [360, 940, 1800])
def test_it_fits_any_width(browser, one, width):
    with page_of(browser, f"{one.url}#cell=0.3,0.5", viewport={"width": width, "height": 800}) as page:
        page.wait_for_selector("#motion h2")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert area(page)[2] > 200


HELD = """() => {
  const message = document.querySelector('#message');
  message.hidden = false;
  message.textContent = 'Shown: 298 × 210 cells. The finest map, 596 × 420 cells, would take about 33 s. ';
  message.append(document.createElement('button'));
  message.lastChild.textContent = 'Compute it';
  return document.querySelector('#work').scrollHeight - document.querySelector('#work').clientHeight;
}"""


@pytest.mark.parametrize("lecture", ["", "&lecture=on"])
@pytest.mark.parametrize("width", [1000, 1280, 1920])
def test_a_message_does_not_resize_the_map(browser, one, width, lecture):
    """A map that it resized would be computed again, with another message, and so on without end."""
    address = f"{one.url}#cell=0.3,0.5{lecture}"
    with page_of(browser, address, viewport={"width": width, "height": 800}) as page:
        page.wait_for_selector("#motion h2")
        before = area(page)
        assert page.evaluate(HELD) <= 0  # nothing of it is outside of its room
        assert area(page) == before


def test_the_page_unpacks_the_packets_of_the_server(browser, one):
    """A packet of the server, unpacked by the page, is what Python unpacks."""
    with page_of(browser, one.url) as page:
        regime, z, numbers = json.loads(page.evaluate(UNPACK))
        header, arrays = packet(one, "/motion?at=0.3,0.5")
        assert regime == header["regime"]
        np.testing.assert_array_equal(np.float32(z), arrays["z"])
        np.testing.assert_array_equal(np.array(numbers, dtype=float), arrays["numbers"])


UNITS = '[units]\nnatural_frequency = "4.2 Hz"\nload = "12.5 N"\nstiffness = "3 N/mm"\n'

#: Waits until the address of the page has a text.
CHANGED = "(text) => location.hash.includes(text)"


def test_numbers_are_typed_with_units(browser, tmp_path):
    text = TWO_MASSES.replace("[grid]", f"{UNITS}[grid]")
    with served(scene_from(tmp_path, text)) as server:
        address = "#r=2.1 Hz,8.4 Hz&beta=0 N,25 N&cell=4.2 Hz,2.5 N&stiffness_ratios[2]=1.5 Hz"
        with page_of(browser, server.url + address) as page:
            assert page.inner_text("#notice").startswith(
                "stiffness_ratios[2] must be a number with a unit of stiff"
            )
            shown = of_address(page)
            assert (shown["r"], shown["beta"], shown["cell"]) == ("0.5,2", "0,2", "1,0.2")
            field, refused = (
                f".slider:has([name='stiffness_ratios[2]']) {one}" for one in (".number", ".refused")
            )
            page.fill(field, "1.5 kN/m")
            page.keyboard.press("Enter")
            page.wait_for_function("(field) => document.querySelector(field).value === '0.5'", arg=field)
            repainted(page, lambda: page.wait_for_function(CHANGED, arg="stiffness_ratios[2]=0.5&"))
            page.fill(field, "1.5 kN")
            page.keyboard.press("Enter")
            page.wait_for_selector(refused)
            assert page.inner_text(refused).endswith("got '1.5 kN': kN is a unit of force")
            page.fill(field, "4.5 N/mm")
            page.keyboard.press("Enter")
            page.wait_for_function("(field) => document.querySelector(field).value === '1.5'", arg=field)
            assert page.is_hidden(refused)
            repainted(page, lambda: page.wait_for_function(CHANGED, arg="stiffness_ratios[2]=1.5&"))
            page.wrong = [one for one in page.wrong if "400 (Bad Request)" not in one]


def test_a_unit_without_its_reference_is_refused_next_to_the_field(browser, tmp_path):
    with served(scene_from(tmp_path, TWO_MASSES)) as server, page_of(browser, server.url) as page:
        page.fill(".number[name='mass_ratios[2]']", "20 kg")
        page.keyboard.press("Enter")
        refused = page.locator(".slider:has([name='mass_ratios[2]']) .refused")
        refused.wait_for()
        assert "missing; give units.natural_frequency" in refused.inner_text()
        assert 'units.stiffness = "3 N/mm"' in refused.inner_text()
        page.wrong = [one for one in page.wrong if "400 (Bad Request)" not in one]

"""The page in motion in headless Chromium: drawing, lights, moments, history, crosshair, presets, tour."""

import re

import numpy as np
import pytest
from browser import DONE, MOVE, area, page_of, point, repainted
from conftest import ROOT
from pages import ONE, TWO_MASSES, scene_from, served
from test_explore_contacts import BELT, ELASTIC, TWO

import frictionmap as fm
from frictionmap.explorer import stored
from frictionmap.explorer.presets import PRESETS, preset_scene
from frictionmap.explorer.scene import scene_of
from frictionmap.files.config import config_of, load_config

LARGE = {"width": 1280, "height": 800}

#: Scripts: go to moments, and read there where masses are and which lights are on; what is running.
MOMENTS = """(values) => {
  const slider = document.querySelector('#motion .time');
  return values.map((value) => {
    slider.value = value;
    slider.dispatchEvent(new Event('input'));
    const masses = [...document.querySelectorAll('.drawing .mass')].map((mass) =>
      Number(/translate\\(([-0-9.]+)/.exec(mass.getAttribute('transform'))[1]) - Number(mass.dataset.rest));
    const lights = [...document.querySelectorAll('.drawing .light')];
    return [masses, lights.map((light) => light.classList.contains('lit'))];
  });
}"""
SCALE = "Number(document.querySelector('.drawing').dataset.scale)"
TIME = "Number(document.querySelector('#motion .time').value)"
MARK = """(name) => {
  const frame = document.querySelector(`#motion .${name}`).parentNode;
  const { transform } = frame.querySelector('.mark').style;
  const [x, y] = /translateX?\\(([-0-9.]+)px(?:, ([-0-9.]+)px)?/.exec(transform).slice(1);
  return [Number(x), Number(y), Number(frame.dataset.left), Number(frame.dataset.width)];
}"""


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as server:
        yield server


def stuck_at(ds, times, k=None):
    """Whether a contact is stuck at times, from the events of a motion; None within rounding of an event."""
    events, senses = (ds[name].values for name in ("event_tau", "event_direction"))
    if k is not None:
        own = ds["event_contact"].values == k + 1
        events, senses = events[own], senses[own]
    period = 2.0 * np.pi * max(1, int(ds["period"].item()))
    order = np.argsort(events % period)
    events, senses = (events % period)[order], senses[order]
    last = np.searchsorted(events, times % period, side="right") - 1
    near = np.abs((times % period)[:, np.newaxis] - events).min(axis=1) < 1e-6
    return [None if beside else bool(senses[at] == 0) for at, beside in zip(last, near, strict=True)]


def check_moments(page, ds, contacts, tolerance=2e-3):
    """Masses of the drawing are where the response has them, and lights are on while contacts are stuck."""
    count = int(page.get_attribute("#motion .time", "max"))
    values = np.arange(count)
    seen = page.evaluate(MOMENTS, values.tolist())
    scale = page.evaluate(SCALE)
    moved = np.array([masses for masses, _ in seen]) / scale
    np.testing.assert_allclose(moved, ds["x"].values[:, 4 * values].T, atol=tolerance / scale + 1e-6)
    assert scale * np.ptp(moved, axis=0).max() > 15.0  # it is seen
    for k in range(contacts):
        right = stuck_at(ds, ds["tau"].values[4 * values], k if contacts > 1 else None)
        pairs = [
            (lights[k], stuck) for (_, lights), stuck in zip(seen, right, strict=True) if stuck is not None
        ]
        assert {stuck for _, stuck in pairs} == {True, False}
        assert [light for light, _ in pairs] == [stuck for _, stuck in pairs]


# The motion


def test_it_opens_with_a_stick_slip_motion_that_runs(browser, one):
    with page_of(browser, one.url, viewport=LARGE) as page:
        page.wait_for_selector("#motion .drawing .mass")
        assert page.inner_text("#motion .regime") == "Stick-slip"
        r, beta = (float(value) for value in re.findall(r"= ([0-9.]+)", page.inner_text("#motion .where")))
        assert page.inner_text("#motion .where").startswith("example: ")
        assert fm.sweep(fm.System(), r, beta)["regime"].item() == fm.regimes.STICK_SLIP
        assert "cell=" not in page.url
        first = page.evaluate(TIME)
        page.wait_for_function(f"(first) => {TIME} !== first", arg=first)
        page.mouse.move(*point(page, 0.75, 0.05))  # the pointer takes over
        page.wait_for_function(  # there is no regime while kernels are compiled
            "() => document.querySelector('#motion .regime')?.innerText === 'Continuous sliding'"
        )
        assert not page.inner_text("#motion .where").startswith("example")


@pytest.mark.parametrize("cell", [(0.3, 0.5), (0.2, 0.12)])
def test_masses_and_lights_follow_the_response(browser, one, cell):
    r, beta = cell
    with page_of(browser, f"{one.url}#cell={r},{beta}", viewport=LARGE) as page:
        page.wait_for_selector("#motion .drawing .mass")
        check_moments(page, fm.response(fm.System(), r, beta, points=400), 1)


@pytest.mark.parametrize(
    ("text", "r", "beta", "contacts"),
    [(TWO_MASSES, 0.7, 0.4, 1), (TWO, 0.6, 0.6, 2), (ELASTIC, 0.7, 0.4, 1), (BELT, 0.5, 0.6, 1)],
)
def test_other_systems_are_drawn_as_they_move(browser, tmp_path, text, r, beta, contacts):
    ds = fm.response(config_of(text, {}).system, r, beta, points=400)
    with (
        served(scene_from(tmp_path, text)) as server,
        page_of(browser, f"{server.url}#cell={r},{beta}", viewport=LARGE) as page,
    ):
        page.wait_for_selector("#motion .drawing .mass")
        assert page.locator(".drawing .light").count() == contacts
        check_moments(page, ds, contacts)


def test_one_moment_is_marked_in_all_charts(browser, one):
    with page_of(browser, f"{one.url}#cell=0.3,0.5", viewport=LARGE) as page:
        page.wait_for_selector("#motion .others:not([hidden])")
        page.evaluate(MOMENTS, [30])
        for name in ("displacement", "force"):
            x, _, left, width = page.evaluate(MARK, name)
            assert x == pytest.approx(left + 0.3 * width, abs=0.1)
        places = {}
        for value in (30, 80):  # half a period later a symmetric motion is at the opposite point
            page.evaluate(MOMENTS, [value])
            places[value] = [page.evaluate(MARK, name)[:2] for name in ("portrait", "loop")]
        for k, name in enumerate(("portrait", "loop")):
            box = page.locator(f"#motion .{name}").bounding_box()
            middle = np.mean([places[30][k], places[80][k]], axis=0)
            assert middle == pytest.approx(
                [38 + (box["width"] - 46) / 2, 6 + (box["height"] - 26) / 2], abs=0.2
            )
        box = page.locator("#motion .displacement").bounding_box()
        _, _, left, width = page.evaluate(MARK, "displacement")
        page.mouse.move(box["x"] + left + 0.1 * width, box["y"] + 40)
        page.mouse.down()
        page.mouse.move(box["x"] + left + 0.6 * width, box["y"] + 40, steps=3)
        page.mouse.up()
        assert page.evaluate(TIME) == pytest.approx(60, abs=1)
        page.focus("#motion .time")
        before = page.evaluate(TIME)
        page.keyboard.press("ArrowRight")
        assert page.evaluate(TIME) == before + 1
        text = page.evaluate("document.querySelector('#motion .time').ariaValueText")
        assert re.fullmatch(r"0\.6\d? of 1 excitation periods: x1 = [−0-9.]+, contact (stuck|slides)", text)


def test_it_plays_and_pauses(browser, one):
    with page_of(browser, f"{one.url}#cell=0.3,0.5", reduced_motion="reduce", viewport=LARGE) as page:
        page.wait_for_selector("#motion .drawing .mass")
        page.wait_for_timeout(400)
        assert page.evaluate(TIME) == 0  # less motion is asked for
        page.select_option("#motion .pace", "1")
        page.click("#motion .play")
        page.wait_for_function(f"() => {TIME} > 5")
        page.focus("#stage")
        page.keyboard.press("p")
        assert page.get_attribute("#motion .play", "aria-label") == "Play the motion"
        still = page.evaluate(TIME)
        page.wait_for_timeout(300)
        assert page.evaluate(TIME) == still


def test_a_page_as_a_file_has_a_motion(browser, tmp_path, monkeypatch):
    monkeypatch.setattr(stored, "_CELLS", {False: (40, 30)})
    monkeypatch.setattr(stored, "_PLACES", 2)
    path = tmp_path / "page.html"
    path.write_bytes(stored.write_page(scene_from(tmp_path, ONE), lambda *_: None))
    with page_of(browser, path.as_uri(), offline=True, viewport=LARGE) as page:
        page.wait_for_selector("#motion .drawing .mass")
        r, beta = (float(value) for value in re.findall(r"= ([0-9.]+)", page.inner_text("#motion .where")))
        check_moments(page, fm.response(fm.System(), r, beta, points=400), 1)
        page.mouse.move(*point(page, 0.75, 0.05))
        page.wait_for_function(
            "() => document.querySelector('#motion .where').innerText.startsWith('nearest in this file')"
        )
        page.mouse.move(5, 5)
        page.wait_for_function(
            "() => document.querySelector('#motion .where').innerText.startsWith('example')"
        )
        repainted(page, lambda: page.evaluate(MOVE, ["mu", 1]))
        page.wait_for_function(  # that of another mu
            "() => document.querySelector('#motion .where').innerText.startsWith('nearest in this file')"
        )


# History


def of_hash(page, key):
    found = re.search(rf"[#&]{key}=([^&]*)", page.url)
    return found and found[1]


def test_changes_are_undone_and_done_again(browser, one):
    with page_of(browser, one.url) as page:
        page.wait_for_timeout(300)
        assert page.is_disabled("#undo")
        repainted(page, lambda: page.evaluate(MOVE, ["mu", 100]))
        for k in range(3):  # one drag is one step
            page.evaluate(MOVE, ["mu", 150 + 25 * k])
            page.wait_for_timeout(250)
        repainted(page, lambda: page.click("[data-zoom=in]"))
        page.wait_for_timeout(300)
        zoomed = of_hash(page, "r")
        assert (of_hash(page, "mu"), zoomed) == ("1.4", "0.375,1.625")
        repainted(page, lambda: page.click("#undo"))
        page.wait_for_function("() => location.hash.includes('r=0,2&')")
        assert of_hash(page, "mu") == "1.4"
        page.focus("#stage")
        page.keyboard.press("Control+z")
        page.wait_for_function("() => location.hash.includes('mu=1&') || location.hash.endsWith('mu=1')")
        page.wait_for_function("() => document.querySelector('input[name=mu]').value === '1'")
        page.wait_for_selector(DONE)
        assert page.is_disabled("#undo")
        page.keyboard.press("Control+Shift+z")
        page.wait_for_function("() => location.hash.includes('mu=1.4')")
        page.go_forward()
        page.wait_for_function("() => location.hash.includes('r=0.375,1.625')")
        page.wait_for_selector(DONE)
        assert page.is_disabled("#redo")
        page.go_back()
        page.go_back()
        page.wait_for_function("() => document.querySelector('input[name=mu]').value === '1'")


def test_a_change_undone_is_done_again_at_once(browser, one):
    with page_of(browser, one.url) as page:
        page.wait_for_timeout(300)
        repainted(page, lambda: page.evaluate(MOVE, ["mu", 225]))
        page.wait_for_function("() => location.hash.includes('mu=1.45')")
        page.evaluate("""() => new Promise((done) => {
          addEventListener('popstate', () => { history.forward(); done(); }, { once: true });
          history.back();
        })""")
        page.wait_for_timeout(600)  # until a view that was to replace the address would have
        assert of_hash(page, "mu") == page.input_value("input[name=mu]") == "1.45"
        assert page.is_disabled("#redo")
        assert page.is_enabled("#undo")


def test_sliders_state_their_units(browser, tmp_path):
    text = TWO.replace("ratio = 0.5\n", "force = 0.5\n").replace(
        "[grid]",
        '[units]\nnatural_frequency = "2 Hz"\nbase_amplitude = "10 mm"\nstiffness = "1 kN/mm"\n[grid]',
    )
    with served(scene_from(tmp_path, text)) as server, page_of(browser, server.url) as page:
        words = page.evaluate(
            "[...document.querySelectorAll('#controls input[type=range]')].map((one) => one.ariaValueText)"
        )
        assert words[:2] == ["1 times the kinetic friction", "0.02 of critical damping"]
        assert "0.5 times P, 5 kN" in words
        assert "1 times m1" in words


# The response curve


CROSS = """([x, y]) => {
  const ratio = devicePixelRatio;
  const pen = document.querySelector('#over').getContext('2d');
  return [...pen.getImageData(Math.round(x * ratio), Math.round(y * ratio), 1, 1).data];
}"""


def test_curve_and_map_show_the_same_place(browser, one):
    with page_of(browser, f"{one.url}#cell=0.4,0.3&cut=r", viewport=LARGE) as page:
        page.wait_for_selector("#cut:not([hidden])")
        page.wait_for_timeout(300)
        page.wait_for_selector(DONE)
        assert page.inner_text("#cut .reading").startswith("r = 0.4:")  # the selected cell is marked
        page.mouse.move(*point(page, 0.15, 0.6))
        page.wait_for_function(
            "() => /^r = 0\\.(29|30?)\\d*:/.test(document.querySelector('#cut .reading').innerText)"
        )
        assert "stop" in page.inner_text("#cut .reading")
        page.mouse.move(5, 5)
        page.focus("#cut .plot")
        for _ in range(10):
            page.keyboard.press("PageUp")
        page.keyboard.press("ArrowLeft")
        assert page.inner_text("#cut .reading").startswith("r = 1.98:")
        text = page.get_attribute("#cut .plot", "aria-valuetext")
        assert text == page.inner_text("#cut .reading")
        ds = fm.curves(fm.System(), 1.98, 0.3)
        value = float(re.search(r"mass ([0-9.]+)", text)[1])
        assert value == pytest.approx(ds["amplitude"].item(), rel=2e-2)
        _, _, width, height = area(page)
        near = [page.evaluate(CROSS, [64 + 0.99 * width + off, 18 + 0.2 * height]) for off in range(-3, 4)]
        assert any(red > 1.5 * green and alpha > 100 for red, green, _, alpha in near)
        page.keyboard.press("Enter")
        page.wait_for_function("() => location.hash.includes('cell=1.98,0.3')")


# Boundaries, and waiting


def dark_share(page):
    """Share of dark pixels of boundaries over the cells."""
    _, _, width, height = area(page)
    return page.evaluate(
        """([width, height]) => {
          const pen = document.querySelector('#over').getContext('2d');
          const { data } = pen.getImageData(64, 18, width, height);
          let dark = 0;
          for (let at = 0; at < data.length; at += 4) dark += data[at + 3] > 200 && data[at] < 60;
          return dark / (width * height);
        }""",
        [int(width), int(height)],
    )


def test_boundaries_come_before_the_map(browser, one):
    with page_of(browser, one.url, wait=None) as page:
        page.route("**/map?**", lambda route: None)
        page.reload()
        page.wait_for_function("() => document.querySelector('#stage').dataset.cells === '1 1'")
        assert dark_share(page) > 1e-3


# Presets, tour


def test_other_systems_can_be_chosen(browser, one):
    with page_of(browser, one.url, viewport=LARGE) as page:
        labels = page.locator("#preset option").all_inner_texts()
        assert labels[1:] == [preset.label for preset in PRESETS.values()]
        with page.expect_navigation():
            page.select_option("#preset", "brace-dampers")
        page.wait_for_selector("#motion .drawing .mass")
        assert page.inner_text("#title") == preset_scene("brace-dampers").title
        assert page.locator(".drawing .light").count() == 2
        assert "slowed" in page.inner_text("#motion .slowed")
        page.go_back()
        page.wait_for_function("() => document.querySelector('#title')?.textContent === 'One mass'")
        page.wait_for_selector(DONE)


def test_a_tour_by_keys(browser, one):
    with page_of(browser, one.url, viewport=LARGE) as page:
        page.wait_for_selector("#motion .drawing .mass")
        page.keyboard.press("?")
        page.click("#keys [data-tour]")
        for step in range(1, 7):
            assert page.inner_text("#tour h2").startswith(f"{step} of 6: ")
            assert page.locator(".toured").count() == 1
            page.keyboard.press("Enter")
        assert page.is_hidden("#tour")
        assert page.locator(".toured").count() == 0
        page.click("#motion [data-tour]")
        page.keyboard.press("Escape")
        assert page.is_hidden("#tour")


@pytest.mark.parametrize("size", [(390, 844), (640, 400)])
def test_everything_fits_small_screens(browser, one, size):
    with page_of(
        browser, f"{one.url}#cell=0.3,0.5&cut=r", viewport={"width": size[0], "height": size[1]}
    ) as page:
        page.wait_for_selector("#motion .drawing .mass")
        page.wait_for_selector("#cut:not([hidden])")
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]


def test_the_first_screen_of_a_phone_has_map_sliders_and_motion(browser, one):
    size = {"width": 390, "height": 844}
    with page_of(browser, one.url, viewport=size, has_touch=True) as page:
        page.wait_for_selector("#motion .drawing .mass")
        boxes = [page.locator(name).bounding_box() for name in ("#stage", "#slider-mu", "#motion .drawing")]
        ends = [box["y"] + box["height"] for box in boxes]
        assert sorted(ends) == ends
        assert max(ends) <= size["height"]
        assert all(box["x"] >= 0 and box["x"] + box["width"] <= size["width"] for box in boxes)
        assert boxes[0]["height"] > 300


def test_the_next_cell_by_keys_begins_at_the_example(browser, one):
    with page_of(browser, one.url, viewport=LARGE) as page:
        page.wait_for_selector("#motion .drawing .mass")
        r, beta = map(float, re.findall(r"= ([0-9.]+)", page.inner_text("#motion .where")))
        page.focus("#stage")
        page.keyboard.press("Shift+ArrowLeft")
        page.wait_for_function("() => location.hash.includes('cell=')")
        cell = page.evaluate("location.hash.match(/cell=([0-9.]+),([0-9.]+)/).slice(1).map(Number)")
        assert r - 0.05 < cell[0] < r
        assert cell[1] == pytest.approx(beta, abs=0.01)


def test_help_begins_at_its_beginning(browser, one):
    with page_of(browser, one.url, viewport={"width": 390, "height": 500}) as page:
        page.focus("#stage")
        page.keyboard.press("?")
        assert page.evaluate("document.querySelector('#keys').scrollTop") == 0
        assert page.evaluate("document.activeElement.id") == "keys-title"
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.innerText") == "Close"
        page.keyboard.press("Enter")
        assert page.is_hidden("#keys")
        assert page.evaluate("document.activeElement.id") == "stage"


#: Scripts: record the texts that are written on canvases; pairs that touch in the panel of the motion.
WRITING = """() => {
  const { prototype } = CanvasRenderingContext2D;
  const { fillText, clearRect } = prototype;
  const texts = (window.texts = new Map());
  prototype.clearRect = function (...box) {
    texts.set(this.canvas, []);
    clearRect.apply(this, box);
  };
  prototype.fillText = function (text, x, y, ...more) {
    const { width } = this.measureText(text);
    if (this.getTransform().b === 0) texts.get(this.canvas)?.push({ text, x, y, width });
    fillText.call(this, text, x, y, ...more);
  };
}"""
TOUCHING = """() => {
  const found = { texts: 0, touching: [] };
  for (const canvas of document.querySelectorAll('#motion canvas')) {
    const here = window.texts.get(canvas) ?? [];
    found.texts += here.length;
    for (const one of here) for (const other of here) {
      const apart = (one.width + other.width) / 2 + 2;
      const near = other.y === one.y && other.x > one.x && other.x - one.x < apart;
      if (near) found.touching.push(`${one.text} ${other.text}`);
    }
  }
  return found;
}"""


def test_texts_of_narrow_charts_do_not_touch(browser):
    size = {"width": 1024, "height": 768}
    scene = scene_of(load_config(ROOT / "configs/contacts/two-storey-frame.toml"))
    with served(scene) as server, page_of(browser, server.url, viewport=size) as page:
        page.wait_for_selector("#motion .drawing .mass")
        page.evaluate(WRITING)
        page.evaluate("location.hash = '#cell=1.06,1.05'")
        page.wait_for_selector("#motion .where:has-text('selected')")
        found = page.evaluate(TOUCHING)
        assert found["texts"] > 20
        assert found["touching"] == []


COVERED = """() => {
  const box = (name) => document.querySelector(name).getBoundingClientRect();
  const [card, part] = [box('#tour'), box('.toured')];
  const [x, y] = [part.left + 10, Math.max(part.top, 0) + 10];
  const inside = x > card.left && x < card.right && y > card.top && y < card.bottom;
  return inside || part.bottom < 0 || y > innerHeight;
}"""


@pytest.mark.parametrize("size", [(390, 844), (640, 400), (1280, 800)])
def test_the_tour_shows_what_it_is_about(browser, one, size):
    with page_of(browser, one.url, viewport={"width": size[0], "height": size[1]}) as page:
        page.wait_for_selector("#motion .drawing .mass")
        page.click("#motion [data-tour]")
        for _ in range(6):
            assert not page.evaluate(COVERED), page.inner_text("#tour h2")
            page.keyboard.press("Enter")

"""The page in a lecture, on paper, in forced colours and for ears: what is shown, and what words it has."""

import re

import numpy as np
import pytest
from browser import DONE, MOVE, page_of, repainted
from pages import ONE, scene_from, served
from test_explore_alive import TIME
from test_explore_contacts import ELASTIC, TWO

import frictionmap as fm

LARGE = {"width": 1280, "height": 800}
MOTION = "#motion .drawing .mass"

#: Texts that follow each other on one line without a space between them: they are read as one word.
GLUED = r"""() => {
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const block = (node) => {
    let at = node.parentElement;
    while (getComputedStyle(at).display === 'inline') at = at.parentElement;
    const flex = ['flex', 'inline-flex', 'grid'].includes(getComputedStyle(at.parentElement).display);
    return flex && getComputedStyle(at.parentElement).flexDirection !== 'column' ? at.parentElement : at;
  };
  const seen = [];
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    if (node.parentElement.closest('script, style, option, svg, table, dialog, #controls, nav')) continue;
    if (node.parentElement.checkVisibility()) seen.push(node);
  }
  const glued = [];
  seen.forEach((node, k) => {
    const before = seen[k - 1];
    if (!before || block(before) !== block(node)) return;
    if (node.parentElement.closest('sub') || before.parentElement.closest('sub')) return;
    if (/\S$/.test(before.data) && /^\S/.test(node.data)) glued.push(`${before.data}|${node.data}`);
  });
  return glued;
}"""
INK = """(name) => {  // the lightest and the darkest pixel of a canvas that are opaque
  const canvas = document.querySelector(name);
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let [low, high] = [255, 0];
  for (let at = 0; at < data.length; at += 4) {
    if (data[at + 3] < 255) continue;
    [low, high] = [Math.min(low, data[at]), Math.max(high, data[at])];
  }
  return [low, high];
}"""
GROUND = """() => {
  const canvas = document.querySelector('#motion .displacement');
  const { data } = canvas.getContext('2d').getImageData(canvas.width - 14, 7, 1, 1);
  return data[0];
}"""
OVERLAP = """() => {
  const box = (name) => document.querySelector(name).getBoundingClientRect();
  const [one, other] = ['#message', '#cells'].map(box);
  return one.height > 0 && one.top < other.bottom && one.bottom > other.top;
}"""


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as server:
        yield server


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("two"), TWO)) as server:
        yield server


def times_of_events(ds):
    """Times at which the direction in a contact changes, in periods, as far as the samples know them."""
    states = np.atleast_2d(ds.direction.values)
    changed = np.flatnonzero((np.diff(states, axis=1) != 0).any(axis=0)) + 1
    return ds.tau.values[changed] / (2 * np.pi)


def test_it_steps_from_event_to_event(browser, one):
    wanted = times_of_events(fm.response(fm.System(), 0.3, 0.5, points=400))
    with page_of(browser, f"{one.url}#cell=0.3,0.5", reduced_motion="reduce", viewport=LARGE) as page:
        page.wait_for_selector(MOTION)
        page.focus("#stage")
        seen, words = [], []
        for _ in range(wanted.size + 1):
            page.keyboard.press("e")
            seen.append(page.evaluate(TIME) / 100)
            words.append(page.inner_text("#motion .slowed"))
        assert seen == pytest.approx([*wanted, wanted[0]], abs=0.006)  # the slider has 100 steps
        assert words[0] == f"event 1 of {wanted.size}: the contact begins to slide"
        assert words[1] == f"event 2 of {wanted.size}: the contact stops"
        assert page.locator(".drawing .light.lit").count() == 0  # at the first event again, it slides
        page.click("#motion .event")
        assert page.locator(".drawing .light.lit").count() == 1


def test_a_lecture_shows_the_map_and_one_motion_in_large_type(browser, two):
    with page_of(
        browser, f"{two.url}#cell=0.6,0.6", reduced_motion="reduce", viewport={"width": 1920, "height": 1080}
    ) as page:
        page.wait_for_selector(MOTION)
        size = "() => parseFloat(getComputedStyle(document.querySelector('#motion .regime')).fontSize)"
        small = page.evaluate(size)
        repainted(page, lambda: page.click("#lecture"))
        assert page.evaluate(size) > 1.8 * small
        for name in ("#controls", "#motion table", "#motion .pace", "#save"):
            assert page.is_hidden(name)
        for name in ("#cells", "#legend", MOTION, "#motion .event", "#motion .of-masses"):
            assert page.locator(name).first.is_visible()
        assert page.locator("#motion .contacts canvas:visible").count() == 1
        page.wait_for_function("() => location.hash.includes('lecture=on')")
        address = page.url
        page.keyboard.press("l")
        assert page.is_visible("#controls")
    with page_of(browser, address, viewport=LARGE) as page:
        assert page.get_attribute("#lecture", "aria-pressed") == "true"


@pytest.mark.parametrize("where", ["one", "two"])
def test_separate_texts_are_not_read_as_one(browser, request, where):
    server = request.getfixturevalue(where)
    with page_of(browser, f"{server.url}#cell=0.6,0.6", viewport=LARGE) as page:
        page.wait_for_selector(MOTION)
        page.evaluate(
            """() => import('/main.js').then(() => {  // pins have buttons beside each other
              location.hash += '&designA=cell%3D0.6%2C0.6';
            })"""
        )
        page.wait_for_selector("#pins button")
        assert page.evaluate(GLUED) == []


def test_a_coarse_map_states_how_many_cells_there_would_be(browser, two):
    with page_of(browser, two.url, viewport=LARGE) as page:
        page.route("**/map?**", slow_first := SlowAnswers())
        page.evaluate(MOVE, ["mu", 500])
        page.wait_for_selector("#message button")
        words = page.inner_text("#message")
        assert re.fullmatch(
            r"Shown: \d+ × \d+ cells\. The finest map, \d+ × \d+ cells, would take about \d+ (s|min)\. "
            r"Compute it", words
        ), words  # fmt: skip
        assert page.text_content("#message") == words
        assert not page.evaluate(OVERLAP)
        assert slow_first.count
        page.unroute_all(behavior="ignoreErrors")


class SlowAnswers:
    """Answers of maps that state a hundred times the seconds that they took."""

    def __init__(self):
        self.count = 0

    def __call__(self, route):
        self.count += 1
        answer = route.fetch()
        body = answer.body()
        found = re.search(rb'"seconds": ([0-9.e-]+)', body)
        longer = b'"seconds": ' + b"9" * (len(found[1]) - 2) + b".0"
        route.fulfill(response=answer, body=body.replace(found[0], longer[: len(found[0])]))


def test_undo_takes_a_pin_back(browser, one):
    with page_of(browser, f"{one.url}#cell=0.3,0.5", viewport=LARGE) as page:
        page.wait_for_selector(MOTION)
        page.wait_for_timeout(400)
        page.click("[data-pin=A]")
        page.wait_for_function("() => location.hash.includes('designA')")
        page.wait_for_timeout(1600)  # pins of one moment are one step
        page.click("[data-pin=B]")
        page.wait_for_function("() => location.hash.includes('designB')")
        page.click("#undo")
        page.wait_for_function("() => document.querySelectorAll('#pins thead button').length === 2")
        page.click("#undo")
        page.wait_for_selector("#pins", state="hidden")
        page.click("#redo")
        page.wait_for_selector("#pins button:text-is('show A')")


def test_a_cell_deselected_by_undo_takes_its_motion_along(browser, one):
    with page_of(browser, one.url, viewport=LARGE) as page:
        page.wait_for_selector(MOTION)
        page.wait_for_timeout(400)
        page.focus("#stage")
        page.keyboard.press("Shift+ArrowRight")
        page.wait_for_function("() => document.querySelector('.where')?.innerText.startsWith('selected')")
        page.wait_for_function("() => location.hash.includes('cell=')")
        page.click("#undo")
        page.wait_for_function("() => !document.querySelector('.where')?.innerText.startsWith('selected')")


def test_swatches_and_axes_stay_in_forced_colours(browser, one):
    options = {"forced_colors": "active", "color_scheme": "dark", "viewport": LARGE}
    with page_of(browser, f"{one.url}#cell=0.3,0.5", **options) as page:
        page.wait_for_selector(MOTION)
        swatch = "getComputedStyle(document.querySelector('#legend i')).backgroundColor"
        assert page.evaluate(swatch) == "rgb(196, 196, 196)"  # permanent sticking
        assert page.evaluate(INK, "#over")[1] == 255  # numbers are light on a dark page
        line = "getComputedStyle(document.querySelector('.names .key-line')).borderTopColor"
        assert page.evaluate(line) != page.evaluate("getComputedStyle(document.body).color")


def test_a_dark_page_is_printed_in_light_colours(browser, one):
    with page_of(browser, f"{one.url}#cell=0.3,0.5", color_scheme="dark", viewport=LARGE) as page:
        page.wait_for_selector(MOTION)
        assert page.evaluate(INK, "#motion .displacement")[0] < 60  # the ground of a dark chart
        page.emulate_media(media="print")
        page.wait_for_function(
            "() => getComputedStyle(document.body).backgroundColor === 'rgb(255, 255, 255)'"
        )
        page.wait_for_timeout(200)
        assert page.evaluate(GROUND) > 200
        exact = "getComputedStyle(document.querySelector('#legend i')).printColorAdjust"
        assert page.evaluate(exact) == "exact"


def test_the_system_is_drawn_while_its_kernels_are_compiled(browser, tmp_path):
    """The boundaries of a contact with a spring need no kernels: they come at once, too."""
    with served(scene_from(tmp_path, ELASTIC)) as server:
        context = browser.new_context(viewport=LARGE)
        page = context.new_page()
        waiting = []
        for kind in ("map", "motion", "example"):
            page.route(f"**/{kind}?**", lambda route: waiting.append(route))
        compiling = {"seconds": 12.4, "kernels": 3, "left": 27.8}
        page.route("**/state?**", lambda route: route.fulfill(json={"compiling": compiling}))
        page.goto(server.url)
        page.wait_for_function("() => document.querySelector('#message').innerText.includes('compiling')")
        page.wait_for_function("() => document.querySelector('#message').innerText.includes('boundaries')")
        assert page.inner_text("#message").endswith("Until then the boundaries are shown without the map.")
        assert page.locator(MOTION).count() == 1
        assert "at rest" in page.get_attribute("#motion .drawing", "aria-label")
        assert "the contact never slips" in page.inner_text("#legend")
        page.wait_for_function("() => location.hash.startsWith('#r=')")
        assert "mu=" not in page.url  # a spring has no mu: a link with it would be refused
        page.unroute_all(behavior="ignoreErrors")
        context.close()


def test_a_phone_has_the_contact_menu_in_view(browser, two):
    size = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
    with page_of(browser, two.url, wait=DONE, **size) as page:
        for name in ("#contact", "#cells"):
            box = page.locator(name).bounding_box()
            assert 0 <= box["y"] < box["y"] + box["height"] <= 844  # the first screen
        assert page.evaluate("document.documentElement.scrollWidth") <= 390

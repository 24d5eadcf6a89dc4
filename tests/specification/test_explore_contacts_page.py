"""The page of systems with several contacts, springs and belts in headless Chromium."""

import numpy as np
import pytest
from browser import MOVE, colours, page_of, repainted, wanted
from pages import scene_from, served
from test_explore_contacts import BELT, ELASTIC, TWO, middles

import frictionmap as fm
from frictionmap import regimes
from frictionmap.explorer import stored
from frictionmap.files.config import config_of

SMALL = {"width": 400, "height": 400}
R, BETA = (0.3, 1.8), (0.0, 1.2)

#: Scripts of the page: choose of a menu; how many values the pixels of a chart have.
CHOOSE = """([name, value]) => {
  const select = document.getElementById(name);
  select.value = value;
  select.dispatchEvent(new Event('change'));
}"""
DRAWN = """(name) => [...document.querySelectorAll(`#motion .${name}`)].map((canvas) => {
  const { width, height } = canvas;
  return new Set(canvas.getContext('2d').getImageData(0, 0, width, height).data).size;
})"""


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("two"), TWO)) as server:
        yield server


def sweep_of(system, shape):
    """The regimes of the pixels of a map."""
    axes = (middles(*ends, count) for ends, count in zip((R, BETA), shape, strict=True))
    return fm.sweep(system, *axes, outputs=("regime",)).isel(mu=0)


def test_all_contacts_then_one(browser, two):
    system = config_of(TWO, {}).system
    with page_of(browser, two.url, viewport=SMALL) as page:
        seen = colours(page)
        np.testing.assert_array_equal(seen, wanted(system, R, BETA, 1.0, seen.shape[:2]))
        assert "all contacts stuck" in page.inner_text("#legend")
        repainted(page, lambda: page.evaluate(CHOOSE, ["contact", "contact-2"]))
        page.wait_for_function("() => document.querySelector('#legend').innerText.includes('others held')")
        assert "2 stops" in page.inner_text("#legend")
        repainted(page, lambda: page.evaluate(CHOOSE, ["quantity", "stuck_fraction"]))
        repainted(page, lambda: page.evaluate(CHOOSE, ["contact", "all"]))
        assert page.input_value("#quantity") == "regime"  # all together have no share of time stuck
        page.wait_for_function(
            "() => document.querySelector('#legend').innerText.includes('all contacts stuck')"
        )
        np.testing.assert_array_equal(colours(page), seen)


def test_a_cell_has_a_trace_of_every_contact(browser, two):
    with page_of(browser, f"{two.url}#cell=0.6,0.6", viewport={"width": 700, "height": 500}) as page:
        page.wait_for_selector("#motion .contacts figure")
        names = page.locator("#motion .contacts figcaption b").all_inner_texts()
        assert names == ["lower brace", "upper brace"]
        assert min(page.evaluate(DRAWN, "of-contact") + page.evaluate(DRAWN, "of-loop")) > 10
        groups = page.locator("#motion tr.group").all_inner_texts()
        assert groups == ["lower brace", "upper brace", "masses and all contacts"]
        page.wait_for_timeout(600)
        assert page.is_hidden("#motion .others")
        repainted(page, lambda: page.evaluate(CHOOSE, ["contact", "contact-2"]))
        page.wait_for_selector("#motion .moves:not([hidden])")
        assert page.is_hidden("#motion .contacts")
        assert "upper brace" in page.inner_text("#motion .where")


def test_a_link_brings_a_contact_and_its_quantity_back(browser, two):
    address = f"{two.url}#contact=contact-2&quantity=stuck_fraction&cell=0.6,0.6&cut=r"
    with page_of(browser, address, viewport={"width": 700, "height": 500}) as page:
        assert page.input_value("#quantity") == "stuck_fraction"
        assert page.input_value("#contact") == "contact-2"
        assert page.is_hidden("#notice")
        page.wait_for_selector("#cut:not([hidden])")
        page.wait_for_function("() => document.querySelector('#cut .key').innerText.includes('contact')")


@pytest.mark.parametrize(
    ("text", "key", "before", "after"),
    [
        (TWO, "contacts[2].ratio", "ratio = 0.5", "ratio = 1.0"),
        (ELASTIC, "contact_stiffness", "contact_stiffness = 1.0", "contact_stiffness = 10.0"),
        (BELT, "wall_velocity", "wall_velocity = 0.5", "wall_velocity = 5.0"),
    ],
)
def test_a_slider_changes_the_map(browser, tmp_path, text, key, before, after):
    assert before in text
    with served(scene_from(tmp_path, text)) as server, page_of(browser, server.url, viewport=SMALL) as page:
        place = 500 if "ratio" in key else 1000
        repainted(page, lambda: page.evaluate(MOVE, [key, place]))
        seen = colours(page)
        system = config_of(text.replace(before, after), {}).system
        if key == "wall_velocity":  # one-way sliding has a colour of the page's own
            ds = sweep_of(system, seen.shape[:2])
            pale = (seen == np.array([213, 236, 200])).all(axis=-1)
            np.testing.assert_array_equal(pale, ds.regime.values == regimes.ONE_WAY_SLIDING)
            assert pale.mean() > 0.5
        else:
            np.testing.assert_array_equal(seen, wanted(system, R, BETA, 1.0, seen.shape[:2]))


def test_a_page_as_a_file_lists_its_contents(browser, tmp_path, monkeypatch):
    monkeypatch.setattr(stored, "_CELLS", {False: (24, 18), True: (24, 18)})
    monkeypatch.setattr(stored, "_PLACES", 2)
    path = tmp_path / "page.html"
    path.write_bytes(stored.write_page(scene_from(tmp_path, TWO), lambda done, total: None))
    context = browser.new_context(viewport=SMALL)
    page = context.new_page()
    page.goto(path.as_uri())
    page.wait_for_selector("#stage[data-state=done]")
    assert page.locator("#contact").count() == 0
    assert "all contacts stuck" in page.inner_text("#legend")
    assert page.locator("#quantity option").first.inner_text() == "regime of all contacts"
    repainted(page, lambda: page.evaluate(CHOOSE, ["quantity", "multiplier"]))
    assert "Floquet multiplier" in page.inner_text("#legend")
    context.close()


@pytest.mark.parametrize("width", [390, 1400])
def test_it_fits_any_width(browser, two, width):
    charts, size = "#motion .contacts figure", {"width": width, "height": 800}
    with page_of(browser, f"{two.url}#cell=0.6,0.6", wait=charts, viewport=size) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width

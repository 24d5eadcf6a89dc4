"""Goals and pinned designs on the page, in headless Chromium."""

import base64
import re
import urllib.parse

import numpy as np
import pytest
from browser import MOVE, area, page_of, point, repainted
from pages import scene_from, served
from test_explore_contacts import ELASTIC, TWO
from test_explore_contacts_page import CHOOSE
from test_explore_delayed import held
from test_explore_goals import CHAIN

import frictionmap as fm
from frictionmap.explorer import stored
from frictionmap.files.config import config_of

LARGE = {"width": 1280, "height": 800}
PLAIN = CHAIN.partition("[units]")[0]
CHAIN_SYSTEM = config_of(PLAIN, {}).system

#: Scripts of the page: set a number field; opacity of what is drawn over the cells.
FILL = """([name, value]) => {
  const field = document.querySelector(name);
  field.value = value;
  field.dispatchEvent(new Event('change'));
}"""
ANSWERED = """() => {
  const text = document.querySelector('.goal .answer').innerText;
  return text && !text.startsWith('Computing');
}"""
NARROW = """(name) => {
  const { scrollWidth, clientWidth } = document.querySelector(name);
  return scrollWidth <= clientWidth;
}"""
OPACITY = """() => {
  const canvas = document.querySelector('#over');
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  const alpha = data.filter((_, k) => k % 4 === 3);
  let text = '';
  for (let k = 0; k < alpha.length; k += 8192) text += String.fromCharCode(...alpha.subarray(k, k + 8192));
  return [canvas.width, canvas.height, btoa(text)];
}"""


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("chain"), PLAIN)) as server:
        yield server


@pytest.fixture(scope="module")
def in_units(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("units"), CHAIN)) as server:
        yield server


def answered(page):
    """Sentences of the answer, once it is there."""
    page.wait_for_function(ANSWERED)
    return page.inner_text(".goal .answer")


def asked(page, goal):
    page.evaluate(CHOOSE, ["goal", goal])
    return answered(page)


def numbers(text, name):
    """Numbers that follow a name and an equals sign."""
    return [float(found) for found in re.findall(rf"{name} = (\d+(?:\.\d+)?)", text)]


def address(page):
    page.wait_for_timeout(400)
    return dict(urllib.parse.parse_qsl(urllib.parse.urlsplit(page.url).fragment))


def test_the_panel_agrees_with_design(browser, chain):
    band = (0.3, 2.2)
    with page_of(browser, chain.url, viewport=LARGE) as page:
        for name, value in zip(("from", "to"), band, strict=True):
            page.evaluate(CHOOSE, ["goal", "stuck"])
            page.evaluate(FILL, [f"[name=goal-{name}]", value])
        ds = fm.design.stuck(CHAIN_SYSTEM, band)
        text = answered(page)
        assert numbers(text, "β") == [pytest.approx(ds.beta.item(), rel=1e-3)]
        assert numbers(text, "r") == [pytest.approx(ds.at_r.item(), rel=1e-3)]
        ds = fm.design.least_peak(CHAIN_SYSTEM, band)
        text = asked(page, "least-peak")
        assert f"Least peak of mass 1: {ds.peak.values[0]:.4g} P/k₁, at β = {ds.beta.item():.4g}." in text
        assert f"at r = {ds.peak_r.values[0]:.4g}: continuous" in text
        near = fm.design.at_most(CHAIN_SYSTEM, band, 1.05 * ds.peak.values[0])
        low, high = near.interval_begin.item(), near.interval_end.item()
        assert f"β from {low:.4g} to {high:.4g}" in text
        page.evaluate(CHOOSE, ["goal-of", "contact-1"])
        ds = fm.design.least_peak(CHAIN_SYSTEM, band, quantity="contact")
        page.wait_for_function(
            "() => document.querySelector('.goal .answer').innerText.includes('of the contact:')"
        )
        assert numbers(answered(page), "β")[0] == pytest.approx(ds.beta.item(), rel=1e-3)
        assert address(page)["goal"] == "least-peak:0.3,2.2:contact-1"
        page.evaluate(CHOOSE, ["goal", ""])
        assert page.inner_text(".goal .answer") == ""
        assert "goal" not in address(page)


def test_it_speaks_hertz_newtons_and_millimetres(browser, in_units):
    with page_of(browser, f"{in_units.url}#goal=at-most:0.3,2.2:mass-1", viewport=LARGE) as page:
        assert page.input_value("[name=goal-from]") == "0.75"
        assert page.inner_text("#goal-band") == "over frequencies [Hz]"
        assert "largest value" in page.inner_text(".goal .answer")
        page.evaluate(FILL, ["[name=goal-to]", "5.5"])
        page.evaluate(FILL, ["#goal-limit", "8"])  # mm: 4 times P/k1
        text = answered(page)
        units = fm.Units(natural_frequency="2.5 Hz", load="8 N", stiffness="4 N/mm")
        ds = fm.design.at_most(CHAIN_SYSTEM, ["0.75 Hz", "5.5 Hz"], "8 mm", units=units)
        assert "Mass 1 stays within 4 P/k₁ (8 mm)" in text
        begin, end = ds.interval_begin_N.item(), ds.interval_end_N.item()
        assert re.search(rf"from [\d.]+ \({begin:.4g} N\) to [\d.]+ \({end:.4g} N\)", text)
        peak, friction = 1e3 * ds.peak_m.values[0], f"{ds.beta.item():.4g} ({ds.friction_force.item():.4g} N)"
        assert f"({peak:.4g} mm), at β = {friction}" in text
        assert f"({ds.peak_frequency.values[0]:.4g} Hz)" in text
        assert address(page)["goal"] == "at-most:0.3,2.2:mass-1:4"


def opacity(page):
    """Opacity of what is drawn over the cells, shape (columns, rows from above), on a screen of ratio 1."""
    columns, rows, text = page.evaluate(OPACITY)
    return np.frombuffer(base64.b64decode(text), np.uint8).reshape(rows, columns).T


def test_the_shading_covers_the_friction_that_meets_the_goal(browser, chain):
    limit, band = 6.0, (0.6, 1.5)
    ds = fm.design.at_most(CHAIN_SYSTEM, band, limit)
    (low,), (high,) = ds.interval_begin.values, ds.interval_end.values
    view = "r=0.3,1.8&beta=0,5"
    assert 0.2 < low < ds.beta.item() < high < 4.8
    with page_of(browser, f"{chain.url}#{view}&goal=at-most:0.6,1.5:mass-1:6", viewport=LARGE) as page:
        answered(page)
        _, _, width, height = area(page)
        seen = opacity(page)
        r = 0.3 + 1.5 * (np.arange(seen.shape[0]) + 0.5 - 64) / width
        beta = 5.0 * (height + 18 - np.arange(seen.shape[1]) - 0.5) / height
        page.evaluate(CHOOSE, ["goal", ""])
        added = (seen > 0) & (opacity(page) == 0)  # what the goal draws beyond boundaries and axes
        without = opacity(page) > 0
        edge_r, edge_beta = 6 * 1.5 / width, 6 * 5.0 / height  # lines have a width

        def part(in_r, in_beta):
            rows = np.ix_(in_r, in_beta)
            return added[rows][~without[rows]].mean()

        inside = (r > band[0] + edge_r) & (r < band[1] - edge_r)
        feasible = (beta > low + edge_beta) & (beta < high - edge_beta)
        assert part(inside, feasible) == 1.0
        below = (beta > edge_beta) & (beta < low - edge_beta)
        above = (beta > high + edge_beta) & (beta < 5.0 - edge_beta)
        outside = (r > 0.3 + edge_r) & (r < band[0] - edge_r)
        assert part(inside, below | above) == 0.0
        assert part(outside, feasible) == 0.0
        optimum = np.abs(beta - ds.beta.item()) < 5.0 / height
        assert (seen[np.ix_(inside, optimum)].max(axis=1) > 200).all()  # a line across the band


def test_an_answer_to_an_old_goal_is_not_shown(browser, chain):
    """The answers come in when the panel has long been asked for another goal, of another system."""
    with page_of(browser, f"{chain.url}#goal=least-peak:0.3,2.2:mass-1", viewport=LARGE) as page:
        before = answered(page)
        with held(page, "goal"):
            with page.expect_request("**/goal?**"):
                page.evaluate(CHOOSE, ["goal-of", "mass-2"])
            with page.expect_request("**/goal?**"):
                page.evaluate(CHOOSE, ["goal", "stuck"])
            with page.expect_request("**/goal?**"):
                page.evaluate(MOVE, ["damping_ratios", 500])
            page.wait_for_timeout(800)
            assert page.inner_text(".goal .answer") == "Computing."
        text = answered(page)
        page.wait_for_timeout(800)
        assert page.inner_text(".goal .answer") == text != before
        zeta = float(address(page)["damping_ratios"])
        system = config_of(PLAIN.replace("= 0.01", f"= {zeta}"), {}).system
        assert numbers(text, "β") == [
            pytest.approx(fm.design.stuck(system, [0.3, 2.2]).beta.item(), rel=1e-3)
        ]


def test_a_refusal_is_shown_in_its_place(browser, tmp_path):
    with (
        served(scene_from(tmp_path, ELASTIC)) as server,
        page_of(browser, server.url, viewport=LARGE) as page,
    ):
        text = asked(page, "no-stop")
        assert "a spring in the contact has no such limit" in text
        assert "wrong" in page.get_attribute(".goal .answer", "class")
        assert page.get_attribute("#stage", "data-state") == "done"
        assert "Always stuck" in asked(page, "stuck")
        assert "wrong" not in page.get_attribute(".goal .answer", "class")
        page.wrong = [text for text in page.wrong if "400 (Bad Request)" not in text]


def test_several_contacts_are_named(browser, tmp_path):
    with served(scene_from(tmp_path, TWO)) as server, page_of(browser, server.url, viewport=LARGE) as page:
        page.evaluate(CHOOSE, ["goal", "stuck"])
        page.evaluate(FILL, ["[name=goal-from]", 0.7])  # below, the search takes long
        page.evaluate(CHOOSE, ["goal", "least-peak"])
        page.evaluate(CHOOSE, ["goal-of", "contact-2"])
        page.wait_for_function(
            "() => document.querySelector('.goal .answer').innerText.includes('upper brace')"
        )
        low, high = (float(page.input_value(f"[name=goal-{name}]")) for name in ("from", "to"))
        ds = fm.design.least_peak(config_of(TWO, {}).system, [low, high], quantity="contact", contact=2)
        assert numbers(answered(page), "β")[0] == pytest.approx(ds.beta.item(), rel=1e-3)


def test_handles_move_the_band(browser, chain):
    address_of = f"{chain.url}#r=0.3,1.8&goal=stuck:0.6,1.5"
    with page_of(browser, address_of, viewport=LARGE) as page:
        answered(page)
        lower, upper = page.locator(".handle").all()
        box = upper.bounding_box()
        start, stop = (box["x"] + box["width"] / 2, box["y"] + 8), point(page, 0.6, 0.0)
        page.mouse.move(*start)
        page.mouse.down()
        page.mouse.move(stop[0], start[1], steps=4)
        assert page.inner_text(".goal .answer") == ""  # not of this band
        page.mouse.up()
        text = answered(page)
        found = address(page)
        band = [float(part) for part in found["goal"].split(":")[1].split(",")]
        assert band == [0.6, pytest.approx(1.2, abs=0.004)]
        assert found["r"] == "0.3,1.8"  # the map stays
        assert "cell" not in found
        assert numbers(text, "β") == [
            pytest.approx(fm.design.stuck(CHAIN_SYSTEM, band).beta.item(), rel=1e-3)
        ]
        lower.focus()
        page.keyboard.press("ArrowRight")
        assert float(page.input_value("[name=goal-from]")) == pytest.approx(0.615, abs=1e-3)
        page.keyboard.press("Shift+ArrowLeft")
        assert float(page.input_value("[name=goal-from]")) == pytest.approx(0.6135, abs=1e-3)
        assert address(page)["r"] == "0.3,1.8"
        repainted(page, lambda: page.evaluate("() => (location.hash = '#r=1.4,1.8&goal=stuck:0.6,1.5')"))
        assert [handle.is_visible() for handle in (lower, upper)] == [False, True]


def rows_of(page):
    """The table of pinned designs: values by the names of rows."""
    rows = page.locator("#pins tbody tr").all()
    return {row.locator("th").inner_text(): row.locator("td").all_inner_texts() for row in rows}


def test_two_designs_are_pinned_compared_and_restored(browser, chain):
    with page_of(browser, f"{chain.url}#cell=0.8,0.6&goal=no-stop:0.6,1.5", viewport=LARGE) as page:
        answered(page)
        page.click("[data-pin=A]")
        repainted(page, lambda: page.evaluate(MOVE, ["damping_ratios", 500]))
        asked(page, "stuck")
        page.click(".goal .peak")
        page.evaluate(MOVE, ["mu", 250])
        answered(page)
        page.click("[data-pin=B]")
        page.wait_for_function("() => !document.querySelector('#pins').innerText.includes('…')")
        at_b = address(page)
        rows = rows_of(page)
        zeta, mu = float(at_b["damping_ratios"]), float(at_b["mu"])
        damped = config_of(PLAIN.replace("= 0.01", f"= {zeta}"), {}).system
        cell = [float(part) for part in at_b["cell"].split(",")]
        assert rows["r"] == ["0.8", f"{cell[0]:.4g}"]
        assert rows["μ"] == ["1", f"{mu:.4g}"]
        assert rows["ζ of all modes"] == ["0.01", f"{zeta:.4g}"]
        own = fm.response(CHAIN_SYSTEM, 0.8, 0.6)
        assert rows["stops per cycle"][0] == f"{own.stops_per_cycle.item():.4g}"
        assert rows["regime"][0] == "stick-slip"
        assert rows["amplitude"][0].startswith(f"{own.amplitude.values.ravel()[0]:.4g} P/k₁")
        least = fm.design.no_stop(CHAIN_SYSTEM, [0.6, 1.5]).beta.item()
        most = fm.design.stuck(damped, [0.6, 1.5], mu).beta.item()
        assert [numbers(text, "β")[0] for text in rows["its friction"]] == [
            pytest.approx(least, rel=1e-3), pytest.approx(most, rel=1e-3),
        ]  # fmt: skip
        repainted(page, lambda: page.click("#pins button:text-is('show A')"))
        assert page.input_value("#goal") == "no-stop"
        assert page.input_value("input.number[name=damping_ratios]") == "0.01"
        assert numbers(answered(page), "β") == [pytest.approx(least, rel=1e-3)]
        found = address(page)
        assert (found["cell"], found["mu"]) == ("0.8,0.6", "1")
        assert "damping_ratios" not in found
        repainted(page, lambda: page.click("#pins button:text-is('show B')"))
        assert address(page) == at_b
        link = page.url
    with page_of(browser, link, viewport=LARGE) as page:  # the link brings both back
        page.wait_for_function("() => !document.querySelector('#pins').innerText.includes('…')")
        assert rows_of(page) == rows
        page.click("[title='remove design A']")
        assert "designA" not in address(page)
        assert page.locator("#pins thead button").all_inner_texts() == ["show B", "×"]


def test_an_invalid_goal_in_the_address_is_reported(browser, chain):
    with page_of(browser, f"{chain.url}#goal=best:1,2&mu=1.5") as page:
        assert "goal must be GOAL:FROM,TO" in page.inner_text("#notice")
        assert "got best:1,2; used: none" in page.inner_text("#notice")
        assert page.input_value("input.number[name=mu]") == "1.5"


@pytest.mark.parametrize("width", [390, 900, 1280])
def test_it_fits_any_width(browser, in_units, width):
    text = "cell%3D0.8%2C0.6%26goal%3Dleast-peak%3A0.3%2C2.2%3Amass-1"
    url = f"{in_units.url}#goal=at-most:0.3,2.2:mass-1:4&designA={text}&designB={text}"
    with page_of(browser, url, viewport={"width": width, "height": 844}) as page:
        answered(page)
        page.wait_for_function("() => !document.querySelector('#pins').innerText.includes('…')")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for name in (".goal", "#pins"):
            assert page.evaluate(NARROW, name)


def test_the_page_as_a_file_has_no_panel(browser, chain, tmp_path, monkeypatch):
    """Its maps were computed before; nobody is there to answer."""
    monkeypatch.setattr(stored, "_CELLS", {False: (24, 18), True: (24, 18)})
    monkeypatch.setattr(stored, "_PLACES", 2)
    path = tmp_path / "page.html"
    path.write_bytes(stored.write_page(chain.page.scene, lambda done, total: None))
    with page_of(browser, path.as_uri(), offline=True) as page:
        assert page.locator(".goal, .handle").count() == 0
        assert page.is_hidden("#pins")

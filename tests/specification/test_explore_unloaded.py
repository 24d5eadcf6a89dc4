"""The page of systems on belts without a load: maps over belt speed and friction, motions, limits."""

import json
import urllib.parse

import numpy as np
import pytest
from browser import MOVE, page_of, repainted
from pages import ask, packet, scene_from, served
from test_explore_contacts import middles

import frictionmap as fm
from frictionmap.explorer.belt_classes import EXAMPLES, LOOKS
from frictionmap.files.config import config_of

FALLING = """\
[system]
damping_ratios = 0.03
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
law = { speed = [0.0, 0.2, 0.6, 1.2], factor = [1.0, 0.8, 0.7, 0.68], slope = 0.08 }
[units]
natural_frequency = "1 Hz"
load = "10 N"
stiffness = "100 N/m"
[grid]
wall_speed = [0.1, 1.5]
beta = [0.2, 1.4]
"""
DROP = """\
[system]
damping_ratios = 0.05
[grid]
wall_speed = [0.1, 1.5]
beta = [0.2, 1.4]
mu = 1.5
"""
TWO = """\
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.02
[[system.contacts]]
name = "upper"
kind = "fixed-wall"
masses = [1]
[[system.contacts]]
name = "lower"
kind = "fixed-wall"
masses = [2]
ratio = 0.5
[grid]
wall_speed = [0.1, 0.6]
beta = [0.2, 1.0]
mu = 1.6
"""
TEXTS = {"falling": FALLING, "drop": DROP, "two": TWO}
SPEED, BETA = (0.1, 1.5), (0.2, 1.4)


@pytest.fixture(scope="module")
def servers(tmp_path_factory):
    opened, found = [], {}
    for name, text in TEXTS.items():
        opened.append(served(scene_from(tmp_path_factory.mktemp("page"), text)))
        found[name] = opened[-1].__enter__()
    yield found
    for one in opened:
        one.__exit__(None, None, None)


def labels(classes):
    return np.array([look.label for look in LOOKS])[classes]


@pytest.mark.parametrize(
    ("query", "before", "after"),
    [
        ("", "", ""),
        ("&contacts[1].law.last=0.9", "[1.0, 0.8, 0.7, 0.68]", "[1.0, 0.9375, 0.90625, 0.9]"),
        ("&contacts[1].law.slope=0.3", "slope = 0.08", "slope = 0.3"),
        ("&damping_ratios=0.3", "damping_ratios = 0.03", "damping_ratios = 0.3"),
    ],
)
def test_a_map_is_that_of_the_changed_configuration(servers, query, before, after):
    assert before in FALLING
    _, found = packet(servers["falling"], f"/map?columns=8&rows=6{query}&quantity=peak_to_peak_1")
    changed = config_of(FALLING.replace(before, after), {}).system
    ds = fm.sweep(changed, wall_speed=middles(*SPEED, 8), beta=middles(*BETA, 6)).isel(mu=0)
    shown = labels(found["classes"])
    names = {4: "steady sliding", 5: "stick-slip cycle", 6: "cycle without stops"}
    for regime, name in names.items():
        alone = ds.also_reachable.values == 1 << regime
        np.testing.assert_array_equal(shown == name, alone & (ds.regime.values == regime))
    both = ds.also_reachable.values == (1 << 4) + (1 << 5)
    np.testing.assert_array_equal(shown == "stick-slip cycle; steady sliding is stable too", both)
    whole = (ds.x_max - ds.x_min).isel(dof=0).where(ds.regime != fm.regimes.STEADY_SLIDING)
    np.testing.assert_allclose(found["values"], whole, rtol=1e-6)


def test_the_cycle_of_a_falling_law(servers):
    """Period and extremes by two other programs; while the contact sticks, it is as fast as the belt."""
    header, found = packet(servers["falling"], "/motion?at=0.3,1")
    numbers = dict(zip((one["name"] for one in header["entries"]), found["numbers"], strict=True))
    assert header["regime"] == "Stick-slip cycle"
    assert numbers["cycle_frequency"] == pytest.approx(2.0 * np.pi / 7.198913805721023, rel=1e-10)
    assert header["rate"] == numbers["cycle_frequency"]
    assert numbers["x_max"] == pytest.approx(1.2341840785926574, rel=1e-10)
    assert numbers["x_min"] == pytest.approx(0.2151323896425577, rel=1e-10)
    assert numbers["cycle_speed_lim"] == pytest.approx(1.124273429839, rel=1e-10)
    assert numbers["beta_sliding_lim"] == pytest.approx(0.06 / 0.25)
    assert found["tau"][-1] == pytest.approx(2.0 * np.pi)
    rate = np.gradient(found["z"], found["tau"] / header["rate"])
    stuck = found["direction"] == 0
    assert 0.0 < stuck.mean() < 1.0
    np.testing.assert_allclose(found["z_rate"][stuck], 0.3, rtol=1e-6)
    np.testing.assert_allclose(found["z_rate"][5:-5], rate[5:-5], atol=0.02)
    assert header["drawing"]["loaded"] == []
    assert header["drawing"]["contacts"][0]["belt"] == 0.3


def test_several_stable_motions_are_named(servers):
    header, _ = packet(servers["falling"], "/motion?at=0.7,1")
    assert any("The initial state decides" in words for words in header["summary"])
    header, _ = packet(servers["falling"], "/motion?at=1.3,1")
    assert header["regime"] == "Steady sliding"
    assert not any("The initial state decides" in words for words in header["summary"])


def test_limits(servers):
    """Constant friction with a drop has a cycle up to v = (mu - 1) beta/rho, rho(0.05) = 0.910669990890."""
    _, found = packet(servers["drop"], "/lines?count=30")
    wanted = 0.5 * middles(*BETA, 30) / 0.910669990890
    np.testing.assert_allclose(found["line_cycle_speed_lim"], wanted, rtol=1e-10)
    assert np.isinf(found["line_sliding_lim"]).all()
    _, found = packet(servers["falling"], "/map?columns=4&rows=4&lines=14")
    slopes = np.array([1.0, 0.25, 0.25, 0.25, 0.25, 0.1 / 3] + [0.02 / 0.6] * 5)
    np.testing.assert_allclose(found["line_sliding_lim"][:11], 0.06 / slopes[:11], rtol=1e-12)
    assert np.isinf(found["line_sliding_lim"][11:]).all()


def test_contacts_of_a_structure(servers):
    header, found = packet(servers["two"], "/motion?at=0.25,0.8")
    assert header["contacts"] == ["upper", "lower"]
    assert found["z"].shape == (2, 400)
    alone, one = packet(servers["two"], "/motion?at=0.25,0.8&contact=contact-2")
    assert alone["contact"] == "lower"
    np.testing.assert_array_equal(one["z"], found["z"][1])
    _, cells = packet(servers["two"], "/map?columns=3&rows=2&quantity=contact_peak_to_peak&contact=contact-2")
    system = config_of(TWO, {}).system
    ds = fm.sweep(system, wall_speed=middles(0.1, 0.6, 3), beta=middles(0.2, 1.0, 2), mu=1.6).isel(mu=0)
    whole = (ds.z_max - ds.z_min).isel(contact=1).where(ds.regime != fm.regimes.STEADY_SLIDING)
    np.testing.assert_allclose(cells["values"], whole, rtol=1e-6)


def test_addresses_take_units(servers):
    query = urllib.parse.quote("wall_speed=0.2 m/s,0.4 m/s&beta=3 N,9 N&at=0.3 m/s,5 N", safe="=&,")
    status, body, _ = ask(servers["falling"], f"/ratios?{query}")
    assert status == 200, body
    found = json.loads(body)
    assert found["wall_speed"] == pytest.approx([0.2 / (0.2 * np.pi), 0.4 / (0.2 * np.pi)])
    assert (found["beta"], found["at"][1]) == ([0.3, 0.9], 0.5)
    status, body, _ = ask(servers["falling"], "/map?columns=2&rows=2&r=0.1,0.5")
    assert status == 400
    assert b"unknown key 'r'; valid: wall_speed, beta" in body


def test_a_view_is_a_configuration(servers):
    _, body, _ = ask(servers["falling"], "/configuration.toml?columns=9&rows=7&contacts[1].law.slope=0.3")
    config = config_of(body.decode(), {})
    np.testing.assert_allclose(config.wall_speed, middles(*SPEED, 9), rtol=1e-15)
    assert config.system.contacts[0].law.slope == 0.3
    _, body, _ = ask(servers["falling"], "/map.csv?columns=3&rows=2")
    rows = body.decode().splitlines()
    assert (len(rows), rows[0].split(",")[1]) == (7, "wall_speed")


def test_an_example_vibrates(servers):
    _, body, _ = ask(servers["falling"], "/example")
    speed, beta = json.loads(body)["cell"]
    header, _ = packet(servers["falling"], f"/motion?at={speed},{beta}")
    assert header["class"] in EXAMPLES[0]


def test_refusals(tmp_path, servers):
    with pytest.raises(fm.InputError, match="cannot use r with wall_speed"):
        fm.explore(fm.System(), r=(0.1, 1.0), wall_speed=(0.1, 1.0))
    with pytest.raises(fm.InputError, match="load_harmonics without a load"):
        fm.explore(fm.System(load_harmonics=[{"n": 3, "amplitude": 1.0, "mass": 1}]), wall_speed=(0.1, 1.0))
    with fm.explore(fm.System(damping_ratios=0.05), wall_speed=(0.1, 1.0), mu=1.5) as page:
        assert page._server.page.scene.r == (0.1, 1.0)


def test_the_page(browser, servers):
    with page_of(browser, servers["drop"].url, viewport={"width": 700, "height": 500}) as page:
        page.wait_for_selector("#motion h2")
        assert "wall_speed=0.1,1.5" in page.url
        legend = page.inner_text("#legend")
        assert "no stick-slip cycle" in legend
        assert "stick-slip cycle; steady sliding is stable too" in legend
        assert "Stick-slip cycle" in page.inner_text("#motion")
        assert page.locator("[data-cut], [data-start], #goal").count() == 0
        repainted(page, lambda: page.evaluate(MOVE, ["damping_ratios", "1000"]))
        page.wait_for_function("() => document.querySelector('#legend').innerText.includes('sliding, 100')")


def test_a_link_brings_a_view_back(browser, servers):
    url = f"{servers['drop'].url}#wall_speed=0.2,0.8&beta=0.4,1.2&mu=1.8&quantity=peak_to_peak_1&cell=0.3,1"
    with page_of(browser, url, viewport={"width": 700, "height": 500}) as page:
        page.wait_for_selector("#motion h2")
        assert page.is_hidden("#notice")
        assert "selected: v = 0.3, β = 1" in page.inner_text("#motion .where")
        assert page.input_value("#quantity") == "peak_to_peak_1"

"""A saved page: its sliders and size, motions of its cells, and what an interrupt leaves of it."""

import io
import json
import re
import sys

import numpy as np
import pytest
from browser import MOVE, page_of, point, repainted
from pages import scene_from

import frictionmap as fm
from frictionmap.command_line import cli
from frictionmap.errors import InputError
from frictionmap.explorer import stored
from frictionmap.explorer.stored import StoredPage
from frictionmap.files.places import claimed

ONE = """\
title = "One mass"
[system]
contact = "fixed-wall"
damping_ratios = 0.02
[grid]
r = [0.2, 1.8]
beta = [0.1, 1.2]
"""
CHAIN = "mass_ratios = [1.0, 1.0]\nstiffness_ratios = [1.0, 1.0]\n"
TWO_MASSES = ONE.replace("damping_ratios", CHAIN + "damping_ratios")


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(stored, "_CELLS", {False: (8, 6), True: (8, 6)})
    monkeypatch.setattr(stored, "_PLACES", 2)
    monkeypatch.setattr(stored, "_PER_MOTION", {False: (2, 4), True: (2, 4)})


def content_of(body):
    return json.loads(re.search(r'<script type="application/json" id="stored">(.*?)</script>', body, re.S)[1])


class Interrupted(Exception):
    """The run ends here."""


def stopping(after):
    """A receiver of progress that ends the run after this number of maps."""

    def progress(done, total):
        if done >= after and done == int(done):
            raise Interrupted

    return progress


def test_a_page_interrupted_has_the_maps_so_far(tmp_path):
    page = StoredPage(scene_from(tmp_path, ONE))
    with pytest.raises(Interrupted):
        page.compute(stopping(3))
    assert (page.done, page.count) == (3, 6)
    with claimed(tmp_path / "page.html") as output:
        assert cli._kept_page(output, page) == f"wrote {tmp_path / 'page.html'} with 3 of 6 maps"
    found = content_of((tmp_path / "page.html").read_text())
    assert found["values"] == {"mu": [1.0, 3.0], "damping_ratios": [0.0, 0.02]}
    assert set(found["maps"]) == {"0,1", "1,1", "0,0"}
    assert found["first"] == "0,1"
    page.compute(lambda *_: None)
    assert page.done == page.count == len(content_of(page.page().decode())["maps"])


def test_nothing_is_kept_before_the_first_map(tmp_path):
    with claimed(tmp_path / "page.html") as output:
        assert cli._kept_page(output, StoredPage(scene_from(tmp_path, ONE))) == ""
    assert not (tmp_path / "page.html").exists()


def test_a_limited_size_is_kept_to(tmp_path):
    page = StoredPage(scene_from(tmp_path, TWO_MASSES))
    page.compute(lambda *_: None, only_first=True)
    first, expected = page.size, page.expected_size
    page.compute(lambda *_: None, most=2.5 * first)
    assert 1 < page.done < page.count
    assert page.size <= 2.5 * first
    page.compute(lambda *_: None)
    assert page.done == page.count
    assert expected == pytest.approx(page.size, rel=0.5)


def test_sliders_are_chosen(tmp_path):
    scene = scene_from(tmp_path, TWO_MASSES)
    page = StoredPage(scene, ["mass_ratios[2]"])
    page.compute(lambda *_: None)
    found = content_of(page.page().decode())
    assert [slider["key"] for slider in found["scene"]["sliders"]] == ["mass_ratios[2]"]
    assert list(found["values"]) == ["mass_ratios[2]"]
    assert len(found["maps"]) == page.count == 3
    with pytest.raises(InputError, match=r"unknown slider 'nu' \(did you mean mu\?\); valid: mu, damping"):
        StoredPage(scene, ["nu"])


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("answer", "maps"), [("\n", 6), ("mu\n", 2), ("none\n", 1)])
def test_a_terminal_is_asked_for_the_sliders(tmp_path, monkeypatch, capsys, answer, maps):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.toml").write_text(ONE)
    monkeypatch.setattr(sys, "stdin", Terminal(answer))
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert cli.main(["explore", "one.toml", "--export", "page.html"]) == 0
    asked = capsys.readouterr().err
    assert re.search(r"6 maps, about 0\.\d+ MB with the sliders mu, damping_ratios\n", asked)
    assert len(content_of((tmp_path / "page.html").read_text())["maps"]) == maps


def test_options_of_a_saved_page_need_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.toml").write_text(ONE)
    assert cli.main(["explore", "one.toml", "--no-browser", "--size", "3"]) == 2
    assert "cannot use --size without --export" in capsys.readouterr().err
    arguments = ["explore", "one.toml", "--export", "page.html", "--sliders", "mu", "--size", "0.001"]
    assert cli.main(arguments) == 0
    assert "with 1 of 2 maps" in capsys.readouterr().out


def test_cells_of_a_saved_page_can_be_clicked(browser, tmp_path):
    scene = scene_from(tmp_path, ONE)
    path = tmp_path / "page.html"
    path.write_bytes(stored.write_page(scene, lambda *_: None))
    where = "document.querySelector('#motion .where')?.innerText ?? ''"
    with page_of(browser, path.as_uri(), offline=True, viewport={"width": 1280, "height": 800}) as page:
        page.wait_for_selector("#motion .drawing .mass")
        page.mouse.click(*point(page, 0.4, 0.3))
        page.wait_for_function(f"() => {where}.startsWith('selected, nearest in this file')")
        r, beta = (float(text) for text in re.findall(r"= ([0-9.]+)", page.evaluate(where)))
        cell = 0.2 + 1.6 * 3.5 / 8, 0.1 + 1.1 * 1.5 / 6  # of 8 x 6 of the map, with 4 x 3 motions
        assert (r, beta) == pytest.approx(cell, abs=1e-3)
        ds = fm.response(scene.system, *cell)
        regime = {fm.regimes.STICK_SLIP: "Stick-slip", fm.regimes.CONTINUOUS: "Continuous sliding"}
        assert page.inner_text("#motion .regime") == regime[ds.regime.item()]
        words = page.inner_text("#motion table")
        assert f"{ds.contact_amplitude.item():.6g}" in words
        shown = page.evaluate(where)
        repainted(page, lambda: page.evaluate(MOVE, ["mu", 1]))
        page.wait_for_function("(old) => document.querySelector('.where').innerText !== old", arg=shown)
        assert page.locator("#motion .drawing .mass").count() == 1
        assert np.isfinite(page.evaluate("document.querySelector('.drawing').dataset.scale * 1"))

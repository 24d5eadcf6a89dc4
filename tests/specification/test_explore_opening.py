"""The page of contacts that open, of piecewise linear springs and of friction over speed."""

import json

import numpy as np
import pytest
from pages import ask, packet, scene_from, served
from test_explore_contacts import middles

import frictionmap as fm
from frictionmap.explorer.law_numbers import put_law_number
from frictionmap.files.config import config_of

GRID = "[grid]\nr = [0.3, 1.8]\nbeta = [0.1, 1.0]\n"
OPENING = f"""\
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.02
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
normal = {{ mass = 2, stiffness = 0.5, friction = 0.4, preload = 0.8 }}
{GRID}"""
AT_PRELOAD = OPENING.replace(", preload = 0.8", "")
GAP = OPENING.replace("normal = { mass = 2, stiffness = 0.5, friction = 0.4, preload = 0.8 }\n", "").replace(
    "[grid]", "[[system.springs]]\nmasses = [1, 2]\ngap = 0.5\nstiffness = 2.0\n[grid]"
)
LAW = f"""\
[system]
damping_ratios = 0.02
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
wall_speed = 0.5
law = {{ speed = [0.0, 0.5, 1.0], factor = [1.0, 0.8, 0.6] }}
{GRID}"""
FORMULA = LAW.replace(
    "speed = [0.0, 0.5, 1.0], factor = [1.0, 0.8, 0.6]",
    'formula = "exponential", kinetic = 0.6, speed = 0.4, viscous = 0.1, error = 0.02',
)
TEXTS = {"opening": OPENING, "at preload": AT_PRELOAD, "gap": GAP, "law": LAW}
R, BETA, SHAPE = (0.3, 1.8), (0.1, 1.0), (6, 4)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    opened = {}

    def page(name):
        if name not in opened:
            opened[name] = served(scene_from(tmp_path_factory.mktemp("page"), TEXTS[name]))
            servers[name] = opened[name].__enter__()
        return servers[name]

    servers = {}
    yield page
    for one in opened.values():
        one.__exit__(None, None, None)


def cells_of(system):
    axes = (middles(*ends, count) for ends, count in zip((R, BETA), SHAPE, strict=True))
    return fm.sweep(system, *axes, outputs=("regime", "stops_per_cycle")).isel(mu=0)


@pytest.mark.parametrize(
    ("name", "query", "before", "after"),
    [
        ("opening", "", "", ""),
        ("opening", "&contacts[1].normal.preload=1.3", "preload = 0.8", "preload = 1.3"),
        ("opening", "&contacts[1].normal.friction=0.7", "friction = 0.4", "friction = 0.7"),
        ("at preload", "&contacts[1].normal.stiffness=0.2", "stiffness = 0.5", "stiffness = 0.2"),
        ("gap", "", "", ""),
        ("law", "&contacts[1].law.last=0.2", "[1.0, 0.8, 0.6]", "[1.0, 0.6, 0.2]"),
        ("law", "&contacts[1].law.slope=0.3", "0.6] }", "0.6], slope = 0.3 }"),
    ],
)
def test_a_map_is_that_of_the_changed_configuration(pages, name, query, before, after):
    assert before in TEXTS[name]
    system = config_of(TEXTS[name].replace(before, after) if before else TEXTS[name], {}).system
    columns, rows = SHAPE
    _, arrays = packet(pages(name), f"/map?columns={columns}&rows={rows}{query}")
    stuck, continuous = (arrays["classes"].reshape(SHAPE) == k for k in (1, 2))
    regime = cells_of(system).regime.values
    np.testing.assert_array_equal(stuck, regime == fm.regimes.PERMANENT_STICKING)
    np.testing.assert_array_equal(continuous, regime == fm.regimes.CONTINUOUS)
    if query:
        plain = cells_of(config_of(TEXTS[name], {}).system)
        assert not plain.equals(cells_of(system))


def test_an_open_contact_has_a_state_of_its_own(pages):
    header, arrays = packet(pages("opening"), "/motion?at=0.7,0.4")
    ds = fm.response(config_of(OPENING, {}).system, 0.7, 0.4, points=400)
    share = ds.open_fraction.item()
    assert 0.1 < share < 0.9
    opened = arrays["states"][0] == 2
    np.testing.assert_array_equal(opened, ds.open.values.ravel() == 1)
    assert "The preload is given: the friction at rest is 0.32 P, whatever β is." in header["summary"]
    assert not any("β_stick" in text for text in header["summary"])
    assert any(f"it is open {100 * share:.3g} % of the time" in text for text in header["summary"])
    listed = {entry["name"]: value for entry, value in zip(header["entries"], arrays["numbers"], strict=True)}
    assert listed["open_fraction"] == pytest.approx(100 * share)
    assert listed["normal_force_max"] == pytest.approx(ds.normal_force_max.item())


@pytest.mark.parametrize("name", ["at preload"])
def test_its_boundary_is_that_of_boundaries(pages, name):
    _, arrays = packet(pages(name), "/lines?count=4")
    wanted = fm.boundaries(config_of(TEXTS[name], {}).system, middles(*R, 4)).beta_stick.values.ravel()
    np.testing.assert_allclose(arrays["line_stick"], wanted, rtol=1e-12)
    assert np.isfinite(wanted).all()


def test_a_configuration_of_the_view_has_the_changed_numbers(pages):
    query = "columns=2&rows=2&contacts[1].normal.preload=1.3"
    status, body, _ = ask(pages("opening"), f"/configuration.toml?{query}")
    assert status == 200, body
    assert config_of(body.decode(), {}).system.contacts[0].normal.preload == 1.3


def test_every_page_has_sliders_of_its_law(pages):
    def keys(name):
        return {slider["key"] for slider in json.loads(ask(pages(name), "/scene")[1])["sliders"]}

    assert {"contacts[1].normal.preload", "contacts[1].normal.friction"} <= keys("opening")
    assert "contacts[1].normal.preload" not in keys("at preload")  # beta is the friction at preload
    assert {"contacts[1].law.last", "contacts[1].law.slope", "contacts[1].wall_speed"} <= keys("law")


@pytest.mark.parametrize(("name", "value"), [("kinetic", 0.3), ("speed", 0.8), ("viscous", 0.0)])
def test_numbers_of_a_formula_make_it_anew(name, value):
    contacts = config_of(FORMULA, {}).system.contacts
    changed = put_law_number(contacts, f"contacts[1].law.{name}", value)[0].law
    given = {"kinetic": 0.6, "speed": 0.4, "viscous": 0.1, name: value}
    exact = given["kinetic"] + (1 - given["kinetic"]) * np.exp(-np.array([0.1, 0.7, 2.0]) / given["speed"])
    exact += given["viscous"] * np.array([0.1, 0.7, 2.0])
    assert np.abs(changed([0.1, 0.7, 2.0]) - exact).max() <= 0.02 * (1 + 1e-9)


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("contacts[1].law.slope=-1", "contacts[1].law.slope must be >= 0"),
        ("contacts[1].law.last=1", "contacts[1].law.last must leave friction that depends on the speed"),
        ("contacts[1].law.kinetic=1", "unknown key 'contacts[1].law.kinetic'"),
    ],
)
def test_what_a_law_cannot_be_is_refused_in_a_line(pages, query, words):
    status, body, _ = ask(pages("law"), f"/map?columns=2&rows=2&{query}")
    assert status == 400
    assert words in body.decode()


BEAM = """\
[system]
load_mass = "shaker"
damping_ratios = 0.01
[[system.contacts]]
kind = "fixed-wall"
masses = ["tip"]
stiffness = "5 N/mm"
[system.beam]
ends = "clamped-free"
length = "300 mm"
bending_stiffness = "21 N m^2"
mass_per_length = "0.78 kg/m"
points = { tip = "300 mm", shaker = "180 mm" }
modes = 6
[units]
load = "10 N"
[grid]
r = ["20 Hz", "60 Hz"]
beta = ["1 N", "13 N"]
"""


def test_points_of_a_beam_have_names_and_move(tmp_path):
    scene = scene_from(tmp_path, BEAM)
    with served(scene) as server:
        header, arrays = packet(server, "/motion?at=1.1,0.3")
        quantities = json.loads(ask(server, "/scene")[1])["quantities"]
        assert ask(server, "/configuration.toml?columns=2&rows=2")[0] == 200
    ds = fm.response(scene.system, 1.1, 0.3, points=400)
    np.testing.assert_allclose(arrays["x"], ds.x.values, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(arrays["z_rate"], ds.v.sel(dof=1).values, rtol=1e-5, atol=1e-5)
    assert header["dofs"] == header["drawing"]["names"] == ["tip", "shaker"]
    assert header["drawing"]["contacts"][0]["masses"] == [0]
    assert header["drawing"]["loaded"] == [1]
    assert "amplitude of point shaker" in [one["label"] for one in quantities]


def test_a_beam_has_a_picture_of_its_structure(tmp_path):
    with served(scene_from(tmp_path, BEAM)) as server:
        assert json.loads(ask(server, "/scene")[1])["structure"]
        status, body, headers = ask(server, "/structure.svg")
        assert (status, headers["Content-Type"]) == (200, "image/svg+xml; charset=utf-8")
        for name in (b"friction between point tip", b"load on point shaker"):
            assert name in body
    with served(scene_from(tmp_path, LAW)) as server:
        assert not json.loads(ask(server, "/scene")[1])["structure"]
        assert ask(server, "/structure.svg")[0] == 404

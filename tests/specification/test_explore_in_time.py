"""The page of motions in time under records: what its server answers and refuses, what it shows."""

import contextlib
import http.client
import json
import re
import subprocess
import sys
import tempfile
from urllib.parse import quote

import numpy as np
import pytest
from browser import MOVE, page_of
from layouts import words_of
from pages import HANG, ask, packet, served

import frictionmap as fm
from frictionmap import InputError
from frictionmap.explorer.in_time import around_largest, check, extremes
from frictionmap.motions.configuration import load_motions

#: A block on a floor that is pushed by a force of 1 for 2 units of time: it has the speed 2 (1 - F) then.
BLOCK = """\
title = "A push"
[system]
stiffness_ratios = [0.0]
[record]
quantity = "force"
pulse = { kind = "rectangle", amplitude = 1.0, duration = 2.0 }
after = 20.0
[history]
beta = [0.3, 0.5]
"""
#: The same in units: P = 20 N, m = 5 kg.
IN_UNITS = """\
[system]
[units]
natural_frequency = "2 Hz"
mass = "5 kg"
load = "20 N"
[record]
[record.generate]
kind = "kanai-tajimi"
frequency = "2.5 Hz"
damping = 0.6
peak = "0.4 g"
duration = "3 s"
dt = "0.01 s"
count = 2
[history]
friction = ["5 N"]
"""
SHOWN = "#in-time[data-state=done]"


def motions_from(folder, text):
    path = folder / "motions.toml"
    path.write_text(text)
    return load_motions(path)


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    with served(motions_from(tmp_path_factory.mktemp("block"), BLOCK)) as server:
        yield server


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    with served(motions_from(tmp_path_factory.mktemp("shaken"), IN_UNITS)) as server:
        yield server


@pytest.mark.parametrize("friction", [0.3, 0.5, 0.8])
def test_a_block_slides_as_far_as_in_the_formula_of_newmark(block, friction):
    header, arrays = packet(block, f"/motion?beta={friction}")
    far = 2.0**2 / (2.0 * friction) * (1.0 - friction)
    stop = 2.0 / friction  # when friction has taken all momentum
    assert arrays["x"][0].max() == pytest.approx(far, rel=1e-12)
    np.testing.assert_allclose(arrays["stuck"][-1], [stop, arrays["time"][-1]], rtol=1e-12)
    sliding = (arrays["time"] > 0.0) & (arrays["time"] < 0.999 * stop)  # the stop has a sample of each side
    assert np.allclose(np.abs(arrays["friction"][0][sliding]), friction, rtol=1e-12)
    rows = dict(header["rows"])
    assert rows["stops"] == "1"
    assert float(rows["place of rest"]) == pytest.approx(far, rel=1e-3)
    assert rows["slides first at"] == "0"


def test_points_and_masses_have_their_names(tmp_path):
    """Those of a structure given by modes are the user's, on the page and in pictures; others are numbers."""
    points = (
        "[system]\nmodes = { frequencies = [1.0, 3.0], shapes = [[0.6, 0.3], [0.2, -0.4]], "
        'points = ["tip", "hub"], normalised = "mass" }\ncontact_masses = ["tip"]\nload_mass = "hub"\n'
    )
    chain = "[system]\nmass_ratios = [1, 1]\nstiffness_ratios = [1, 1]\n"
    blow = '[record]\nquantity = "force"\npulse = { kind = "half-sine", amplitude = 1.0, duration = 2.0 }\n'
    rest = "damping_ratios = 0.05\n" + blow + "[history]\nbeta = [0.2]\n"
    for system, names in ((points, ["point tip", "point hub"]), (chain, ["mass 1", "mass 2"])):
        motions = motions_from(tmp_path, system + rest)
        with served(motions) as server:
            header, _ = packet(server, "/motion")
        assert header["masses"] == names
        assert header["contacts"] == ["contact 1"]
        axes = fm.plot_history(motions.follow(motions.records))
        assert words_of(axes)[:2] == names


def test_a_block_that_a_force_cannot_move(block):
    header, arrays = packet(block, "/motion?beta=1.5&mu=1.2")
    assert dict(header["rows"])["slides first at"] == "never"
    np.testing.assert_array_equal(arrays["stuck"], [[0.0, arrays["time"][-1]]])
    assert not arrays["x"].any()
    _, moved = packet(block, "/motion?beta=1.5&mu=1.2&scale=2")
    assert moved["x"][0].max() == pytest.approx(2.0 * (2.0 - 1.5) * (2.0 / 1.5), rel=1e-12)


def test_numbers_may_have_units(shaken):
    for text, beta in (("5 N", 0.25), ("0.01 kN", 0.5), ("2 m/s^2", 0.5), ("0.75", 0.75)):
        _, body, _ = ask(shaken, f"/ratios?beta={quote(text)}")
        assert f'"beta": {beta}' in body.decode(), text
    header, _ = packet(shaken, f"/motion?record=2&beta={quote('10 N')}")
    assert dict(header["rows"])["friction"] == "10 N"
    assert (header["record"], header["beta"]) == (2, 0.5)
    assert header["names"]["x"] == "displacement [m]"
    assert header["names"]["time"] == "time [s]"


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("record=3", "record must be <= 2; got 3"),
        ("record=0", "record must be >= 1; got 0"),
        ("record=1.5", "record must be a whole number; got 1.5"),
        ("beta=-1", "beta must be >= 0; got -1"),
        ("beta=3%20Hz", "Hz is a unit of frequency"),
        ("mu=0.9", "mu must be >= 1; got 0.9"),
        ("scale=nan", "scale must be"),
        ("friction=1", "unknown key 'friction'; valid: record, beta, mu, scale"),
        ("beta=1&beta=2", "beta must be given once"),
    ],
)
def test_refused_queries(shaken, query, words):
    for address in ("/motion", "/ratios"):
        status, body, _ = ask(shaken, f"{address}?{query}")
        assert status == 400
        assert words in body.decode()
        assert body.count(b"\n") == 1


def test_units_are_needed_for_friction_with_a_unit(block):
    status, body, _ = ask(block, "/motion?beta=5%20N")
    assert status == 400
    assert re.search("units", body.decode())


def test_only_the_page_itself_is_answered(block):
    assert ask(block, "/motion", {"Origin": "http://elsewhere.example"})[0] == 403
    assert ask(block, "/motion", {"Host": "elsewhere.example"})[0] == 403
    assert ask(block, "/map?columns=2&rows=2")[0] == 404
    status, body, headers = ask(block, "/")
    assert status == 200
    assert b"in_time.js" in body
    assert "default-src 'self'" in headers["Content-Security-Policy"]


def test_a_thinner_curve_keeps_its_extremes():
    rows = np.random.default_rng(3).normal(size=(3, 10_007)).cumsum(axis=1)
    kept = extremes(rows, 100)
    assert kept.size <= 100 * 2 * 3 + 2
    assert (kept[0], kept[-1]) == (0, 10_006)
    assert (np.diff(kept) > 0).all()
    for begin in range(0, 10_007, 101):  # ceil(10007 / 100)
        part = kept[(kept >= begin) & (kept < begin + 101)]
        for row in rows:
            own = row[begin : begin + 101]
            assert (row[part].min(), row[part].max()) == (own.min(), own.max())
    np.testing.assert_array_equal(extremes(rows[:, :150], 100), np.arange(150))


def test_the_samples_of_a_loop_are_successive():
    rows = np.zeros((2, 100))
    for at, window in ((3, slice(0, 20)), (50, slice(40, 60)), (98, slice(80, 100))):
        rows[:] = 0.0
        rows[1, at] = -1.0
        assert around_largest(rows, 20) == window
    assert around_largest(rows, 200) == slice(0, 100)


def test_a_missing_reference_value_is_named_before_the_page_opens(tmp_path):
    motions = motions_from(tmp_path, IN_UNITS.replace('natural_frequency = "2 Hz"\nmass = "5 kg"\n', ""))
    with pytest.raises(InputError, match=re.escape("units.natural_frequency")):
        check(motions)


def test_motions_are_not_stored_as_a_page(tmp_path):
    path = tmp_path / "push.toml"
    path.write_text(BLOCK)
    command = [
        sys.executable,
        "-m",
        "frictionmap",
        "explore",
        str(path),
        "--export",
        str(tmp_path / "page.html"),
    ]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 2
    assert "frictionmap history" in found.stderr
    assert not (tmp_path / "page.html").exists()


def test_the_motion_follows_the_slider(browser, block):
    with page_of(browser, block.url, SHOWN) as page:
        assert page.title() == "A push – frictionmap"
        before = page.inner_text("#numbers")
        page.evaluate(MOVE, ["beta", 500])  # half of twice the largest friction, 0.5
        page.wait_for_selector(SHOWN)
        assert page.input_value("input.number[name=beta]") == "0.5"
        assert page.inner_text("#numbers") != before
        assert re.search(r"place of rest\s+2\b", page.inner_text("#numbers"))
        assert "beta=0.5" in page.url


def test_a_refusal_stands_next_to_its_field(browser, shaken):
    with page_of(browser, shaken.url, SHOWN) as page:
        field = page.locator("input.number[name=beta]")
        field.fill("10 N")
        field.press("Enter")
        page.wait_for_selector("#numbers :text('10 N')")
        assert re.search(r"friction\s+10 N", page.inner_text("#numbers"))
        field.fill("3 Hz")
        field.press("Enter")
        page.wait_for_selector("#controls .refused:not([hidden])")
        assert "Hz is a unit of frequency" in page.inner_text("#controls .refused:not([hidden])")
        page.wrong.clear()  # the refusal itself, which browsers log


def test_a_page_of_motions_from_python():
    """The push of `BLOCK`, with friction 0.5 at first."""
    block, push = fm.System(stiffness_ratios=[0.0]), fm.Record([1.0, 1.0], dt=2.0, quantity="force")
    with fm.explore(block, beta=0.5, record=push, port=0) as page:
        _, arrays = packet(page._server, "/motion")
        assert arrays["x"][0].max() == pytest.approx(2.0, rel=1e-12)
        assert json.loads(ask(page._server, "/scene")[1])["title"] == "Motions in time"
    refused = [
        ({"r": (0.5, 1.0)}, "cannot use r with record"), ({"beta": -1.0}, r"^beta must be >= 0"),
        ({"start": "moving"}, "cannot use start with record"), ({"mu": 0.5}, r"^mu must be >= 1"),
    ]  # fmt: skip
    for more, said in refused:
        with pytest.raises(InputError, match=said):
            fm.explore(block, record=push, **more)
    quake = fm.Record([0.0, 1.0, 0.0], dt=0.1, unit="g")
    with pytest.raises(InputError, match="reference value"):
        fm.explore(fm.System(), record=quake)


def send(server, name, body, path="/record?name=", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=HANG)
    with contextlib.closing(connection):
        connection.request("POST", path + quote(name), body, headers)
        answer = connection.getresponse()
        return answer.status, answer.read().decode()


#: The push of `BLOCK` as a file: a force of 1 for 2 units of time.
FILE = b"time,force\n0,1\n2,1\n"


def test_a_file_of_a_record_is_one_more_record(tmp_path):
    with served(motions_from(tmp_path, BLOCK)) as server:
        status, body = send(server, "../push/down.csv", FILE)
        assert status == 200, body
        found = json.loads(body)
        assert found["record"] == 2
        assert found["records"][1]["label"] == "2: _push_down"
        _, arrays = packet(server, "/motion?record=2&beta=0.5")
        assert arrays["x"][0].max() == pytest.approx(2.0, rel=1e-12)
        assert not list(tmp_path.glob("**/*.csv"))


def test_a_pulse_is_one_more_record(tmp_path, shaken):
    with served(motions_from(tmp_path, BLOCK)) as server:
        pulse = "/pulse?kind=rectangle&amplitude=1&duration="
        status, body = send(server, "2", b"", pulse)
        assert status == 200, body
        assert json.loads(body)["records"][1]["label"] == "2: rectangle 1, 2"
        _, arrays = packet(server, "/motion?record=2&beta=0.5")
        assert arrays["x"][0].max() == pytest.approx(2.0, rel=1e-12)
        assert send(server, "2", b"", pulse, Origin="http://elsewhere.example")[0] == 403
    ricker = "/pulse?kind=ricker&duration=0.5%20s&amplitude="
    assert send(shaken, "0.4 g", b"", ricker)[0] == 200
    for text, said in (
        ("0.4 mm", "unit must be one of"),
        ("strong", "amplitude must be"),
        ("", "amplitude must be"),
    ):
        status, body = send(shaken, text, b"", ricker)
        assert (status, body.count("\n")) == (400, 1)
        assert said in body


@pytest.mark.parametrize(
    ("name", "body", "words"),
    [
        ("push.csv", b"time,force\n0,1\n", "push.csv"),
        ("push.csv", b"\xff\xfe\x00", "push.csv"),
        ("push.at2", b"no earthquake", "push.at2"),
        ("push.csv", b"", "push.csv"),
        ("...", FILE, "name must be that of a file"),
        ("push.csv", b"time_s,force_N\n0,1\n2,1\n", "natural_frequency"),
    ],
)
def test_refused_files(block, name, body, words):
    status, said = send(block, name, body)
    assert status == 400
    assert words in said
    assert said.count("\n") == 1
    assert tempfile.gettempdir() not in said


def test_files_come_from_the_page_alone(block, tmp_path):
    assert send(block, "push.csv", FILE, Origin="http://elsewhere.example")[0] == 403
    assert send(block, "push.csv", FILE, Origin="null")[0] == 403
    assert send(block, "push.csv", FILE, Host="elsewhere.example")[0] == 403
    status, said = send(block, "push.csv", b"", **{"Content-Length": str(2**40)})
    assert (status, "32 MB" in said) == (413, True)
    assert send(block, "push.csv", b"", **{"Content-Length": "-1"})[0] == 411
    assert packet(block, "/motion?record=1")
    assert ask(block, "/motion?record=2")[0] == 400


def test_a_file_that_is_chosen_on_the_page(browser, tmp_path):
    path = tmp_path / "push.csv"
    path.write_bytes(FILE)
    with served(motions_from(tmp_path, BLOCK)) as server, page_of(browser, server.url, SHOWN) as page:
        page.set_input_files("#file", path)
        page.wait_for_selector("#record option:nth-child(2)", state="attached")
        page.wait_for_selector(SHOWN)
        assert page.input_value("#record") == "2"
        assert "record=2" in page.url
        path.write_bytes(b"")
        page.set_input_files("#file", path)
        page.wait_for_selector("#file + .refused:not([hidden])")
        page.wrong.clear()  # the refusal itself, which browsers log


def test_a_pulse_that_is_defined_on_the_page(browser, tmp_path):
    with served(motions_from(tmp_path, BLOCK)) as server, page_of(browser, server.url, SHOWN) as page:
        page.click("#pulse summary")
        page.fill("#pulse-amplitude", "1")
        page.fill("#pulse-duration", "2 parsec")
        page.click("#pulse-add")
        page.wait_for_selector("#pulse .refused:not([hidden])")
        page.wrong.clear()  # the refusal itself, which browsers log
        page.fill("#pulse-duration", "2")
        page.press("#pulse-duration", "Enter")
        page.wait_for_selector("#record option:nth-child(2)", state="attached")
        page.wait_for_selector(SHOWN)
        assert page.input_value("#record") == "2"


def test_spectra_have_no_page(tmp_path):
    path = tmp_path / "spectra.toml"
    record = BLOCK.replace("[system]\nstiffness_ratios = [0.0]\n", "").partition("[history]")[0]
    path.write_text(record + "[spectrum]\nperiod = [1.0]\nfriction = [0.1]\n")
    command = [sys.executable, "-m", "frictionmap", "explore", str(path)]
    found = subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANG)
    assert found.returncode == 2
    assert f"use frictionmap spectrum {path}, or add a table [system]" in found.stderr

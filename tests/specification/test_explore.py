"""The page that explores maps, without a browser: what its server answers, refuses, gives up; its files."""

import base64
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import zlib
from html.parser import HTMLParser
from urllib.parse import quote

import numpy as np
import pytest
import xarray as xr
from conftest import ROOT
from pages import HANG, TWO_MASSES, ask, packet, scene_from, served, solver
from refusals import refusal
from structures import chain_matrices

import frictionmap as fm
from frictionmap import InputError, regimes
from frictionmap._kernels.compiler.notices import listeners
from frictionmap.explorer import cell, stored
from frictionmap.explorer.cell import motion
from frictionmap.explorer.jobs import Jobs, Outdated
from frictionmap.explorer.packets import pack, unpack
from frictionmap.files.config import config_of, load_config
from frictionmap.motions.configuration import load_motions
from frictionmap.pictures.classes import classes
from frictionmap.structures import reduction

ONE = """\
title = "One mass"
[system]
contact = "fixed-wall"
[grid]
r = { start = 0.0, stop = 2.0, step = 0.1 }
beta = { start = 0.0, stop = 1.2, step = 0.1 }
mu = [1.5, 1.75]
[solver]
outputs = ["period"]
"""
TWO = TWO_MASSES.replace("[grid]", "damping_ratios = 0.02\n[grid]")

UNITS = '[units]\nnatural_frequency = "4.2 Hz"\nload = "12.5 N"\nstiffness = "3 N/mm"\n'


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    """A server of one mass."""
    with served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as server:
        yield server


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    """A server of two masses."""
    with served(scene_from(tmp_path_factory.mktemp("two"), TWO)) as server:
        yield server


def middles(low, high, count):
    half = (high - low) / (2 * count)
    return np.linspace(low + half, high - half, count)


# What it computes


@pytest.mark.parametrize("mu", [1.0, 1.5])
def test_a_map_is_that_of_sweep_to_the_bit(one, mu):
    r, beta = middles(0.2, 1.4, 40), middles(0.0, 1.1, 30)
    ds = fm.sweep(fm.System(), r, beta, mu, solver=solver())
    began = time.perf_counter()
    header, arrays = packet(one, f"/map?r=0.2,1.4&beta=0,1.1&mu={mu}&columns=40&rows=30")
    assert 0.0 < header["seconds"] < time.perf_counter() - began
    np.testing.assert_array_equal(arrays["classes"], classes(ds.isel(mu=0)))
    for name in ("beta_lim", "beta_stick"):
        np.testing.assert_array_equal(arrays[name], ds[name].values[0])
    assert (header["first"], header["last"]) == (0, 40)
    _, coarse = packet(one, f"/map?r=0.2,1.4&beta=0,1.1&mu={mu}&columns=4&rows=3&lines=40")
    np.testing.assert_array_equal(coarse["line_lim"], arrays["beta_lim"])
    np.testing.assert_array_equal(coarse["line_stick"], arrays["beta_stick"])
    assert np.unique(arrays["classes"]).size > 2


@pytest.mark.parametrize(
    "name", ["contact_amplitude", "multiplier", "stuck_fraction", "work_friction", "amplitude_2"]
)
def test_pieces_of_a_quantity_are_those_of_sweep(two, name):
    r, beta = middles(0.1, 2.5, 12), middles(0.0, 2.0, 9)
    system = fm.System(
        "between-masses", [1, 2], mass_ratios=[1, 0.5], stiffness_ratios=[1, 3.0], damping_ratios=0.02
    )
    output = "amplitude" if name == "amplitude_2" else name
    ds = fm.sweep(system, r, beta, outputs=[output])
    whole = ds[output].values[0, ..., 1] if name == "amplitude_2" else ds[output].values[0]
    query = f"/map?quantity={name}&columns=12&rows=9&{quote('stiffness_ratios[2]')}=3"
    parts = [packet(two, f"{query}&first={first}&last={last}")[1] for first, last in ((0, 5), (5, 12))]
    joined = np.concatenate([part["values"] for part in parts])
    np.testing.assert_array_equal(joined, whole.astype(np.float32))


def test_a_cell_has_the_motion_of_response(one):
    _, arrays = packet(one, "/motion?at=0.3,0.5&mu=1")
    header, _ = packet(one, "/motion?at=0.3,0.5&mu=1")
    ds = fm.response(fm.System(), 0.3, 0.5, points=arrays["tau"].size - 1)
    for name in ("tau", "z", "friction", "x"):
        np.testing.assert_array_equal(arrays[name], ds[name].values.astype(np.float32))
    sliding = arrays["direction"] != 0
    np.testing.assert_array_equal(arrays["z_rate"][sliding], ds["v"].values[0, sliding].astype(np.float32))
    assert not arrays["z_rate"][~sliding].any()
    numbers = dict(zip([entry["name"] for entry in header["entries"]], arrays["numbers"], strict=True))
    assert numbers["contact_amplitude"] == ds["contact_amplitude"].item()
    # a dataset has it in single precision
    assert numbers["stuck_fraction"] == pytest.approx(100.0 * ds["stuck_fraction"].item(), rel=2.0**-24)
    assert header["regime"] == "stick_slip"
    (why,) = (entry["why"] for entry in header["entries"] if entry["name"] == "phase_lag")
    begin, end = (f"{ds[name].item():.3f}".replace("-", "−") for name in ("phase_begin", "phase_end"))
    assert why == f"held at its maximum from {begin} to {end} rad"


def test_a_motion_of_every_kind_is_rehearsed(one, two, monkeypatch):
    """Else the first cell of a kind waits for its kernels."""
    for server in (one, two):
        kinds = set()

        def told(*asked, kinds=kinds):
            header, arrays = motion(*asked)
            kinds.add(header["regime"])
            return header, arrays

        monkeypatch.setattr(cell, "motion", told)
        server.page.rehearse()
        monkeypatch.undo()
        assert kinds == {"stick_slip", "continuous", "permanent_sticking"}


@pytest.mark.parametrize(
    ("asked", "period", "why"),
    [
        ("at=0.3,1.1&mu=1", 1, "the mass is at rest"),
        ("at=0.3881,0.1013&mu=2.5", 3, "the period is 3 cycles"),
        ("at=0.1913,0.0496&mu=2.5", 0, "the motion has no period"),
        ("at=1.5,0.1&mu=1", 1, ""),
    ],
)
def test_the_reason_of_a_missing_lag_is_given(one, asked, period, why):
    header, arrays = packet(one, f"/motion?{asked}")
    numbers = dict(zip([entry["name"] for entry in header["entries"]], arrays["numbers"], strict=True))
    assert numbers["period"] == period
    assert np.isnan(numbers["phase_lag"]) == bool(why)
    assert [entry["why"] for entry in header["entries"] if entry["why"]] == [why] * bool(why)


@pytest.mark.parametrize(
    ("at", "mu", "regime", "words"),
    [
        ("0.3,0.5", 1.0, "stick_slip", ["The contact slides and stops: 2 stops per cycle", "lies between"]),
        ("0.3,1.1", 1.0, "permanent_sticking", ["The contact never slides", "reaches β_stick = 1:"]),
        ("1.5,0.1", 1.0, "continuous", ["The contact slides to and fro", "lies below β_lim = "]),
        (
            "0.5,0.2",
            1.0,
            "continuous",
            ["to and fro", "lies below β_lim", "No damping, and r is an even sub-multiple"],
        ),
    ],
)
def test_a_cell_is_described_in_words(one, at, mu, regime, words):
    header, _ = packet(one, f"/motion?at={at}&mu={mu}")
    assert header["regime"] == regime
    for sentence, begin in zip(header["summary"], words, strict=True):
        assert begin in sentence


def test_the_velocity_in_a_moving_contact(one):
    """A joined base-wall: z = x - cos tau, so that z' = v + sin tau."""
    _, arrays = packet(one, "/motion?at=1.3,0.2&mu=1&contact=joined-base-wall:1")
    step = arrays["tau"][1].astype(float)
    rate = np.gradient(arrays["z"].astype(float), step)
    np.testing.assert_allclose(arrays["z_rate"][1:-1], rate[1:-1], atol=2e-3)


def test_the_reason_of_a_missing_steady_state_is_given(one):
    header, arrays = packet(one, "/motion?at=1,0.1&mu=1")
    assert "undamped resonance" in header["none"]
    assert arrays == {}


def test_what_other_starts_give(one):
    """Fixed wall, r = 0.303, beta = 0.76, mu = 1.5: stuck from rest, else two stops with Z = 0.853."""
    header, arrays = packet(one, "/others?at=0.303,0.76&mu=1.5")
    assert header["reachable"] == ["permanent_sticking", "stick_slip"]
    assert header["start"] == "moving"
    assert not header["same"]
    assert "2 stops per cycle" in header["summary"][0]
    assert np.abs(arrays["z"]).max() == pytest.approx(0.853, abs=5e-4)
    back, _ = packet(one, "/others?at=0.303,0.76&mu=1.5&start=moving")
    assert (back["start"], back["same"]) == ("rest", False)
    same, arrays = packet(one, "/others?at=0.303,0.5&mu=1")
    assert same["same"]
    assert list(arrays) == ["multiplier"]


@pytest.mark.parametrize(("along", "place"), [("r", 0.4), ("beta", 0.55)])
def test_a_cut_is_that_of_curves(two, along, place):
    _, arrays = packet(two, f"/cut?along={along}&place={place}&count=110&r=0.2,2.2&beta=0.1,1.9")
    system = fm.System(
        "between-masses", [1, 2], mass_ratios=[1, 0.5], stiffness_ratios=[1, 2], damping_ratios=0.02
    )
    r = middles(0.2, 2.2, 110) if along == "r" else place
    beta = place if along == "r" else middles(0.1, 1.9, 110)
    ds = fm.curves(system, r, beta, quantities=["amplitude", "energy", "first_harmonic"])
    flat = ds.isel({"mu": 0, "beta" if along == "r" else "r": 0})
    np.testing.assert_array_equal(arrays["amplitude"], flat["amplitude"].values.T.astype(np.float32))
    np.testing.assert_array_equal(arrays["contact_amplitude"], flat["contact_amplitude"].astype(np.float32))
    np.testing.assert_array_equal(arrays["work_friction"], flat["work_friction"].astype(np.float32))
    assert ("held" in arrays) == (along == "r")


# Reduced structures


def test_a_reduced_structure_is_shown_where_it_is_like_the_whole(tmp_path, monkeypatch):
    """With this number of modes compliances err by 0.9e-3 up to r = 3, and by 12e-3 up to r = 6."""
    compared = []
    comparison = reduction.Comparison
    monkeypatch.setattr(
        reduction, "Comparison", lambda *given: compared.append(given[1:]) or comparison(*given)
    )
    scene = seventy(tmp_path, "reduce = { keep = [17], modes = 12 }")
    with served(scene) as server:
        told = json.loads(ask(server, "/scene?r=0.7,2&damping_ratios=0.2")[1])["system"]
        assert re.search(r"; natural frequencies within .*, compliances within .*, for r = 0.7 to 2;", told)
        packet(server, "/map?columns=3&rows=2&damping_ratios=0.1")
        packet(server, "/motion?at=1.5,0.3&damping_ratios=0.3")
        assert len(compared) == 1
        with pytest.raises(InputError, match=r"reduce: cannot keep the error below") as refused:
            fm.sweep(scene.system, [0.5, 6.0], 0.1)
        for query in (
            "map?columns=3&rows=2&r=0.5,6",
            "motion?at=5.5,0.3&r=0.5,6",
            "others?at=5.5,0.3&r=0.5,6",
            "cut?along=r&place=0.3&count=3&r=0.5,6",
            "scene?r=0.5,6&damping_ratios=0.3",
        ):
            assert ask(server, f"/{query}")[:2] == (400, f"{refused.value}\n".encode())
        assert len(compared) == 2
        for query in ("motion?at=5.5,0.3", "cut?along=beta&place=5.5&count=3"):
            assert b"reduce: cannot keep the error below" in ask(server, f"/{query}")[1]
        packet(server, "/map?columns=3&rows=2&r=0.6,3")
    with pytest.raises(InputError, match=r"reduce: cannot keep the error below"):
        fm.explore(scene.system, r=[0.5, 6.0])


def test_masses_are_called_by_their_numbers_in_the_file(tmp_path):
    scene = seventy(tmp_path, "reduce = { keep = [17], modes = 12 }")
    ds = fm.response(scene.system, 1.5, 0.3)
    assert ds["dof"].values[1] == 10
    with served(scene) as server:
        header, arrays = packet(server, "/motion?at=1.5,0.3")
        cut, _ = packet(server, "/cut?along=r&place=0.3&count=2")
        told = json.loads(ask(server, "/scene")[1])
        _, cells = packet(server, "/map?columns=2&rows=2&quantity=amplitude_10")
    assert header["dofs"] == cut["dofs"] == ds["dof"].values.tolist()
    listed = dict(zip([entry["label"] for entry in header["entries"]], arrays["numbers"], strict=True))
    assert listed["amplitude of mass 10"] == ds["amplitude"].sel(dof=10).item()
    assert {"key": "amplitude_10", "label": "amplitude of mass 10", "scale": "log"} in told["quantities"]
    amplitudes = fm.sweep(scene.system, middles(0.5, 3.0, 2), middles(0.1, 1.0, 2), outputs=["amplitude"])
    np.testing.assert_array_equal(
        cells["values"], amplitudes["amplitude"].sel(dof=10).values[0].astype(np.float32)
    )


# What it begins with


def test_a_scene_lists_the_parameters_that_can_be_changed(one, two):
    first = json.loads(ask(one, "/scene")[1])
    assert first["title"] == "One mass"
    assert (first["r"], first["beta"], first["mu"]) == ([0.0, 2.0], [0.0, 1.2], 1.5)
    assert [slider["key"] for slider in first["sliders"]] == ["mu", "damping_ratios"]
    assert [contact["key"] for contact in first["contacts"]] == ["fixed-wall:1", "joined-base-wall:1"]
    second = json.loads(ask(two, "/scene?contact=fixed-wall:2")[1])
    keys = ["mu", "damping_ratios", "mass_ratios[2]", "stiffness_ratios[2]"]
    assert [slider["key"] for slider in second["sliders"]] == keys
    assert second["contacts"][0] == {"key": "between-masses:1,2", "label": "masses 1 and 2"}
    assert len(second["contacts"]) == 5
    assert "mass 2 and a fixed wall" in second["system"]
    assert len(second["marks"]["natural frequency"]) == 2


def test_further_axes_begin_at_their_first_point(tmp_path):
    text = f"{ONE}[axes]\ndamping_ratios = [0.05, 0.1]\n"
    assert scene_from(tmp_path, text).system.zeta == 0.05


def test_a_structure_given_by_matrices(tmp_path):
    mass, stiffness = np.diag([1.0, 2.0]), np.array([[3.0, -1.0], [-1.0, 1.0]])
    system = fm.System("fixed-wall", [2], matrices={"M": mass, "K": stiffness})
    with fm.explore(system, r=[0.1, 2.0], beta=[0, 1]) as page:
        port = int(page.url.rstrip("/").rpartition(":")[2])
        with socket.create_connection(("127.0.0.1", port)) as connection:
            connection.sendall(
                f"GET /scene HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n".encode()
            )
            body = b"".join(iter(lambda: connection.recv(65536), b""))
    told = json.loads(body.partition(b"\r\n\r\n")[2])
    assert [slider["key"] for slider in told["sliders"]] == ["mu", "damping_ratios"]
    assert [contact["key"] for contact in told["contacts"]] == ["fixed-wall:2", "joined-base-wall:2"]


# Who is answered


def test_it_listens_on_this_machine_only(one):
    assert one.server_address[0] == "127.0.0.1"


@pytest.mark.parametrize("target", ["/", "/scene", "/map?columns=2&rows=2", "/nothing"])
@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:PORT"},
        {"Host": "127.0.0.1"},
        {"Host": "127.0.0.1:1"},
        {"Host": ""},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": ""},
        {"Origin": "127.0.0.1:PORT"},
        {"Origin": "https://127.0.0.1:PORT"},
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"},
        {"Sec-Fetch-Site": "same-site", "Sec-Fetch-Mode": "cors"},
    ],
)
def test_others_are_refused(one, target, headers):
    port = str(one.server_address[1])
    status, body, _ = ask(one, target, {name: value.replace("PORT", port) for name, value in headers.items()})
    assert status == 403
    assert body.count(b"\n") == 1


def test_two_hosts_are_refused(one):
    port = one.server_address[1]
    with socket.create_connection(("127.0.0.1", port)) as connection:
        connection.sendall(
            f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nHost: x\r\nConnection: close\r\n\r\n".encode()
        )
        assert connection.recv(64).startswith(b"HTTP/1.1 403")


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Host": "localhost:PORT"},
        {"Host": "LOCALHOST:PORT"},
        {"Origin": "http://127.0.0.1:PORT"},
        {"Sec-Fetch-Site": "same-origin", "Sec-Fetch-Mode": "cors"},
        {"Sec-Fetch-Site": "none", "Sec-Fetch-Mode": "navigate"},
    ],
)
def test_our_own_page_is_answered(one, headers):
    port = str(one.server_address[1])
    given = {name: value.replace("PORT", port) for name, value in headers.items()}
    assert ask(one, "/scene", given)[0] == 200


def test_a_link_leads_to_the_page_and_to_no_work(one):
    letter = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    assert [ask(one, target, letter)[0] for target in ("/", "/index.html", "/?utm=1")] == [200] * 3
    assert [ask(one, target, letter)[0] for target in ("/map.csv?columns=2&rows=2", "/scene")] == [403] * 2


# What it refuses

VIEW_KEYS = "r, beta, mu, start, contact, damping_ratios"


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("map?rows=5", "columns must be given; got nothing"),
        ("map?columns=0&rows=5", "columns must be >= 1; got 0"),
        ("map?columns=5.5&rows=5", "columns must be a whole number; got 5.5"),
        ("map?columns=9000&rows=5", "columns must be <= 8192; got 9000"),
        ("map?columns=8192&rows=8192", "columns times rows must be <= 33554432; got 67108864"),
        ("map?columns=5&rows=5&first=5", "first must be <= 4; got 5"),
        ("map?columns=5&rows=5&first=3&last=3", "last must be >= 4; got 3"),
        ("map?columns=5&rows=5&mu=0.5", "mu must be >= 1; got 0.5"),
        ("map?columns=5&rows=5&mu=1,2", "mu must be a number; got '1,2'"),
        ("map?columns=5&rows=5&mu=nan", "mu must be finite; got nan"),
        ("map?columns=5&rows=5&mu=1_5", "mu must be a number; got '1_5'"),
        ("map?columns=5&rows=5&r=1", "r must be two numbers separated by a comma; got '1'"),
        ("map?columns=5&rows=5&r=2,1", "r must be increasing; got 1.0 at index 1"),
        ("map?columns=5&rows=5&r=-1,1", "r must be >= 0; got -1.0 at index 0"),
        ("map?columns=5&rows=5&beta=0,inf", "beta must be finite; got inf"),
        ("map?columns=5&rows=5&r=1,1.0000000000000004", "cannot place distinct columns between"),
        ("map?columns=5&rows=5&start=left", "start must be one of rest, moving; got 'left'"),
        ("map?columns=5&rows=5&contact=fixed-wall:2", "contact must be one of fixed-wall:1, joined"),
        ("map?columns=5&rows=5&quantity=colour", "quantity must be one of regime, contact_amplitude"),
        ("map?columns=5&rows=5&damping_ratios=-1", "damping_ratios must be >= 0; got -1.0"),
        ("map?columns=5&rows=5&damping_ratios=1e3", "damping_ratios must be <= 100; got 1000.0"),
        ("map?columns=5&columns=6&rows=5", "columns must be given once; got '5' and '6'"),
        ("map?colums=5&rows=5", f"unknown key 'colums' (did you mean columns?); valid: {VIEW_KEYS}"),
        ("map?columns", "the query must be KEY=VALUE&"),
        ("map?columns=%ff", "the query must be KEY=VALUE&"),
        ("map?" + "&".join(f"k{k}=1" for k in range(600)), "the query must be KEY=VALUE&"),
        (f"map?columns=5&rows=5&page={'x' * 65}", "page must be at most 64 ASCII characters"),
        ("map?columns=5&rows=5&lines=9000", "lines must be <= 8192; got 9000"),
        ("motion?at=1", "at must be r and beta separated by a comma; got '1'"),
        ("motion?at=0,1", "r must be > 0; got 0.0"),
        ("motion?at=1,-1", "beta must be >= 0; got -1.0"),
        ("motion", "at must be given; got nothing"),
        ("others?at=x,1", "r must be a number; got 'x'"),
        ("cut?along=z&place=1&count=9", "along must be one of r, beta; got 'z'"),
        ("cut?along=r&place=1&count=1", "count must be >= 2; got 1"),
        ("configuration.toml?columns=3", "rows must be given; got nothing"),
        ("map.nc?columns=3&rows=3&quantity=x", "quantity must be one of"),
        ("scene?mu=x", "mu must be a number; got 'x'"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_in_a_line(one, query, words):
    status, body, headers = ask(one, f"/{query}")
    assert status == 400
    assert words in body.decode()
    assert body.count(b"\n") == 1
    assert headers["Content-Type"].startswith("text/plain")


@pytest.mark.parametrize(
    "target",
    ["/nothing", "/page", "/../errors.py", "/%2e%2e/errors.py", "/map/", "/server.py", "/__init__.py"],
)
def test_what_is_not_there(one, target):
    status, body, _ = ask(one, target)
    assert status == 404
    assert body.count(b"\n") == 1


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "CONNECT"])
def test_other_methods_are_refused(one, method):
    for headers, wanted in (({}, 501), ({"Host": "evil.example"}, 403)):
        status, body, _ = ask(one, "/scene", headers, method)
        assert status == wanted
        assert body.count(b"\n") == 1


def test_an_address_that_is_none(one):
    with socket.create_connection(one.server_address) as connection:
        host = f"127.0.0.1:{one.server_address[1]}"
        connection.sendall(f"GET http://[ HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
        said = b"".join(iter(lambda: connection.recv(65536), b"")).decode()
    assert said.startswith("HTTP/1.1 400")
    assert said.endswith("the address must be one of this page; got 'http://[' (Invalid IPv6 URL)\n")


def test_an_address_that_is_too_long(one):
    status, body, _ = ask(one, f"/map?r={'1' * 70000}")
    assert status == 414
    assert body.count(b"\n") == 1


def test_internal_errors_are_reported_in_a_line(one, monkeypatch):
    def fail(*_):
        raise ZeroDivisionError("of ours")

    monkeypatch.setitem(one.page._work, "/state", fail)
    status, body, _ = ask(one, "/state")
    assert (status, body) == (500, b"frictionmap failed: ZeroDivisionError: of ours\n")


# The page's files


def files_asked_for(server):
    """Names of the files that a page loads, none of which names another host."""
    seen, waiting = set(), {"index.html"}
    while waiting:
        name = waiting.pop()
        seen.add(name)
        status, body, _ = ask(server, f"/{name}")
        assert status == 200, name
        text = body.decode()
        # the namespace of SVG is a name that nothing is loaded from
        assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", text), name
        found = re.findall(r'(?:from|href|src)[ =]"(?:\./)?([a-z_.]+\.(?:js|css))"', text)
        waiting |= set(found) - seen
    return seen


def test_the_pages_ask_only_our_own_server(one, tmp_path):
    status, _, headers = ask(one, "/")
    assert status == 200
    assert headers["Content-Security-Policy"].startswith("default-src 'self';")
    assert headers["Content-Type"] == "text/html; charset=utf-8"
    assert ask(one, "/", method="HEAD")[1] == b""
    path = tmp_path / "motions.toml"
    path.write_text(
        '[system]\n[record]\nquantity = "force"\npulse = { kind = "ricker", amplitude = 1, duration = 1 }'
    )
    with served(load_motions(path)) as server:
        of_motions = files_asked_for(server)
    assert {"in_time.js", "in_time.css"} <= of_motions
    kept = {path.name for path in (ROOT / "frictionmap/explorer/page").iterdir()} - {"in_time.html"}
    assert files_asked_for(one) | of_motions == kept  # the server gives in_time.html as index.html


# What is outdated


SLOW = "contact=between-masses:1,2&mu=1.9&columns=700&rows=700&r=0.02,0.2&beta=0.01,0.9&damping_ratios=0"


def in_background(server, target, done):
    def run():
        began = time.perf_counter()
        done.append((*ask(server, target)[:2], time.perf_counter() - began))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread


def waits_for(condition):
    end = time.perf_counter() + HANG
    while not condition():
        assert time.perf_counter() < end
        time.sleep(0.005)


def test_the_newest_request_of_a_page_wins(two):
    packet(two, "/map?columns=3&rows=3&mu=1.9")
    done = []
    thread = in_background(two, f"/map?{SLOW}&page=a", done)
    waits_for(lambda: two.page.jobs._running)
    time.sleep(0.3)
    assert not done
    asked = time.perf_counter()
    packet(two, "/map?columns=3&rows=3&page=b")  # another page
    assert not done
    packet(two, "/map?columns=3&rows=3&page=a")
    thread.join(HANG)
    took = time.perf_counter() - asked
    (answer,) = done
    assert answer[:2] == (204, b"")
    assert took < HANG / 10


@pytest.mark.parametrize(
    "target",
    [
        f"map?{SLOW}",
        f"map.nc?{SLOW}&quantity=work_friction",
        "cut?along=beta&place=0.005&count=8000&mu=1.9&beta=0.001,0.9&damping_ratios=0",
    ],
)
def test_a_page_that_has_gone_is_worked_for_no_more(two, target):
    packet(two, "/map?columns=3&rows=3&mu=1.9")
    port = two.server_address[1]
    connection = socket.create_connection(("127.0.0.1", port))
    connection.sendall(f"GET /{target} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
    waits_for(lambda: two.page.jobs._running)
    time.sleep(0.2)
    assert two.page.jobs._running
    connection.close()
    began = time.perf_counter()
    waits_for(lambda: not two.page.jobs._running)
    assert time.perf_counter() - began < HANG / 10


def test_lanes():
    jobs = Jobs()
    with jobs.enter("map a") as first:
        first.watch()
        with jobs.enter("motion a"), jobs.enter("map b"):
            first.watch()
        with jobs.enter("map a") as second:
            with pytest.raises(Outdated):
                first.watch()
            second.watch()
    with jobs.enter("map a", turn=7) as newest, jobs.enter("map a", turn=6) as late:
        newest.watch()
        with pytest.raises(Outdated):
            late.watch()  # it was asked for before, and came after
        with jobs.enter("map a", turn=8), pytest.raises(Outdated):
            newest.watch()
    with jobs.enter("map a", lambda: True) as gone, pytest.raises(Outdated):
        gone.watch()
    for k in range(1000):
        with jobs.enter(f"map {k}"):
            pass
    assert len(jobs._lanes) < 1000


def test_compilation_is_reported():
    jobs = Jobs()
    jobs.listen()
    listener = listeners[-1]
    assert jobs.state() == {}
    with jobs.enter("map a") as job:
        listener()
        listener()
        state = jobs.state()
        assert state["kernels"] == 2
        assert 0.0 <= state["seconds"] < HANG
        job.progress(1, 2)  # cells have come in
        assert jobs.state() == {}
        listener()
        assert jobs.state()["kernels"] == 3
    assert jobs.state() == {}
    before = len(listeners)
    jobs.close()
    assert len(listeners) == before - 1


# What is taken along


@pytest.mark.parametrize(
    "query",
    [
        "",
        "r=0.123456,0.9&beta=0.1,0.31&mu=1.25&start=moving&quantity=multiplier",
        "contact=fixed-wall:2&mass_ratios%5B2%5D=0.731&damping_ratios=0.1",
        "contact=joined-base-wall:1&stiffness_ratios%5B2%5D=3.3&quantity=amplitude_2",
    ],
)
def test_a_configuration_gives_the_view_again(two, query):
    status, body, headers = ask(two, f"/configuration.toml?{query}&columns=31&rows=17".replace("?&", "?"))
    assert status == 200
    assert headers["Content-Disposition"] == 'attachment; filename="view.toml"'
    config = config_of(body.decode(), {})
    _, arrays = packet(two, f"/map?{query}&columns=31&rows=17".replace("?&", "?"))
    ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
    np.testing.assert_array_equal(arrays["classes"], classes(ds.isel(mu=0)))
    if "multiplier" in query:
        np.testing.assert_array_equal(arrays["values"], ds["multiplier"].values[0].astype(np.float32))


SEVENTY = """\
[system]
contact_masses = [70]
load_mass = 10
matrices = "chain.npz"
damping_ratios = 0.01
{reduce}
[grid]
r = [0.5, 3.0]
beta = [0.1, 1.0]
"""


def seventy(folder, reduce=""):
    """The scene of a chain of seventy masses in a file, perhaps reduced."""
    np.savez(folder / "chain.npz", **chain_matrices(np.ones(70), np.ones(70)))
    return scene_from(folder, SEVENTY.format(reduce=reduce))


@pytest.mark.parametrize("reduce", ["", "reduce = { keep = [17], modes = 66, allow = 1.0 }"])
def test_a_configuration_names_the_files_of_a_large_structure(tmp_path, reduce):
    query = "contact=joined-base-wall:70&damping_ratios=0.3&r=0.5,3&mu=1.25&start=moving&columns=4&rows=3"
    with served(seventy(tmp_path, reduce)) as server:
        path = tmp_path / "again.toml"
        path.write_bytes(ask(server, f"/configuration.toml?{query}")[1])
        _, arrays = packet(server, f"/map?{query}")
        (tmp_path / "chain.npz").rename(tmp_path / "own.npz")
        np.savez(tmp_path / "chain.npz", **chain_matrices(np.ones(70), np.full(70, 2.0)))
        assert b"the files of its matrices have changed" in ask(server, f"/configuration.toml?{query}")[1]
    (tmp_path / "own.npz").rename(tmp_path / "chain.npz")
    assert 'matrices = "chain.npz"' in path.read_text()
    config = load_config(path)
    assert (config.system.contact, config.system.zeta) == ("joined-base-wall", 0.3)
    ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
    np.testing.assert_array_equal(arrays["classes"], classes(ds.isel(mu=0)))
    np.testing.assert_array_equal(arrays["beta_lim"], ds["beta_lim"].values[0])


def test_a_configuration_of_a_structure_that_was_reduced(tmp_path):
    with served(seventy(tmp_path, "reduce = { keep = [17], modes = 9, allow = 1.0 }")) as server:
        status, body, _ = ask(server, "/configuration.toml?columns=4&rows=3")
        _, arrays = packet(server, "/map?columns=4&rows=3")
    assert (status, b"# reduced from 70" in body) == (200, True)
    config = config_of(body.decode(), {})
    ds = fm.sweep(config.system, config.r, config.beta, config.mu, solver=config.solver)
    np.testing.assert_array_equal(arrays["classes"], classes(ds.isel(mu=0)))
    np.testing.assert_array_equal(arrays["beta_lim"], ds["beta_lim"].values[0])


def test_cells_as_files(one, tmp_path):
    query = "columns=9&rows=8&mu=1.2&quantity=work_friction"
    r, beta = middles(0.0, 2.0, 9), middles(0.0, 1.2, 8)
    ds = fm.sweep(fm.System(), r, beta, 1.2, outputs=[*fm.Solver().outputs, "work_friction"])
    status, body, headers = ask(one, f"/map.nc?{query}")
    assert (status, headers["Content-Disposition"]) == (200, 'attachment; filename="map.nc"')
    (tmp_path / "map.nc").write_bytes(body)
    with xr.open_dataset(tmp_path / "map.nc") as written:
        for name in ds.data_vars:
            np.testing.assert_array_equal(written[name].values, ds[name].values)
        assert written.attrs["title"] == "One mass"
        config = config_of(written.attrs["config"], {})
    assert (config.title, config.mu, config.solver.outputs) == ("One mass", [1.2], tuple(ds.data_vars)[:-2])
    np.testing.assert_array_equal(config.r, r)
    np.testing.assert_array_equal(config.beta, beta)
    status, body, _ = ask(one, f"/map.csv?{query}")
    lines = body.decode().splitlines()
    assert lines[0].startswith("mu,r,beta,regime")
    assert len(lines) == 1 + 72


@pytest.mark.parametrize(
    ("scene", "query"),
    [(ONE, "quantity=work_friction"), (ONE + UNITS, "quantity=work_friction"), (TWO, "quantity=amplitude_2")],
)
def test_sizes_of_files_are_stated_before(tmp_path, scene, query):
    with served(scene_from(tmp_path, scene)) as server:
        query = f"columns=60&rows=40&mu=1&{query}"
        told = {
            ending: float(size.split()[0])
            for ending, size in json.loads(ask(server, f"/sizes?{query}")[1]).items()
        }
        taken = {ending: len(ask(server, f"/map.{ending}?{query}")[1]) / 1e6 for ending in told}
    assert told["csv"] == pytest.approx(taken["csv"], rel=0.15)
    assert taken["nc"] / 1.5 < told["nc"] < 1.5 * taken["nc"]


def test_numbers_travel_as_they_are():
    arrays = {
        "a": np.array([np.inf, -0.0, np.nan, 5e-324]),
        "b": np.arange(6, dtype=np.uint8).reshape(2, 3)[:, ::-1],
        "c": np.array([-1], dtype=np.int8),
        "d": np.float32([[1.5]]),
        "e": np.empty((0, 4)),
    }
    header, found = unpack(pack({"word": "β"}, arrays))
    assert header == {"word": "β"}
    for name, values in arrays.items():
        np.testing.assert_array_equal(found[name], values)
        assert found[name].dtype == values.dtype
        assert found[name].shape == values.shape


# The page as a file


class Scripts(HTMLParser):
    """The contents of scripts by their ids or types, and every address that is asked for."""

    def __init__(self, text):
        super().__init__()
        self.found, self.asked, self._inside = {}, [], None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.asked += [given[key] for key in ("src", "href") if key in given]
        self._inside = given.get("id", given.get("type")) if tag == "script" else None

    def handle_data(self, data):
        if self._inside:
            self.found[self._inside] = self.found.get(self._inside, "") + data

    def handle_endtag(self, tag):
        self._inside = None


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A page as a file, with few and coarse maps, and its scene."""
    scene = scene_from(tmp_path_factory.mktemp("small"), ONE)
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {"_CELLS": {False: (12, 10)}, "_PLACES": 3}.items():
            patch.setattr(stored, name, value)
        told = []
        page = stored.write_page(scene, lambda done, total: told.append((done, total)))
    assert told == sorted(told)
    assert [done for done, _ in told if done == int(done)] == list(range(1, 13))
    assert len({int(done) for done, _ in told if 0 < done % 1 < 1}) == 12  # and within each map
    assert {total for _, total in told} == {12}
    return scene, page.decode()


def test_a_page_as_a_file_asks_nothing_of_any_host(small):
    page = Scripts(small[1])
    assert page.asked == ["data:,"]
    assert set(page.found) == {"stored", "importmap", "module"}
    assert "default-src 'none'" in small[1]
    imports = json.loads(page.found["importmap"])["imports"]
    texts = [base64.b64decode(where.partition(",")[2]).decode() for where in imports.values()]
    for text in (*texts, page.found["module"]):
        assert set(re.findall(r'from "([^"]+)"', text)) <= set(imports)


def test_a_page_as_a_file_holds_the_maps_of_its_sliders(small):
    content = json.loads(Scripts(small[1]).found["stored"])
    assert content["values"]["mu"] == [1.0, 1.5, 2.0, 3.0]
    assert content["values"]["damping_ratios"] == [0.0, 0.125, 1.0]
    assert len(content["maps"]) == 12
    assert content["first"] == "1,0"
    kept = content["maps"]["1,1"]
    system = fm.System(damping_ratios=0.125)
    r, beta = middles(0.0, 2.0, 12), middles(0.0, 1.2, 10)
    ds = fm.sweep(system, r, beta, 1.5, outputs=["regime", "stops_per_cycle", "contact_amplitude"])
    found = np.frombuffer(zlib.decompress(base64.b64decode(kept["classes"])), np.uint8).reshape(12, 10)
    np.testing.assert_array_equal(found, classes(ds.isel(mu=0)))
    limits = np.frombuffer(zlib.decompress(base64.b64decode(kept["limits"])))
    np.testing.assert_array_equal(
        limits, np.concatenate((ds["beta_lim"].values[0], ds["beta_stick"].values[0]))
    )
    amplitude = kept["values"]["contact_amplitude"]
    steps = np.frombuffer(zlib.decompress(base64.b64decode(amplitude["steps"])), np.uint8).reshape(12, 10)
    values = amplitude["low"] * (amplitude["high"] / amplitude["low"]) ** ((steps - 1.0) / 254.0)
    moving = ds["regime"].values[0] > regimes.PERMANENT_STICKING
    half_step = (amplitude["high"] / amplitude["low"]) ** (0.5 / 254.0) - 1.0
    np.testing.assert_allclose(
        values[moving],
        ds["contact_amplitude"].values[0][moving].astype(np.float32),
        rtol=1.01 * half_step + 1e-6,
    )


# The command, and Python


def start(folder, *arguments):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    (folder / "one.toml").write_text(ONE)
    command = [sys.executable, "-m", "frictionmap", "explore", "one.toml", "--no-browser", *arguments]
    return subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_the_command_serves_until_an_interrupt(tmp_path, sent):
    process = start(tmp_path, "--port", "0", "--set", "grid.mu=1.25")
    line = process.stdout.readline()
    url = re.fullmatch(r"One mass: (http://127.0.0.1:(\d+)/) \(end with Ctrl-C\)\n", line)
    assert url, line
    with socket.create_connection(("127.0.0.1", int(url[2]))) as connection:
        connection.sendall(
            f"GET /scene HTTP/1.1\r\nHost: 127.0.0.1:{url[2]}\r\nConnection: close\r\n\r\n".encode()
        )
        body = b"".join(iter(lambda: connection.recv(65536), b""))
    assert b'"mu": 1.25' in body
    process.send_signal(sent)
    out, err = process.communicate(timeout=HANG)
    assert (process.returncode, out) == (130, "")
    assert err == "frictionmap: interrupted; page closed\n"


def test_a_port_that_is_taken(tmp_path, capsys, one):
    (tmp_path / "one.toml").write_text(ONE)
    port = one.server_address[1]
    said = refusal(capsys, "explore", tmp_path / "one.toml", "--no-browser", "--port", port)
    assert f"--port must be a free port; got {port} (Address already in use)" in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--export", "page.txt"], "--export must end in .html; got page.txt"),
        (["--set", "grid.mu=0.5"], "grid.mu must be >= 1"),
        (["--set", "axes.damping_ratios=[-1.0]"], "damping_ratios must be >= 0"),
    ],
)
def test_the_command_refuses_in_a_line(tmp_path, capsys, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.toml").write_text(ONE)
    assert words in refusal(capsys, "explore", "one.toml", "--no-browser", *arguments)


def test_the_command_writes_a_page(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, value in {"_CELLS": {False: (4, 3)}, "_PLACES": 2}.items():
        monkeypatch.setattr(stored, name, value)
    (tmp_path / "one.toml").write_text(ONE)
    from frictionmap.command_line.cli import main

    assert main(["explore", "one.toml", "--export", "page.html"]) == 0
    assert re.fullmatch(r"[0-9.]+ s; wrote page.html \(0\.\d+ MB\)\n", capsys.readouterr().out)
    assert (tmp_path / "page.html").read_text().startswith("<!doctype html>")
    assert "page.html: it already exists" in refusal(capsys, "explore", "one.toml", "--export", "page.html")


def test_python_serves_the_same_page():
    page = fm.explore(
        fm.System(), r=np.linspace(0.1, 2.0, 50), beta=[0.0, 0.5], mu=1.5, start="moving", title="It <b>"
    )
    other = fm.explore(fm.System())
    try:
        assert page.url != other.url
        assert repr(page) == f"<frictionmap page at {page.url}>"
        assert f'<iframe src="{page.url}"' in page._repr_html_()
        told = json.loads(ask(page._server, "/scene")[1])
        assert (told["r"], told["mu"], told["start"], told["title"]) == ([0.1, 2.0], 1.5, "moving", "It <b>")
    finally:
        page.close()
        other.close()
    page.close()
    assert repr(page) == "<frictionmap page, closed>"
    assert page._repr_html_() == "&lt;frictionmap page, closed&gt;"
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(page._server.server_address, timeout=1.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"system": "chain"}, "system must be a frictionmap.System; got 'chain'"),
        ({"r": 1.0}, "r must be a range of two numbers, or more; got 1"),
        ({"beta": [1.0, 0.0]}, "beta must be increasing"),
        ({"mu": 0.9}, "mu must be >= 1; got 0.9"),
        ({"start": "left"}, "start must be one of rest, moving"),
        ({"title": 3}, "title must be text; got 3"),
        ({"port": 70000}, "port must be <= 65535; got 70000"),
        ({"port": "80"}, "port must be a whole number; got '80'"),
    ],
)
def test_python_refuses(arguments, words):
    with pytest.raises(InputError, match=re.escape(words)):
        fm.explore(**{"system": fm.System(), **arguments})


# Units


def test_units_stand_next_to_the_ratios(tmp_path):
    with served(scene_from(tmp_path, ONE + UNITS)) as server:
        told = json.loads(ask(server, "/scene")[1])
        assert told["r"] == [0.0, 2.0]
        assert {kind: one["unit"] for kind, one in told["physical"].items()} == {
            "frequency": "Hz", "force": "N", "length": "mm", "work": "mJ",
        }  # fmt: skip
        factors = {kind: one["factor"] for kind, one in told["physical"].items()}
        assert factors == pytest.approx(
            {"frequency": 4.2, "force": 12.5, "length": 12.5 / 3, "work": 156.25 / 3}
        )
        config = config_of(ask(server, "/configuration.toml?columns=4&rows=3")[1].decode(), {})
        assert config.units == fm.Units(natural_frequency="4.2 Hz", load="12.5 N", stiffness="3 N/mm")
        (tmp_path / "map.nc").write_bytes(ask(server, "/map.nc?columns=4&rows=3")[1])
        with xr.open_dataset(tmp_path / "map.nc") as written:
            np.testing.assert_allclose(written["frequency"], 4.2 * middles(0.0, 2.0, 4), rtol=1e-12)
            np.testing.assert_allclose(written["friction_force"], 12.5 * middles(0.0, 1.2, 3), rtol=1e-12)


def test_python_takes_units():
    units = fm.Units(natural_frequency="60 rpm")
    with fm.explore(fm.System(), ("0.5 Hz", "180 rpm"), units=units) as page:
        told = json.loads(ask(page._server, "/scene")[1])
    assert told["r"] == [0.5, 3.0]
    with pytest.raises(InputError, match=r"give units\.load"):
        fm.explore(fm.System(), beta=("1 N", "2 N"), units=units)
    assert told["physical"] == {"frequency": {"unit": "Hz", "factor": 1.0}}
    with pytest.raises(InputError, match=r"cannot use units\.base_amplitude: it needs base excitation"):
        fm.explore(fm.System(), units=fm.Units(base_amplitude="1 mm"))


#: One mass with a spring in its contact, and two with belts and forces of their own.
SPRING = """\
[system]
damping_ratios = 0.02
contact_stiffness = 1.0
[grid]
r = [0.0, 2.0]
beta = [0.0, 1.2]
"""
BELTS = """\
[system]
mass_ratios = [1.0, 0.5]
stiffness_ratios = [1.0, 2.0]
damping_ratios = 0.02
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
force = 0.4
wall_speed = 0.5
[[system.contacts]]
kind = "fixed-wall"
masses = [2]
wall_velocity = 0.5
[grid]
r = [0.1, 2.5]
beta = [0.0, 2.0]
"""


@pytest.mark.parametrize(
    ("text", "key", "given", "ratio"),
    [
        # r = f/(4.2 Hz), beta = F/(12.5 N), lengths over 12.5 N/(3 N/mm) = 25/6 mm
        (SPRING, "r", "2.1 Hz,252 rpm", [0.5, 1.0]),
        (SPRING, "at", "0.5,2.5 N", [0.5, 0.2]),
        (SPRING, "beta", "2.5 N,0.0125 kN", [0.2, 1.0]),
        (SPRING, "at", "2.1 Hz,2.5 N", [0.5, 0.2]),
        (SPRING, "band", "2.1 Hz,4.2 Hz", [0.5, 1.0]),
        (SPRING, "limit", "1.25 cm", 3.0),
        (SPRING, "contact_stiffness", "6 N/mm", 2.0),
        (SPRING, "mu", "1.5", 1.5),
        (BELTS, "contacts[1].force", "2.5 N", 0.2),
        (BELTS, "mass_ratios[2]", f"{1.5e3 / (2 * np.pi * 4.2) ** 2!r} kg", 0.5),
        (BELTS, "stiffness_ratios[2]", "1.5 kN/m", 0.5),
        (BELTS, "contacts[1].wall_speed", f"{2 * np.pi * 4.2 * 25e-3 / 12!r} m/s", 0.5),
    ],
)
def test_numbers_of_a_query_have_units(tmp_path, text, key, given, ratio):
    with served(scene_from(tmp_path, text + UNITS)) as server:
        status, body, _ = ask(server, f"/ratios?{quote(key)}={quote(given)}")
        assert status == 200, body
        assert set(json.loads(body)) == {key}
        assert json.loads(body)[key] == pytest.approx(ratio, rel=1e-15)
    with served(scene_from(tmp_path, text)) as server:
        status, body, _ = ask(server, f"/ratios?{quote(key)}={quote(given)}")
        if key == "mu":
            assert status == 200
        else:
            assert status == 400
            assert body.startswith(b"cannot convert ")
            assert b"missing; give units." in body
            line = body.decode().partition("such as ")[2].strip()
    if key != "mu":  # the remedy of the message works
        units = "[units]\n" + "\n".join(one.strip().removeprefix("units.") for one in line.split(" and "))
        with served(scene_from(tmp_path, f"{text}{units}\n")) as server:
            assert ask(server, f"/ratios?{quote(key)}={quote(given)}")[0] == 200


def test_a_motion_is_asked_for_in_units(tmp_path):
    with served(scene_from(tmp_path, ONE + UNITS)) as server:
        header, arrays = packet(server, f"/motion?at={quote('2.1 Hz,2.5 N')}&mu=1.5")
        plain, curves = packet(server, "/motion?at=0.5,0.2&mu=1.5")
    assert header == plain
    assert all((arrays[name] == curves[name]).all() for name in curves)


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("at=2.1 N,2.5 N", "r must be a number with a unit of frequency (Hz, kHz, rad/s, rpm), such as "
         "'4.2 Hz'; got '2.1 N': N is a unit of force"),
        ("r=0.5,4.2 Hz", "got '0.5': it has no unit"),
        ("beta=0 N,50 n", "unknown unit n (did you mean N?)"),
        ("mu=1.5 N", "mu must be a number; got '1.5 N'"),
        ("damping_ratios=1 Hz", "damping_ratios must be a number without a unit, of critical damping; "
         "got '1 Hz'"),
        ("contacts[2].wall_velocity=0.2 m/s", "without a unit, times ωP/k1; got '0.2 m/s'; for a speed that "
         "is the same at all frequencies set wall_speed in the configuration"),
        ("contacts[1].force=-5 N", "must be >= 0"),
    ],
)  # fmt: skip
def test_wrong_units_of_a_query_are_refused_in_a_line(tmp_path, query, words):
    key, _, value = query.partition("=")
    with served(scene_from(tmp_path, BELTS + UNITS)) as server:
        status, body, _ = ask(server, f"/ratios?{quote(key)}={quote(value)}")
    assert status == 400
    assert words in body.decode()
    assert body.count(b"\n") == 1

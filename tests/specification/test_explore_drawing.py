"""What the page is sent to draw a motion, its first cell, presets, and expected times of compilation."""

import json
import re

import numpy as np
import pytest
from conftest import ROOT
from pages import TWO_MASSES, ask, packet, scene_from, served
from structures import chain_matrices
from test_explore_contacts import ELASTIC, TWO

import frictionmap as fm
from frictionmap._kernels.compiler.notices import listeners
from frictionmap.explorer import compile_times
from frictionmap.explorer import jobs as jobs_module
from frictionmap.explorer.compile_times import Compilation, CompileTimes, group_of
from frictionmap.explorer.drawing import drawing_curves, drawing_of
from frictionmap.explorer.example import largest_square
from frictionmap.explorer.jobs import REHEARSAL, Jobs
from frictionmap.explorer.presets import PRESETS, preset_scene
from frictionmap.explorer.queries import read_query
from frictionmap.explorer.server import _VIEWS
from frictionmap.files.config import config_of

TAU = np.linspace(0.0, 2.0 * np.pi, 9)

# The drawing


def test_springs_of_a_chain_join_neighbours():
    chain = fm.System("between-masses", [1, 3], mass_ratios=[1, 2, 1], stiffness_ratios=[1, 0.5, 2])
    found = drawing_of(chain)
    assert found["springs"] == [[-1, 0], [0, 1], [1, 2]]
    assert found["loaded"] == [0]
    assert not found["base"]
    assert [contact["masses"] for contact in found["contacts"]] == [[0, 2]]


def test_springs_of_matrices_are_their_couplings():
    """Masses 1 and 3 are coupled, 2 is on the ground only, 3 on the ground too."""
    stiffness = np.array([[1.0, 0.0, -1.0], [0.0, 2.0, 0.0], [-1.0, 0.0, 4.0]])
    system = fm.System("fixed-wall", [2], matrices={"M": np.eye(3), "K": stiffness})
    assert drawing_of(system)["springs"] == [[-1, 1], [-1, 2], [0, 2]]


def test_large_structures_are_drawn_by_contact_and_load():
    system = fm.System("fixed-wall", [70], load_mass=10, matrices=chain_matrices(np.ones(70), np.ones(70)))
    found = drawing_of(system)
    assert (found["rows"], found["names"], found["masses"]) == ([9, 69], ["10", "70"], 70)
    assert found["springs"] == []
    assert (found["loaded"], found["contacts"][0]["masses"]) == ([0], [1])


def test_base_and_loads_have_the_motion_of_the_system():
    base = drawing_curves(fm.System("joined-base-wall"), TAU)
    np.testing.assert_allclose(base["base"], np.cos(TAU), atol=1e-6)
    two = fm.System("fixed-wall", [1], load=[0.5, 1j], mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    assert drawing_of(two)["loaded"] == [1, 0]  # the largest first
    np.testing.assert_allclose(drawing_curves(two, TAU)["load"], [-np.sin(TAU), 0.5 * np.cos(TAU)], atol=1e-6)
    square = fm.System(waveform="square", harmonics=7)
    exact = sum(4.0 / np.pi * (-1) ** k * np.cos((2 * k + 1) * TAU) / (2 * k + 1) for k in range(4))
    sines = sum(4.0 / np.pi * np.sin((2 * k + 1) * TAU) / (2 * k + 1) for k in range(4))
    load = drawing_curves(square, TAU)["load"][0]
    assert min(np.abs(load - exact).max(), np.abs(load - sines).max()) < 1e-6


def test_springs_of_contacts_stretch_by_their_force(tmp_path):
    """A Jenkins element: its spring carries the friction force, and the slider is where the spring ends."""
    with served(scene_from(tmp_path, ELASTIC)) as server:
        _, arrays = packet(server, "/motion?at=0.7,0.4")
    ds = fm.response(config_of(ELASTIC, {}).system, 0.7, 0.4, points=400)
    stiffness = 1.0
    np.testing.assert_allclose(arrays["stretched"][0], ds["friction"].values.ravel() / stiffness, atol=1e-6)
    slider = arrays["z"] - arrays["stretched"][0]
    stuck = arrays["states"][0] == 0
    assert 0.1 < stuck.mean() < 0.9
    held = stuck[1:] & stuck[:-1]
    assert np.abs(np.diff(slider)[held]).max() < 1e-6  # it rests without slip
    assert np.abs(np.diff(slider)[~held]).max() > 1e-4


def test_all_contacts_have_states_where_one_is_shown(tmp_path):
    with served(scene_from(tmp_path, TWO)) as server:
        _, every = packet(server, "/motion?at=0.6,0.6")
        header, one = packet(server, "/motion?at=0.6,0.6&contact=contact-2")
    np.testing.assert_array_equal(one["states"], every["direction"])
    assert [contact["name"] for contact in header["drawing"]["contacts"]] == ["lower brace", "upper brace"]


# The cell that it opens with


def test_the_largest_square_is_found():
    random = np.random.default_rng(5)
    for _ in range(20):
        classes = random.integers(1, 4, (9, 7)).astype(np.uint8)
        column, row = largest_square(classes, (2, 3))
        squares = [
            size
            for size in range(1, 8)
            for i in range(10 - size)
            for j in range(8 - size)
            if classes[i, j] in (2, 3) and (classes[i : i + size, j : j + size] == classes[i, j]).all()
        ]
        half = (max(squares) - 1) // 2
        around = classes[column - half : column + half + 1, row - half : row + half + 1]
        assert around.shape == (2 * half + 1, 2 * half + 1)
        assert (around == classes[column, row]).all()
    assert largest_square(np.ones((3, 3), dtype=np.uint8), (2, 3)) is None


@pytest.mark.parametrize("query", ["", "mu=1.6", "contact=fixed-wall:2&r=0.1,0.6"])
def test_the_example_sticks_and_slips(tmp_path, query):
    scene = scene_from(tmp_path, TWO_MASSES)
    with served(scene) as server:
        r, beta = json.loads(ask(server, f"/example?{query}")[1])["cell"]
    view = read_query(scene, query).view
    assert view.r[0] < r < view.r[1]
    assert view.beta[0] < beta < view.beta[1]
    ds = fm.sweep(view.system, r, beta, view.mu, solver=view.solver)
    assert ds["regime"].item() == fm.regimes.STICK_SLIP


def test_without_stick_slip_another_cell_is_taken(tmp_path):
    scene = scene_from(tmp_path, TWO_MASSES)
    with served(scene) as server:
        r, beta = json.loads(ask(server, "/example?r=1,1.4&beta=0,0.001")[1])["cell"]
        assert fm.sweep(scene.system, r, beta)["regime"].item() == fm.regimes.CONTINUOUS
        assert json.loads(ask(server, "/example?r=0.1,0.2&beta=50,60")[1]) == {"cell": None}


def test_boundaries_come_alone(tmp_path):
    scene = scene_from(tmp_path, TWO_MASSES)
    with served(scene) as server:
        header, arrays = packet(server, "/lines?r=0.3,1.5&count=30")
        assert ask(server, "/lines?count=1")[:2] == (400, b"count must be >= 2; got 1\n")
    places = 0.3 + 1.2 * (np.arange(30) + 0.5) / 30
    curves = fm.boundaries(scene.system, places)
    np.testing.assert_allclose(arrays["line_lim"], curves["beta_lim"].values.ravel(), rtol=1e-12)
    np.testing.assert_allclose(arrays["line_stick"], curves["beta_stick"].values.ravel(), rtol=1e-12)
    assert [line["lower"] for line in header["about"]["lines"]] == ["lim", "stick"]


# Presets


@pytest.mark.parametrize("key", PRESETS)
def test_a_preset_has_a_map_and_an_example(tmp_path, key):
    with served(scene_from(tmp_path, TWO_MASSES)) as server:
        scene = json.loads(ask(server, f"/scene?preset={key}")[1])
        _, arrays = packet(server, f"/map?preset={key}&columns=3&rows=2")
        cell = json.loads(ask(server, f"/example?preset={key}")[1])["cell"]
        header, _ = packet(server, f"/motion?preset={key}&at={cell[0]},{cell[1]}")
    assert scene["title"] == preset_scene(key).title
    assert arrays["classes"].shape == (3, 2)
    assert header["regime"].replace("_", " ").lower() in (
        "stick slip", "stick-slip", "slips and rests", "stick-slip cycle",
    )  # fmt: skip


def test_an_unknown_preset_is_refused(tmp_path):
    with served(scene_from(tmp_path, TWO_MASSES)) as server:
        status, body, _ = ask(server, "/scene?preset=clutch")
    assert status == 400
    assert body.decode() == f"unknown preset 'clutch'; valid: {', '.join(PRESETS)}\n"


# Expected times


def test_measured_times_are_kept(tmp_path):
    place = tmp_path / "times.json"
    times = CompileTimes(place)
    times.record("map one", 12.5, 40)
    assert CompileTimes(place).expected("map one") == (12.5, 40)
    times.record("map one", 0.5, 3)  # most kernels were there
    assert CompileTimes(place).expected("map one") == (12.5, 40)
    times.record("map one", 9.0, 38)
    assert CompileTimes(place).expected("map one") == (9.0, 38)


DAMAGED = (
    "", "{", "[]", '{"map one": 3}', '{"map one": {"seconds": "x", "kernels": 2}}',
    '{"map one": {"seconds": -1, "kernels": 2}}',
)  # fmt: skip


@pytest.mark.parametrize("content", DAMAGED)
def test_a_damaged_file_counts_as_missing(tmp_path, content):
    place = tmp_path / "times.json"
    place.write_text(content)
    assert 1.0 < CompileTimes(place).expected("map one").seconds < 1e4
    CompileTimes(tmp_path / "none" / "times.json").record("map one", 2.0, 3)  # no folder: nothing is kept


def test_unmeasured_times_grow_with_the_slowness_of_the_machine(monkeypatch):
    expected = []
    for factor in (1.0, 3.0):
        monkeypatch.setattr(compile_times, "_loop_time", lambda factor=factor: factor * compile_times._LOOP)
        expected.append(CompileTimes().expected("motion structure").seconds)
    assert expected[1] == pytest.approx(3.0 * expected[0])


def test_groups_distinguish_engines():
    names = [group_of("map", system) for system in (
        fm.System(), fm.System("between-masses", [1, 2], mass_ratios=[1, 1], stiffness_ratios=[1, 1]),
        fm.System(contact_stiffness=1.0))]  # fmt: skip
    assert names == ["map one", "map structure", "map general"]


def test_the_time_left_is_that_of_the_job_that_is_waited_for(tmp_path, monkeypatch):
    jobs = Jobs()
    jobs.listen()
    jobs._times = CompileTimes(tmp_path / "times.json")
    jobs._times.record("map one", 100.0, 100)
    jobs._times.record("cut one", 500.0, 100)
    listener = listeners[-1]
    with jobs.enter(REHEARSAL, group="cut one"):
        listener()
        assert 400.0 < jobs.state()["left"] <= 500.0
        with jobs.enter("map a", group="map one"):
            listener()
            assert 50.0 < jobs.state()["left"] <= 100.0
        assert 400.0 < jobs.state()["left"] <= 500.0
        for _ in range(60):
            listener()
    jobs.close()
    assert jobs._times.expected("map one") == (100.0, 100)  # measured by rehearsals only
    assert jobs._times.expected("cut one").seconds < 60.0


def left_after(kernels, seconds, tmp_path, monkeypatch):
    """Seconds that the page states after some of 100 kernels, expected to take 100 s together."""
    clock = [1000.0]
    monkeypatch.setattr(jobs_module.time, "monotonic", lambda: clock[0])
    times = CompileTimes(tmp_path / "times.json")
    times.record("map one", 100.0, 100)
    job = jobs_module.Job(lambda: False, 0, "map one", times)
    job.compiles_since, job.kernels = clock[0], kernels
    return job.left(clock[0] + seconds)


def test_the_time_left_follows_the_kernels(tmp_path, monkeypatch):
    assert left_after(50, 50.0, tmp_path, monkeypatch) == pytest.approx(50.0)  # as expected
    assert left_after(90, 90.0, tmp_path, monkeypatch) == pytest.approx(10.0)
    assert 100.0 < left_after(50, 200.0, tmp_path, monkeypatch) < 200.0  # four times as slow
    assert left_after(90, 360.0, tmp_path, monkeypatch) == pytest.approx(40.0, rel=0.1)
    assert left_after(100, 360.0, tmp_path, monkeypatch) == 0.0


def test_the_page_waits_for_what_the_rehearsal_has_begun(tmp_path):
    jobs = Jobs()
    jobs.listen()
    jobs._times = CompileTimes(tmp_path / "times.json")
    jobs._times.record("motion one", 100.0, 10)
    listener = listeners[-1]
    with jobs.enter(REHEARSAL, group="motion one"):
        for _ in range(9):
            listener()
        with jobs.enter("motion a", group="motion one"):
            listener()
            assert jobs.state()["left"] == 0.0  # all ten have begun
    jobs.close()


def test_a_page_that_waits_for_the_kernels_of_another_job_knows_how_long(tmp_path):
    jobs = Jobs()
    jobs.listen()
    jobs._times = CompileTimes(tmp_path / "times.json")
    jobs._times.record("motion one", 100.0, 10)
    jobs._times.record("cut one", 400.0, 40)
    listener = listeners[-1]
    with jobs.enter("motion a", group="motion one"), jobs.enter(REHEARSAL, group="cut one"):
        for _ in range(9):
            listener()
        assert 0.0 < jobs.state()["left"] <= 10.0
        listener()
        assert 200.0 < jobs.state()["left"] <= 300.0
    jobs.close()


class EndsMeanwhile:
    """Expected times; while they are looked up, the thread of a job ends its compilation."""

    def __init__(self):
        self.job, self.asked = None, 0

    def expected(self, group):
        self.asked += 1
        self.job.compiled()
        return Compilation(100.0, 10)


def test_compilation_may_end_while_its_state_is_read():
    """The page asks for the state at any time; it was an internal error of the server (500) now and then."""
    jobs = Jobs()
    jobs._times = EndsMeanwhile()
    with jobs.enter("map a", group="map one") as job:
        jobs._times.job = job
        jobs._compiling()
        state = jobs.state()
        assert jobs._times.asked == 1
        assert job.compiles_since is None
        assert state["kernels"] == 1
        assert 0.0 <= state["seconds"] < 60.0
        assert 0.0 <= state["left"] <= 100.0
        assert jobs.state() == {}  # nothing is compiled any more


@pytest.mark.parametrize("kind", ["one", "structure", "general", "phases"])
def test_every_kind_of_work_of_the_server_has_an_expected_time(kind):
    source = (ROOT / "frictionmap/explorer/server.py").read_text(encoding="utf-8")
    alone = set(re.findall(r'self\._enter\("(\w+)", query, gone\)', source))
    assert "lines" in alone
    times = CompileTimes()
    for work in alone | {"map", "quantity", *_VIEWS}:
        assert work in compile_times._BENCHMARK[kind]
        assert min(times.expected(f"{work} {kind}")) > 0.0

"""What is said of a long run: on a terminal, elsewhere, and before it begins."""

import io
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import frictionmap as fm
from frictionmap._kernels.compiler.notices import listeners
from frictionmap.command_line import progress
from frictionmap.command_line.cli import main
from frictionmap.command_line.progress import Progress
from frictionmap.model.settings import curve_settings
from frictionmap.steady import cost


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Clock:
    """A clock that is set by hand, in the place of the module's."""

    def __init__(self, monkeypatch):
        self.now = 100.0
        monkeypatch.setattr(progress, "time", self)

    def monotonic(self):
        return self.now


def work(monkeypatch, stream, quiet=False, seconds=1.0):
    """What is shown of work that compiles for a while, then takes five equal steps, then is written."""
    clock = Clock(monkeypatch)
    monkeypatch.setattr(sys, "stderr", stream)
    with Progress("a map", quiet) as shown:
        for _ in range(3):
            shown.compiling()
        clock.now += 30.0
        for done in range(1, 6):
            clock.now += seconds
            shown(1000 * done, 5000)
        shown.writing(Path("out.nc"), 12_300_000)
    return stream.getvalue()


def test_on_a_terminal(monkeypatch):
    """One line, renewed and wiped; the time left does not count what was compiled."""
    text = work(monkeypatch, Terminal(), seconds=10.0)
    assert "\n" not in text
    shown = [line.rstrip() for line in text.split("\r") if line.strip()]
    assert shown == [
        "first use: compiling, about 40 s, once only",
        " 20.0 %",
        " 40.0 %  about 30 s left",
        " 60.0 %  about 20 s left",
        " 80.0 %  about 10 s left",
        "100.0 %  about 1 s left",
        "writing out.nc: 12 MB",
    ]
    longest = max(map(len, shown))
    assert text.endswith("\r" + " " * longest + "\r")
    for line in text.split("\r")[2:-2]:
        assert len(line) >= longest  # nothing of the line before stays


def test_elsewhere_there_is_a_line_of_compiling_and_one_of_long_work(monkeypatch):
    assert work(monkeypatch, io.StringIO()).splitlines() == [
        "frictionmap: first use: compiling, about 40 s, once only",
        "frictionmap: a map: 20 % done",
    ]


@pytest.mark.parametrize(
    ("stream", "wanted"),
    [
        (Terminal(), ["0 of 3 maps    5.6 %", "1 of 3 maps   33.3 %  about 48 s left",
                      "2 of 3 maps   72.2 %  about 21 s left"]),
        (io.StringIO(), ["frictionmap: 1 of 3 maps  about 48 s left",
                         "frictionmap: 2 of 3 maps  about 21 s left"]),
    ],
)  # fmt: skip
def test_progress_of_parts_is_shown_one_by_one(monkeypatch, stream, wanted):
    clock = Clock(monkeypatch)
    monkeypatch.setattr(sys, "stderr", stream)
    with Progress("a page", quiet=False, parts="maps") as shown:
        for done, after in ((1 / 6, 10.0), (1.0, 20.0), (13 / 6, 30.0)):
            clock.now += after
            shown(done, 3)
    text = stream.getvalue()
    assert [line.rstrip() for line in text.replace("\r", "\n").splitlines() if line.strip()] == wanted


@pytest.mark.parametrize("stream", [Terminal(), io.StringIO()])
def test_quiet(monkeypatch, stream):
    assert work(monkeypatch, stream, quiet=True) == ""


def test_without_standard_error(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    with Progress("a map", quiet=False) as shown:
        shown(1, 2)


@pytest.mark.parametrize("stream", [Terminal, io.StringIO])
def test_short_work_shows_nothing(monkeypatch, stream):
    monkeypatch.setattr(sys, "stderr", stream())
    with Progress("a map", quiet=False) as shown:
        shown(1, 2)
    assert sys.stderr.getvalue() == ""


@pytest.mark.parametrize(("seconds", "words"), [(0.512, "0.51 s"), (9.0, "9 s"), (35.2, "35 s")])
def test_the_time_that_a_summary_states(monkeypatch, seconds, words):
    clock = Clock(monkeypatch)
    with Progress("a map", quiet=True) as shown:
        clock.now += seconds
        assert shown.took == words


def test_progress_counts_what_else_a_cell_could_end_in():
    """Most of the time of such a map goes there: it is not done when its cells are followed."""
    seen = []
    r, beta = np.linspace(0.3, 2.0, 5), np.linspace(0.1, 0.9, 5)
    fm.sweep(fm.System(), r, beta, 1.5, outputs=["also_reachable"], threads=1,
             progress=lambda done, total: seen.append(done / total))  # fmt: skip
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert seen[-6] < 0.1  # five rows are looked at


# Before the work


def test_memory_is_about_what_a_map_takes():
    """16 million cells of the default outputs, measured: 0.63 GB; and 6 million frequencies: 1.4 GB."""
    cells = cost.memory_of_map({"mu": 1, "r": 4096, "beta": 4096}, 1, fm.Solver().outputs)
    assert 0.5e9 < cells < 0.8e9
    frequencies = cost.memory_of_map({"mu": 1, "r": 6_000_000, "beta": 1}, 1, fm.Solver().outputs)
    assert 1.2e9 < frequencies < 2.5e9
    masses = [cost.memory_of_map({"mu": 1, "r": 100, "beta": 10**6}, n, ("amplitude",)) for n in (1, 5)]
    assert masses[1] - masses[0] > 4 * 8 * 1e8


def test_memory_is_about_what_response_curves_take():
    """A million cells of two masses, and 15 harmonics of them, measured: 0.82 and 2.71 GB."""
    counts = {"mu": 1, "r": 1000, "beta": 1000}
    few, many = (cost.memory_of_curves(counts, 2, curve_settings(n)) for n in (0, 15))
    assert 0.8e9 < few < 1.0e9
    assert 2.5e9 < many < 3.5e9


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({}, 7e9),
        ({"memory.max": "max", "memory.current": "1"}, 7e9),
        ({"memory.max": "3000000000", "memory.current": "1000000000"}, 2e9),
        ({"memory/memory.limit_in_bytes": "3000", "memory/memory.usage_in_bytes": "1000"}, 2e3),
    ],
)
def test_a_container_may_have_less_than_the_machine(tmp_path, monkeypatch, files, expected):
    monkeypatch.setattr(cost, "_GROUP", tmp_path)
    monkeypatch.setattr(cost, "_machine_memory", lambda: 7e9)
    (tmp_path / "memory").mkdir()
    for name, content in files.items():
        (tmp_path / name).write_text(content + "\n")
    assert cost.available_memory() == expected


def test_this_machine_has_some_memory():
    assert 1e7 < cost.available_memory() < 1e15


LARGE = """\
[system]
[grid]
r = { start = 0.3, stop = 2, num = 40_000 }
beta = { start = 0, stop = 1, num = 20_000 }
"""


def test_a_map_beyond_the_memory_is_refused_before_it_takes_any(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "large.toml").write_text(LARGE)
    monkeypatch.setattr(cost, "available_memory", lambda: 3e9)
    monkeypatch.setattr(np, "linspace", None)  # no axis is made
    assert main(["map", "large.toml"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err == (
        "frictionmap: cannot fit the grid in memory: its 800,000,000 cells need about 13 GB, "
        "3 GB are available; use a coarser grid, request fewer outputs, or override with --yes\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["large.toml"]


def test_curves_beyond_the_memory_are_refused_before_they_take_any(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "large.toml").write_text(LARGE)
    monkeypatch.setattr(cost, "available_memory", lambda: 3e9)
    monkeypatch.setattr(np, "linspace", None)  # no axis is made
    assert main(["curves", "large.toml", "--set", "curves.quantities=['energy']"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("frictionmap: cannot fit the grid in memory: its 800,000,000 cells need about ")
    assert err.endswith(
        "3 GB are available; use a coarser grid, request fewer quantities or harmonics, or override "
        "with --yes\n"
    )
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.toml").write_text("[system]\n[grid]\nr = [0.3, 0.8]\nbeta = 1\n")
    monkeypatch.setattr(cost, "available_memory", lambda: 0.0)
    assert main(["curves", "small.toml"]) == 2
    assert main(["curves", "small.toml", "--yes"]) == 0


def test_yes_overrides(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.toml").write_text("[system]\n[grid]\nr = [0.3, 0.8]\nbeta = 1\n")
    monkeypatch.setattr(cost, "available_memory", lambda: 0.0)
    assert main(["map", "small.toml"]) == 2
    assert main(["map", "small.toml", "--yes"]) == 0
    monkeypatch.setattr(cost, "available_memory", lambda: 1e12)
    assert main(["map", "small.toml", "--overwrite"]) == 0


def test_the_cost_of_many_cells_is_stated_before_the_work(tmp_path, monkeypatch, capsys):
    from frictionmap.command_line import cli

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cli, "_MANY", 2)
    (tmp_path / "small.toml").write_text("[system]\n[grid]\nr = [0.3, 0.8]\nbeta = 1\n")
    main(["map", "small.toml"])
    lines = capsys.readouterr().err.splitlines()
    assert "frictionmap: 2 cells need about 400 MB of memory and 1 s" in lines
    main(["map", "small.toml", "--quiet", "--overwrite"])
    assert capsys.readouterr().err == ""


def test_time_is_about_what_a_map_takes():
    """Within a factor of five, on a machine that others use."""
    axes = {"r": np.linspace(0.3, 2.0, 700), "beta": np.linspace(0.1, 0.9, 700), "mu": np.array([1.5])}
    told = cost.seconds_of_map(fm.System(), solver=fm.Solver(), threads=1, **axes)
    began = time.perf_counter()
    fm.sweep(fm.System(), threads=1, **axes)
    took = time.perf_counter() - began
    assert took / 5.0 < told < 5.0 * took


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.1, "1 s"), (59.6, "60 s"), (99.0, "99 s"), (150.0, "2 min"), (5000.0, "83 min"), (7200.0, "2.0 h")],
)
def test_times_in_words(seconds, words):
    assert cost.in_time(seconds) == words


@pytest.mark.parametrize(
    ("size", "words"),
    [(1.5e6, "1.5 MB"), (4.2e8, "420 MB"), (1.46e10, "15 GB"), (2.5e11, "250 GB"), (1.5e9, "1.5 GB")],
)
def test_sizes_in_words(size, words):
    assert cost.in_bytes(size) == words


QUESTION = """\
[system]
contact = "joined-base-wall"
damping_ratios = 0.1
[grid]
r = [0.5, 1.0]
beta = [0.1, 0.2]
[design]
question = "at-most"
band = [0.4, 1.5]
limit = 0.01
"""


def test_a_run_that_is_refused_hears_of_no_later_compiling(tmp_path, capsys):
    """The limit is refused after cells have been computed."""
    (tmp_path / "question.toml").write_text(QUESTION)
    before = list(listeners)
    assert main(["design", str(tmp_path / "question.toml"), "-o", str(tmp_path / "no.nc"), "--quiet"]) == 2
    assert "the least peak" in capsys.readouterr().err
    assert listeners == before

"""The command line: every message, every exit status, and what is and is not left in the folder."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
import tomllib
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from conftest import ROOT

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.model.settings import OUTPUTS

ENVIRONMENT = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}

#: Seconds after which something hangs, on a machine however slow.
HANGS = 1200.0

SYSTEM = 'contact = "fixed-wall"'
GRID = "r = [0.3, 0.8]\nbeta = [0.1, 0.5, 1.5]"


def toml(system=SYSTEM, grid=GRID, solver="", top=""):
    return f"{top}\n[system]\n{system}\n[grid]\n{grid}\n[solver]\n{solver}\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with a good configuration in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.toml").write_text(toml())
    return tmp_path


def listing(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in folder.rglob("*")
    }


def status_of(arguments):
    """Exit status of a command line, given as one string or as a list."""
    try:
        return main(shlex.split(arguments) if isinstance(arguments, str) else arguments)
    except SystemExit as stop:  # of argparse
        return stop.code


def assert_refused(capsys, folder, arguments, *words, status=2):
    """One line on standard error with these words in it; nothing printed, nothing written."""
    before = listing(folder)
    assert status_of(arguments) == status
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("frictionmap")
    assert re.fullmatch(r"[^\n]+\n", err), err
    for word in words:
        assert word in err
    assert listing(folder) == before


# Bad configurations: what the message says

BAD_CONFIGURATIONS = {
    "brackets without end": ("a = " + "[" * 5000, ["bad.toml", "TOML"]),
    "a number of thousands of digits": ("a = " + "1" * 5000, ["bad.toml", "TOML"]),
    # unknown keys, at each level
    "unknown key with a line break": (toml(top='"a\\nb" = 1'), ["unknown key 'a\\nb'"]),
    "unknown axis key": (
        toml(grid="beta = 1\nr = { start = 0, stop = 1, stepp = 0.1 }"),
        ["unknown key 'grid.r.stepp'", "did you mean step?", "start, stop, step, num, values"],
    ),
    # missing and misplaced
    "no grid": ("[system]", ["grid.r must be a number", "got nothing"]),
    "no beta": (toml(grid="r = 1"), ["grid.beta must be a number", "got nothing"]),
    "system is not a table": ("system = 5", ["system must be a table", "got 5"]),
    # wrong types
    "text for a number": (toml(solver='tolerance = "1e-9"'), ["solver.tolerance must be a number", "'1e-9'"]),
    "true for a number": (toml(system="damping_ratios = true"), ["system.damping_ratios", "number", "True"]),
    "true for a whole number": (toml(solver="cycles = true"), ["solver.cycles", "whole number", "True"]),
    "text in an axis": (toml(grid='r = [1, "2"]\nbeta = 1'), ["grid.r[1] must be a number", "'2'"]),
    "true in an axis": (toml(grid="r = [true]\nbeta = 1"), ["grid.r[0] must be a number", "True"]),
    "true for an axis": (toml(grid="r = true\nbeta = 1"), ["grid.r", "a number, a list", "True"]),
    "a date for an axis": (toml(grid="r = 2020-01-01\nbeta = 1"), ["grid.r", "a number, a list", "2020"]),
    "text in an axis table": (
        toml(grid='beta = 1\nr = { start = "0", stop = 1, num = 3 }'),
        ["grid.r.start must be a number", "'0'"],
    ),
    "a fraction for num": (
        toml(grid="beta = 1\nr = { start = 0, stop = 1, num = 2.5 }"),
        ["grid.r.num must be a whole number", "2.5"],
    ),
    # out of range
    "r too large": (toml(grid="r = [1, 1e9]\nbeta = 1"), ["grid.r must be <= 1e+08", "index 1"]),
    "zeta in a list < 0": (toml(system="damping_ratios = [-0.1]"), ["system.damping_ratios[0]", ">= 0"]),
    "zeta not finite": (toml(system="damping_ratios = nan"), ["system.damping_ratios", "finite", "nan"]),
    "inf in an axis": (toml(grid="r = 1\nbeta = [1, inf]"), ["grid.beta[1] must be finite", "inf"]),
    "inf for an axis": (toml(grid="r = inf\nbeta = 1"), ["grid.r must be finite", "inf"]),
    "nan as a start": (
        toml(grid="beta = 1\nr = { start = nan, stop = 1, num = 2 }"),
        ["grid.r.start must be finite", "nan"],
    ),
    "an integer beyond all doubles": (toml(grid=f"beta = 1\nr = 1{400 * '0'}"), ["grid.r", "finite", "inf"]),
    # solver
    "too many cycles": (toml(solver="cycles = 10_000_000_000"), ["solver.cycles must be <= 1e+09"]),
    "a tolerance of zero": (toml(solver="tolerance = 0"), ["solver.tolerance must be >= 1e-15", "got 0"]),
    # system
    "a mass as text": (toml(system='mass_ratios = "1"'), ["system.mass_ratios must be a list", "'1'"]),
}


@pytest.mark.parametrize(("text", "words"), BAD_CONFIGURATIONS.values(), ids=BAD_CONFIGURATIONS)
def test_bad_configuration(folder, capsys, text, words):
    (folder / "bad.toml").write_text(text)
    assert_refused(capsys, folder, ["map", "bad.toml"], *words)


@pytest.mark.parametrize("command", ["map", "boundaries", "response --r 1 --beta 1"])
def test_configurations_that_cannot_be_read(folder, capsys, command):
    command, *more = command.split()
    (folder / "latin.toml").write_bytes('title = "é"'.encode("latin-1"))
    (folder / "result.nc").write_bytes(b"\x89HDF\r\n")
    (folder / "a folder").mkdir()
    for name, word in (
        ("missing.toml", "No such file or directory"),
        ("a folder", "directory"),
        ("good.toml/x.toml", "Not a directory"),
        ("latin.toml", "it is not text in UTF-8"),
        ("result.nc", "results are read by frictionmap plot, info and export"),
    ):
        assert_refused(capsys, folder, [command, name, *more], f"cannot read configuration {name}: ", word)


@pytest.mark.parametrize(
    ("grid", "words"),
    [
        (
            "r = { start = 0, stop = 1, step = 1e-6 }\nbeta = { start = 0, stop = 1, num = 1_000_000 }",
            ["grid must have at most 1e+09 cells", "got 1e+12", "1000001 r x 1000000 beta"],
        ),
        ("r = { start = 0, stop = 1, step = 1e-12 }\nbeta = 1", ["grid.r.step", "at most 1e+09", "1e+12"]),
        ("r = { start = 0, stop = 1, step = 5e-324 }\nbeta = 1", ["grid.r.step", "at most 1e+09", "5e-324"]),
        ("beta = { start = 0, stop = 1, num = 1_000_000_000_000 }\nr = 1", ["grid.beta.num", "<= 1e+09"]),
        (
            f"r = {{ start = 0, stop = 1, num = 100_000_000 }}\nbeta = 1\nmu = {list(range(1, 21))}",
            ["at most 1e+09 cells", "20 mu x 100000000 r"],
        ),
    ],
)
def test_huge_grids_are_refused_at_once_and_without_memory(folder, capsys, grid, words):
    (folder / "huge.toml").write_text(toml(grid=grid))
    tracemalloc.start()
    began = time.perf_counter()
    try:
        assert_refused(capsys, folder, ["map", "huge.toml"], *words)
        assert tracemalloc.get_traced_memory()[1] < 5e6
    finally:
        tracemalloc.stop()
    assert time.perf_counter() - began < 5.0  # it takes some milliseconds


# Bad arguments


def test_an_argument_that_no_file_can_record(folder, capsys):
    assert_refused(capsys, folder, ["map", "good.toml", "--set", "title=\udcff"], "UTF-8", r"'title=\udcff'")


def test_an_argument_with_a_line_break(folder, capsys):
    assert_refused(capsys, folder, ["map", "good.toml", "a\nb"], "unrecognized arguments: a b")


@pytest.mark.parametrize("override", ["solver.steps=9\nsolver.cycles=5", "title=one\ntwo", "grid.r\r\n=1"])
def test_an_override_with_a_line_break(folder, capsys, override):
    assert_refused(capsys, folder, ["map", "good.toml", "--set", override], "--set must be one line")


def test_files_of_others(folder, capsys):
    xr.Dataset({"regime": ("x", [1.0])}).to_netcdf(folder / "foreign.nc")
    xr.Dataset({"t": ("x", [1.0])}, attrs={"source": "frictionmap 1"}).to_netcdf(folder / "strange.nc")
    undecodable = xr.Dataset({"t": ("x", [1.0], {"units": "days since never"})})
    undecodable.to_netcdf(folder / "undecodable.nc")
    for command in ("plot", "info"):
        for name, word in (
            ("foreign.nc", "its source is 'not given'"),
            ("strange.nc", "give a file written by frictionmap"),
            ("undecodable.nc", "its source is 'not given'"),
        ):
            assert_refused(capsys, folder, [command, name], f"cannot read {name}: ", word)
    first = "compute it first, e.g. frictionmap map good.toml"
    refusal = "cannot read results from good.toml: it is a configuration"
    assert_refused(capsys, folder, ["info", "good.toml"], refusal, first)
    assert status_of(["plot", "good.toml"]) == 0  # of its structure


OUTPUT_COMMANDS = [
    "map good.toml",
    "boundaries good.toml",
    "response good.toml --r 0.8 --beta 0.1",
    "plot ours.nc",
]


@pytest.mark.parametrize("command", OUTPUT_COMMANDS)
def test_outputs_that_cannot_be_written(folder, capsys, command):
    assert status_of("map good.toml -o ours.nc --quiet") == 0
    for ending in ("png", "nc"):
        (folder / f"dir.{ending}").mkdir()
        (folder / f"old.{ending}").write_text("old")
    for output, words in (
        ("none/out.png", ["-o must be in an existing folder", "none/out.png"]),
        ("good.toml/out.png", ["-o must be in an existing folder", "good.toml/out.png"]),
        ("dir.png", ["-o must be a file", "folder dir.png"]),
        ("-", ["-o: must be the name of a file; got '-'"]),
        ("", ["-o: must be the name of a file; got ''"]),
        ("new.png/", ["-o: must be the name of a file; got 'new.png/'"]),
        ("old.png", ["old.png: it already exists", "--overwrite"]),
        ("x" * 300 + ".png", ["cannot write x", "too long"]),
    ):
        if not command.startswith("plot"):
            output, words = output.replace(".png", ".nc"), [word.replace(".png", ".nc") for word in words]
        assert_refused(capsys, folder, [*command.split(), "-o", output], *words)
        if not output.startswith("old."):
            assert_refused(capsys, folder, [*command.split(), "-o", output, "--overwrite"], *words)
    if hasattr(os, "mkfifo"):  # stands for /dev/null, which a test must not endanger
        pipe = "pipe.png" if command.startswith("plot") else "pipe.nc"
        os.mkfifo(folder / pipe)
        assert_refused(capsys, folder, f"{command} -o {pipe} --overwrite", "-o must be an ordinary file")


@pytest.mark.parametrize("command", OUTPUT_COMMANDS)
def test_no_output_is_an_input(folder, capsys, command):
    """Whatever its name: the configuration, its matrices, the file that is drawn."""
    np.savez(folder / "frame.npz", M=np.eye(1), K=np.eye(1))
    (folder / "good.toml").write_text(toml(system=f'{SYSTEM}\nmatrices = "frame.npz"'))
    assert status_of("map good.toml -o ours.nc --quiet") == 0
    (folder / "ours.png").symlink_to("ours.nc")
    (folder / "link").symlink_to("good.toml")
    (folder / "hard").hardlink_to(folder / "frame.npz")
    (folder / "same.nc").symlink_to("good.toml")
    names = ["ours.png"] if command.startswith("plot") else ["same.nc", "link", "hard"]
    for name in names:
        for overwrite in ([], ["--overwrite"]):
            words = [f"cannot write {name}: it is the input file"]
            assert_refused(capsys, folder, [*command.split(), "-o", name, *overwrite], *words)


def test_a_file_named_like_what_is_read(folder, capsys):
    """The default name of the output of a configuration x.nc is x.nc."""
    (folder / "x.nc").write_text(toml())
    assert_refused(capsys, folder, "map x.nc --overwrite", "cannot write x.nc: it is the input file")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission(folder, capsys):
    (folder / "closed").mkdir(mode=0o500)
    words = ["cannot write", "Permission denied"]
    assert_refused(capsys, folder, ["map", "good.toml", "-o", "closed/out.nc"], *words)


def test_a_map_that_cannot_be_drawn(folder, capsys):
    assert status_of(["map", "good.toml", "--quiet", "--set", 'solver.outputs=["cycles"]']) == 0
    assert_refused(capsys, folder, ["plot", "good.nc"], "regime or stops_per_cycle", "neither")


def test_user_errors_without_a_traceback_from_the_shell(folder):
    for arguments, word in (
        (["map", "missing.toml"], "missing.toml"),
        (["mapp"], "mapp"),
        (["--verison"], "--version"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "frictionmap", *arguments],
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
            timeout=HANGS,
        )
        assert done.returncode == 2
        assert done.stdout == ""
        assert word in done.stderr
        assert done.stderr.count("\n") == 1
    assert list(listing(folder)) == ["good.toml"]


# Trouble that is nobody's fault: exit status 1


def test_an_undamped_resonance_has_no_response(folder, capsys):
    arguments = "response good.toml --r 1 --beta 0.3"
    assert_refused(capsys, folder, arguments, "r = 1, beta = 0.3", "undamped resonance", status=1)


@pytest.mark.parametrize(
    ("error", "word"),
    [
        (MemoryError(), "MemoryError"),
        (MemoryError("Unable to allocate 8 GiB"), "8 GiB"),
        (OSError(28, "No space left on device"), "cannot write good.nc: No space left on device"),
        (RuntimeError("NetCDF: HDF error"), "check disk space"),
    ],
)
def test_trouble_while_writing(folder, capsys, monkeypatch, error, word):
    def fail(self, path, **options):
        Path(path).write_text("half")
        raise error

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    assert_refused(capsys, folder, ["map", "good.toml", "--quiet"], word, status=1)


# Good paths


def output_of(capsys, arguments):
    """What is printed; on standard error are at most the lines of a map, which is no terminal."""
    assert status_of(arguments) == 0
    out, err = capsys.readouterr()
    assert re.fullmatch(
        r"(frictionmap: first use: compiling, .*\n)?(frictionmap: map of \d+ cells: \d+ % done.*\n)?",
        err,
    )
    if "--quiet" in arguments:
        assert err == ""
    return out


def test_every_command_with_default_names(folder, capsys):
    assert re.fullmatch(
        r"6 cells \(2 permanent sticking, 2 stick slip, 2 continuous\) in \S+ s; wrote good\.nc\n",
        output_of(capsys, ["map", "good.toml"]),
    )
    out = output_of(capsys, ["boundaries", "good.toml"])
    assert re.fullmatch(r"boundaries at 2 frequencies, 1 mu in \S+ m?s; wrote good-boundaries\.nc\n", out)
    out = output_of(capsys, "response good.toml --r 0.3 --beta 0.5")
    assert re.fullmatch(r"stick slip, 2 stops per cycle, .*; wrote good-response\.nc\n", out)
    for name in ("good", "good-boundaries", "good-response"):
        assert output_of(capsys, ["plot", f"{name}.nc"]) == f"wrote {name}.png\n"
    assert sorted(listing(folder)) == sorted(
        ["good.toml"]
        + [f"good{kind}.{ending}" for kind in ("", "-boundaries", "-response") for ending in ("nc", "png")]
    )


def test_info(folder, capsys):
    status_of(
        ["map", "good.toml", "--quiet", "--set", f"solver.outputs={list(OUTPUTS)}", "--set", "title=A map"]
    )
    brief = output_of(capsys, ["info", "good.nc"])
    listed = brief.split("variables (info --verbose describes them)\n")[1].splitlines()
    assert listed[-1].startswith("cells by stops per cycle")
    assert {*OUTPUTS, "beta_lim", "beta_stick"} <= {*" ".join(listed).replace(",", "").split()}
    assert "history" not in brief
    out = output_of(capsys, ["info", "good.nc", "--verbose"])
    lines = out.splitlines()
    assert lines[0] == "A map [map]"
    assert "one mass" in out
    assert re.search(r"^  r +0\.3, 0\.8$", out, re.MULTILINE)
    assert "6 cells (2 permanent sticking, 2 stick slip, 2 continuous)" in lines
    errors = [name for name in OUTPUTS if name.endswith("_error")]
    for name in {*OUTPUTS, "beta_lim", "beta_stick"} - {*errors}:
        assert re.search(rf"^  {name} +\(mu, r", out, re.MULTILINE)
    assert f"standard errors       {', '.join(errors)}" in " ".join(out.split("\n                       "))
    assert len(lines) <= 42

    status_of("response good.toml --quiet --r 0.8 --beta 0.1")
    out = output_of(capsys, ["info", "good-response.nc"])
    assert "[response]" in out
    assert re.search(r"^continuous, amplitude 2\.7", out, re.MULTILINE)

    status_of("boundaries good.toml --quiet")
    assert "[boundaries]" in output_of(capsys, ["info", "good-boundaries.nc"])


def test_info_gives_a_remedy_for_unresolved_cells(folder, capsys):
    grid = ["--set", "grid.r=[0.0, 0.5]", "--set", "grid.beta=[0.1]", "--set", 'solver.outputs=["status"]']
    status_of(["map", "good.toml", "--quiet", *grid])
    assert "1 cell quasi_static: at r = 0" in output_of(capsys, ["info", "good.nc"])


@pytest.mark.parametrize(
    "command", ["map good.toml", "boundaries good.toml", "response good.toml --r 2 --beta 0.1"]
)
def test_quiet_prints_nothing(folder, capsys, command):
    assert output_of(capsys, [*command.split(), "--quiet", "-o", "out.nc"]) == ""
    assert output_of(capsys, ["plot", "out.nc", "--quiet", "-o", "out.svg"]) == ""
    assert sorted(listing(folder)) == ["good.toml", "out.nc", "out.svg"]


def test_overwrite_replaces(folder, capsys):
    status_of(["map", "good.toml", "--quiet"])
    first = xr.load_dataset("good.nc")
    status_of(["map", "good.toml", "--quiet", "--overwrite", "--set", "grid.r=0.7"])
    assert first.sizes["r"] == 2
    assert xr.load_dataset("good.nc").r.values.tolist() == [0.7]


def test_overrides_are_kept_in_the_file_and_give_it_again(folder, capsys):
    overrides = [
        "grid.r={ start = 0.3, stop = 0.7, step = 0.2 }",
        "grid.r.num=5",
        "grid.mu=[1, 1.5]",
        "system.contact=joined-base-wall",
        "system.damping_ratios=0.05",
        "solver.start=moving",
        'solver.outputs=["regime", "contact_amplitude"]',
        'title=with "quotes" and \\ in it',
    ]
    status_of(["map", "good.toml", "--quiet", *(a for text in overrides for a in ("--set", text))])
    first = xr.load_dataset("good.nc")
    tree = tomllib.loads(first.attrs["config"])
    assert tree["grid"]["r"] == {"start": 0.3, "stop": 0.7, "num": 5}
    assert tree["solver"]["start"] == "moving"
    assert first.attrs["title"] == tree["title"] == 'with "quotes" and \\ in it'
    assert list(first.data_vars)[:2] == ["regime", "contact_amplitude"]

    (folder / "again.toml").write_text(first.attrs["config"])
    status_of(["map", "again.toml", "--quiet"])
    again = xr.load_dataset("again.nc")
    assert again.attrs.pop("history") != first.attrs.pop("history")
    xr.testing.assert_identical(again, first)


def test_history_has_the_command_line(folder):
    status_of(["map", "good.toml", "--quiet", "-o", "a b.nc"])
    history = xr.load_dataset("a b.nc").attrs["history"]
    assert re.fullmatch(
        r"20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ frictionmap map good\.toml --quiet -o 'a b\.nc'", history
    )


def test_map_and_response_and_library_agree(folder):
    status_of("map good.toml --quiet --threads 1")
    status_of("response good.toml --quiet --r 0.3 --beta 0.5")
    ds, one = xr.load_dataset("good.nc"), xr.load_dataset("good-response.nc")
    cell = ds.sel(mu=1.0, r=0.3, beta=0.5)
    for name in ("regime", "stops_per_cycle"):
        assert cell[name] == one[name]
    assert float(cell.contact_amplitude) == pytest.approx(float(one.contact_amplitude), rel=1e-12)
    direct = fm.sweep(fm.System(), [0.3, 0.8], [0.1, 0.5, 1.5])
    for name in direct.variables:
        np.testing.assert_array_equal(ds[name], direct[name], strict=True)


def test_response_takes_the_mu_of_its_configuration(folder):
    """One value is it, whatever it is; --mu goes before it."""
    for grid, option, mu in (("1.5", "", 1.5), ("[2]", "", 2.0), ("[1, 2]", "--mu 1.2", 1.2)):
        status_of(
            f"response good.toml --quiet --overwrite --r 0.8 --beta 0.5 --set 'grid.mu={grid}' {option}"
        )
        assert float(xr.load_dataset("good-response.nc").mu) == mu
    status_of("response good.toml --quiet --overwrite --r 0.8 --beta 0.5")
    assert float(xr.load_dataset("good-response.nc").mu) == 1.0


@pytest.mark.parametrize("arguments", [["--help"], ["map", "--help"], ["--version"], ["-V"], ["help"]])
def test_help_and_version(capsys, arguments):
    assert status_of(arguments) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "frictionmap" in out
    if arguments == ["--help"]:
        for command in ("map", "curves", "response", "plot", "info"):
            assert re.search(rf"^ +{command}\b", out, re.MULTILINE)
        for older in ("boundaries", "schema", "completion"):
            assert not re.search(rf"^ +{older}\b", out, re.MULTILINE)


def test_help_on_a_command_is_its_own_help(capsys):
    assert status_of(["help", "map"]) == 0
    said = capsys.readouterr().out
    assert status_of(["map", "--help"]) == 0
    assert said == capsys.readouterr().out


def test_a_summary_for_scripts(folder, capsys):
    assert status_of("map good.toml -o ours.nc --quiet") == 0
    capsys.readouterr()
    assert status_of("info ours.nc --json") == 0
    found = json.loads(capsys.readouterr().out)
    ds = xr.load_dataset("ours.nc")
    assert found["kind"] == "map"
    assert found["sizes"] == dict(ds.sizes)
    assert found["axes"]["r"]["first"] == ds.r[0]
    assert found["axes"]["beta"]["last"] == ds.beta[-1]
    assert sum(found["cells"].values()) == ds.regime.size
    assert found["cells"]["continuous"] == int((ds.regime == 2).sum())
    assert found["variables"]["regime"]["dimensions"] == ["mu", "r", "beta"]
    assert status_of(["info", "ours.nc", "--json", "--at", f"r={float(ds.r[1])!r}"]) == 0
    assert json.loads(capsys.readouterr().out)["sizes"]["r"] == 1


def test_a_summary_of_one_cell_for_scripts(folder, capsys):
    assert status_of("response good.toml --r 0.8 --beta 0.5 --mu 1 -o one.nc --quiet") == 0
    capsys.readouterr()
    assert status_of("info one.nc --json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["kind"] == "response"
    assert sum(found["cells"].values()) == 1


def test_csv_on_standard_output_is_that_of_the_file(folder, capsys):
    assert status_of("map good.toml -o ours.nc --quiet") == 0
    assert status_of("export ours.nc -o ours.csv --quiet") == 0
    capsys.readouterr()
    before = sorted(folder.iterdir())
    assert status_of("export ours.nc -o -") == 0
    assert capsys.readouterr().out == (folder / "ours.csv").read_text()
    assert sorted(folder.iterdir()) == before


# On a terminal: progress and Ctrl-C


def start_on_a_terminal(arguments):
    """The program with a terminal as its standard error; the other end of it."""
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "frictionmap", *arguments]
    process = subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    return process, ours


def read_until(terminal, word, seconds=HANGS):
    text = ""
    deadline = time.monotonic() + seconds
    while word not in text and time.monotonic() < deadline:
        try:
            text += os.read(terminal, 4096).decode()
        except OSError:  # what Linux says when the other end is closed
            break
    return text


def close(process, terminal):
    process.kill()
    process.wait()
    process.stdout.close()
    os.close(terminal)


#: Every cell of it is marched, some 17,000 a second on one processor: three minutes there.
SLOW_GRID = [
    "--set", 'solver.steady="marched"',
    "--set", "grid.mu=1.5",
    "--set", "grid.r={ start = 0.02, stop = 0.3, num = 3000 }",
    "--set", "grid.beta={ start = 0.01, stop = 0.5, num = 1000 }",
]  # fmt: skip

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="terminals and signals of POSIX")


@POSIX
def test_interrupt(folder):
    """Ctrl-C during a long map: the end within seconds, and nothing is left."""
    process, terminal = start_on_a_terminal(["map", "good.toml", *SLOW_GRID])
    try:
        assert re.search(r"\r +[0-9.]+ %  about [0-9.]+ (s|min|h) left", read_until(terminal, " left"))
        assert process.poll() is None
        began = time.perf_counter()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=HANGS) == 130
        assert time.perf_counter() - began < 25.0  # two seconds, on a machine ten times slower
        text = read_until(terminal, "nothing was written")
        assert "frictionmap: interrupted; nothing was written" in text
        assert "Traceback" not in text
        assert process.stdout.read() == b""
        assert list(listing(folder)) == ["good.toml"]
    finally:
        close(process, terminal)

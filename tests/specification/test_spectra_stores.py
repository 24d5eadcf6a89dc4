"""Stores of spectra: block by block the same bits as at once, however a run was stopped."""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap import InputError
from frictionmap.command_line.cli import main
from frictionmap.motions.spectra import checked_spectra
from frictionmap.stores.cuts import cut_by_cost
from frictionmap.stores.run import fill_store, in_this_process
from frictionmap.stores.spectra import spectra_of
from frictionmap.stores.store import opened
from frictionmap.version import _NO_MATTER

pytest.importorskip("zarr")

PACKAGE = Path(fm.__file__).parent
AXES = {
    "period": np.geomspace(0.3, 9.0, 7),
    "friction": [0.0, 0.1, 0.3],
    "mu": [1.0, 1.5],
    "scale": [0.5, 2.0],
}
CONFIG = """
title = "Spectra of random loads"
[record]
generate = { kind = "white", rms = 1.0, duration = 40.0, dt = 0.1, seed = 3, count = 6 }
[spectrum]
period = { start = 0.5, stop = 20.0, num = 9, spacing = "log" }
friction = [0.1, 0.2, 0.5]
damping = 0.05
"""
#: The same with some seconds of work.
LONG = ["--set", "record.generate.duration=20000.0", "--set", "spectrum.period.num=60"]


def suite(count=3, **more):
    return fm.Record.generate("white", 30.0, 0.1, rms=1.0, seed=5, count=count, **more)


def stored(path):
    with xr.open_zarr(path, consolidated=False, chunks=None) as ds:
        return ds.load()


def same(one, other):
    assert set(other.data_vars) <= set(one.data_vars)
    for name, variable in other.variables.items():
        assert one[name].dims == variable.dims
        assert one[name].dtype == variable.dtype
        np.testing.assert_array_equal(one[name].values, variable.values)
        assert one[name].attrs["long_name"] == variable.attrs["long_name"]


@pytest.mark.parametrize(
    ("records", "cells"),
    [(suite(), 10**6), (suite(), 12), (suite(), 25), (suite(quantity="displacement"), 40),
     (suite(5, unit="g", interpolation="cubic"), 400),
     ([fm.Record.pulse("half-sine", 1.0, 3.0), *suite(2)], 25)],
)  # fmt: skip
def test_a_store_is_the_spectra_to_the_bit(tmp_path, records, cells):
    axes = AXES | ({"friction": ["0.1 g", "0.3 g"]} if records[0].unit else {})
    wanted = spectra_of(checked_spectra(records, **axes, damping=0.02))
    path = tmp_path / "s.zarr"
    fill_store(path, wanted, "s", in_this_process(2), find_cut=lambda one: one.cut_at(cells))
    same(stored(path), fm.spectrum(records, **axes, damping=0.02))
    again = opened(path).study  # as workers build it
    assert again.description("s") == wanted.description("s")
    np.testing.assert_array_equal(again.records[-1].values, records[-1].values)
    for found, given in zip(again.records[0].series or (), records[0].series or (), strict=True):
        np.testing.assert_array_equal(found, given)  # of pulses, which are exact between samples


def test_a_store_in_python(tmp_path):
    """Stopped and repeated, the same bits as in memory."""
    records, path = suite(), tmp_path / "s.zarr"

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fm.spectrum(records, **AXES, store=path, threads=1, progress=stop)
    ds = fm.spectrum(records, **AXES, store=str(path))
    same(ds, fm.spectrum(records, **AXES))
    assert fm.open(path).attrs["title"] == "Friction response spectra"
    with pytest.raises(InputError, match=r"its configuration differs, spectrum\.damping"):
        fm.spectrum(records, **AXES, damping=0.1, store=path)
    fm.spectrum(records, **AXES, damping=0.1, store=path, overwrite=True)
    with pytest.raises(InputError, match=r"^store must be a path that ends in \.zarr; got 's\.nc'$"):
        fm.spectrum(records, **AXES, store="s.nc")
    with pytest.raises(InputError, match=r"^cannot use watch with store"):
        fm.spectrum(records, **AXES, store=path, watch=lambda: None)


def test_contacts_with_a_spring(tmp_path):
    records, axes = suite(2), {"period": [1.0, 3.0], "friction": [0.1, 0.4], "contact_stiffness": 5.0}
    path, wanted = tmp_path / "s.zarr", spectra_of(checked_spectra(records, **axes))
    fill_store(path, wanted, "s", in_this_process(1), find_cut=lambda one: one.cut_at(2))
    same(stored(path), fm.spectrum(records, **axes))
    with pytest.raises(InputError, match="must be 1 with contact_stiffness"):
        checked_spectra(records, **axes, mu=1.5)


def test_unfinished_spectra_are_marked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    wanted = spectra_of(checked_spectra(suite(), **AXES))
    some = lambda store, batches: islice(in_this_process(1)(store, batches), 2)  # noqa: E731
    fill_store(tmp_path / "s.zarr", wanted, "s", some, find_cut=lambda one: one.cut_at(24))
    ds = fm.open(tmp_path / "s.zarr")
    done = ds.status != 6
    assert 0 < int(done.sum()) < done.size
    np.testing.assert_array_equal(np.isnan(ds.amplitude), ~done)
    assert main(["info", "s.zarr"]) == 0
    assert f"{int((~done).sum())} motions not_computed: of a block of a store" in capsys.readouterr().out
    fill_store(tmp_path / "s.zarr", wanted, "s", in_this_process(1))
    same(stored(tmp_path / "s.zarr"), fm.spectrum(suite(), **AXES))


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("c.toml").write_text(CONFIG)
    assert main(["spectrum", "c.toml", "-o", "s.zarr"]) == 0
    assert re.match(r"Spectra of random loads in [0-9.]+ m?s; wrote s.zarr\n", capsys.readouterr().out)
    assert main(["spectrum", "c.toml", "-o", "s.nc", "--quiet"]) == 0
    store, file = fm.open("s.zarr"), fm.open("s.nc")
    same(store, file)
    assert store.attrs["config"] == file.attrs["config"]
    assert store.attrs["records"] == file.attrs["records"]
    for then in (["info"], ["info", "--json"], ["plot", "-o", "s.png"], ["export", "-o", "s.csv"]):
        assert main([then[0], "s.zarr", *then[1:]]) == 0
    assert Path("s.csv").read_text().count("\n") == file.amplitude.size + 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("spectrum.damping=0.1", "spectrum.damping: 0.05 there, 0.1 now"),
        ("record.generate.seed=4", "its configuration differs, records: "),
        ('spectrum.quantities=["amplitude"]', "names: "),
    ],
)
def test_other_spectra_are_refused(tmp_path, monkeypatch, capsys, change, words):
    monkeypatch.chdir(tmp_path)
    Path("c.toml").write_text(CONFIG)
    few = ["spectrum", "c.toml", "-o", "s.zarr", "--quiet", "--set", "record.generate.count=1"]
    assert main(few) == 0
    assert main(few) == 0
    assert main([*few, "--set", change]) == 2
    assert words in capsys.readouterr().err
    assert main([*few, "--set", change, "--overwrite"]) == 0


def test_a_store_of_maps_is_no_store_of_spectra(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("c.toml").write_text(CONFIG)
    Path("m.toml").write_text("[system]\n[grid]\nr = [0.5, 1.0]\nbeta = [0.1, 0.2]\n")
    assert main(["map", "m.toml", "-o", "m.zarr", "--quiet"]) == 0
    assert main(["spectrum", "c.toml", "-o", "m.zarr", "--quiet"]) == 2
    assert "cannot resume m.zarr: it holds a map" in capsys.readouterr().err


def _is_whole(file: Path) -> bool:
    """A chunk has its name when it is complete; the part that is being written has the suffix .partial."""
    return file.is_file() and file.suffix != ".partial"


@pytest.mark.slow
@pytest.mark.parametrize("workers", [None, 2])
def test_killed_spectra_go_on_to_the_same_bits(tmp_path, workers):
    """Killed as soon as a block is done; the blocks that were done are not done again."""
    if workers:
        pytest.importorskip("distributed")
    (tmp_path / "c.toml").write_text(CONFIG)
    command = [sys.executable, "-m", "frictionmap", "spectrum", "c.toml", *LONG, "-o", "s.zarr", "--quiet"]
    command += ["--workers", str(workers)] if workers else ["--threads", "1"]
    search = os.environ | {"PYTHONPATH": str(Path(fm.__file__).parent.parent)}
    run = subprocess.Popen(command, cwd=tmp_path, env=search, start_new_session=True)
    marks = tmp_path / "s.zarr" / "block_done" / "c"
    while not any(map(_is_whole, marks.rglob("*"))) and run.poll() is None:
        time.sleep(0.002)
    os.killpg(run.pid, signal.SIGKILL)
    assert run.wait() == -signal.SIGKILL
    chunks = {file: file.stat().st_mtime_ns for file in marks.rglob("*") if _is_whole(file)}
    found = opened(tmp_path / "s.zarr").marks()
    assert found.any()
    assert not found.all()
    assert subprocess.run(command, cwd=tmp_path, env=search, timeout=600).returncode == 0
    assert {file: file.stat().st_mtime_ns for file in chunks} == chunks
    at_once = [*command[: command.index("-o")], "-o", "at once.nc", "--quiet"]
    assert subprocess.run(at_once, cwd=tmp_path, env=search, timeout=600).returncode == 0
    same(stored(tmp_path / "s.zarr"), fm.open(tmp_path / "at once.nc"))


def test_blocks_take_a_time_and_every_worker_has_some():
    records = suite(40)
    wanted = spectra_of(checked_spectra(records, np.geomspace(0.5, 50.0, 100), np.linspace(0.0, 1.0, 20)))
    cut = cut_by_cost(wanted)
    assert replace(wanted, cut=cut).blocks >= 40
    assert wanted.cell_seconds(None) == pytest.approx(300 * 3e-8 * np.ceil(
        2.0 * np.pi * 0.1 / np.geomspace(0.5, 50.0, 100)).mean())  # fmt: skip


@pytest.mark.parametrize("stiffness", [None, 1.0])
def test_all_that_computes_blocks_is_part_of_the_state(stiffness):
    """Rooms that the state leaves out are loaded, to read files of records, but nothing of them is called."""
    wanted = spectra_of(checked_spectra(suite(2), 2.0, 0.1, contact_stiffness=stiffness))
    rooms = set()

    def seen(frame, event, _):
        path = Path(frame.f_code.co_filename)
        if event == "call" and path.is_relative_to(PACKAGE):
            rooms.add(path.relative_to(PACKAGE).parts[0])

    _ = wanted.sample  # what is imported late
    threading.setprofile(seen)
    sys.setprofile(seen)
    try:
        wanted.compute(wanted.batch((0, 0)), 1)
    finally:
        threading.setprofile(None)
        sys.setprofile(None)
    assert "motions" in rooms
    assert not rooms & _NO_MATTER
